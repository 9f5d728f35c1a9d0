//! Rust source as words: without comments, with string contents set apart, and with test code marked.

/// A piece of source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Word {
    /// A name, keyword or number.
    Name(String),
    /// The contents of a string literal, escapes as written.
    Text(String),
    /// A punctuation mark.
    Mark(char),
}

/// A word and its position.
#[derive(Clone, Debug)]
pub struct Token {
    pub word: Word,
    /// Line, from 1.
    pub line: usize,
    /// It belongs to an item under `#[cfg(test)]`.
    pub in_test: bool,
    /// Depth of its enclosing inline modules.
    pub inline_modules: usize,
}

impl Token {
    pub fn is_name(&self, name: &str) -> bool {
        matches!(&self.word, Word::Name(n) if n == name)
    }

    pub fn is_mark(&self, mark: char) -> bool {
        self.word == Word::Mark(mark)
    }

    /// The name, if it is one.
    pub fn name(&self) -> Option<&str> {
        match &self.word {
            Word::Name(name) => Some(name),
            _ => None,
        }
    }
}

/// A source file.
#[derive(Clone, Debug)]
pub struct File {
    /// Path from the repository's root, with `/`.
    pub path: String,
    /// Its words.
    pub tokens: Vec<Token>,
    /// Number of lines.
    pub lines: usize,
}

impl File {
    /// Reads a source text.
    pub fn new(path: &str, text: &str) -> Self {
        let mut tokens = split(text);
        mark_tests(&mut tokens);
        mark_modules(&mut tokens);
        if path.ends_with("/tests.rs") || path.contains("/tests/") {
            tokens.iter_mut().for_each(|token| token.in_test = true);
        }
        Self {
            path: path.to_string(),
            tokens,
            lines: text.lines().count(),
        }
    }

    /// A message about a token.
    pub fn at(&self, token: &Token, message: impl std::fmt::Display) -> String {
        format!("{}:{}: {message}", self.path, token.line)
    }

    /// The positions at which these words follow each other. A letter or `_` at its start makes a word a name.
    pub fn find(&self, words: &[&str]) -> Vec<usize> {
        let fits = |(token, word): (&Token, &&str)| match (&token.word, word.chars().next()) {
            (Word::Name(name), _) => name == word,
            (Word::Mark(mark), Some(first)) => *mark == first && word.len() == 1,
            _ => false,
        };
        let starts = self.tokens.windows(words.len()).enumerate();
        starts
            .filter(|(_, window)| window.iter().zip(words).all(fits))
            .map(|(start, _)| start)
            .collect()
    }
}

/// The position after the bracket that closes the one at `open`; the end of the tokens if there is none.
pub fn after_group(tokens: &[Token], open: usize) -> usize {
    let mut depth = 0_usize;
    for (i, token) in tokens.iter().enumerate().skip(open) {
        match token.word {
            Word::Mark('{' | '(' | '[') => depth += 1,
            Word::Mark('}' | ')' | ']') => {
                depth = depth.saturating_sub(1);
                if depth == 0 {
                    return i + 1;
                }
            }
            _ => {}
        }
    }
    tokens.len()
}

fn split(text: &str) -> Vec<Token> {
    let chars: Vec<char> = text.chars().collect();
    let at = |i: usize| chars.get(i).copied().unwrap_or('\0');
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    let mut tokens = Vec::new();
    let mut line = 1;
    let mut i = 0;
    while i < chars.len() {
        let start = i;
        let word = match at(i) {
            c if c.is_whitespace() => {
                i += 1;
                None
            }
            '/' if at(i + 1) == '/' => {
                while i < chars.len() && at(i) != '\n' {
                    i += 1;
                }
                None
            }
            '/' if at(i + 1) == '*' => {
                i = after_comment(&chars, i);
                None
            }
            '"' => {
                i = after_string(&chars, i + 1);
                Some(Word::Text(
                    chars[start + 1..i.max(start + 2) - 1].iter().collect(),
                ))
            }
            '\'' if at(i + 1) == '\\' || at(i + 2) == '\'' => {
                // A character, not a lifetime.
                i += if at(i + 1) == '\\' { 3 } else { 2 };
                while i < chars.len() && at(i) != '\'' {
                    i += 1;
                }
                i += 1;
                None
            }
            c if is_name(c) => {
                while is_name(at(i)) {
                    i += 1;
                }
                let name: String = chars[start..i].iter().collect();
                let hashes = chars[i..].iter().take_while(|c| **c == '#').count();
                let raw = matches!(name.as_str(), "r" | "br" | "cr") && at(i + hashes) == '"';
                if raw {
                    let from = i + hashes + 1;
                    i = after_raw_string(&chars, from, hashes);
                    let end = i.saturating_sub(hashes + 1).max(from).min(chars.len());
                    Some(Word::Text(chars[from.min(end)..end].iter().collect()))
                } else {
                    Some(Word::Name(name))
                }
            }
            mark => {
                i += 1;
                Some(Word::Mark(mark))
            }
        };
        if let Some(word) = word {
            tokens.push(Token {
                word,
                line,
                in_test: false,
                inline_modules: 0,
            });
        }
        i = i.min(chars.len());
        line += chars[start..i].iter().filter(|c| **c == '\n').count();
    }
    tokens
}

/// Block comments nest.
fn after_comment(chars: &[char], start: usize) -> usize {
    let mut depth = 0_usize;
    let mut i = start;
    while i < chars.len() {
        match (chars[i], chars.get(i + 1)) {
            ('/', Some('*')) => {
                depth += 1;
                i += 2;
            }
            ('*', Some('/')) => {
                depth -= 1;
                i += 2;
                if depth == 0 {
                    break;
                }
            }
            _ => i += 1,
        }
    }
    i
}

