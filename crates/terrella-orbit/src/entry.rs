//! Entries of CCSDS messages, CZML documents and tables (a key, its value, its position), and errors with file, line and column.

use super::cut::CutOff;
use super::interpolated::{Doubt, InterpolationError, SegmentError};
use super::iso8601;
use super::kepler::KeplerError;
use super::numerical::NumericalError;
use std::borrow::Cow;
use std::path::{Path, PathBuf};
use terrella_files::excerpt;
use terrella_frames::{Epoch, TimeError, TimeScale, epoch_from_ccsds};

/// Most entries read from a file.
pub(super) const MAX_ENTRIES: usize = 1_000_000;

/// An error in a record of a file: its position, the fault, and the remedy.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}:{line}:{column}: {fault}", path.display())]
pub struct RecordError {
    /// The file.
    pub path: PathBuf,
    /// Line, from 1.
    pub line: usize,
    /// Column, in bytes, from 1.
    pub column: usize,
    /// The fault, and the remedy.
    pub fault: Box<RecordFault>,
}

impl RecordError {
    /// Whether the file conforms to its format, so that strict reading would not change the result.
    pub(super) fn is_of_good_form(&self) -> bool {
        matches!(
            &*self.fault,
            RecordFault::Doubt(_) | RecordFault::NotFollowed { .. }
        )
    }

    /// Whether it only states that nothing is left, or one state, which an earlier fault explains.
    pub(super) fn is_of_emptiness(&self) -> bool {
        matches!(
            &*self.fault,
            RecordFault::Samples(InterpolationError::Empty)
                | RecordFault::Segments(SegmentError::Empty | SegmentError::Instant { .. })
        )
    }

    /// Whether all content of the file is used in spite of it.
    pub fn is_notice(&self) -> bool {
        match &*self.fault {
            RecordFault::CutOff(cut) => !cut.leaves_out(),
            _ => self.is_of_good_form(),
        }
    }
}

/// Faults of a record.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum RecordFault {
    /// The text has not the form of its format.
    #[error("not {format}: {cause}")]
    Syntax {
        /// XML, JSON, …
        format: &'static str,
        /// The parser's reason.
        cause: String,
    },
    /// Something else belongs here.
    #[error("{text:?} is not allowed here; expected {expected}")]
    Unexpected {
        /// The text found.
        text: String,
        /// The accepted values.
        expected: &'static str,
    },
    /// A value is not what it should be.
    #[error("{key} is {text:?}; expected {expected}")]
    Field {
        /// The field's name.
        key: String,
        /// The text found.
        text: String,
        /// The expected text.
        expected: &'static str,
    },
    /// A date is invalid.
    #[error("{key}: {cause}")]
    Time {
        /// The field's name.
        key: String,
        cause: TimeError,
    },
    /// A value is right and cannot be used.
    #[error("{key} = {text:?} cannot be used: {remedy}")]
    Unsupported {
        /// The field's name.
        key: String,
        /// The text found.
        text: String,
        /// The reason and the remedy.
        remedy: &'static str,
    },
    /// A unit other than the one that the format prescribes.
    #[error("{key} is in {unit:?}; the format requires {expected}")]
    Unit {
        /// The field's name.
        key: String,
        /// The unit in the file.
        unit: String,
        /// The unit that the format prescribes.
        expected: &'static str,
    },
    /// Something that must be there is not.
    #[error("{what} without {key}{remedy}")]
    Missing {
        /// The container that lacks it.
        what: &'static str,
        key: &'static str,
        /// The remedy after a semicolon, or nothing.
        remedy: &'static str,
    },
    /// The header of a table lacks columns.
    #[error("the header has no {}{remedy}", Columns(columns))]
    MissingColumns {
        /// Their names.
        columns: Vec<&'static str>,
        /// What to do, after a semicolon.
        remedy: &'static str,
    },
    /// Something comes twice that may come once.
    #[error("duplicate {key}; the first is in line {first}")]
    Repeated {
        /// The field's name.
        key: String,
        /// Line of the first, from 1.
        first: usize,
    },
    /// The states are no ephemeris.
    #[error(transparent)]
    Samples(InterpolationError),
    /// The segments are no ephemeris.
    #[error(transparent)]
    Segments(SegmentError),
    /// The file ends before its text does, or may do.
    #[error(transparent)]
    CutOff(CutOff),
    /// States that can be used and are not likely to be meant.
    #[error(transparent)]
    Doubt(Doubt),
    /// A value whose meaning is not supported.
    #[error("{key} = {text} is not followed: {why}")]
    NotFollowed {
        /// The field's name.
        key: &'static str,
        /// The text found.
        text: String,
        /// The consequence.
        why: &'static str,
    },
    /// Keplerian elements that no orbit has.
    #[error("the elements: {0}")]
    Elements(KeplerError),
    /// A state from which no motion can be integrated.
    #[error(transparent)]
    Motion(NumericalError),
    /// More than anyone needs.
    #[error("more than {limit} {what}; cut out what you need")]
    TooMany { what: &'static str, limit: usize },
}

