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

/// Where all names are listed, for errors that suggest one of them.
pub(super) const LISTED: &str = "`terrella check --all` lists all keys";

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
            remedy: self.syntax_remedy(error.message(), &span),
        }
    }

    /// The remedy for a common syntax error, after a semicolon; empty for others.
    fn syntax_remedy(&self, message: &str, span: &Range<usize>) -> String {
        let word = self.text.get(span.clone()).unwrap_or_default().trim();
        let is_switch = ["yes", "no", "on", "off", "true", "false"]
            .iter()
            .any(|switch| word.eq_ignore_ascii_case(switch));
        if is_switch {
            return "; write true or false".to_owned();
        }
        if message != "duplicate key" {
            return String::new();
        }
        let line = self.text.lines().nth(self.line(span.start) - 1);
        let header = line
            .map(str::trim_start)
            .filter(|line| line.starts_with('['));
        let Some(header) = header else {
            return "; leave one of the two out".to_owned();
        };
        let header = header.trim_start_matches('[');
        let name = header.split(']').next().unwrap_or_default().trim();
        let several = match name {
            "orbit" => "satellites",
            "station" => "ground stations",
            "geojson" => "files",
            "caption" => "captions",
            "camera.keys" => "keyframes",
            other => {
                let name = printable(other);
                return format!("; write [{name}] once, with all of its keys below it");
            }
        };
        format!("; write [[{name}]] for each of several {several}")
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
        let is_list = is_list_of_tables(value.get_ref());
        let is_table = is_list || matches!(value.get_ref(), DeValue::Table(_));
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
                match (table_meant(word), nearest(word, tables)) {
                    (Some(meant), _) if is_list => {
                        format!("unknown table; did you mean [[{meant}]]? {LISTED}")
                    }
                    (Some(meant), _) => {
                        format!("unknown table; did you mean [{meant}]? {LISTED}")
                    }
                    // The nearest name may be far off.
                    (None, Some(near)) => {
                        format!("unknown table; did you mean [{near}]? A scene has {all}")
                    }
                    (None, None) => format!("unknown table; a scene has {all}"),
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
                            "unknown key outside any table; did you mean {key} in [{table}]? {LISTED}"
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
        let home = TABLES
            .iter()
            .find(|other| other.keys.iter().any(|key| key.name == word));
        let renamed = RENAMED.iter().find(|(old, _)| *old == word);
        let renamed = renamed.filter(|(_, new)| keys.clone().any(|key| key == *new));
        let meant = key_meant(table.name, word);
        // A synonym for a key of this table is not redirected to another table.
        let home = home.filter(|_| meant.is_none_or(|(of, _)| of != table.name));
        let alike = nearest(word, keys.clone());
        let begun = alike.filter(|key| key.starts_with(word));
        let near = match meant {
            Some((of, key)) if of == table.name => Some(key.to_owned()),
            // A key of this table that begins so is likelier than a meaning elsewhere.
            Some((of, key)) => begun.map_or_else(
                || Some(format!("{key} in [{of}]")),
                |key| Some(key.to_owned()),
            ),
            None => alike.map(str::to_owned),
        };
        let not_drawn = NOT_DRAWN
            .iter()
            .find(|not| (not.0, not.1) == (table.name, word));
        SceneError::Unknown {
            place: self.place(name.span().start, table.name, word),
            remedy: match (not_drawn, renamed, home, near) {
                (Some((.., why)), ..) => (*why).to_owned(),
                (_, Some((_, new)), ..) => format!("this key is now called {new}; rename it"),
                (_, _, Some(home), _) => {
                    format!("unknown key here; it belongs in [{}]", home.name)
                }
                (.., Some(near)) => format!("unknown key; did you mean {near}? {LISTED}"),
                _ => {
                    let all = keys.collect::<Vec<_>>().join(", ");
                    format!("unknown key. [{}] has {all}", table.name)
                }
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

/// Whether a value is that of `[[NAME]]`.
fn is_list_of_tables(value: &DeValue<'_>) -> bool {
    matches!(value, DeValue::Array(items) if !items.is_empty() && items.iter().all(is_table))
}

fn contains(outer: &Range<usize>, inner: &Range<usize>) -> bool {
    outer.start <= inner.start && inner.end <= outer.end
}
