//! Helpers for every key: value or default, range, choice of names, path, and rejection text.

use super::error::{KeyLocation, SceneError, printable};
use super::record::{KeyText, Notes, number_text, quoted};
use super::text::{SceneText, nearest};
use serde::de::value::StrDeserializer;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt::Display;
use std::marker::PhantomData;
use std::ops::{Range, RangeInclusive};
use std::path::{Path, PathBuf};
use terrella_ground::light::Tone;
use toml::Spanned;

/// A key with its value, if the file gives one, and its rule from the declaration in [`keys`](super::keys). The rule is
/// [`Bounds`] for a number with a default, the range for one without, the default of a `bool`, or nothing.
pub(super) struct Field<'r, T, R = ()> {
    pub(super) table: &'static str,
    pub(super) key: &'static str,
    /// Unit of a number.
    pub(super) of: &'static str,
    pub(super) given: Option<&'r Spanned<T>>,
    pub(super) rule: R,
    /// Destination of the key's effective value.
    pub(super) notes: &'r Notes,
}

/// Range and default of a number.
pub(super) struct Bounds<N> {
    pub(super) range: RangeInclusive<N>,
    pub(super) default: N,
}

impl<T, R> Field<'_, T, R> {
    pub(super) fn is_given(&self) -> bool {
        self.given.is_some()
    }

    /// Records the key's effective value.
    pub(super) fn note(&self, text: KeyText) {
        self.notes.note(self.key, text);
    }
}

impl<T: Copy, R> Field<'_, T, R> {
    /// The value given in the file.
    pub(super) fn value(&self) -> Option<T> {
        self.given.map(|given| *given.get_ref())
    }
}

impl<R> Field<'_, bool, R> {
    /// Whether the key is on, with this default.
    pub(super) fn is_on_or(&self, default: bool) -> bool {
        let is_on = self.value().unwrap_or(default);
        self.note(Ok(is_on.to_string()));
        is_on
    }
}

impl Field<'_, bool, bool> {
    /// Whether the key is on, with its declared default.
    pub(super) fn is_on(&self) -> bool {
        self.is_on_or(self.rule)
    }
}

/// The satellite's own key, or the common one. The effective value is recorded with the satellite.
pub(super) fn own_or<'r, T, R>(own: Field<'r, T, R>, common: Field<'r, T, R>) -> Field<'r, T, R> {
    match own.is_given() {
        true => own,
        false => Field {
            notes: own.notes,
            ..common
        },
    }
}