/// `column a`, or `columns a, b`.
struct Columns<'c>(&'c [&'static str]);

impl std::fmt::Display for Columns<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let plural = if self.0.len() == 1 { "" } else { "s" };
        write!(f, "column{plural} {}", self.0.join(", "))
    }
}

/// A name and its value, as all formats have them.
#[derive(Clone, Debug)]
pub(super) struct Entry<'t> {
    pub key: Cow<'t, str>,
    pub value: Cow<'t, str>,
    /// Without brackets.
    pub unit: Option<Cow<'t, str>>,
    /// Position of the value's first character.
    pub place: TextPosition,
}

/// Line and column (in bytes), both from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TextPosition {
    pub line: usize,
    pub column: usize,
}

impl TextPosition {
    pub fn error(self, origin: &Path, fault: RecordFault) -> RecordError {
        RecordError {
            path: origin.to_owned(),
            line: self.line,
            column: self.column,
            fault: Box::new(fault),
        }
    }
}

impl Entry<'_> {
    /// The error that the value is not `expected`.
    pub fn wrong(&self, origin: &Path, expected: &'static str) -> RecordError {
        let fault = RecordFault::Field {
            key: excerpt(&self.key),
            text: excerpt(&self.value),
            expected,
        };
        self.place.error(origin, fault)
    }

    /// The error that the value cannot be used.
    pub fn unsupported(&self, origin: &Path, remedy: &'static str) -> RecordError {
        let fault = RecordFault::Unsupported {
            key: excerpt(&self.key),
            text: excerpt(&self.value),
            remedy,
        };
        self.place.error(origin, fault)
    }

    /// Rejects a unit other than `expected`; a missing unit is accepted.
    pub fn check_unit(&self, origin: &Path, expected: &'static str) -> Result<(), RecordError> {
        match &self.unit {
            Some(unit) if !unit.trim().eq_ignore_ascii_case(expected) => {
                let fault = RecordFault::Unit {
                    key: excerpt(&self.key),
                    unit: excerpt(unit),
                    expected,
                };
                Err(self.place.error(origin, fault))
            }
            _ => Ok(()),
        }
    }

    /// A date in CCSDS format, or with a blank in place of the `T`; in UTC also with a zone other than `Z`.
    pub fn epoch(&self, origin: &Path, scale: TimeScale) -> Result<Epoch, RecordError> {
        let text = match self.value.trim().split_once(' ') {
            Some((date, time)) => Cow::Owned(format!("{date}T{}", time.trim_start())),
            None => Cow::Borrowed(self.value.trim()),
        };
        let time = text.split_once('T').map_or("", |(_, time)| time);
        let read = match scale == TimeScale::Utc && time.contains(['+', '-']) {
            true => iso8601::epoch(&text),
            false => epoch_from_ccsds(&text, scale),
        };
        read.map_err(|cause| {
            let key = excerpt(&self.key);
            self.place.error(origin, RecordFault::Time { key, cause })
        })
    }

    /// A number within limits.
    pub fn number(
        &self,
        origin: &Path,
        range: std::ops::RangeInclusive<f64>,
        expected: &'static str,
    ) -> Result<f64, RecordError> {
        number(&self.value)
            .filter(|value| range.contains(value))
            .ok_or_else(|| self.wrong(origin, expected))
    }
}

/// Keys that are read, and their accepted units (empty: not checked).
pub(super) type Keys = [(&'static str, &'static str)];

