//! Comma-separated values (RFC 4180), a record a line.

/// A field and the column of its first byte, from 1.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CsvField {
    pub text: String,
    pub column: usize,
}

/// The fields of a line, with blanks around them removed; `None` if a quotation mark is unpaired or inside a field.
pub fn fields(line: &str) -> Option<Vec<CsvField>> {
    let mut fields = Vec::new();
    let mut rest = line;
    loop {
        let column = line.len() - rest.len() + 1;
        let (text, behind) = match rest.trim_start().strip_prefix('"') {
            Some(quoted) => {
                let (text, behind) = unquoted(quoted)?;
                (text, behind.trim_start())
            }
            None => {
                let end = rest.find(',').unwrap_or(rest.len());
                let (text, behind) = rest.split_at(end);
                (text.trim().to_owned(), behind)
            }
        };
        if text.contains('"') && !rest.trim_start().starts_with('"') {
            return None;
        }
        fields.push(CsvField { text, column });
        match behind.strip_prefix(',') {
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
    use super::fields;

    #[test]
    fn quotes_and_columns() {
        let read = |line| {
            let fields = fields(line)?;
            Some(
                fields
                    .into_iter()
                    .map(|f| (f.text, f.column))
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
}