impl SceneText<'_> {
    /// A finite number in its range, or its default. `remedy` receives an invalid number, and the range as text.
    pub(super) fn number(
        &self,
        field: &Field<'_, f64, Bounds<f64>>,
        remedy: impl Fn(f64, &str) -> String,
    ) -> Result<f64, SceneError> {
        let Bounds { range, default } = &field.rule;
        let value = field.value().unwrap_or(*default);
        let value = self.in_range(field, value, range, |value| {
            remedy(value, &range_text(range))
        })?;
        field.note(Ok(number_text(value)));
        Ok(value)
    }

    /// As `number` with a standard remedy, for ranges that are best written with exponents.
    pub(super) fn quantity(&self, field: &Field<'_, f64, Bounds<f64>>) -> Result<f64, SceneError> {
        let Bounds { range, default } = &field.rule;
        self.quantity_in(field, range, *default, field.of)
    }

    /// The same with a variable default.
    pub(super) fn quantity_or(
        &self,
        field: &Field<'_, f64, RangeInclusive<f64>>,
        default: f64,
    ) -> Result<f64, SceneError> {
        self.quantity_in(field, &field.rule, default, field.of)
    }

    /// The same with another unit text.
    pub(super) fn quantity_in<R>(
        &self,
        field: &Field<'_, f64, R>,
        range: &RangeInclusive<f64>,
        default: f64,
        unit: &str,
    ) -> Result<f64, SceneError> {
        let value = field.value().unwrap_or(default);
        let value = self.in_range(field, value, range, |_| must_be_within(range, unit))?;
        field.note(Ok(number_text(value)));
        Ok(value)
    }

    /// Checks a finite number against a range, without recording it. `remedy` receives an invalid
    /// number.
    pub(super) fn in_range<R>(
        &self,
        field: &Field<'_, f64, R>,
        value: f64,
        range: &RangeInclusive<f64>,
        remedy: impl Fn(f64) -> String,
    ) -> Result<f64, SceneError> {
        if !value.is_finite() {
            return Err(self.reject(field, "must be a finite number, not nan or inf"));
        }
        if !range.contains(&value) {
            return Err(self.reject(field, remedy(value)));
        }
        Ok(value)
    }

    /// An integer in its range, or its default; `remedy` receives the range as text.
    pub(super) fn count(
        &self,
        field: &Field<'_, i64, Bounds<i64>>,
        remedy: impl Fn(&str) -> String,
    ) -> Result<u32, SceneError> {
        let Bounds { range, default } = &field.rule;
        let count = whole(field.value().unwrap_or(*default), range)
            .ok_or_else(|| self.reject(field, remedy(&range_text(range))))?;
        field.note(Ok(count.to_string()));
        Ok(count)
    }

    /// One of the names of an enum, or its default.
    pub(super) fn choice<T: Copy + for<'de> Deserialize<'de> + Serialize>(
        &self,
        field: &Field<'_, Choice<T>, T>,
    ) -> Result<T, SceneError> {
        self.choice_or(field, field.rule)
    }

    /// The same with a variable default.
    pub(super) fn choice_or<T: for<'de> Deserialize<'de> + Serialize, R>(
        &self,
        field: &Field<'_, Choice<T>, R>,
        default: T,
    ) -> Result<T, SceneError> {
        let value = match field.given {
            Some(given) => self.named(field, &given.get_ref().word)?,
            None => default,
        };
        field.note(quoted(&written(&value)));
        Ok(value)
    }

    /// One of the names of an enum.
    pub(super) fn named<T: for<'de> Deserialize<'de>, F, R>(
        &self,
        field: &Field<'_, F, R>,
        word: &str,
    ) -> Result<T, SceneError> {
        named(word).map_err(|UnknownName(known)| {
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
            self.reject(field, list + &hint)
        })
    }

    /// An existing path relative to the scene's folder; `without` is the reason if no path is given.
    pub(super) fn path(
        &self,
        field: &Field<'_, RawPath>,
        kind: PathKind,
        without: &'static str,
    ) -> Result<Option<PathBuf>, SceneError> {
        let Some(given) = field.given.map(Spanned::get_ref) else {
            field.note(Err(without));
            return Ok(None);
        };
        let path = self.existing(field, given, kind)?;
        field.note(quoted(&path.display().to_string()));
        Ok(Some(path))
    }

    /// Resolves an existing path relative to the scene's folder.
    pub(super) fn existing<F>(
        &self,
        field: &Field<'_, F>,
        RawPath(given): &RawPath,
        kind: PathKind,
    ) -> Result<PathBuf, SceneError> {
        let (what, other) = match kind {
            PathKind::File => ("a file", "a folder"),
            PathKind::Folder => ("a folder", "a file"),
            PathKind::Set => (
                "a file, a folder, or a pattern such as dem/*.tif",
                "nothing of these",
            ),
        };
        if given.is_empty() {
            let advice = format!(
                "must not be empty; give the path of {what}, relative to the scene's folder"
            );
            return Err(self.reject(field, advice));
        }
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let path = folder.join(given);
        let shown = printable(&path.display().to_string());
        match std::fs::metadata(&path) {
            Ok(_) if kind == PathKind::Set => Ok(path),
            Ok(found) if found.is_dir() == (kind == PathKind::Folder) => Ok(path),
            Err(_) if kind == PathKind::Set && is_pattern(&path) => Ok(path),
            Ok(_) => {
                let advice = format!("{shown} is {other}; give the path of {what}");
                Err(self.reject(field, advice))
            }
            Err(error) => {
                let advice = format!(
                    "{shown} cannot be opened: {error}; give the path of {what}, relative to the scene's folder"
                );
                Err(self.reject(field, advice))
            }
        }
    }

    /// Rejects a given key that has no meaning in the scene. Otherwise records the reason why it has no
    /// value.
    pub(super) fn idle<T, R>(
        &self,
        field: &Field<'_, T, R>,
        why: &'static str,
        advice: impl Display,
    ) -> Result<(), SceneError> {
        if field.is_given() {
            return Err(self.reject(field, advice));
        }
        field.note(Err(why));
        Ok(())
    }

    /// The error for a table without a required key; `given` are its keys.
    pub(super) fn missing<T, R, K>(
        &self,
        field: &Field<'_, T, R>,
        given: impl Iterator<Item = (K, Range<usize>)>,
        remedy: impl Display,
    ) -> SceneError {
        let lines = given.map(|(_, span)| self.line(span.start));
        SceneError::Missing {
            place: Box::new(KeyLocation {
                path: self.path.to_owned(),
                line: lines.min(),
                table: field.table.to_owned(),
                key: field.key.to_owned(),
            }),
            remedy: remedy.to_string(),
        }
    }

    /// Rejects a key of the file by the span of its value.
    pub(super) fn reject_at(
        &self,
        table: &str,
        key: &str,
        span: Range<usize>,
        remedy: impl Display,
    ) -> SceneError {
        SceneError::Value {
            place: Box::new(KeyLocation {
                path: self.path.to_owned(),
                line: Some(self.line(span.start)),
                table: table.to_owned(),
                key: key.to_owned(),
            }),
            value: self.excerpt(&span),
            remedy: remedy.to_string(),
        }
    }

    /// Rejects a key's value, or its default if the file gives none.
    pub(super) fn reject<T, R>(&self, field: &Field<'_, T, R>, remedy: impl Display) -> SceneError {
        let span = field.given.map(Spanned::span);
        SceneError::Value {
            place: Box::new(KeyLocation {
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

/// A path in a scene, relative to the scene's folder. Every key with a path has this type; tests rely on it.
#[derive(Debug, Deserialize)]
#[serde(transparent)]
pub(super) struct RawPath(pub(super) String);

/// A word in a scene that should name a value of an enum.
#[derive(Debug, Deserialize)]
#[serde(transparent, bound = "")]
pub(super) struct Choice<T> {
    word: String,
    #[serde(skip)]
    of: PhantomData<T>,
}

/// Dated maps with file paths; checked by dated_maps.rs.
#[derive(Debug, Deserialize)]
#[serde(transparent)]
pub(super) struct RawDatedMaps(pub(super) toml::Value);

/// A named tone curve, or a measured one with its file; checked by tone.rs.
#[derive(Debug, Deserialize)]
#[serde(transparent)]
pub(super) struct RawTone(pub(super) toml::Value);

/// Accepted forms of a tone.
pub(super) fn tone_forms() -> String {
    let names = names_of::<Tone>().iter().map(|name| format!("\"{name}\""));
    let names: Vec<_> = names.collect();
    format!(
        "one of {}, or {{ file = \"responses.txt\", name = \"NAME\" }}",
        names.join(", ")
    )
}

/// Target of the camera; checked by look_at.rs.
#[derive(Debug, Deserialize)]
#[serde(transparent)]
pub(super) struct RawLookAt(pub(super) toml::Value);

/// Accepted targets of the camera.
pub(super) fn look_at_forms() -> String {
    "\"sun\", \"moon\", \"satellite\", a satellite's name, or a place, { lat_deg = 48.2, lon_deg = 16.4, height_km = 0 }".to_owned()
}

/// An entry of `[[camera.keys]]`; checked by camera_keys.rs.
pub(super) type RawCameraKey = BTreeMap<String, Spanned<toml::Value>>;

/// Required kind of a path.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum PathKind {
    File,
    Folder,
    /// A file, a folder of files, or a pattern of their names.
    Set,
}

/// Whether the last part of a path is a pattern, in a folder that exists.
fn is_pattern(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    name.contains(['*', '?']) && path.parent().is_some_and(Path::is_dir)
}

/// serde's error for an unknown enum name; it lists the known names.
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

/// The enum value with this serde name.
fn named<T: for<'de> Deserialize<'de>>(word: &str) -> Result<T, UnknownName> {
    T::deserialize(StrDeserializer::new(word))
}

/// The names of an enum's values, in order.
pub(super) fn names_of<T: for<'de> Deserialize<'de>>() -> &'static [&'static str] {
    let unnamed = named::<T>("").err();
    unnamed.map_or(&[], |UnknownName(names)| names)
}

/// The name of an enum value in scene syntax.
pub(super) fn written(value: &impl serde::Serialize) -> String {
    match toml::Value::try_from(value) {
        Ok(toml::Value::String(name)) => name,
        Ok(other) => other.to_string(),
        Err(error) => error.to_string(),
    }
}

/// Converts an integer if it is in the range and not negative.
pub(super) fn whole(value: i64, range: &RangeInclusive<i64>) -> Option<u32> {
    u32::try_from(value).ok().filter(|_| range.contains(&value))
}

/// The text of a range: "1 to 48".
pub(super) fn range_text<T: Display>(range: &RangeInclusive<T>) -> String {
    format!("{} to {}", range.start(), range.end()).replace('-', "−")
}

/// A remedy with a range and an optional unit.
fn must_be_within(range: &RangeInclusive<f64>, unit: &str) -> String {
    let text = format!("must be from {} {unit}", short_range_text(range));
    text.trim_end().to_owned()
}

/// A compact text of a range: "−1e11 to 1e11".
pub(super) fn short_range_text(range: &RangeInclusive<f64>) -> String {
    let short = |bound: f64| {
        let text = match bound != 0.0 && !(1e-3..1e6).contains(&bound.abs()) {
            true => format!("{bound:e}"),
            false => bound.to_string(),
        };
        match text.strip_prefix('-') {
            Some(size) => format!("−{size}"),
            None => text,
        }
    };
    format!("{} to {}", short(*range.start()), short(*range.end()))
}

/// Why satellite keys have no value in a scene without satellites.
pub(super) const NO_ORBIT: &str = "the camera stands over a place on the ground";
