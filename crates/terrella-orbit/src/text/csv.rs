//! Separated values, a record a line: by commas (RFC 4180), or by the semicolons and tabs that spreadsheets write.

use std::borrow::Cow;

/// A field and the column of its first byte, from 1.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CsvField<'t> {
    pub text: Cow<'t, str>,
    pub column: usize,
}

/// The separator of a table: the first of comma, semicolon and tab in its header, names in quotation marks aside. `None` for a line
/// of one field.
pub fn separator(header: &str) -> Option<char> {
    let mut is_quoted = false;
    header.chars().find(|&c| {
        is_quoted ^= c == '"';
        !is_quoted && matches!(c, ',' | ';' | '\t')
    })
}

/// The lines of a text without empty lines, with their numbers from 1. Trailing tabs are kept: they separate fields.
pub fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let numbered = (1..).zip(text.lines());
    numbered
        .map(|(line, text)| (line, text.trim_end_matches([' ', '\r'])))
        .filter(|(_, text)| !text.trim().is_empty())
}

/// The same without comments: the header and the rows of a table.
pub fn rows(text: &str) -> impl Iterator<Item = (usize, &str)> {
    lines(text).filter(|(_, text)| !text.starts_with('#'))
}

/// The header of a table: the first of its [`rows`], if it has a separator.
pub fn header(text: &str) -> Option<(usize, &str, char)> {
    let (line, header) = rows(text).next()?;
    Some((line, header, separator(header)?))
}

/// The fields of a line, with blanks around them removed; `None` if a quotation mark is unpaired or inside a field.
pub fn fields(line: &str, separator: char) -> Option<Vec<CsvField<'_>>> {
    let is_blank = |c: char| c.is_whitespace() && c != separator;
    let mut fields = Vec::new();
    let mut rest = line;
    loop {
        let column = line.len() - rest.len() + 1;
        let quoted = rest.trim_start_matches(is_blank).strip_prefix('"');
        let (text, behind) = match quoted {
            Some(quoted) => {
                let (text, behind) = unquoted(quoted)?;
                (Cow::Owned(text), behind.trim_start_matches(is_blank))
            }
            None => {
                let end = rest.find(separator).unwrap_or(rest.len());
                let (text, behind) = rest.split_at(end);
                (Cow::Borrowed(text.trim()), behind)
            }
        };
        if text.contains('"') && quoted.is_none() {
            return None;
        }
        fields.push(CsvField { text, column });
        match behind.strip_prefix(separator) {
            Some(next) => rest = next,
            None => return behind.is_empty().then_some(fields),
        }
    }
}

/// The text before the closing quotation mark, doubled marks halved, and the rest of the line.
fn unquoted(text: &str) -> Option<(String, &str)> {
    let mut whole = String::new();
    let mut rest = text;
    loop {
        let (before, behind) = rest.split_once('"')?;
        whole.push_str(before);
        match behind.strip_prefix('"') {
            Some(next) => {
                whole.push('"');
                rest = next;
            }
            None => return Some((whole, behind)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{fields, separator};

    #[test]
    fn quotes_and_columns() {
        let read = |line| {
            let fields = fields(line, ',')?;
            Some(
                fields
                    .into_iter()
                    .map(|f| (f.text.into_owned(), f.column))
                    .collect::<Vec<_>>(),
            )
        };
        let expected = |fields: &[(&str, usize)]| {
            Some(fields.iter().map(|&(t, c)| (t.to_owned(), c)).collect())
        };
        assert_eq!(read("a, b ,"), expected(&[("a", 1), ("b", 3), ("", 7)]));
        assert_eq!(
            read(r#""DEB, ""A""",7"#),
            expected(&[(r#"DEB, "A""#, 1), ("7", 14)])
        );
        assert_eq!(read(""), expected(&[("", 1)]));
        for wrong in [r#""open"#, r#"a"b,1"#, r#""a"b,1"#] {
            assert_eq!(read(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn semicolons_and_tabs_separate_as_commas_do() {
        let texts = |line, separator| {
            let fields = fields(line, separator).unwrap();
            fields.into_iter().map(|f| f.text).collect::<Vec<_>>()
        };
        assert_eq!(texts("a, b;\"c;d\" ;", ';'), ["a, b", "c;d", ""]);
        assert_eq!(
            texts("\ta b\t\t \"c\td\"\t", '\t'),
            ["", "a b", "", "c\td", ""]
        );
        assert_eq!(separator("\"a,b\";c,d"), Some(';'));
        assert_eq!(separator("a b\tc"), Some('\t'));
        assert_eq!(separator("a b"), None);
    }
}
