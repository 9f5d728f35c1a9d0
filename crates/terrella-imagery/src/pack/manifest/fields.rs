//! TOML tables and values with their places: what is missing, unknown or not as it must be is named with line and key.

use crate::pack::error::{ManifestPlace, PackError};
use std::fmt::Display;
use std::ops::RangeInclusive;
use std::path::Path;
use terrella_files::{self as files, excerpt, is_unprintable};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A manifest's text and the name of its file.
#[derive(Clone, Copy)]
pub(super) struct ManifestText<'a> {
    pub(super) path: &'a Path,
    pub(super) text: &'a str,
}

impl<'a> ManifestText<'a> {
    /// The text as tables and keys.
    pub(super) fn parse(&self) -> Result<Spanned<DeTable<'a>>, PackError> {
        DeTable::parse(self.text).map_err(|error| {
            let span = error.span().unwrap_or(0..0);
            let found = match excerpt(self.text.get(span.clone()).unwrap_or_default()) {
                text if text.is_empty() => "the end of the line or of the file".to_owned(),
                text => format!("`{text}`"),
            };
            PackError::Syntax {
                path: self.path.to_owned(),
                line: self.line(span.start),
                message: excerpt(error.message()),
                found,
            }
        })
    }

    /// Line of a byte offset, from 1.
    fn line(&self, offset: usize) -> usize {
        let before = self.text.as_bytes().iter().take(offset);
        before.filter(|byte| **byte == b'\n').count() + 1
    }

    fn reject(&self, offset: Option<usize>, key: &str, cause: impl Display) -> PackError {
        PackError::Key {
            place: Box::new(ManifestPlace {
                path: self.path.to_owned(),
                line: offset.map(|offset| self.line(offset)),
                key: excerpt(key),
            }),
            cause: files::cause(cause),
        }
    }
}

/// A table of a manifest.
#[derive(Clone)]
pub(super) struct Table<'a> {
    source: ManifestText<'a>,
    /// Its name with those of its enclosing tables and a full stop; empty for the whole file.
    prefix: String,
    /// Offset of its start; `None` for the whole file.
    offset: Option<usize>,
    entries: &'a DeTable<'a>,
}

impl<'a> Table<'a> {
    /// The whole file, which may have these keys.
    pub(super) fn root(
        source: ManifestText<'a>,
        entries: &'a DeTable<'a>,
        known: &[&str],
    ) -> Result<Self, PackError> {
        let table = Self {
            source,
            prefix: String::new(),
            offset: None,
            entries,
        };
        table.check_keys(known)?;
        Ok(table)
    }

    fn check_keys(&self, known: &[&str]) -> Result<(), PackError> {
        for (name, _) in self.entries {
            let word: &str = name.get_ref();
            if !known.contains(&word) {
                let hint = match nearest(word, known) {
                    Some(near) => format!("unknown key; did you mean {near}?"),
                    None => format!("unknown key; known here: {}", known.join(", ")),
                };
                let key = format!("{}{word}", self.prefix);
                return Err(self.source.reject(Some(name.span().start), &key, hint));
            }
        }
        Ok(())
    }

    pub(super) fn get(&self, key: &str) -> Option<Value<'a>> {
        self.entries.get(key).map(|value| Value {
            source: self.source,
            key: format!("{}{key}", self.prefix),
            value,
        })
    }

    /// The value of a key that must be there.
    pub(super) fn need(&self, key: &str) -> Result<Value<'a>, PackError> {
        self.get(key).ok_or_else(|| {
            let name = format!("{}{key}", self.prefix);
            let cause = "is missing; build the pack again";
            self.source.reject(self.offset, &name, cause)
        })
    }
}

/// A value of a manifest.
#[derive(Clone)]
pub(super) struct Value<'a> {
    source: ManifestText<'a>,
    key: String,
    value: &'a Spanned<DeValue<'a>>,
}

impl<'a> Value<'a> {
    /// The value of a key outside any table.
    pub fn new(source: ManifestText<'a>, key: &str, value: &'a Spanned<DeValue<'a>>) -> Self {
        Self {
            source,
            key: key.to_owned(),
            value,
        }
    }

    /// The error that rejects this value, with its line.
    pub(super) fn reject(&self, cause: impl Display) -> PackError {
        let span = self.value.span();
        let excerpt = excerpt(self.source.text.get(span.clone()).unwrap_or_default());
        let cause = format!("{cause} (found {excerpt})");
        self.source.reject(Some(span.start), &self.key, cause)
    }

