//! Orbit mean-elements messages (OMM, CCSDS 502.0-B-2 and -3): KVN, XML, and the JSON and CSV that catalogues publish.
//!
//! Our own reader, because `sgp4` reads JSON only and `ccsds-ndm` (0.0) is immature, and because a fault must name line, column
//! and remedy and cost its own record only.

mod fields;
mod json;
mod table;
mod write;

use super::cut::{CutOff, open_line};
use super::entry::{Entry, MAX_ENTRIES, RecordError, RecordFault, TextPosition};
use super::text::xml::XmlItem;
use super::text::{kvn, unmarked, xml};
use super::{MeanElements, OrbitError};
use fields::{ElementEntries, OmmSource};
use std::path::Path;
use terrella_files::excerpt;

pub(super) use table::{has_element_columns, missing_columns};
pub use write::write_omm;

/// A record that cannot be used.
pub(super) struct BadRecord {
    /// What its satellite is called, as far as that is known.
    pub names: Vec<String>,
    pub error: OrbitError,
}

impl BadRecord {
    fn new(names: Vec<String>, error: impl Into<OrbitError>) -> Box<Self> {
        let error = error.into();
        Box::new(Self { names, error })
    }
}

/// The elements of a satellite and the line where they begin.
type Read = Result<(MeanElements, usize), Box<BadRecord>>;

/// What is done with each satellite; its error ends the reading.
type Each<'e> = dyn FnMut(Read) -> Result<(), OrbitError> + 'e;

/// The elements of a record that is complete.
fn elements(record: &ElementEntries, origin: &Path, source: OmmSource) -> Read {
    let line = record.place().line;
    let elements = record.elements(origin, source);
    elements
        .map(|elements| (elements, line))
        .map_err(|error| BadRecord::new(record.names(), error))
}

enum OmmNotation {
    Kvn,
    Xml,
    Json,
    Csv,
}

fn notation(text: &str) -> Option<OmmNotation> {
    let text = unmarked(text).trim_start();
    match text.as_bytes().first()? {
        b'<' => Some(OmmNotation::Xml),
        b'[' | b'{' => Some(OmmNotation::Json),
        _ => match kvn::lines(text).next()? {
            kvn::KvnLine::Entry(entry) => (entry.key == VERSION).then_some(OmmNotation::Kvn),
            kvn::KvnLine::Other { .. } => {
                table::has_element_columns(text).then_some(OmmNotation::Csv)
            }
        },
    }
}

/// The key that begins a message in KVN.
const VERSION: &str = "CCSDS_OMM_VERS";

/// Whether a text is an OMM rather than two-line elements.
pub(super) fn is_omm(text: &str) -> bool {
    notation(text).is_some()
}

/// What shows that a message in KVN or CSV may have been cut off: XML and JSON are closed or are none.
pub(super) fn cut_off(text: &str, origin: &Path) -> Option<RecordError> {
    let is_of_lines = matches!(notation(text)?, OmmNotation::Kvn | OmmNotation::Csv);
    let line = open_line(text).filter(|_| is_of_lines)?;
    let fault = RecordFault::CutOff(CutOff::Unended);
    Some(TextPosition { line, column: 1 }.error(origin, fault))
}

/// Calls `each` for every satellite of a message in any form.
pub(super) fn each_elements(
    text: &str,
    origin: &Path,
    each: &mut Each<'_>,
) -> Result<(), OrbitError> {
    let text = unmarked(text);
    let read = match notation(text) {
        Some(OmmNotation::Xml) => from_xml(text, origin, each),
        Some(OmmNotation::Json) => json::each_elements(text, origin, each),
        Some(OmmNotation::Csv) => table::each_elements(text, origin, each),
        Some(OmmNotation::Kvn) | None => from_kvn(text, origin, each),
    };
    // What ends a whole text is one more fault where the others are good.
    read.or_else(|error| each(Err(BadRecord::new(Vec::new(), error))))
}

fn from_kvn(text: &str, origin: &Path, each: &mut Each<'_>) -> Result<(), OrbitError> {
    let mut record: Option<ElementEntries> = None;
    let mut count = 0;
    let mut finish = |record: Option<ElementEntries>, each: &mut Each<'_>| match record {
        Some(record) => {
            count += 1;
            check_count(count, record.place(), origin)?;
            each(elements(&record, origin, OmmSource::Message))
        }
        None => Ok(()),
    };
    for line in kvn::lines(text) {
        match line {
            kvn::KvnLine::Entry(entry) if entry.key == VERSION => {
                finish(record.take(), each)?;
                match check_version(&entry, origin) {
                    Ok(()) => record = Some(ElementEntries::new("the message", entry.place)),
                    Err(error) => each(Err(BadRecord::new(Vec::new(), error)))?,
                }
            }
            kvn::KvnLine::Entry(entry) => {
                // Behind a fault the rest of its record is skipped.
                if let Some(Err(error)) = record.as_mut().map(|r| r.add(entry, origin)) {
                    let names = record.take().map(|r| r.names()).unwrap_or_default();
                    each(Err(BadRecord::new(names, error)))?;
                }
            }
            kvn::KvnLine::Other { text, place } => {
                if let Some(record) = record.take() {
                    let fault = RecordFault::Unexpected {
                        text: excerpt(text),
                        expected: "KEY = value",
                    };
                    each(Err(BadRecord::new(
                        record.names(),
                        place.error(origin, fault),
                    )))?;
                }
            }
        }
    }
    finish(record, each)
}

fn check_version(entry: &Entry<'_>, origin: &Path) -> Result<(), RecordError> {
    match entry.value.split('.').next() {
        Some("1" | "2" | "3") => Ok(()),
        _ => Err(entry.unsupported(origin, "versions 1 to 3 are read")),
    }
}

fn check_count(count: usize, place: TextPosition, origin: &Path) -> Result<(), RecordError> {
    let limit = MAX_ENTRIES;
    match count > limit {
        true => {
            let what = "satellites";
            Err(place.error(origin, RecordFault::TooMany { what, limit }))
        }
        false => Ok(()),
    }
}

fn from_xml(text: &str, origin: &Path, each: &mut Each<'_>) -> Result<(), OrbitError> {
    let mut record: Option<ElementEntries> = None;
    // A fault has been reported: the rest of the record is skipped.
    let mut count = 0;
    xml::walk::<OrbitError>(text, origin, &mut |item| {
        match item {
            XmlItem::Open("omm", line) => {
                count += 1;
                let place = TextPosition { line, column: 1 };
                check_count(count, place, origin)?;
                record = Some(ElementEntries::new("the message", place));
            }
            XmlItem::Close("omm") => {
                if let Some(record) = record.take() {
                    each(elements(&record, origin, OmmSource::Message))?;
                }
            }
            XmlItem::Value(entry) => {
                if let Some(Err(error)) = record.as_mut().map(|r| r.add(entry, origin)) {
                    let names = record.take().map(|r| r.names()).unwrap_or_default();
                    each(Err(BadRecord::new(names, error)))?;
                }
            }
            XmlItem::Open(..) | XmlItem::Close(_) => {}
        }
        Ok(())
    })
}
