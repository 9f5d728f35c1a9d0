//! The four forms of text that orbit files come in, read into names and values with their places.

pub mod csv;
pub mod json;
pub mod kvn;
pub mod xml;

use super::entry::TextPosition;
use std::borrow::Cow;

/// Finds the line of a byte. It stores a mark at regular distances, so that neither a text of one line nor a text of line breaks only costs much
/// memory or time.
pub struct Lines<'t> {
    text: &'t [u8],
    /// Of each block's first byte: its line, from 1, and where that line begins.
    marks: Vec<(usize, usize)>,
}

/// Bytes from mark to mark.
const BLOCK: usize = 512;

impl<'t> Lines<'t> {
    pub fn of(text: &'t str) -> Self {
        let text = text.as_bytes();
        let mut marks = Vec::with_capacity(text.len() / BLOCK + 1);
        let mut mark = (1, 0);
        for (index, block) in text.chunks(BLOCK).enumerate() {
            marks.push(mark);
            mark = through(block, index * BLOCK, mark);
        }
        Self { text, marks }
    }

    /// The place of byte `at`.
    pub fn place(&self, at: usize) -> TextPosition {
        let at = at.min(self.text.len());
        let block = (at / BLOCK).min(self.marks.len().saturating_sub(1));
        let mark = self.marks.get(block).copied().unwrap_or((1, 0));
        let before = self.text.get(block * BLOCK..at).unwrap_or_default();
        let (line, begin) = through(before, block * BLOCK, mark);
        TextPosition {
            line,
            column: at - begin + 1,
        }
    }
}

/// Line number and start of line after `bytes`, which begin at `first`.
fn through(bytes: &[u8], first: usize, mark: (usize, usize)) -> (usize, usize) {
    let breaks = bytes.iter().enumerate().filter(|&(_, &b)| b == b'\n');
    breaks.fold(mark, |(line, _), (at, _)| (line + 1, first + at + 1))
}

/// Where `part`, a piece of `whole`, begins in it.
pub fn offset(whole: &str, part: &str) -> usize {
    (part.as_ptr() as usize).saturating_sub(whole.as_ptr() as usize)
}

/// With lines that end in line feeds where all end in carriage returns alone, as old Macintoshes write them. Every byte keeps its
/// place.
pub fn with_line_feeds(text: &str) -> Cow<'_, str> {
    match text.contains('\r') && !text.contains('\n') {
        true => Cow::Owned(text.replace('\r', "\n")),
        false => Cow::Borrowed(text),
    }
}

/// The text without a byte order mark.
pub fn unmarked(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_has_its_place() {
        for text in [
            String::new(),
            "a\n\nbc\n".to_owned(),
            "\n".repeat(2000),
            "x".repeat(2000),
            "some words\nand a line\n".repeat(100),
        ] {
            let lines = Lines::of(&text);
            let (mut line, mut column) = (1, 1);
            for (at, byte) in text.bytes().enumerate() {
                assert_eq!(lines.place(at), TextPosition { line, column }, "{at}");
                (line, column) = match byte {
                    b'\n' => (line + 1, 1),
                    _ => (line, column + 1),
                };
            }
            assert_eq!(lines.place(text.len()), TextPosition { line, column });
            assert_eq!(lines.place(text.len() + 9), TextPosition { line, column });
        }
    }
}