    /// A whole number in a range.
    pub(super) fn whole(&self, range: RangeInclusive<u64>) -> Result<u64, PackError> {
        let DeValue::Integer(digits) = self.value.get_ref() else {
            return Err(self.reject("must be a whole number"));
        };
        u64::from_str_radix(digits.as_str(), digits.radix())
            .ok()
            .filter(|number| range.contains(number))
            .ok_or_else(|| {
                let (least, most) = range.into_inner();
                if least == most {
                    self.reject(format!("must be {least}"))
                } else {
                    self.reject(format!("must be a whole number from {least} to {most}"))
                }
            })
    }

    /// A finite number above zero.
    pub(super) fn positive(&self) -> Result<f64, PackError> {
        self.number(|number| number > 0.0)
            .ok_or_else(|| self.reject("must be a finite number above 0"))
    }

    /// A finite number.
    pub(super) fn finite(&self) -> Result<f64, PackError> {
        self.number(|_| true)
            .ok_or_else(|| self.reject("must be a finite number"))
    }

    fn number(&self, is_good: impl Fn(f64) -> bool) -> Option<f64> {
        let number = match self.value.get_ref() {
            DeValue::Float(digits) => digits.as_str().parse().ok(),
            DeValue::Integer(digits) => i64::from_str_radix(digits.as_str(), digits.radix())
                .ok()
                .map(|whole| whole as f64),
            _ => None,
        };
        number.filter(|number: &f64| number.is_finite() && is_good(*number))
    }

    pub(super) fn string(&self) -> Result<&'a str, PackError> {
        match self.value.get_ref() {
            DeValue::String(text) => Ok(text),
            _ => Err(self.reject("must be a string")),
        }
    }

    /// A string for people: of a bounded length, without control characters.
    pub(super) fn text(&self, most_chars: usize) -> Result<String, PackError> {
        let text = self.string()?;
        if text.chars().nth(most_chars).is_some() {
            return Err(self.reject(format!("must have at most {most_chars} characters")));
        }
        if text.chars().any(is_unprintable) {
            return Err(self.reject("must have no control characters"));
        }
        Ok(text.to_owned())
    }

    /// The items of a list whose length is in a range.
    pub(super) fn list(
        &self,
        lengths: RangeInclusive<usize>,
    ) -> Result<impl Iterator<Item = Value<'a>> + use<'a>, PackError> {
        let DeValue::Array(items) = self.value.get_ref() else {
            return Err(self.reject("must be a list"));
        };
        if !lengths.contains(&items.len()) {
            let (least, most) = lengths.into_inner();
            let cause = if least == most {
                format!("must have {least} items and has {}", items.len())
            } else {
                format!("must have {least} to {most} items and has {}", items.len())
            };
            // The items themselves would make no good excerpt.
            let start = self.value.span().start;
            return Err(self.source.reject(Some(start), &self.key, cause));
        }
        let (source, key) = (self.source, self.key.clone());
        Ok(items.iter().map(move |value| Value {
            source,
            key: key.clone(),
            value,
        }))
    }

    /// A table that may have these keys.
    pub(super) fn table(&self, known: &[&str]) -> Result<Table<'a>, PackError> {
        let DeValue::Table(entries) = self.value.get_ref() else {
            return Err(self.reject("must be a table"));
        };
        let table = Table {
            source: self.source,
            prefix: format!("{}.", self.key),
            offset: Some(self.value.span().start),
            entries,
        };
        table.check_keys(known)?;
        Ok(table)
    }
}

/// The known name most like `word`, if any is alike at all.
pub(super) fn nearest<'k>(word: &str, known: &[&'k str]) -> Option<&'k str> {
    /// Jaro–Winkler similarity below which a suggestion would only confuse.
    const ALIKE: f64 = 0.7;
    /// No known name is half as long; the comparison's cost grows with the length.
    const LONGEST_WORD: usize = 64;
    if word.len() > LONGEST_WORD {
        return None;
    }
    let word = word.to_lowercase();
    let likeness = known
        .iter()
        .map(|name| (strsim::jaro_winkler(&word, name), *name));
    likeness
        .filter(|(likeness, _)| *likeness >= ALIKE)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name)
}
