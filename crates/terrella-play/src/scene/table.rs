//! Declaration syntax of scene keys; [`keys`](super::keys) has the declarations.
//!
//! `key: type, of "unit", in range, default value, for USE;` declares a field of the table, and a method of the same name that passes its rule to the
//! checks. Only the type is required:
//!
//! - `of` is the unit of a number, the target of a path, the meaning of a choice, or for other types the accepted values;
//! - `in` is the range of the numbers;
//! - `default` is the constant default. Defaults that depend on other keys are stated in the sentence above the key;
//! - `for` is the scope of the key; without it, the key applies everywhere.

use super::choices::OrbitSource;
use super::field::{
    Choice, RawCameraKey, RawDatedMaps, RawLookAt, RawPath, RawTone, look_at_forms, names_of,
    tone_forms,
};
use serde::Deserialize;
use toml::Spanned;

/// A key of a table.
#[derive(Debug)]
pub(super) struct Key {
    pub(super) name: &'static str,
    /// Accepted values, as the rest of a sentence after "must be".
    pub(super) expected: fn() -> String,
    /// Scope of the key; `None` means everywhere.
    pub(super) only: Option<&'static Only>,
    #[cfg(test)]
    pub(super) about: About,
}

/// Scope of a key.
#[derive(Debug)]
pub(super) struct Only {
    /// Reason, as the rest of a sentence after "not used:".
    pub(super) why: &'static str,
    /// The sources of `[orbit]` that use the key; empty for keys of other tables.
    pub(super) sources: &'static [OrbitSource],
}

/// Additional data for the reference page and the schema.
#[cfg(test)]
#[derive(Debug)]
pub(super) struct About {
    pub(super) meaning: &'static str,
    pub(super) of: &'static str,
    pub(super) shape: fn() -> Shape,
    /// Smallest and largest number.
    pub(super) range: Option<[f64; 2]>,
    pub(super) default: Option<fn() -> serde_json::Value>,
}

/// Shape of a value.
#[cfg(test)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    Flag,
    Number,
    Whole,
    /// One of several words.
    Word(&'static [&'static str]),
    Text,
    Path,
    Paths,
    /// Three numbers.
    Vector,
    /// Two integers.
    Pair,
    DatedMaps,
    /// A word, or a table with a path.
    Tone,
    /// A word, or a table with a place.
    LookAt,
    /// A shape that only this key has.
    Own,
}

/// A table of scenes.
#[derive(Debug)]
pub(super) struct Table {
    pub(super) name: &'static str,
    pub(super) keys: &'static [Key],
}

impl Table {
    /// Whether a scene may have several of this table.
    pub(super) fn is_list(&self) -> bool {
        matches!(self.name, "orbit" | "station" | "geojson" | "caption")
    }
}

/// Types of values.
pub(super) trait Value {
    type Number;
    type Default;
    #[cfg(test)]
    const SHAPE: fn() -> Shape;

    /// The accepted values, from the `of` of the key.
    fn expected(of: &str) -> String {
        of.to_owned()
    }
}

impl Value for bool {
    type Number = ();
    type Default = Self;
    #[cfg(test)]
    const SHAPE: fn() -> Shape = || Shape::Flag;

    fn expected(_: &str) -> String {
        "true or false".to_owned()
    }
}

impl Value for f64 {
    type Number = Self;
    type Default = Self;
    #[cfg(test)]
    const SHAPE: fn() -> Shape = || Shape::Number;

    fn expected(unit: &str) -> String {
        match unit {
            "" => "a number".to_owned(),
            unit => format!("a number of {unit}"),
        }
    }
}

impl Value for RawPath {
    type Number = ();
    type Default = ();
    #[cfg(test)]
    const SHAPE: fn() -> Shape = || Shape::Path;

    fn expected(what: &str) -> String {
        format!("a string, the path of {what}")
    }
}

impl Value for RawTone {
    type Number = ();
    type Default = ();
    #[cfg(test)]
    const SHAPE: fn() -> Shape = || Shape::Tone;

    fn expected(_: &str) -> String {
        tone_forms()
    }
}

impl Value for RawLookAt {
    type Number = ();
    type Default = ();
    #[cfg(test)]
    const SHAPE: fn() -> Shape = || Shape::LookAt;

    fn expected(_: &str) -> String {
        look_at_forms()
    }
}

impl<T: for<'de> Deserialize<'de>> Value for Choice<T> {
    type Number = ();
    type Default = T;
    #[cfg(test)]
    const SHAPE: fn() -> Shape = || Shape::Word(names_of::<T>());

    fn expected(what: &str) -> String {
        let names: Vec<_> = names_of::<T>()
            .iter()
            .map(|name| format!("\"{name}\""))
            .collect();
        let (last, others) = names.split_last().expect("a choice has names");
        let what = match what {
            "" => String::new(),
            what => format!(", {what}"),
        };
        format!("a string{what}: {} or {last}", others.join(", "))
    }
}

