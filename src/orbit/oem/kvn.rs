//! OEM in KVN: blocks of metadata, rows of states, blocks of covariances.

use super::super::entry::{
    Entry, Fields, RecordError, RecordFault, TextPosition, number, scaled_number, shortened,
};
use super::super::text::kvn::{KvnLine, lines};
use super::super::text::offset;
use super::draft::{Draft, metadata};
use super::{Each, VERSION};
use crate::frames::Epoch;
use glam::DVec3;
use std::borrow::Cow;
use std::path::Path;

/// Calls `each` for every message.
pub fn read(text: &str, origin: &Path, each: &mut Each<'_>) -> Result<(), RecordError> {
    let mut message: Option<Message<'_>> = None;
    for line in lines(text) {
        if let KvnLine::Entry(entry) = &line
            && entry.key == VERSION
        {
            if let Some(message) = message.take() {
                each(message.finish())?;
            }
            match entry.value.split('.').next() {
                Some("1" | "2" | "3") => message = Some(Message::new(origin, entry.place)),
                _ => each(Err(entry.unsupported(origin, "versions 1 to 3 are read")))?,
            }
            continue;
        }
        // Behind a fault the rest of its message is passed over.
        if let Some(Err(error)) = message.as_mut().map(|m| m.line(line)) {
            message = None;
            each(Err(error))?;
        }
    }
    match message {
        Some(message) => each(message.finish()),
        None => Ok(()),
    }
}

struct Message<'o> {
    origin: &'o Path,
    draft: Draft<'o>,
    block: Block,
}

/// Between which marks the reader is.
enum Block {
    /// Header or rows of states.
    None,
    Metadata(Fields),
    /// Of a matrix: its epoch, how many rows have been read, the diagonal.
    Covariance(Option<Epoch>, usize, [f64; 3]),
}

impl<'o> Message<'o> {
    fn new(origin: &'o Path, place: TextPosition) -> Self {
        Self {
            origin,
            draft: Draft::new(origin, place),
            block: Block::None,
        }
    }

    fn line(&mut self, line: KvnLine<'_>) -> Result<(), RecordError> {
        match line {
            KvnLine::Entry(entry) => self.entry(entry),
            KvnLine::Other { text, place } => self.words(text, place),
        }
    }

    fn entry(&mut self, entry: Entry<'_>) -> Result<(), RecordError> {
        match &mut self.block {
            Block::Metadata(meta) => meta.add(entry, self.origin),
            Block::Covariance(epoch, rows, _) => {
                if entry.key == "EPOCH" {
                    if *rows != 0 {
                        let expected = "six rows of a matrix before the next one";
                        return Err(self.unexpected(&entry.key, entry.place, expected));
                    }
                    let scale = self.draft.scale(entry.place)?;
                    *epoch = Some(entry.epoch(self.origin, scale)?);
                }
                // COV_REF_FRAME: the sum of the variances is the same in all axes.
                Ok(())
            }
            // The header.
            Block::None => Ok(()),
        }
    }

    fn words(&mut self, text: &str, place: TextPosition) -> Result<(), RecordError> {
        match (text, &mut self.block) {
            ("META_START", Block::None) => {
                self.block = Block::Metadata(metadata(place));
                Ok(())
            }
            ("META_STOP", Block::Metadata(meta)) => {
                let result = self.draft.begin(meta);
                self.block = Block::None;
                result
            }
            ("COVARIANCE_START", Block::None) => {
                self.draft.scale(place)?;
                self.block = Block::Covariance(None, 0, [0.0; 3]);
                Ok(())
            }
            ("COVARIANCE_STOP", Block::Covariance(_, 0, _)) => {
                self.block = Block::None;
                Ok(())
            }
            (_, Block::None) => self.state(text, place),
            (_, Block::Covariance(..)) => self.covariance_row(text, place),
            (_, Block::Metadata(_)) => {
                Err(self.unexpected(text, place, "KEY = value, or META_STOP"))
            }
        }
    }

    /// Epoch, three kilometres, three kilometres per second, and perhaps three accelerations, which are not used.
    fn state(&mut self, text: &str, place: TextPosition) -> Result<(), RecordError> {
        let words: Vec<_> = text.split_whitespace().take(11).collect();
        let Some((date, values)) = words
            .split_first()
            .filter(|(_, values)| matches!(values.len(), 6 | 9))
        else {
            let expected =
                "an epoch and six numbers (km, km/s) or nine, or META_START, COVARIANCE_START";
            return Err(self.unexpected(text, place, expected));
        };
        let at = |word: &str| TextPosition {
            line: place.line,
            column: place.column + offset(text, word),
        };
        let mut numbers = [0.0; 9];
        const NAMES: [&str; 9] = [
            "X", "Y", "Z", "X_DOT", "Y_DOT", "Z_DOT", "X_DDOT", "Y_DDOT", "Z_DDOT",
        ];
        for ((slot, word), name) in numbers.iter_mut().zip(values).zip(NAMES) {
            *slot = scaled_number(word, 3).ok_or_else(|| {
                let fault = RecordFault::Field {
                    key: name.to_owned(),
                    text: shortened(word),
                    expected: "a number",
                };
                at(word).error(self.origin, fault)
            })?;
        }
        let date = Entry {
            key: Cow::Borrowed("the epoch"),
            value: Cow::Borrowed(date),
            unit: None,
            place,
        };
        let scale = self.draft.scale(place)?;
        let epoch = date.epoch(self.origin, scale)?;
        let [x, y, z, vx, vy, vz, ..] = numbers;
        self.draft
            .state(place, epoch, DVec3::new(x, y, z), DVec3::new(vx, vy, vz))
    }

    /// Row n of a lower triangle has n numbers.
    fn covariance_row(&mut self, text: &str, place: TextPosition) -> Result<(), RecordError> {
        let Block::Covariance(epoch, rows, variances) = &mut self.block else {
            return Ok(());
        };
        let words: Vec<_> = text.split_whitespace().take(7).collect();
        let numbers: Option<Vec<f64>> = words.iter().map(|word| number(word)).collect();
        let row = numbers.filter(|numbers| numbers.len() == *rows + 1);
        let (Some(row), Some(at)) = (row, *epoch) else {
            let expected = "EPOCH = …, then the six rows of a lower triangle, one to six numbers (km², km²/s, km²/s²)";
            return Err(self.unexpected(text, place, expected));
        };
        if let (Some(slot), Some(diagonal)) = (variances.get_mut(*rows), row.last()) {
            *slot = *diagonal;
        }
        *rows += 1;
        if *rows == 6 {
            let variances = *variances;
            (*epoch, *rows) = (None, 0);
            self.draft.covariance(place, at, variances)?;
        }
        Ok(())
    }

    fn unexpected(&self, text: &str, place: TextPosition, expected: &'static str) -> RecordError {
        let text = shortened(text);
        place.error(self.origin, RecordFault::Unexpected { text, expected })
    }

    fn finish(self) -> Result<crate::orbit::EphemerisFeed, RecordError> {
        let missing = |place: TextPosition, key| {
            let fault = RecordFault::Missing {
                what: "the message",
                key,
                remedy: "; it has been cut off",
            };
            Err(place.error(self.origin, fault))
        };
        match &self.block {
            Block::Metadata(meta) => missing(meta.place(), "META_STOP"),
            Block::Covariance(..) => {
                let place = self.draft.place();
                missing(place, "COVARIANCE_STOP")
            }
            Block::None => self.draft.finish(),
        }
    }
}
