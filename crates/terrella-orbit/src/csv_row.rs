//! A row of a table in CSV under a header: its fields as entries, by the number of their column.

use super::entry::{Entry, RecordError, RecordFault, TextPosition, scaled_number};
use super::text::csv::{self, CsvField};
use std::borrow::Cow;
use std::path::Path;

/// The fields of a line of a table.
///
/// # Errors
/// A quotation mark that is unpaired or inside a field.
pub fn fields<'t>(
    text: &'t str,
    separator: char,
    place: TextPosition,
    origin: &Path,
) -> Result<Vec<CsvField<'t>>, RecordError> {
    csv::fields(text, separator).ok_or_else(|| {
        let fault = RecordFault::Syntax {
            format: "CSV",
            cause: "a quotation mark without its partner".to_owned(),
        };
        place.error(origin, fault)
    })
}

/// A row that is as long as its header.
pub struct CsvRow<'a> {
    fields: &'a [CsvField<'a>],
    line: usize,
    origin: &'a Path,
}

impl<'a> CsvRow<'a> {
    /// # Errors
    /// A row that has not `count` fields.
    pub fn new(
        fields: &'a [CsvField<'a>],
        count: usize,
        line: usize,
        origin: &'a Path,
    ) -> Result<Self, RecordError> {
        let row = Self {
            fields,
            line,
            origin,
        };
        if fields.len() == count {
            return Ok(row);
        }
        let fault = RecordFault::Unexpected {
            text: format!("{} fields", fields.len()),
            expected: "as many as the header has",
        };
        Err(row.place().error(origin, fault))
    }

    /// Position of its first character.
    pub fn place(&self) -> TextPosition {
        TextPosition {
            line: self.line,
            column: 1,
        }
    }

    /// The field of a column, which messages call `key`.
    pub fn entry(&self, column: usize, key: &'static str) -> Entry<'a> {
        let field = self.fields.get(column);
        Entry {
            key: Cow::Borrowed(key),
            value: Cow::Borrowed(field.map_or("", |field| &field.text)),
            unit: None,
            place: TextPosition {
                line: self.line,
                column: field.map_or(1, |field| field.column),
            },
        }
    }

    /// The numbers of some columns, times ten to a power.
    ///
    /// # Errors
    /// A field that is no number.
    pub fn numbers<const N: usize>(
        &self,
        columns: [usize; N],
        keys: [&'static str; N],
        power: i32,
    ) -> Result<[f64; N], RecordError> {
        let mut numbers = [0.0; N];
        for ((slot, column), key) in numbers.iter_mut().zip(columns).zip(keys) {
            let entry = self.entry(column, key);
            *slot = scaled_number(&entry.value, power)
                .ok_or_else(|| entry.wrong(self.origin, "a number"))?;
        }
        Ok(numbers)
    }
}
