//! What every key needs: its value or default, a range, a choice of names, a path, and words of refusal.

use super::error::{Place, SceneError, printable};
use super::locate::{Source, nearest};
use serde::Deserialize;
use serde::de::value::StrDeserializer;
use std::fmt::Display;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use toml::Spanned;

/// A key with its value, if the file gives one.
pub(super) struct Field<'r, T> {
    pub(super) table: &'static str,
    pub(super) key: &'static str,
    pub(super) given: Option<&'r Spanned<T>>,
}

impl<T> Field<'_, T> {
    pub(super) fn is_given(&self) -> bool {
        self.given.is_some()
    }
}

/// The field of a raw table under its own name: the name in a message cannot differ from the key that is read.
macro_rules! field {
    ($table:ident . $key:ident) => {
        Field {
            table: stringify!($table),
            key: stringify!($key),
            given: $table.$key.as_ref(),
        }
    };
}

pub(super) use field;

impl Source<'_> {
    /// A finite number in a range; `remedy` gets the number that is not.
    pub(super) fn number(
        &self,
        field: &Field<'_, f64>,
        default: f64,
        range: RangeInclusive<f64>,
        remedy: impl Fn(f64) -> String,
    ) -> Result<f64, SceneError> {
        let value = field.given.map_or(default, |given| *given.get_ref());
        if !value.is_finite() {
            return Err(self.refuse(field, "must be a finite number, not nan or inf"));
        }
        if !range.contains(&value) {
            return Err(self.refuse(field, remedy(value)));
        }
        Ok(value)
    }

    /// One of the names of an enum, as its serde derive spells them.
    pub(super) fn choice<T: for<'de> Deserialize<'de>>(
        &self,
        field: &Field<'_, String>,
        default: T,
    ) -> Result<T, SceneError> {
        let Some(given) = field.given else {
            return Ok(default);
        };
        let word = given.get_ref();
        T::deserialize(StrDeserializer::<UnknownName>::new(word)).map_err(|UnknownName(known)| {
            let all = known
                .iter()
                .map(|name| format!("\"{name}\""))
                .collect::<Vec<_>>();
            let list = match all.as_slice() {
                [only] => format!("must be {only}, the only kind there is"),
                all => format!("must be one of {}", all.join(", ")),
            };
            let hint = match nearest(word, known.iter().copied()) {
                Some(near) if known.len() > 1 => format!("; did you mean \"{near}\"?"),
                _ => String::new(),
            };
            self.refuse(field, list + &hint)
        })
    }

    /// A path relative to the scene's folder, of something that is there.
    pub(super) fn path(
        &self,
        field: &Field<'_, String>,
        wanted: Wanted,
    ) -> Result<Option<PathBuf>, SceneError> {
        let Some(given) = field.given else {
            return Ok(None);
        };
        let (what, other) = match wanted {
            Wanted::File => ("a file", "a folder"),
            Wanted::Folder => ("a folder", "a file"),
        };
        if given.get_ref().is_empty() {
            let advice = format!(
                "must not be empty; give the path of {what}, relative to the scene's folder"
            );
            return Err(self.refuse(field, advice));
        }
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let path = folder.join(given.get_ref());
        let shown = printable(&path.display().to_string());
        match std::fs::metadata(&path) {
            Ok(found) if found.is_dir() == (wanted == Wanted::Folder) => Ok(Some(path)),
            Ok(_) => {
                let advice = format!("{shown} is {other}; give the path of {what}");
                Err(self.refuse(field, advice))
            }
            Err(error) => {
                let advice = format!(
                    "{shown} cannot be opened: {error}; give the path of {what}, relative to the scene's folder"
                );
                Err(self.refuse(field, advice))
            }
        }
    }

    /// Refuses a key that the file gives, by the span of its value.
    pub(super) fn refuse_at(
        &self,
        table: &str,
        key: &str,
        span: std::ops::Range<usize>,
        remedy: impl Display,
    ) -> SceneError {
        SceneError::Value {
            place: Box::new(Place {
                path: self.path.to_owned(),
                line: Some(self.line(span.start)),
                table: table.to_owned(),
                key: key.to_owned(),
            }),
            value: self.excerpt(&span),
            remedy: remedy.to_string(),
        }
    }

    pub(super) fn refuse<T>(&self, field: &Field<'_, T>, remedy: impl Display) -> SceneError {
        let span = field.given.map(Spanned::span);
        SceneError::Value {
            place: Box::new(Place {
                path: self.path.to_owned(),
                line: span.as_ref().map(|span| self.line(span.start)),
                table: field.table.to_owned(),
                key: field.key.to_owned(),
            }),
            value: match span {
                Some(span) => self.excerpt(&span),
                None => "its default".to_owned(),
            },
            remedy: remedy.to_string(),
        }
    }
}

/// What a path must lead to.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Wanted {
    File,
    Folder,
}

/// What serde says of a name that an enum does not have: the names it has.
#[derive(Debug)]
struct UnknownName(&'static [&'static str]);

impl Display for UnknownName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "must be one of {}", self.0.join(", "))
    }
}

impl std::error::Error for UnknownName {}

impl serde::de::Error for UnknownName {
    fn custom<T: Display>(_: T) -> Self {
        Self(&[])
    }

    fn unknown_variant(_: &str, expected: &'static [&'static str]) -> Self {
        Self(expected)
    }
}

/// The name of an enum's value as a scene writes it.
pub(super) fn written(value: &impl serde::Serialize) -> String {
    match toml::Value::try_from(value) {
        Ok(toml::Value::String(name)) => name,
        Ok(other) => other.to_string(),
        Err(error) => error.to_string(),
    }
}

pub(super) fn flag(field: &Field<'_, bool>, default: bool) -> bool {
    field.given.map_or(default, |given| *given.get_ref())
}

pub(super) fn in_range(value: i64, range: &RangeInclusive<i64>) -> Option<u32> {
    u32::try_from(value).ok().filter(|_| range.contains(&value))
}

/// A range in words: "1 to 48".
pub(super) fn span_of<T: Display>(range: &RangeInclusive<T>) -> String {
    format!("{} to {}", range.start(), range.end()).replace('-', "−")
}