/// The entries of one record (a message, a segment's metadata, a state) by key; entries of other keys are skipped.
pub(super) struct Fields {
    /// Its name in errors: "the message".
    what: &'static str,
    place: TextPosition,
    keys: &'static Keys,
    values: Vec<Option<Entry<'static>>>,
}

impl Fields {
    /// Empty; `place` is where the record begins.
    pub fn new(what: &'static str, place: TextPosition, keys: &'static Keys) -> Self {
        Self {
            what,
            place,
            keys,
            values: vec![None; keys.len()],
        }
    }

    /// Position of the record's first character.
    pub fn place(&self) -> TextPosition {
        self.place
    }

    /// Adds an entry if its key is looked at.
    pub fn add(&mut self, entry: Entry<'_>, origin: &Path) -> Result<(), RecordError> {
        let mut known = self.keys.iter().zip(&mut self.values);
        let Some(((_, unit), slot)) = known.find(|((key, _), _)| *key == entry.key) else {
            return Ok(());
        };
        if !unit.is_empty() {
            entry.check_unit(origin, unit)?;
        }
        if let Some(first) = slot {
            let fault = RecordFault::Repeated {
                key: entry.key.into_owned(),
                first: first.place.line,
            };
            return Err(entry.place.error(origin, fault));
        }
        *slot = Some(Entry {
            key: Cow::Owned(entry.key.into_owned()),
            value: Cow::Owned(entry.value.trim().to_owned()),
            unit: None,
            place: entry.place,
        });
        Ok(())
    }

    pub fn get(&self, key: &str) -> Option<&Entry<'static>> {
        let at = self.keys.iter().position(|(name, _)| *name == key)?;
        self.values.get(at)?.as_ref()
    }

    /// The entry with this key, or the error that it is missing; `remedy` follows a semicolon.
    pub fn must(
        &self,
        key: &'static str,
        remedy: &'static str,
        origin: &Path,
    ) -> Result<&Entry<'static>, RecordError> {
        self.get(key).ok_or_else(|| {
            let fault = RecordFault::Missing {
                what: self.what,
                key,
                remedy,
            };
            self.place.error(origin, fault)
        })
    }
}

/// A decimal number, with an exponent or without; no "nan", no "inf", no blanks within.
pub(super) fn number(text: &str) -> Option<f64> {
    let is_plain = |c: u8| matches!(c, b'0'..=b'9' | b'.' | b'+' | b'-' | b'e' | b'E');
    let text = text.trim();
    (text.len() <= 80 && text.bytes().all(is_plain))
        .then(|| text.parse::<f64>().ok())
        .flatten()
        .filter(|value| value.is_finite())
}

/// As [`number`], times a power of ten: the double nearest to that decimal number, so that kilometres become metres
/// without another rounding.
pub(super) fn scaled_number(text: &str, power: i32) -> Option<f64> {
    number(text)?;
    let text = text.trim();
    let (mantissa, exponent) = match text.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, exponent.parse::<i32>().ok()?),
        None => (text, 0),
    };
    let exponent = exponent.checked_add(power)?;
    number(&format!("{mantissa}e{exponent}"))
}

/// Faults of records that were skipped, so many that a reader can see what is wrong with a file.
#[derive(Debug, Default)]
pub(super) struct Faults<E> {
    pub is_strict: bool,
    pub kept: Vec<E>,
    pub left_out: usize,
}

impl<E> Faults<E> {
    /// How many are kept in full.
    const KEPT: usize = 1000;

    pub fn new(is_strict: bool) -> Self {
        Self {
            is_strict,
            kept: Vec::new(),
            left_out: 0,
        }
    }

    /// Keeps it and goes on, or gives it back if the file is read strictly.
    pub fn note(&mut self, error: E) -> Result<(), E> {
        if self.is_strict {
            return Err(error);
        }
        self.keep(error);
        Ok(())
    }

    /// Keeps it, however the file is read.
    pub fn keep(&mut self, error: E) {
        match self.kept.len() < Self::KEPT {
            true => self.kept.push(error),
            false => self.left_out += 1,
        }
    }
}

/// A name without control characters, 128 characters at most.
pub(super) fn printable(name: &str) -> String {
    name.chars().filter(|c| !c.is_control()).take(128).collect()
}