macro_rules! values {
    ($($kind:ty: $number:ty, $shape:ident;)*) => {
        $(impl Value for $kind {
            type Number = $number;
            type Default = $number;
            #[cfg(test)]
            const SHAPE: fn() -> Shape = || Shape::$shape;
        })*
    };
}

values! {
    i64: i64, Whole;
    String: (), Text;
    toml::Value: i64, Own;
    Vec<f64>: f64, Vector;
    Vec<i64>: i64, Pair;
    Vec<String>: (), Own;
    Vec<Spanned<RawPath>>: (), Paths;
    Vec<RawCameraKey>: (), Own;
    RawDatedMaps: (), DatedMaps;
}

/// The value of an optional part of a declaration, or its substitute.
macro_rules! given_or {
    ($none:expr;) => {
        $none
    };
    ($none:expr; $given:expr) => {
        $given
    };
}

/// The method of a key, with the rule from its declaration.
macro_rules! method {
    ($(#[doc = $doc:literal])+ $key:ident: $kind:ty, of $of:expr) => {
        method! { @ $(#[doc = $doc])+ $key: $kind, $of, (), () }
    };
    ($(#[doc = $doc:literal])+ $key:ident: $kind:ty, of $of:expr, in $range:expr) => {
        method! { @ $(#[doc = $doc])+ $key: $kind, $of, RangeInclusive<<$kind as Value>::Number>, $range }
    };
    ($(#[doc = $doc:literal])+ $key:ident: $kind:ty, of $of:expr, in $range:expr, default $default:expr) => {
        method! {
            @ $(#[doc = $doc])+ $key: $kind, $of,
            Bounds<<$kind as Value>::Number>, Bounds { range: $range, default: $default }
        }
    };
    ($(#[doc = $doc:literal])+ $key:ident: $kind:ty, of $of:expr, default $default:expr) => {
        method! { @ $(#[doc = $doc])+ $key: $kind, $of, <$kind as Value>::Default, $default }
    };
    (@ $(#[doc = $doc:literal])+ $key:ident: $kind:ty, $of:expr, $rule:ty, $value:expr) => {
        $(#[doc = $doc])+
        pub(super) fn $key(&self) -> Field<'_, $kind, $rule> {
            Field {
                table: Self::TABLE.name,
                key: stringify!($key),
                of: $of,
                given: self.$key.as_ref(),
                rule: $value,
                notes: &self.notes,
            }
        }
    };
}

/// Declares a table by its keys.
macro_rules! table {
    ($name:ident = $table:literal {
        $($(#[doc = $doc:literal])+ $key:ident: $kind:ty
            $(, of $of:literal)? $(, in $range:expr)? $(, default $default:expr)? $(, for $only:expr)?;)*
    }) => {
        #[derive(Debug, Default, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub(super) struct $name {
            $($(#[doc = $doc])+ $key: Option<Spanned<$kind>>,)*
            /// What its readers note.
            #[serde(skip)]
            pub(super) notes: Notes,
        }

        impl $name {
            pub(super) const TABLE: Table = Table {
                name: $table,
                keys: &[$(Key {
                    name: stringify!($key),
                    expected: || <$kind as Value>::expected(given_or!(""; $($of)?)),
                    only: given_or!(None; $(Some($only))?),
                    #[cfg(test)]
                    about: About {
                        meaning: concat!($($doc),+),
                        of: given_or!(""; $($of)?),
                        shape: <$kind as Value>::SHAPE,
                        range: given_or!(None; $(Some({
                            let range = $range;
                            [*range.start() as f64, *range.end() as f64]
                        }))?),
                        default: given_or!(None; $(Some(|| json!($default)))?),
                    },
                }),*],
            };

            /// All keys, with the spans of values given in the file.
            pub(super) fn declared(&self) -> impl Iterator<Item = (&'static Key, Option<Range<usize>>)> {
                let spans = [$(self.$key.as_ref().map(Spanned::span)),*];
                Self::TABLE.keys.iter().zip(spans)
            }

            /// The keys given in the file, with the spans of their values.
            pub(super) fn given(&self) -> impl Iterator<Item = (&'static Key, Range<usize>)> {
                self.declared().filter_map(|(key, span)| Some((key, span?)))
            }

            /// The effective values of its keys, after all have been read.
            pub(super) fn record(self, source: SceneText<'_>) -> Record {
                let given = self.given();
                let lines = given.map(|(key, span)| (key.name, source.line(span.start))).collect();
                Record::new(lines, self.notes)
            }

            $(method! { $(#[doc = $doc])+ $key: $kind, of given_or!(""; $($of)?) $(, in $range)? $(, default $default)? })*
        }
    };
}

pub(super) use {given_or, method, table};
