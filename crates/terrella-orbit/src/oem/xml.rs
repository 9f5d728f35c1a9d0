//! OEM in XML.

use super::super::entry::{Fields, Keys, RecordError, TextPosition, scaled_number};
use super::super::found::{Each, Found};
use super::super::text::xml::{XmlItem, walk};
use super::draft::{Draft, metadata};
use glam::DVec3;
use std::path::Path;

const STATE_KEYS: &Keys = &[
    ("EPOCH", ""),
    ("X", "km"),
    ("Y", "km"),
    ("Z", "km"),
    ("X_DOT", "km/s"),
    ("Y_DOT", "km/s"),
    ("Z_DOT", "km/s"),
];

const COVARIANCE_KEYS: &Keys = &[
    ("EPOCH", ""),
    ("CX_X", "km**2"),
    ("CY_Y", "km**2"),
    ("CZ_Z", "km**2"),
];

/// Calls `each` for every message.
pub fn read(text: &str, origin: &Path, each: &mut Each<'_>) -> Result<(), RecordError> {
    let mut message: Option<Message<'_>> = None;
    let read = walk::<RecordError>(text, origin, &mut |item| {
        match &item {
            XmlItem::Open("oem", line) => {
                let place = TextPosition {
                    line: *line,
                    column: 1,
                };
                message = Some(Message {
                    origin,
                    draft: Draft::new(origin, place),
                    block: None,
                });
                return Ok(());
            }
            XmlItem::Close("oem") => {
                return match message.take() {
                    Some(message) => {
                        let names = message.draft.names();
                        let object = message.draft.finish(each);
                        each(Found::of(names, object))
                    }
                    None => Ok(()),
                };
            }
            _ => {}
        }
        // Behind a fault that corrupts its message the rest of that is skipped.
        if let Some(Err(error)) = message.as_mut().map(|m| m.item(item, each)) {
            let names = message.take().map(|message| message.draft.names());
            each(Found::Corrupt(names.unwrap_or_default(), error))?;
        }
        Ok(())
    });
    // An error that ends the text is one more fault if other segments are valid.
    read.or_else(|error| each(Found::corrupt(error)))
}

struct Message<'o> {
    origin: &'o Path,
    draft: Draft<'o>,
    /// The innermost element that holds values, by name.
    block: Option<(&'static str, Fields)>,
}

impl Message<'_> {
    fn item(&mut self, item: XmlItem<'_>, each: &mut Each<'_>) -> Result<(), RecordError> {
        match item {
            XmlItem::Open(name, line) => {
                let place = TextPosition { line, column: 1 };
                self.block = match name {
                    "metadata" => Some(("metadata", metadata(place))),
                    "stateVector" => {
                        Some(("stateVector", Fields::new("the state", place, STATE_KEYS)))
                    }
                    "covarianceMatrix" => Some((
                        "covarianceMatrix",
                        Fields::new("the covariance", place, COVARIANCE_KEYS),
                    )),
                    _ => None,
                };
                Ok(())
            }
            XmlItem::Value(entry) => match &mut self.block {
                Some((block, fields)) => match fields.add(entry, self.origin) {
                    // The rest of the element is skipped.
                    Err(error) if *block != "metadata" => {
                        self.block = None;
                        each(Found::BadState(error))
                    }
                    done => done,
                },
                None => Ok(()),
            },
            XmlItem::Close(name) => match self.block.take().filter(|(block, _)| *block == name) {
                Some(("metadata", fields)) => self.draft.begin(&fields, each),
                Some((block, fields)) => {
                    let read = match block {
                        "stateVector" => self.state(&fields),
                        _ => self.covariance(&fields),
                    };
                    match read {
                        Err(error) if self.draft.system(fields.place()).is_ok() => {
                            each(Found::BadState(error))
                        }
                        done => done,
                    }
                }
                None => Ok(()),
            },
        }
    }

    fn state(&mut self, fields: &Fields) -> Result<(), RecordError> {
        let origin = self.origin;
        let system = self.draft.system(fields.place())?;
        let epoch = system.epoch(fields.must("EPOCH", "", origin)?, origin)?;
        let number = |key| {
            let entry = fields.must(key, "", origin)?;
            scaled_number(&entry.value, 3).ok_or_else(|| entry.wrong(origin, "a number"))
        };
        let position = DVec3::new(number("X")?, number("Y")?, number("Z")?);
        let velocity = DVec3::new(number("X_DOT")?, number("Y_DOT")?, number("Z_DOT")?);
        self.draft.state(fields.place(), epoch, position, velocity)
    }

    fn covariance(&mut self, fields: &Fields) -> Result<(), RecordError> {
        let origin = self.origin;
        let system = self.draft.system(fields.place())?;
        let epoch = system.epoch(fields.must("EPOCH", "", origin)?, origin)?;
        let number = |key| {
            let entry = fields.must(key, "", origin)?;
            entry.number(origin, -1e300..=1e300, "a number")
        };
        let variances = [number("CX_X")?, number("CY_Y")?, number("CZ_Z")?];
        self.draft.covariance(fields.place(), epoch, variances)
    }
}
