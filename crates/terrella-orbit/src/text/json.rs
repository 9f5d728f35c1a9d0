//! JSON objects as names and values with their places; numbers as they are written.

use super::super::entry::{Entry, RecordError, RecordFault, TextPosition};
use super::{Lines, offset};
use serde::de::{Error as _, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use serde_json::value::RawValue;
use std::borrow::Cow;
use std::fmt;
use std::path::Path;
use terrella_files::{excerpt, printable};

/// Most members of an object that is looked into.
const MAX_MEMBERS: usize = 10_000;

/// A JSON text, to find places in it.
pub struct Document<'t> {
    pub text: &'t str,
    pub origin: &'t Path,
    lines: Lines<'t>,
}

/// Names and values in their order.
pub struct Object<'t>(pub Vec<(Cow<'t, str>, &'t RawValue)>);

impl<'t> Document<'t> {
    pub fn new(text: &'t str, origin: &'t Path) -> Self {
        Self {
            text,
            origin,
            lines: Lines::of(text),
        }
    }

    /// Position of a value's first character.
    pub fn place(&self, value: &RawValue) -> TextPosition {
        self.lines.place(offset(self.text, value.get()))
    }

    pub fn error(&self, value: &RawValue, fault: RecordFault) -> RecordError {
        self.place(value).error(self.origin, fault)
    }

    /// That `value` is not `expected`.
    pub fn wrong(&self, key: &str, value: &RawValue, expected: &'static str) -> RecordError {
        let fault = RecordFault::Field {
            key: excerpt(key),
            text: excerpt(value.get()),
            expected,
        };
        self.error(value, fault)
    }

