//! OEM in KVN: blocks of metadata, rows of states, blocks of covariances.

use super::super::cut::{CutOff, LastLine};
use super::super::entry::{
    Entry, Fields, RecordError, RecordFault, TextPosition, number, scaled_number,
};
use super::super::found::{Each, Found};
use super::super::text::kvn::{KvnLine, lines};
use super::super::text::offset;
use super::VERSION;
use super::draft::{Draft, metadata};
use glam::DVec3;
use std::borrow::Cow;
use std::path::Path;
use terrella_files::excerpt;
use terrella_frames::Epoch;

/// Calls `each` for every message.
pub fn read(text: &str, origin: &Path, each: &mut Each<'_>) -> Result<(), RecordError> {
    let mut message: Option<Message<'_>> = None;
    for line in lines(text) {
        if let KvnLine::Entry(entry) = &line
            && entry.key == VERSION
        {
            if let Some(message) = message.take() {
                message.hand_on(each)?;
            }
            match entry.value.split('.').next() {
                Some("1" | "2" | "3") => message = Some(Message::new(text, origin, entry.place)),
                _ => {
                    let error = entry.unsupported(origin, "versions 1 to 3 are read");
                    each(Found::corrupt(error))?;
                }
            }
            continue;
        }
        // Behind a fault that corrupts its message the rest of that is skipped.
        if let Some(Err(error)) = message.as_mut().map(|m| m.line(line, each)) {
            let names = message.take().map(|message| message.draft.names());
            each(Found::Corrupt(names.unwrap_or_default(), error))?;
        }
    }
    match message {
        Some(message) => message.hand_on(each),
        None => Ok(()),
    }
}

/// Keywords that are alone on their line.
const MARKS: [&str; 4] = [
    "META_START",
    "META_STOP",
    "COVARIANCE_START",
    "COVARIANCE_STOP",
];

struct Message<'o> {
    origin: &'o Path,
    draft: Draft<'o>,
    block: Block,
    last_line: LastLine,
}

/// Between which marks the reader is.
enum Block {
    /// Header or rows of states.
    None,
    Metadata(Fields),
    /// Of a matrix: its epoch, how many rows have been read, the diagonal.
    Covariance(Option<Epoch>, usize, [f64; 3]),
    /// Behind the fault of a matrix, to the next one's epoch.
    BadCovariance,
}

impl<'o> Message<'o> {
    fn new(text: &str, origin: &'o Path, place: TextPosition) -> Self {
        Self {
            last_line: LastLine::of(text),
            origin,
            draft: Draft::new(origin, place),
            block: Block::None,
        }
    }

    /// Ends the message and hands its object on.
    fn hand_on(self, each: &mut Each<'_>) -> Result<(), RecordError> {
        let names = self.draft.names();
        let object = self.finish(each);
        each(Found::of(names, object))
    }

