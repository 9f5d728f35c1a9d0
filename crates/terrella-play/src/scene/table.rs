//! How scene keys are declared; [`keys`](super::keys) has the declarations.
//!
//! `key: type, of "unit", in range, default value, for USE;` makes the key's field in the table as written and a method of the
//! same name that hands its rule to the checks. Only the type is needed:
//!
//! - `of` is the unit of a number, what a path leads to, what a word chooses, or for other types all that the value must be;
//! - `in` is the range of the numbers;
//! - `default` is the value where a scene leaves the key out. What depends on other keys is in the sentence above the key;
//! - `for` is where the key has a meaning, everywhere if it is left out.

use super::choices::OrbitSource;
use super::field::{
    Choice, RawCameraKey, RawDatedMaps, RawLookAt, RawPath, RawTone, look_at_forms, names_of,
    tone_forms,
};
use serde::Deserialize;
use toml::Spanned;

/// A key that a table knows.
#[derive(Debug)]
pub(super) struct Key {
    pub(super) name: &'static str,
    /// What its value must be, to be read after "must be".
    pub(super) expected: fn() -> String,
    /// Where it has a meaning; `None` is everywhere.
    pub(super) only: Option<&'static Only>,
    #[cfg(test)]
    pub(super) about: About,
}

/// Where a key has a meaning.
#[derive(Debug)]
pub(super) struct Only {
    /// To be read after "not used:".
    pub(super) why: &'static str,
    /// The sources of `[orbit]` that it is for; none for keys of other tables.
    pub(super) sources: &'static [OrbitSource],
}

/// What the reference page and the schema have of a key besides.
#[cfg(test)]
#[derive(Debug)]
pub(super) struct About {
    pub(super) meaning: &'static str,
    pub(super) of: &'static str,
    pub(super) shape: fn() -> Shape,
    /// Least and greatest number.
    pub(super) range: Option<[f64; 2]>,
    pub(super) default: Option<fn() -> serde_json::Value>,
}

/// What a value is.
#[cfg(test)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    Flag,
    Number,
    Whole,
    /// One of these words.
    Word(&'static [&'static str]),
    Text,
    Path,
    Paths,
    /// Three numbers.
    Vector,
    /// Two whole numbers.
    Pair,
    DatedMaps,
    /// A word, or a table with a path.
    Tone,
    /// A word, or a table with a place.
    LookAt,
    /// What the key alone has.
    Own,
}

/// A table that a scene knows.
#[derive(Debug)]
pub(super) struct Table {
    pub(super) name: &'static str,
    pub(super) keys: &'static [Key],
}

impl Table {
    /// Whether a scene may have several of it.
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

    /// What the value must be, from the `of` of its key.
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

/// The value in an option of a declaration, or what stands for none.
macro_rules! given_or {
    ($none:expr;) => {
        $none
    };
    ($none:expr; $given:expr) => {
        $given
    };
}

/// The method of a key, with as much of a rule as its declaration has.
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

/// A table from its keys.
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

            /// All keys, with the span of their values where the file gives them.
            pub(super) fn declared(&self) -> impl Iterator<Item = (&'static Key, Option<Range<usize>>)> {
                let spans = [$(self.$key.as_ref().map(Spanned::span)),*];
                Self::TABLE.keys.iter().zip(spans)
            }

            /// The keys that the file gives, with the span of their values.
            pub(super) fn given(&self) -> impl Iterator<Item = (&'static Key, Range<usize>)> {
                self.declared().filter_map(|(key, span)| Some((key, span?)))
            }

            /// What its keys came to, once all of them are read.
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