    /// Calls `each` for every member of an array, or for the one object that the text is; ends at its first error.
    pub fn each_object<E: From<RecordError>>(
        &self,
        limit: usize,
        what: &'static str,
        each: &mut dyn FnMut(&'t RawValue) -> Result<(), E>,
    ) -> Result<(), E> {
        self.each_member(self.text, limit, what, each)
    }

    /// The same for a value within the text.
    pub fn each_member<E: From<RecordError>>(
        &self,
        part: &'t str,
        limit: usize,
        what: &'static str,
        each: &mut dyn FnMut(&'t RawValue) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut failed: Option<E> = None;
        if part.trim_start().starts_with('{') {
            let object = serde_json::from_str::<&RawValue>(part);
            return each(object.map_err(|e| self.syntax(part, &e))?);
        }
        if !part.trim_start().starts_with('[') {
            let place = self.lines.place(offset(self.text, part));
            let text = excerpt(part.trim());
            let expected = "an array";
            let fault = RecordFault::Unexpected { text, expected };
            return Err(place.error(self.origin, fault).into());
        }
        let members = Members {
            each: &mut |count, value| {
                let result = match count > limit {
                    true => Err(self
                        .error(value, RecordFault::TooMany { what, limit })
                        .into()),
                    false => each(value),
                };
                result.map_err(|error| failed = Some(error)).is_ok()
            },
        };
        let mut deserializer = serde_json::Deserializer::from_str(part);
        let read = deserializer
            .deserialize_seq(members)
            .and_then(|()| deserializer.end());
        match (failed, read) {
            (Some(error), _) => Err(error),
            (None, read) => read.map_err(|e| self.syntax(part, &e).into()),
        }
    }

    /// Calls `each` for every value of a text of several, as JSON lines are, and for what is no JSON. Behind that only lines count
    /// that are an object each.
    pub fn each_of_stream<E>(
        &self,
        each: &mut dyn FnMut(Result<&'t RawValue, RecordError>) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut values = serde_json::Deserializer::from_str(self.text).into_iter::<&RawValue>();
        let mut end = 0;
        loop {
            match values.next() {
                None => return Ok(()),
                Some(Ok(value)) => each(Ok(value))?,
                Some(Err(error)) => {
                    each(Err(self.syntax(self.text, &error)))?;
                    break;
                }
            }
            end = values.byte_offset();
        }
        let rest = self.text.get(end..).unwrap_or_default().trim_start();
        let lines = rest.lines().skip(1).map(str::trim);
        for line in lines.filter(|line| line.starts_with('{') && line.ends_with('}')) {
            let value = serde_json::from_str(line);
            each(value.map_err(|error| self.syntax(line, &error)))?;
        }
        Ok(())
    }

    /// The members of an object.
    pub fn object(
        &self,
        value: &'t RawValue,
        expected: &'static str,
    ) -> Result<Object<'t>, RecordError> {
        serde_json::from_str(value.get()).map_err(|_| {
            let text = excerpt(value.get());
            self.error(value, RecordFault::Unexpected { text, expected })
        })
    }

    /// A text or a number as an entry; `None` for null. Anything else keeps its JSON as the value.
    pub fn entry(&self, key: &str, value: &'t RawValue) -> Option<Entry<'t>> {
        let json = value.get();
        let text = match json.as_bytes().first() {
            Some(b'n') => return None,
            Some(b'"') => serde_json::from_str::<String>(json).map(Cow::Owned),
            _ => Ok(Cow::Borrowed(json)),
        };
        Some(Entry {
            key: Cow::Owned(key.to_owned()),
            value: text.unwrap_or(Cow::Borrowed(json)),
            unit: None,
            place: self.place(value),
        })
    }

    fn syntax(&self, part: &str, error: &serde_json::Error) -> RecordError {
        let at = self.lines.place(offset(self.text, part));
        let (line, column) = (error.line().max(1), error.column().max(1));
        let place = TextPosition {
            line: at.line + line - 1,
            column: match line {
                1 => at.column + column - 1,
                _ => column,
            },
        };
        // The parser puts the place behind its reason; it is in front already.
        let cause = error.to_string();
        let cause = cause.split(" at line ").next().unwrap_or(&cause);
        let fault = RecordFault::Syntax {
            format: "JSON",
            cause: printable(cause),
        };
        place.error(self.origin, fault)
    }
}

impl<'t> Object<'t> {
    /// The value with that name; the last one if it is repeated, as in JavaScript.
    pub fn get(&self, key: &str) -> Option<&'t RawValue> {
        let mut values = self.0.iter().rev();
        values
            .find(|(name, _)| name == key)
            .map(|(_, value)| *value)
            .filter(|value| value.get() != "null")
    }
}

impl<'de> Deserialize<'de> for Object<'de> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Pairs;
        impl<'de> Visitor<'de> for Pairs {
            type Value = Object<'de>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut pairs = Vec::new();
                while let Some((Name(name), value)) =
                    map.next_entry::<Name<'de>, &'de RawValue>()?
                {
                    if pairs.len() >= MAX_MEMBERS {
                        return Err(A::Error::custom("too many members"));
                    }
                    pairs.push((name, value));
                }
                Ok(Object(pairs))
            }
        }
        deserializer.deserialize_map(Pairs)
    }
}

/// A key, borrowed where it has no escapes.
struct Name<'n>(Cow<'n, str>);

impl<'de> Deserialize<'de> for Name<'de> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Text;
        impl<'de> Visitor<'de> for Text {
            type Value = Name<'de>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a name")
            }
            fn visit_borrowed_str<E>(self, text: &'de str) -> Result<Self::Value, E> {
                Ok(Name(Cow::Borrowed(text)))
            }
            fn visit_str<E>(self, text: &str) -> Result<Self::Value, E> {
                Ok(Name(Cow::Owned(text.to_owned())))
            }
        }
        deserializer.deserialize_str(Text)
    }
}

/// Passes members of an array to a callback while parsing: none is kept.
struct Members<'m, 't> {
    each: &'m mut dyn FnMut(usize, &'t RawValue) -> bool,
}

impl<'de> Visitor<'de> for Members<'_, 'de> {
    type Value = ();
    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an array of objects")
    }
    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<(), A::Error> {
        let mut count = 0;
        while let Some(value) = seq.next_element::<&'de RawValue>()? {
            count += 1;
            if !(self.each)(count, value) {
                return Err(A::Error::custom("ended by the reader"));
            }
        }
        Ok(())
    }
}