fn after_string(chars: &[char], mut i: usize) -> usize {
    while i < chars.len() && chars[i] != '"' {
        i += if chars[i] == '\\' { 2 } else { 1 };
    }
    (i + 1).min(chars.len())
}

fn after_raw_string(chars: &[char], mut i: usize, hashes: usize) -> usize {
    let closes = |i: usize| {
        chars[i] == '"'
            && chars[i + 1..]
                .iter()
                .take(hashes)
                .filter(|c| **c == '#')
                .count()
                == hashes
    };
    while i < chars.len() && !closes(i) {
        i += 1;
    }
    (i + 1 + hashes).min(chars.len())
}

/// Marks the items under an attribute such as `#[cfg(test)]` or `#[cfg(all(test, unix))]`.
fn mark_tests(tokens: &mut [Token]) {
    let mut i = 0;
    while i < tokens.len() {
        let is_attribute = tokens[i].is_mark('#')
            && tokens.get(i + 1).is_some_and(|t| t.is_mark('['))
            && tokens.get(i + 2).is_some_and(|t| t.is_name("cfg"));
        if !is_attribute {
            i += 1;
            continue;
        }
        let end = after_group(tokens, i + 1);
        let attribute = &tokens[i..end];
        let is_test = attribute.iter().any(|t| t.is_name("test"))
            && !attribute.iter().any(|t| t.is_name("not"));
        if is_test {
            let item_end = after_item(tokens, end);
            tokens[i..item_end]
                .iter_mut()
                .for_each(|t| t.in_test = true);
            i = item_end;
        } else {
            i = end;
        }
    }
}

/// An item ends with its braces, or with a semicolon before any.
fn after_item(tokens: &[Token], start: usize) -> usize {
    let mut i = start;
    while i < tokens.len() {
        match tokens[i].word {
            Word::Mark(';') => return i + 1,
            Word::Mark('{') => return after_group(tokens, i),
            Word::Mark('(' | '[') => i = after_group(tokens, i),
            _ => i += 1,
        }
    }
    tokens.len()
}

fn mark_modules(tokens: &mut [Token]) {
    for i in 0..tokens.len() {
        let is_module = tokens[i].is_name("mod")
            && tokens.get(i + 1).is_some_and(|t| t.name().is_some())
            && tokens.get(i + 2).is_some_and(|t| t.is_mark('{'));
        if is_module {
            let end = after_group(tokens, i + 2);
            tokens[i + 3..end]
                .iter_mut()
                .for_each(|t| t.inline_modules += 1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(text: &str) -> Vec<String> {
        let file = File::new("src/a.rs", text);
        file.tokens
            .iter()
            .filter_map(|t| t.name().map(str::to_string))
            .collect()
    }

    #[test]
    fn comments_and_strings_are_no_names() {
        let text = "//! wgpu\n/* wgpu /* wgpu */ wgpu */ let a = \"wgpu \\\" wgpu\"; let b = r#\"wgpu \" wgpu\"#; // wgpu\nc";
        assert_eq!(names(text), ["let", "a", "let", "b", "c"]);
    }

    #[test]
    fn string_contents_and_lines_are_kept() {
        let file = File::new("src/a.rs", "\n\"a\nb\" \"\" r##\"c\"##\nd");
        let words: Vec<_> = file
            .tokens
            .iter()
            .map(|t| (t.word.clone(), t.line))
            .collect();
        let text = |s: &str| Word::Text(s.into());
        let expected = [
            (text("a\nb"), 2),
            (text(""), 3),
            (text("c"), 3),
            (Word::Name("d".into()), 4),
        ];
        assert_eq!(words, expected);
    }

    #[test]
    fn characters_and_lifetimes_are_distinguished() {
        assert_eq!(
            names("fn f<'a>(x: &'a str) { ('\"', '\\'', '\\u{41}', 'x'); end }"),
            ["fn", "f", "a", "x", "a", "str", "end"]
        );
    }

    #[test]
    fn text_that_ends_early_is_read_to_its_end() {
        for text in [
            "\"",
            "r#\"",
            "/*",
            "'",
            "'\\",
            "\"\\",
            "r#\"a\"",
            "#[cfg(test",
            "mod a {",
            "b'",
        ] {
            File::new("src/a.rs", text);
        }
    }

    #[test]
    fn tests_are_marked() {
        let text = "fn a() {} #[cfg(test)] mod t { fn b() {} } fn c() {} #[cfg(all(test, unix))] use d; e #[cfg(not(test))] fn f() {}";
        let file = File::new("src/a.rs", text);
        let in_test = |name: &str| {
            file.tokens
                .iter()
                .find(|t| t.is_name(name))
                .unwrap()
                .in_test
        };
        assert!(in_test("b") && in_test("d"));
        assert!(!in_test("a") && !in_test("c") && !in_test("e") && !in_test("f"));
        assert!(File::new("src/a/tests.rs", "a").tokens[0].in_test);
    }

    #[test]
    fn words_are_found_in_a_row() {
        let file = File::new("src/a.rs", "a::b(); a . b; label: None");
        assert_eq!(file.find(&["a", ":", ":", "b"]).len(), 1);
        assert_eq!(file.find(&["label", ":", "None"]).len(), 1);
        assert_eq!(file.find(&["b", ":"]).len(), 0);
    }
}
