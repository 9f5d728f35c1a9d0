//! From text to tables and keys: TOML errors become messages with file, line, key, value and remedy.

use super::error::{KeyLocation, SceneError, printable};
use super::keys::{RENAMED, RawScene, TABLES};
use super::meaning::{key_meant, table_meant};
use super::table::{Key, Table};
use super::text::{SceneText, nearest};
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

/// Table, key, and the reason why it does not exist: features that other programs draw.
const NOT_DRAWN: &[(&str, &str, &str)] = &[(
    "geojson",
    "fill",
    "polygons are drawn as outlines, without a fill; leave it out",
)];

impl SceneText<'_> {
    /// The file's text as tables and keys, or the error.
    pub(super) fn parse(&self) -> Result<RawScene, SceneError> {
        let document = DeTable::parse(self.text).map_err(|error| self.syntax(&error))?;
        // The TOML reader reports only where it stopped; the document tells which key that is.
        let index = document.get_ref().clone();
        let deserializer = toml::Deserializer::from(document);
        serde::Deserialize::deserialize(deserializer).map_err(|error| self.explain(&error, &index))
    }

    fn syntax(&self, error: &toml::de::Error) -> SceneError {
        let span = error.span().unwrap_or(0..0);
        let found = match self.excerpt(&span) {
            text if text.is_empty() => "the end of the line or of the file".to_owned(),
            text => format!("`{text}`"),
        };
        SceneError::Syntax {
            path: self.path.to_owned(),
            line: self.line(span.start),
            column: self.column(span.start),
            message: printable(error.message()),
            found,
        }
    }

    fn place(&self, offset: usize, table: &str, key: &str) -> Box<KeyLocation> {
        Box::new(KeyLocation {
            path: self.path.to_owned(),
            line: Some(self.line(offset)),
            table: table.to_owned(),
            key: key.to_owned(),
        })
    }

    /// The error for the first invalid entry of the document.
    fn explain(&self, error: &toml::de::Error, document: &DeTable<'_>) -> SceneError {
        let stop = error.span().unwrap_or(0..0);
        for (name, value) in document {
            let Some(table) = TABLES.iter().find(|table| table.name == name.get_ref()) else {
                if name.span() == stop {
                    return self.unknown_top(name, value);
                }
                continue;
            };
            let found = match (value.get_ref(), table.is_list()) {
                (DeValue::Table(entries), _) => self.explain_table(table, entries, &stop),
                (DeValue::Array(items), true) if items.iter().all(is_table) => {
                    let tables = items.iter().filter_map(|item| match item.get_ref() {
                        DeValue::Table(entries) => Some(entries),
                        _ => None,
                    });
                    tables
                        .filter_map(|entries| self.explain_table(table, entries, &stop))
                        .next()
                }
                _ if contains(&value.span(), &stop) => Some(SceneError::Value {
                    place: self.place(name.span().start, "", table.name),
                    value: self.excerpt(&value.span()),
                    remedy: format!(
                        "must be a table, not {}: write [{}] on a line of its own and its keys below it",
                        kind(value.get_ref()),
                        table.name
                    ),
                }),
                _ => None,
            };
            if let Some(found) = found {
                return found;
            }
        }
        // No tested document reaches this; the TOML reader's message is then better than none.
        self.syntax(error)
    }

    /// The error for the first invalid entry of a table.
    fn explain_table(
        &self,
        table: &Table,
        entries: &DeTable<'_>,
        stop: &Range<usize>,
    ) -> Option<SceneError> {
        for (key_name, value) in entries {
            let known = table.keys.iter().find(|key| key.name == key_name.get_ref());
            match known {
                None if key_name.span() == *stop => return Some(self.unknown_key(table, key_name)),
                Some(key) if contains(&value.span(), stop) => {
                    return Some(self.wrong_type(table, key, key_name.span().start, value));
                }
                _ => {}
            }
        }
        None
    }

    fn unknown_top(
        &self,
        name: &Spanned<DeString<'_>>,
        value: &Spanned<DeValue<'_>>,
    ) -> SceneError {
        let offset = name.span().start;
        let word: &str = name.get_ref();
        let tables = TABLES.iter().map(|table| table.name);
        let all = tables
            .clone()
            .map(|table| format!("[{table}]"))
            .collect::<Vec<_>>()
            .join(", ");
        let is_table = matches!(value.get_ref(), DeValue::Table(_));
        let home = TABLES
            .iter()
            .find(|table| table.keys.iter().any(|key| key.name == word));
        let (place, remedy) = match home {
            Some(table) => (
                self.place(offset, "", word),
                format!("is outside its table; move it below [{}]", table.name),
            ),
            None if is_table => (
                self.place(offset, word, ""),
                match table_meant(word).or_else(|| nearest(word, tables)) {
                    Some(near) => {
                        format!("unknown table; did you mean [{near}]? A scene has {all}")
                    }
                    None => format!("unknown table; a scene has {all}"),
                },
            ),
            None => {
                let keys = TABLES
                    .iter()
                    .flat_map(|table| table.keys.iter().map(move |key| (table.name, key.name)));
                let near = key_meant("", word).or_else(|| {
                    nearest(word, keys.clone().map(|(_, key)| key))
                        .and_then(|near| keys.clone().find(|(_, key)| *key == near))
                });
                (
                    self.place(offset, "", word),
                    match near {
                        Some((table, key)) => format!(
                            "unknown key outside any table; did you mean {key} in [{table}]? A scene has only the tables {all}"
                        ),
                        None => format!(
                            "unknown key outside any table; a scene has only the tables {all}"
                        ),
                    },
                )
            }
        };
        SceneError::Unknown { place, remedy }
    }

    fn unknown_key(&self, table: &Table, name: &Spanned<DeString<'_>>) -> SceneError {
        let word: &str = name.get_ref();
        let keys = table.keys.iter().map(|key| key.name);
        let all = keys.clone().collect::<Vec<_>>().join(", ");
        let home = TABLES
            .iter()
            .find(|other| other.keys.iter().any(|key| key.name == word));
        let renamed = RENAMED.iter().find(|(old, _)| *old == word);
        let renamed = renamed.filter(|(_, new)| keys.clone().any(|key| key == *new));
        let meant = key_meant(table.name, word);
        // A synonym for a key of this table is not redirected to another table.
        let home = home.filter(|_| meant.is_none_or(|(of, _)| of != table.name));
        let near = match meant {
            Some((of, key)) if of == table.name => Some(key.to_owned()),
            Some((of, key)) => Some(format!("{key} in [{of}]")),
            None => nearest(word, keys).map(str::to_owned),
        };
        let hint = match (renamed, home, near) {
            (Some((_, new)), ..) => format!("this key is now called {new}; rename it."),
            (None, Some(home), _) => format!("unknown key here; it belongs in [{}].", home.name),
            (None, None, Some(near)) => format!("unknown key; did you mean {near}?"),
            (None, None, None) => "unknown key.".to_owned(),
        };
        SceneError::Unknown {
            place: self.place(name.span().start, table.name, word),
            remedy: match NOT_DRAWN
                .iter()
                .find(|not| (not.0, not.1) == (table.name, word))
            {
                Some((.., why)) => (*why).to_owned(),
                None => format!("{hint} [{}] has {all}", table.name),
            },
        }
    }

    fn wrong_type(
        &self,
        table: &Table,
        key: &Key,
        offset: usize,
        value: &Spanned<DeValue<'_>>,
    ) -> SceneError {
        let why = if too_large(value.get_ref()) {
            "; this number is too large to be read".to_owned()
        } else {
            format!(", not {}", kind(value.get_ref()))
        };
        SceneError::Value {
            place: self.place(offset, table.name, key.name),
            value: self.excerpt(&value.span()),
            remedy: format!("must be {}{why}", (key.expected)()),
        }
    }
}

/// The type of a value, with its article.
pub(super) fn kind(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "a string",
        DeValue::Integer(_) => "a whole number",
        DeValue::Float(_) => "a number with a fraction",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date-time",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
}

/// Whether a number, or one in a list, has no 64-bit form.
fn too_large(value: &DeValue<'_>) -> bool {
    match value {
        DeValue::Integer(whole) => i64::from_str_radix(whole.as_str(), whole.radix()).is_err(),
        DeValue::Float(float) => {
            let text = float.as_str();
            !text.contains("inf") && text.parse().is_ok_and(f64::is_infinite)
        }
        DeValue::Array(items) => items.iter().any(|item| too_large(item.get_ref())),
        _ => false,
    }
}

fn is_table(value: &Spanned<DeValue<'_>>) -> bool {
    matches!(value.get_ref(), DeValue::Table(_))
}

fn contains(outer: &Range<usize>, inner: &Range<usize>) -> bool {
    outer.start <= inner.start && inner.end <= outer.end
}
