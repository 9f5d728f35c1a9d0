//! The entries of messages, in KVN and in XML.

use super::super::entry::{Entry, Fields, RecordError, RecordFault, TextPosition};
use super::super::text::kvn::{KvnLine, lines};
use super::super::text::xml::{XmlItem, walk};
use super::{maneuver, message};
use std::path::Path;
use terrella_files::excerpt;

/// The key that begins a message in KVN.
pub const VERSION: &str = "CCSDS_OPM_VERS";
/// Most manoeuvres of a message.
const MAX_MANEUVERS: usize = 1_000;

/// The entries of one message.
pub struct Record {
    pub fields: Fields,
    pub maneuvers: Vec<Fields>,
}

/// A message, or the reason why it cannot be used, with the names of its satellite as far as known.
pub type Read = Result<Record, (Vec<String>, RecordError)>;

/// Callback for each message; its error ends the reading.
pub type Each<'e> = dyn FnMut(Read) -> Result<(), RecordError> + 'e;

impl Record {
    fn new(place: TextPosition) -> Self {
        Self {
            fields: Fields::new("the message", place, message::KEYS),
            maneuvers: Vec::new(),
        }
    }

    /// Names of its satellite.
    pub fn names(&self) -> Vec<String> {
        let names = ["OBJECT_NAME", "OBJECT_ID"].map(|key| self.fields.get(key));
        let names = names.into_iter().flatten();
        names.map(|entry| entry.value.to_string()).collect()
    }

    fn add(&mut self, entry: Entry<'_>, origin: &Path) -> Result<(), RecordError> {
        if !entry.key.starts_with("MAN_") {
            return self.fields.add(entry, origin);
        }
        if entry.key == maneuver::FIRST_KEY {
            if self.maneuvers.len() >= MAX_MANEUVERS {
                let (what, limit) = ("manoeuvres", MAX_MANEUVERS);
                return Err(entry
                    .place
                    .error(origin, RecordFault::TooMany { what, limit }));
            }
            let fields = Fields::new("the manoeuvre", entry.place, maneuver::KEYS);
            self.maneuvers.push(fields);
        }
        match self.maneuvers.last_mut() {
            Some(maneuver) => maneuver.add(entry, origin),
            None => {
                let fault = RecordFault::Unexpected {
                    text: excerpt(&entry.key),
                    expected: "MAN_EPOCH_IGNITION, with which a manoeuvre begins",
                };
                Err(entry.place.error(origin, fault))
            }
        }
    }
}

/// Calls `each` for every message of a text.
pub fn each_record(text: &str, origin: &Path, each: &mut Each<'_>) -> Result<(), RecordError> {
    let read = match text.trim_start().starts_with('<') {
        true => from_xml(text, origin, each),
        false => from_kvn(text, origin, each),
    };
    // An error that ends the text is one more fault if other messages are valid.
    read.or_else(|error| each(Err((Vec::new(), error))))
}

fn from_kvn(text: &str, origin: &Path, each: &mut Each<'_>) -> Result<(), RecordError> {
    let mut record: Option<Record> = None;
    for line in lines(text) {
        let added = match line {
            KvnLine::Entry(entry) if entry.key == VERSION => {
                if let Some(record) = record.take() {
                    each(Ok(record))?;
                }
                match entry.value.split('.').next() {
                    Some("1" | "2" | "3") => record = Some(Record::new(entry.place)),
                    _ => {
                        let error = entry.unsupported(origin, "versions 1 to 3 are read");
                        each(Err((Vec::new(), error)))?;
                    }
                }
                continue;
            }
            KvnLine::Entry(entry) => record.as_mut().map(|record| record.add(entry, origin)),
            KvnLine::Other { text, place } => record.as_ref().map(|_| {
                let fault = RecordFault::Unexpected {
                    text: excerpt(text),
                    expected: "KEY = value",
                };
                Err(place.error(origin, fault))
            }),
        };
        // Behind a fault the rest of its message is skipped.
        if let Some(Err(error)) = added {
            let names = record.take().map(|record| record.names());
            each(Err((names.unwrap_or_default(), error)))?;
        }
    }
    match record {
        Some(record) => each(Ok(record)),
        None => Ok(()),
    }
}

fn from_xml(text: &str, origin: &Path, each: &mut Each<'_>) -> Result<(), RecordError> {
    let mut record: Option<Record> = None;
    walk::<RecordError>(text, origin, &mut |item| {
        match item {
            XmlItem::Open("opm", line) => {
                record = Some(Record::new(TextPosition { line, column: 1 }));
            }
            XmlItem::Close("opm") => {
                if let Some(record) = record.take() {
                    each(Ok(record))?;
                }
            }
            XmlItem::Value(entry) => {
                if let Some(Err(error)) = record.as_mut().map(|record| record.add(entry, origin)) {
                    let names = record.take().map(|record| record.names());
                    each(Err((names.unwrap_or_default(), error)))?;
                }
            }
            XmlItem::Open(..) | XmlItem::Close(_) => {}
        }
        Ok(())
    })
}
