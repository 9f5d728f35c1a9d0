//! The messages of a file.

use super::ParameterMessage;
use super::record::each_record;
use crate::choose::{Candidate, Key, choose};
use crate::cut::{CutOff, open_line};
use crate::entry::{Faults, MAX_ENTRIES, RecordError, RecordFault, TextPosition};
use crate::file::read_text;
use crate::recognise::message_of_another_kind;
use crate::rejected::Rejected;
use crate::text::{unmarked, with_line_feeds};
use crate::{FileFormat, OrbitError};
use std::path::Path;

/// The orbit parameter messages of a file, in its order.
#[derive(Debug)]
pub struct ParameterMessages {
    /// Messages that can be used.
    pub messages: Vec<ParameterMessage>,
    /// Errors of rejected messages, and unsupported content of the others: the first thousand.
    pub faults: Vec<OrbitError>,
    /// How many faults there are beyond those.
    pub faults_left_out: usize,
    rejected: Vec<Rejected>,
    /// Why the first message that cannot be used cannot be.
    faulty: Option<RecordError>,
}

impl ParameterMessages {
    /// Largest file read, bytes.
    pub const MAX_FILE_BYTES: u64 = 16 << 20;

    /// Reads a file of orbit parameter messages (CCSDS 502.0, KVN or XML): a state or Keplerian elements, the spacecraft, and manoeuvres, in the
    /// frames and time systems of [`Ephemerides`](crate::Ephemerides). If a message has a state and elements, the state is used. A notice reports a
    /// difference between them, and an unsupported covariance.
    ///
    /// Faulty messages are listed and the others used; `is_strict` rejects the file instead.
    ///
    /// # Errors
    /// If no message is valid, or, when strict, if any is invalid: names line and column, the error, and the remedy.
    pub fn from_file(path: &Path, is_strict: bool) -> Result<Self, OrbitError> {
        Self::from_text(&read_text(path, Self::MAX_FILE_BYTES)?, path, is_strict)
    }

    /// As [`Self::from_file`], from text that is already in memory; `origin` names it in errors.
    ///
    /// # Errors
    /// As [`Self::from_file`], except errors of the file itself.
    pub fn from_text(text: &str, origin: &Path, is_strict: bool) -> Result<Self, OrbitError> {
        let text = with_line_feeds(unmarked(text));
        let text = text.as_ref();
        if FileFormat::of_text(text) != Some(FileFormat::Opm) {
            let path = origin.to_owned();
            return Err(match message_of_another_kind(text) {
                Some(other) => other.error(origin),
                None => OrbitError::NoParameters { path },
            });
        }
        let mut faults = Faults::<RecordError>::new(is_strict);
        let (mut messages, mut rejected, mut faulty) = (Vec::new(), Vec::new(), None);
        if let Some(cut) = cut_off(text, origin) {
            faults.note(cut)?;
        }
        each_record(text, origin, &mut |read| {
            if messages.len() + rejected.len() >= MAX_ENTRIES {
                let (what, limit) = ("messages", MAX_ENTRIES);
                let place = TextPosition { line: 1, column: 1 };
                return Err(place.error(origin, RecordFault::TooMany { what, limit }));
            }
            let read = read.and_then(|record| {
                let mut remark = |error: RecordError| {
                    faults.keep(error);
                    Ok(())
                };
                ParameterMessage::of(&record.fields, &record.maneuvers, origin, &mut remark)
                    .map_err(|error| (record.names(), error))
            });
            match read {
                Ok(message) => messages.push(message),
                Err((names, error)) => {
                    rejected.push(Rejected::new(names, &error));
                    faulty.get_or_insert_with(|| error.clone());
                    faults.note(error)?;
                }
            }
            Ok(())
        })?;
        match (messages.is_empty(), &faulty) {
            (true, Some(faulty)) => Err(faulty.clone().into()),
            (true, None) => Err(OrbitError::NoParameters {
                path: origin.to_owned(),
            }),
            (false, _) => Ok(Self {
                messages,
                faults: faults.kept.into_iter().map(OrbitError::from).collect(),
                faults_left_out: faults.left_out,
                rejected,
                faulty,
            }),
        }
    }

    /// The message of the satellite of that name, letter case aside, or international designator; `None` takes the only one there
    /// is.
    ///
    /// # Errors
    /// None or several match: it lists them, or states why the matching one cannot be used. Without a name also if
    /// a message is faulty, as that leaves open which is the only one.
    pub fn one(&self, origin: &Path, name: Option<&str>) -> Result<&ParameterMessage, OrbitError> {
        if let (None, Some(error)) = (name, &self.faulty) {
            return Err(error.clone().into());
        }
        let candidates: Vec<_> = self
            .messages
            .iter()
            .map(|message| Candidate {
                label: message.name.as_str().into(),
                key: message.object_id.as_deref().map(Into::into),
                line: message.line(),
            })
            .collect();
        match choose(&candidates, Key::Designator, origin, name) {
            Ok(chosen) => self.messages.get(chosen).ok_or_else(|| {
                let path = origin.to_owned();
                OrbitError::NoParameters { path }
            }),
            Err(error) => Err(Rejected::explain(&self.rejected, error)),
        }
    }
}

/// Evidence that a message in KVN was truncated: XML is either closed or invalid.
fn cut_off(text: &str, origin: &Path) -> Option<RecordError> {
    let is_of_lines = !text.trim_start().starts_with('<');
    let line = open_line(text).filter(|_| is_of_lines)?;
    let fault = RecordFault::CutOff(CutOff::Unended);
    Some(TextPosition { line, column: 1 }.error(origin, fault))
}
