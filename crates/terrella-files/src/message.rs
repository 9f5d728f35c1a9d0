//! Text from outside in messages: one bound on its length, and nothing in it that a terminal would obey.

use std::fmt::Display;

/// Most characters that a message quotes of one text from outside: a file, a server, a name, the words of a decoder.
pub const MAX_QUOTED_CHARS: usize = 200;

/// Most characters of a cause.
const CAUSE_CHARS: usize = 600;

/// Most characters of an excerpt.
const EXCERPT_CHARS: usize = 60;

/// Text from outside, fit for a message: [`MAX_QUOTED_CHARS`] at most, with the number of characters left out, and without
/// line breaks, control characters or marks that reorder text.
pub fn printable(text: &str) -> String {
    bounded(text, MAX_QUOTED_CHARS)
}

/// A sentence about an error in a file, which may contain several untrusted texts: at most 600 characters, otherwise as [`printable`].
pub fn cause(text: impl Display) -> String {
    bounded(&text.to_string(), CAUSE_CHARS)
}

fn bounded(text: &str, max_chars: usize) -> String {
    let (mut quoted, left_out) = escaped(text, max_chars);
    if left_out > 0 {
        quoted.push_str(&format!("… ({left_out} more characters)"));
    }
    quoted
}

/// The beginning of a value in a file: of its first line 60 characters at most, then `…` if there is more. Otherwise as [`printable`].
pub fn excerpt(text: &str) -> String {
    let text = text.trim();
    let line = text.lines().next().unwrap_or_default();
    let (mut quoted, left_out) = escaped(line, EXCERPT_CHARS);
    if left_out > 0 || line.len() < text.len() {
        quoted.push('…');
    }
    quoted
}

/// At most so many characters, counted after they are escaped, and how many of the text's are left out.
fn escaped(text: &str, max_chars: usize) -> (String, usize) {
    let mut quoted = String::new();
    let mut length = 0;
    for (index, c) in text.char_indices() {
        let added = if is_unprintable(c) {
            c.escape_unicode().len()
        } else {
            1
        };
        if length + added > max_chars {
            return (quoted, text[index..].chars().count());
        }
        length += added;
        match added {
            1 => quoted.push(c),
            _ => quoted.extend(c.escape_unicode()),
        }
    }
    (quoted, 0)
}

/// Control characters, separators of lines, and marks that reorder text: a message must read as it is written.
pub fn is_unprintable(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_bounded_and_says_how_much_is_left_out() {
        assert_eq!(printable("day.png"), "day.png");
        assert_eq!(printable(&"x".repeat(200)), "x".repeat(200));
        let long = format!("{}… (38400 more characters)", "x".repeat(200));
        assert_eq!(printable(&"x".repeat(38_600)), long);
    }

    #[test]
    fn nothing_in_it_moves_a_cursor_or_reorders_text() {
        assert_eq!(
            printable("a\u{1b}[2Jb\u{202e}c\nd"),
            "a\\u{1b}[2Jb\\u{202e}c\\u{a}d"
        );
        // Escapes count too: 33 of them have 6 characters each.
        let hostile = printable(&"\u{1b}".repeat(10_000));
        assert_eq!(
            hostile,
            format!("{}… (9967 more characters)", "\\u{1b}".repeat(33))
        );
    }

    #[test]
    fn an_excerpt_is_the_beginning_of_one_line() {
        assert_eq!(excerpt("  [1, 2]\n"), "[1, 2]");
        assert_eq!(excerpt("[\n1,\n]"), "[…");
        assert_eq!(excerpt(&"é".repeat(61)), format!("{}…", "é".repeat(60)));
    }
}