    fn line(&mut self, line: KvnLine<'_>, each: &mut Each<'_>) -> Result<(), RecordError> {
        match line {
            KvnLine::Entry(entry) => match self.entry(entry) {
                Err(error) if matches!(self.block, Block::Covariance(..)) => {
                    self.block = Block::BadCovariance;
                    each(Found::BadState(error))
                }
                done => done,
            },
            KvnLine::Other { text, place } => self.words(text, place, each),
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
                    let system = self.draft.system(entry.place)?;
                    *epoch = Some(system.epoch(&entry, self.origin)?);
                }
                // COV_REF_FRAME: the sum of the variances is the same in all axes.
                Ok(())
            }
            Block::BadCovariance if entry.key == "EPOCH" => {
                self.block = Block::Covariance(None, 0, [0.0; 3]);
                self.entry(entry)
            }
            Block::BadCovariance => Ok(()),
            // The header.
            Block::None => Ok(()),
        }
    }

    fn words(
        &mut self,
        text: &str,
        place: TextPosition,
        each: &mut Each<'_>,
    ) -> Result<(), RecordError> {
        match (text, &mut self.block) {
            ("META_START", Block::None) => {
                self.block = Block::Metadata(metadata(place));
                Ok(())
            }
            ("META_STOP", Block::Metadata(meta)) => {
                let result = self.draft.begin(meta, each);
                self.block = Block::None;
                result
            }
            ("COVARIANCE_START", Block::None) => {
                self.draft.system(place)?;
                self.block = Block::Covariance(None, 0, [0.0; 3]);
                Ok(())
            }
            ("COVARIANCE_STOP", Block::Covariance(_, 0, _) | Block::BadCovariance) => {
                self.block = Block::None;
                Ok(())
            }
            (_, Block::None) => match self.whole_state(text, place, each) {
                // A misplaced keyword, or a state without metadata: the following records cannot be interpreted.
                Err(error) if MARKS.contains(&text) || self.draft.system(place).is_err() => {
                    Err(error)
                }
                Err(error) => each(Found::BadState(error)),
                Ok(()) => Ok(()),
            },
            ("COVARIANCE_STOP", Block::Covariance(..)) => {
                self.block = Block::None;
                let expected = "six rows of a matrix before its end";
                each(Found::BadState(self.unexpected(text, place, expected)))
            }
            (_, Block::Covariance(..)) => match self.covariance_row(text, place) {
                Err(error) => {
                    self.block = Block::BadCovariance;
                    each(Found::BadState(error))
                }
                Ok(()) => Ok(()),
            },
            (_, Block::BadCovariance) => Ok(()),
            (_, Block::Metadata(_)) => {
                Err(self.unexpected(text, place, "KEY = value, or META_STOP"))
            }
        }
    }

    /// A state, unless the file ends within its line.
    fn whole_state(
        &mut self,
        text: &str,
        place: TextPosition,
        each: &mut Each<'_>,
    ) -> Result<(), RecordError> {
        let width = text.split_whitespace().count();
        let last = text.split_whitespace().next_back().unwrap_or_default();
        let cut = match MARKS.contains(&text) {
            true => None,
            false => self.last_line.cut(place.line, width, last),
        };
        if let Some(cut) = cut {
            let is_left_out = cut == CutOff::Line;
            each(Found::BadState(
                place.error(self.origin, RecordFault::CutOff(cut)),
            ))?;
            if is_left_out {
                return Ok(());
            }
        }
        self.state(text, place)
    }

    /// Epoch, three kilometres, three kilometres per second, and perhaps three accelerations, which are not used.
    fn state(&mut self, text: &str, place: TextPosition) -> Result<(), RecordError> {
        let words: Vec<_> = text.split_whitespace().take(12).collect();
        // A blank may part the day from the time.
        let of_date = match words.get(1) {
            Some(second) if second.contains(':') => 2,
            _ => 1,
        };
        let Some((date, values)) = words
            .split_at_checked(of_date)
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
                    text: excerpt(word),
                    expected: "a number",
                };
                at(word).error(self.origin, fault)
            })?;
        }
        let date = Entry {
            key: Cow::Borrowed("the epoch"),
            value: Cow::Owned(date.join(" ")),
            unit: None,
            place,
        };
        let system = self.draft.system(place)?;
        let epoch = system.epoch(&date, self.origin)?;
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
        let text = excerpt(text);
        place.error(self.origin, RecordFault::Unexpected { text, expected })
    }

    fn finish(self, each: &mut Each<'_>) -> Result<crate::EphemerisFeed, RecordError> {
        let missing = |place: TextPosition, key| {
            let fault = RecordFault::Missing {
                what: "the message",
                key,
                remedy: "; the file is truncated",
            };
            Err(place.error(self.origin, fault))
        };
        match &self.block {
            Block::Metadata(meta) => missing(meta.place(), "META_STOP"),
            Block::Covariance(..) | Block::BadCovariance => {
                let place = self.draft.place();
                missing(place, "COVARIANCE_STOP")
            }
            Block::None => self.draft.finish(each),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{Ephemerides, Feed};
    use std::path::Path;

    /// Three states of a minute's distance; `date` writes minute n of 2026-03-01 UTC.
    fn message(date: impl Fn(u32) -> String) -> String {
        let states = (0..3).map(|n| format!("{} 7000 {n} 0 0 7.5 0\n", date(n)));
        format!(
            "CCSDS_OEM_VERS = 2.0\nCREATION_DATE = 2026-01-01T00:00:00\nORIGINATOR = X\nMETA_START\nOBJECT_NAME = A\nOBJECT_ID = 2099-001A\n\
             CENTER_NAME = EARTH\nREF_FRAME = EME2000\nTIME_SYSTEM = UTC\nSTART_TIME = {}\nSTOP_TIME = {}\nMETA_STOP\n{}",
            date(0),
            date(2),
            states.collect::<String>()
        )
    }

    #[test]
    fn dates_have_a_blank_or_a_zone() {
        let validity = |text: &str| {
            let read = Ephemerides::from_text(text, Path::new("a.oem"), true);
            let mut feeds = read.map_err(|error| error.to_string())?.feeds;
            Ok::<_, String>(feeds.remove(0).validity())
        };
        let plain = validity(&message(|n| format!("2026-03-01T12:0{n}:00")));
        assert!(plain.is_ok(), "{plain:?}");
        assert_eq!(
            validity(&message(|n| format!("2026-03-01 12:0{n}:00"))),
            plain
        );
        assert_eq!(
            validity(&message(|n| format!("2026-03-01T14:0{n}:00+02:00"))),
            plain
        );
        assert_eq!(
            validity(&message(|n| format!("2026-060T07:3{n}:00-04:30"))),
            plain
        );
        // Only UTC has zones.
        let tai = message(|n| format!("2026-03-01T14:0{n}:00+02:00")).replace("= UTC", "= TAI");
        let error = validity(&tai).expect_err("rejected");
        assert!(
            error.contains("START_TIME") && error.contains("is not a date"),
            "{error}"
        );
    }
}
