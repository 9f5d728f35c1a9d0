//! Elements in a table: CSV as catalogues publish it, also with the semicolons and tabs of spreadsheets.

use super::super::csv_row;
use super::super::entry::{Entry, RecordError, RecordFault, TextPosition, number};
use super::super::text::csv::{self, CsvField};
use super::fields::{ElementEntries, OmmSource};
use super::{BadRecord, Each, Read, check_count, elements};
use crate::OrbitError;
use std::borrow::Cow;
use std::path::Path;

/// Columns required for propagation. A table without names must have numbers.
const NEEDED: [&str; 8] = [
    "EPOCH",
    "MEAN_MOTION",
    "ECCENTRICITY",
    "INCLINATION",
    "RA_OF_ASC_NODE",
    "ARG_OF_PERICENTER",
    "MEAN_ANOMALY",
    "BSTAR",
];

/// Whether a text is a table of mean elements: its header names the mean motion, or two other elements and no position. The test ignores
/// case; the reader requires capitals and reports an error.
pub fn has_element_columns(text: &str) -> bool {
    let Some((_, header, separator)) = csv::header(text) else {
        return false;
    };
    let mut fields = header
        .split(separator)
        .map(|name| name.trim().trim_matches('"'));
    let is = |name: &str| {
        let mut known = NEEDED.iter().chain(&ElementEntries::NAMES);
        known.any(|known| known.eq_ignore_ascii_case(name))
    };
    fields
        .clone()
        .any(|name| name.eq_ignore_ascii_case("MEAN_MOTION"))
        || fields.clone().filter(|name| is(name)).count() >= 2
            && !fields.any(|name| matches!(name, "x_km" | "x_m"))
}

/// The columns that a table lacks if it has no elements; `None` if the text is not a table.
pub fn missing_columns(text: &str, origin: &Path) -> Option<RecordError> {
    let (line, header, separator) = csv::header(text)?;
    let header = csv::fields(header, separator).filter(|fields| fields.len() > 2)?;
    // Two-line elements separated by tabs have numbers where a header would be.
    let is_header = header.iter().all(|field| number(&field.text).is_none());
    is_header.then(|| check_columns(&header, line, origin).err())?
}

/// Calls `each` for every row.
pub(super) fn each_elements(
    text: &str,
    origin: &Path,
    each: &mut Each<'_>,
) -> Result<(), OrbitError> {
    let Some((at, header, separator)) = csv::header(text) else {
        return Ok(());
    };
    let place = |line| TextPosition { line, column: 1 };
    let header = csv_row::fields(header, separator, place(at), origin)?;
    check_columns(&header, at, origin)?;
    for (count, (line, text)) in csv::rows(text).skip(1).enumerate() {
        check_count(count + 1, place(line), origin)?;
        let nameless = |error: RecordError| BadRecord::new(Vec::new(), error);
        let row = csv_row::fields(text, separator, place(line), origin).map_err(nameless);
        each(row.and_then(|row| read(&header, row, line, origin)))?;
    }
    Ok(())
}

/// Rejects a header that lacks a column that every row needs.
fn check_columns(header: &[CsvField<'_>], line: usize, origin: &Path) -> Result<(), RecordError> {
    let has = |name: &str| header.iter().any(|field| field.text == name);
    let mut columns: Vec<_> = NEEDED.into_iter().filter(|name| !has(name)).collect();
    if !has("OBJECT_NAME") && !has("NORAD_CAT_ID") {
        columns.insert(0, "OBJECT_NAME");
    }
    if columns.is_empty() {
        return Ok(());
    }
    let remedy = "; SGP4 needs them all, in capitals and in the units of an OMM: take the table of the catalogue, or two-line elements";
    let fault = RecordFault::MissingColumns { columns, remedy };
    Err(TextPosition { line, column: 1 }.error(origin, fault))
}

fn read(header: &[CsvField<'_>], row: Vec<CsvField<'_>>, line: usize, origin: &Path) -> Read {
    let place = TextPosition { line, column: 1 };
    if row.len() != header.len() {
        let fault = RecordFault::Unexpected {
            text: format!("{} fields", row.len()),
            expected: "as many as the header has",
        };
        let named = header.iter().zip(&row);
        let names = named
            .filter(|(key, _)| ElementEntries::NAMES.contains(&key.text.as_ref()))
            .map(|(_, field)| field.text.clone().into_owned());
        return Err(BadRecord::new(names.collect(), place.error(origin, fault)));
    }
    let mut record = ElementEntries::new("the row", place);
    for (name, field) in header.iter().zip(row) {
        if field.text.is_empty() {
            continue;
        }
        let entry = Entry {
            key: Cow::Borrowed(&name.text),
            value: field.text,
            unit: None,
            place: TextPosition {
                line,
                column: field.column,
            },
        };
        record
            .add(entry, origin)
            .map_err(|error| BadRecord::new(record.names(), error))?;
    }
    elements(&record, origin, OmmSource::Catalogue)
}
