//! Keys of a table that are taken one after the other; what is left at the end was not known.

use std::fmt;
use std::ops::RangeInclusive;
use toml::{Table, Value};

/// Why a scene is not shown.
#[derive(Debug)]
pub enum Fault {
    /// No TOML, with the place.
    Toml(toml::de::Error),
    /// More bytes than a scene has.
    TooLong {
        /// Most of them.
        most: usize,
    },
    /// A key with another kind of value.
    Value {
        /// The key with its table.
        key: String,
        /// What it must be.
        wanted: String,
    },
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Toml(error) => write!(f, "the scene is no TOML: {error}"),
            Self::TooLong { most } => write!(f, "the scene has more than {most} bytes"),
            Self::Value { key, wanted } => write!(f, "{key} must be {wanted}"),
        }
    }
}

/// A table, of which keys are taken.
pub struct Keys {
    name: &'static str,
    table: Table,
}

impl Keys {
    pub fn new(name: &'static str, table: Table) -> Self {
        Self { name, table }
    }

    /// A key with its table, as messages name it.
    pub fn path(&self, key: &str) -> String {
        match self.name {
            "" => key.to_owned(),
            name => format!("{name}.{key}"),
        }
    }

    pub fn wrong(&self, key: &str, wanted: &str) -> Fault {
        Fault::Value {
            key: self.path(key),
            wanted: wanted.to_owned(),
        }
    }

    /// The error of a word that scenes do not have.
    pub fn unknown_word(&self, key: &str, word: &str) -> Fault {
        self.wrong(
            key,
            &format!("one of the words of docs/scene-reference.md, not \"{word}\""),
        )
    }

    /// A value of any kind.
    pub fn value(&mut self, key: &str) -> Option<Value> {
        self.table.remove(key)
    }

    /// A table; empty where there is none.
    pub fn table(&mut self, key: &'static str) -> Result<Self, Fault> {
        match self.value(key) {
            None => Ok(Self::new(key, Table::new())),
            Some(Value::Table(table)) => Ok(Self::new(key, table)),
            Some(_) => Err(self.wrong(key, "a table")),
        }
    }

    /// One table or several.
    pub fn tables(&mut self, key: &'static str, most: usize) -> Result<Vec<Self>, Fault> {
        let values = match self.value(key) {
            None => Vec::new(),
            Some(Value::Array(values)) if values.len() <= most => values,
            Some(value @ Value::Table(_)) => vec![value],
            Some(_) => return Err(self.wrong(key, &format!("a table, or at most {most}"))),
        };
        let tables = values.into_iter().map(|value| match value {
            Value::Table(table) => Ok(Self::new(key, table)),
            _ => Err(self.wrong(key, "a table")),
        });
        tables.collect()
    }

    pub fn text(&mut self, key: &str) -> Result<Option<String>, Fault> {
        match self.value(key) {
            None => Ok(None),
            Some(Value::String(text)) => Ok(Some(text)),
            // A date without quotation marks.
            Some(Value::Datetime(date)) => Ok(Some(date.to_string())),
            Some(_) => Err(self.wrong(key, "a text")),
        }
    }

    pub fn flag(&mut self, key: &str) -> Result<Option<bool>, Fault> {
        match self.value(key) {
            None => Ok(None),
            Some(Value::Boolean(flag)) => Ok(Some(flag)),
            Some(_) => Err(self.wrong(key, "true or false")),
        }
    }

    /// Whether something is drawn: `true`, or a table with how, of which the page has the usual values.
    pub fn is_on(&mut self, key: &str) -> Result<bool, Fault> {
        match self.value(key) {
            None | Some(Value::Boolean(false)) => Ok(false),
            Some(Value::Boolean(true) | Value::Table(_)) => Ok(true),
            Some(_) => Err(self.wrong(key, "true or false")),
        }
    }

    pub fn number(&mut self, key: &str, range: RangeInclusive<f64>) -> Result<Option<f64>, Fault> {
        let value = self.value(key);
        let number = value.map(|value| self.number_of(key, &value, range));
        number.transpose()
    }

    /// The number of a value that was taken.
    pub fn number_of(
        &self,
        key: &str,
        value: &Value,
        range: RangeInclusive<f64>,
    ) -> Result<f64, Fault> {
        let number = match value {
            Value::Integer(number) => *number as f64,
            Value::Float(number) => *number,
            _ => f64::NAN,
        };
        match range.contains(&number) {
            true => Ok(number),
            false => {
                let (from, to) = range.into_inner();
                Err(self.wrong(key, &format!("a number from {from} to {to}")))
            }
        }
    }

    /// What was not taken.
    pub fn rest(&self) -> impl Iterator<Item = String> + '_ {
        self.table.keys().map(|key| self.path(key))
    }
}
