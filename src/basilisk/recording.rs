//! Simulations that were saved (`saveFile`): read where they are needed, never held.
//!
//! A file is messages one after the other, each behind its length as a variable-length number. It may be larger than memory: when it
//! is opened one pass notes where messages begin and when they are, a message in so many where there are many, and what
//! is said once (epoch, ground locations). Basilisk can write files that are spoilt from some message on; what is before that is
//! played.

use super::message::{
    EpochDate, Location, MAX_MESSAGE_BYTES, Message, epoch, read_location, time_stamp,
};
use super::wire::{WireFault, varint};
use super::world::{Place, Roster, Snapshot, UpdateFault, World, seconds};
use crate::frames::{Epoch, rfc3339};
use crate::orbit::{Feed, Frame, OrbitError, OrbitState};
use glam::DVec3;
use std::collections::VecDeque;
use std::fmt;
use std::fs::File;
use std::io::{self, BufReader, ErrorKind, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Most places that are noted of a file.
const MAX_NOTED: usize = 65_536;
/// Most messages that are kept as they were read last.
const MAX_KEPT: usize = 32;
/// Most bytes of a field that is said once.
const MAX_ONCE_BYTES: u64 = 1 << 20;
/// Most changes of epoch or of ground locations.
const MAX_CHANGES: usize = 4096;

/// Why a file cannot be played.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The system.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// Not one message.
    #[error("{}: no message of Basilisk in it ({cause}); it is what saveFile writes that is played", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
        /// What is wrong with its beginning.
        cause: String,
    },
    /// A message that was there when the file was opened.
    #[error("{}: the message at byte {offset} cannot be played: {cause}", path.display())]
    Message {
        /// The file.
        path: PathBuf,
        /// Where the message begins.
        offset: u64,
        /// What is wrong with it.
        cause: String,
    },
}

/// A message that has been found: where, and when it is.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Noted {
    /// Byte of its length.
    offset: u64,
    elapsed_s: f64,
}

/// Something that is said once and holds from then on.
#[derive(Clone, Debug)]
enum Change {
    Epoch(EpochDate),
    Place(Location),
}

/// A saved simulation.
pub struct Recording {
    path: PathBuf,
    noted: Vec<Noted>,
    last: Noted,
    messages: u64,
    changes: Vec<(f64, Change)>,
    start: Epoch,
    craft: Option<String>,
    name: String,
    notes: Vec<String>,
    roster: Roster,
    reader: Mutex<Reader>,
}

/// What can be read at any place.
trait ReadSeek: Read + Seek + Send {}

impl<T: Read + Seek + Send> ReadSeek for T {}

type Source = BufReader<Box<dyn ReadSeek>>;

struct Reader {
    file: Source,
    /// Instants that were read last, by the offset of their message, with the offset behind it.
    kept: VecDeque<(u64, u64, Arc<Snapshot>)>,
}

/// What stands at the beginning of a message.
struct Head {
    elapsed_s: f64,
    changes: Vec<Change>,
    /// Offset of what is behind it.
    end: u64,
}

fn spoilt(fault: WireFault) -> io::Error {
    io::Error::new(ErrorKind::InvalidData, fault)
}

/// A variable-length number of a stream; `None` at its end.
fn stream_varint(read: &mut impl Read) -> io::Result<Option<(u64, u64)>> {
    let mut bytes = [0; 10];
    for len in 0..bytes.len() {
        match read.read_exact(&mut bytes[len..=len]) {
            Ok(()) => {}
            Err(error) if error.kind() == ErrorKind::UnexpectedEof && len == 0 => return Ok(None),
            Err(error) => return Err(error),
        }
        if bytes[len] & 0x80 == 0 {
            let value = varint(&mut &bytes[..=len]).map_err(spoilt)?;
            return Ok(Some((value, len as u64 + 1)));
        }
    }
    Err(spoilt(WireFault::LongNumber))
}

/// The head of the message at `offset`, without the bytes that nobody needs yet; `None` at the end of the file.
fn head(file: &mut Source, offset: u64, file_len: u64) -> io::Result<Option<Head>> {
    let Some((len, len_len)) = stream_varint(file)? else {
        return Ok(None);
    };
    let begin = offset + len_len;
    let end = begin.checked_add(len).filter(|end| *end <= file_len);
    let Some(end) = end.filter(|_| len <= MAX_MESSAGE_BYTES as u64) else {
        return Err(io::Error::other(
            "it is longer than the file, or than a message may be",
        ));
    };
    let mut elapsed_s = None;
    let mut changes = Vec::new();
    let mut at = begin;
    while at < end {
        let (tag, tag_len) = stream_varint(file)?.ok_or(spoilt(WireFault::Short))?;
        let (field_len, len_len) = stream_varint(file)?.ok_or(spoilt(WireFault::Short))?;
        // All fields of this message are messages.
        let (number, kind) = (tag >> 3, (tag & 7) as u8);
        at = at
            .saturating_add(tag_len + len_len)
            .saturating_add(field_len);
        if kind != 2 || number == 0 || at > end {
            return Err(spoilt(WireFault::Field { number, kind }));
        }
        if !matches!(number, 1 | 8 | 9) {
            // Within a message, of which the longest fits.
            file.seek_relative(field_len.cast_signed())?;
            continue;
        }
        if field_len > MAX_ONCE_BYTES {
            return Err(io::Error::other("one of its fields is too long"));
        }
        let mut bytes = vec![0; field_len as usize];
        file.read_exact(&mut bytes)?;
        match number {
            1 => {
                let (_, elapsed_ns) = time_stamp(&bytes).map_err(spoilt)?;
                elapsed_s = Some(elapsed_ns * 1e-9);
            }
            8 => changes.push(Change::Epoch(epoch(&bytes).map_err(spoilt)?)),
            _ => changes.push(Change::Place(read_location(&bytes).map_err(spoilt)?)),
        }
    }
    let elapsed_s = elapsed_s.filter(|elapsed_s| elapsed_s.is_finite() && *elapsed_s >= 0.0);
    match elapsed_s {
        None => Err(io::Error::other("it has no time")),
        Some(elapsed_s) => Ok(Some(Head {
            elapsed_s,
            changes,
            end,
        })),
    }
}

impl fmt::Debug for Recording {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (path, messages) = (&self.path, &self.messages);
        f.debug_struct("Recording")
            .field("path", path)
            .field("messages", messages)
            .finish_non_exhaustive()
    }
}

impl Recording {
    /// Opens a file and goes through it once. `start` is when simulated time is 0 where the file does not say so, `craft` the
    /// spacecraft that cameras fly with; the first where none is named.
    ///
    /// # Errors
    /// A file that cannot be read or does not begin with a message that can be drawn.
    pub fn open(path: &Path, start: Epoch, craft: Option<&str>) -> Result<Self, RecordingError> {
        let unreadable = |source| RecordingError::Read {
            path: path.to_owned(),
            source,
        };
        let file = File::open(path).map_err(unreadable)?;
        Self::read(file, path, start, craft)
    }

    /// The same of anything that can be read at any place; `path` is what messages name.
    ///
    /// # Errors
    /// Those of [`Self::open`].
    pub fn read(
        source: impl Read + Seek + Send + 'static,
        path: &Path,
        start: Epoch,
        craft: Option<&str>,
    ) -> Result<Self, RecordingError> {
        let unreadable = |source| RecordingError::Read {
            path: path.to_owned(),
            source,
        };
        let mut file = Source::with_capacity(1 << 16, Box::new(source));
        let file_len = file.seek(SeekFrom::End(0)).map_err(unreadable)?;
        file.rewind().map_err(unreadable)?;
        let mut noted: Vec<Noted> = Vec::new();
        let mut changes: Vec<(f64, Change)> = Vec::new();
        let mut notes = Vec::new();
        let (mut messages, mut stride) = (0_u64, 1_u64);
        let (mut offset, mut last) = (0, None::<Noted>);
        let mut cause = "it is empty".to_owned();
        loop {
            let head = match head(&mut file, offset, file_len) {
                Ok(Some(head)) => head,
                Ok(None) => break,
                Err(error) => {
                    cause = error.to_string();
                    notes.push(format!(
                        "{}: spoilt from byte {offset} on ({cause}); the {messages} messages before it are played",
                        path.display()
                    ));
                    break;
                }
            };
            if last.is_some_and(|last| head.elapsed_s < last.elapsed_s) {
                notes.push(format!(
                    "{}: time steps back at byte {offset}; the {messages} messages before that are played",
                    path.display()
                ));
                break;
            }
            let here = Noted {
                offset,
                elapsed_s: head.elapsed_s,
            };
            if messages.is_multiple_of(stride) {
                noted.push(here);
            }
            if noted.len() > MAX_NOTED {
                // Every other one is enough from here on.
                let mut index = 0_u64;
                noted.retain(|_| {
                    index += 1;
                    index % 2 == 1
                });
                stride *= 2;
            }
            for change in head.changes {
                if changes.len() < MAX_CHANGES {
                    changes.push((head.elapsed_s, change));
                }
            }
            messages += 1;
            offset = head.end;
            last = Some(here);
        }
        let Some(last) = last else {
            let path = path.to_owned();
            return Err(RecordingError::Empty { path, cause });
        };
        let mut recording = Self {
            path: path.to_owned(),
            noted,
            last,
            messages,
            changes,
            start,
            craft: craft.map(str::to_owned),
            name: String::new(),
            notes,
            roster: Roster::default(),
            reader: Mutex::new(Reader {
                file,
                kept: VecDeque::new(),
            }),
        };
        let first = recording.noted.first().map_or(0, |noted| noted.offset);
        let (first, world) = recording.first(first)?;
        recording.start = world.start();
        recording.notes.extend(world.notes().iter().cloned());
        recording.roster = Roster {
            craft: first
                .craft
                .iter()
                .map(|one| Arc::clone(&one.name))
                .collect(),
            places: recording.all_places(),
        };
        let craft = first.craft(recording.craft.as_deref());
        let name = craft
            .map(|craft| craft.name.to_string())
            .or(recording.craft.clone());
        recording.name = name.unwrap_or_else(|| "Basilisk".to_owned());
        Ok(recording)
    }

    /// The first instant, and the world that it makes: what there is to tell.
    fn first(&self, offset: u64) -> Result<(Snapshot, World), RecordingError> {
        let mut world = World::new(self.start);
        let mut reader = self.reader.lock().unwrap_or_else(PoisonError::into_inner);
        let (message, _) = self.read_message(&mut reader, offset)?;
        let snapshot = world.take(message);
        let snapshot = snapshot.map_err(|fault| self.fault(offset, &fault.to_string()))?;
        Ok((snapshot, world))
    }

    /// All places that are ever said.
    fn all_places(&self) -> Arc<[Place]> {
        let mut world = World::new(self.start);
        let places = self.changes.iter().filter_map(|(_, change)| match change {
            Change::Place(place) => Some(place.clone()),
            Change::Epoch(_) => None,
        });
        world.take_locations(places.collect());
        world.places()
    }

    /// The spacecraft of its first message, and all places on the ground.
    pub fn roster(&self) -> &Roster {
        &self.roster
    }

    fn fault(&self, offset: u64, cause: &str) -> RecordingError {
        RecordingError::Message {
            path: self.path.clone(),
            offset,
            cause: cause.to_owned(),
        }
    }

    /// What a user should know about it, a sentence each.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// How many messages are played.
    pub fn messages(&self) -> u64 {
        self.messages
    }

    /// The name of the craft that cameras fly with, where one is asked for.
    pub fn craft(&self) -> Option<&str> {
        self.craft.as_deref()
    }

    fn read_message(
        &self,
        reader: &mut Reader,
        offset: u64,
    ) -> Result<(Message, u64), RecordingError> {
        let file = &mut reader.file;
        let bytes = file.stream_position().and_then(|position| {
            // Within what is buffered nothing is read anew.
            let ahead = offset.cast_signed().checked_sub(position.cast_signed());
            match ahead {
                Some(ahead) => file.seek_relative(ahead)?,
                None => drop(file.seek(SeekFrom::Start(offset))?),
            }
            let (len, len_len) = stream_varint(file)?.ok_or(spoilt(WireFault::Short))?;
            let is_short = usize::try_from(len).is_ok_and(|len| len <= MAX_MESSAGE_BYTES);
            if !is_short {
                return Err(io::Error::other("it is longer than a message may be"));
            }
            let mut bytes = Vec::new();
            file.take(len).read_to_end(&mut bytes)?;
            match bytes.len() as u64 == len {
                true => Ok((bytes, offset + len_len + len)),
                false => Err(ErrorKind::UnexpectedEof.into()),
            }
        });
        let (bytes, end) = bytes.map_err(|error| self.fault(offset, &error.to_string()))?;
        let message =
            Message::read(&bytes).map_err(|fault| self.fault(offset, &fault.to_string()))?;
        Ok((message, end))
    }

    /// The instant of the message at `offset`, and the offset behind it.
    fn snapshot(
        &self,
        reader: &mut Reader,
        offset: u64,
    ) -> Result<(Arc<Snapshot>, u64), RecordingError> {
        let mut kept = reader.kept.iter();
        if let Some((_, end, snapshot)) = kept.find(|(its, ..)| *its == offset) {
            return Ok((Arc::clone(snapshot), *end));
        }
        let (mut message, end) = self.read_message(reader, offset)?;
        let elapsed_s = message.elapsed_ns * 1e-9;
        // What was said before and holds; what it says itself comes once more and is the same.
        let mut world = World::new(self.start);
        let before = self.changes.iter().take_while(|(s, _)| *s <= elapsed_s);
        let mut places = Vec::new();
        for (_, change) in before {
            match change {
                Change::Epoch(date) => world.take_epoch(date),
                Change::Place(place) => places.push(place.clone()),
            }
        }
        message.locations.splice(0..0, places);
        let snapshot = world.take(message);
        let snapshot =
            snapshot.map_err(|fault: UpdateFault| self.fault(offset, &fault.to_string()))?;
        let snapshot = Arc::new(snapshot);
        if reader.kept.len() == MAX_KEPT {
            reader.kept.pop_front();
        }
        reader.kept.push_back((offset, end, Arc::clone(&snapshot)));
        Ok((snapshot, end))
    }

    /// The simulation at an epoch within [`Feed::validity`], between two messages interpolated; `None` outside.
    ///
    /// # Errors
    /// A file that cannot be read any more, or a message in it that is spoilt.
    pub fn snapshot_at(&self, epoch: Epoch) -> Result<Option<Arc<Snapshot>>, RecordingError> {
        let elapsed_s = (epoch - self.start).to_seconds();
        let first_s = self.noted.first().map_or(0.0, |noted| noted.elapsed_s);
        // Epochs are rounded to nanoseconds.
        let room_s = 1e-6;
        if elapsed_s < first_s - room_s || elapsed_s > self.last.elapsed_s + room_s {
            return Ok(None);
        }
        let elapsed_s = elapsed_s.clamp(first_s, self.last.elapsed_s);
        let behind = self
            .noted
            .partition_point(|noted| noted.elapsed_s <= elapsed_s);
        let noted = self.noted.get(behind.saturating_sub(1));
        let mut offset = noted.map_or(0, |noted| noted.offset);
        let mut reader = self.reader.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            let (before, end) = self.snapshot(&mut reader, offset)?;
            if offset >= self.last.offset || before.elapsed_s >= elapsed_s {
                return Ok(Some(before));
            }
            let (after, _) = self.snapshot(&mut reader, end)?;
            if after.elapsed_s > elapsed_s {
                let span_s = after.elapsed_s - before.elapsed_s;
                let part = (elapsed_s - before.elapsed_s) / span_s;
                return Ok(Some(match part <= 0.0 {
                    true => before,
                    false => Arc::new(before.toward(&after, part)),
                }));
            }
            offset = end;
        }
    }

    /// Its first and its last instant.
    pub fn validity(&self) -> (Epoch, Epoch) {
        let first_s = self.noted.first().map_or(0.0, |noted| noted.elapsed_s);
        (self.at(first_s), self.at(self.last.elapsed_s))
    }

    /// The simulation at an epoch, as a feed answers.
    fn known_at(&self, name: &str, epoch: Epoch) -> Result<Arc<Snapshot>, OrbitError> {
        let known = match self.snapshot_at(epoch) {
            Ok(Some(snapshot)) => return Ok(snapshot),
            Ok(None) => {
                let (first, last) = self.validity();
                format!("from {} to {}", rfc3339(first), rfc3339(last))
            }
            Err(error) => format!("as far as it can be read: {error}"),
        };
        Err(OrbitError::NotCovered {
            satellite: name.to_owned(),
            epoch: rfc3339(epoch),
            known,
        })
    }

    fn at(&self, elapsed_s: f64) -> Epoch {
        self.start + seconds(elapsed_s)
    }
}

/// A craft of a saved simulation, in GCRF about the Earth's centre.
pub struct RecordedCraft {
    recording: Arc<Recording>,
    craft: Option<String>,
}

impl RecordedCraft {
    /// A craft by name; the first where none is given.
    pub fn new(recording: Arc<Recording>, craft: Option<&str>) -> Self {
        Self {
            recording,
            craft: craft.map(str::to_owned),
        }
    }
}

impl Feed for RecordedCraft {
    fn name(&self) -> &str {
        self.craft.as_deref().unwrap_or(&self.recording.name)
    }

    fn validity(&self) -> (Epoch, Epoch) {
        self.recording.validity()
    }

    fn state_at(&self, epoch: Epoch) -> Result<OrbitState, OrbitError> {
        let snapshot = self.recording.known_at(self.name(), epoch)?;
        match snapshot.craft(self.craft.as_deref()) {
            Some(craft) => Ok(OrbitState {
                epoch,
                frame: Frame::Gcrf,
                position_m: craft.position_m,
                velocity_m_s: craft.velocity_m_s,
            }),
            None => Err(OrbitError::NotCovered {
                satellite: self.name().to_owned(),
                epoch: rfc3339(epoch),
                known: "where the simulation has it".to_owned(),
            }),
        }
    }
}

/// A place on the ground of a saved simulation, where the Earth stands at each instant.
pub struct RecordedPlace {
    recording: Arc<Recording>,
    name: Arc<str>,
    position_itrf_m: DVec3,
}

impl RecordedPlace {
    /// One that stands at `position_itrf_m`, metres.
    pub fn new(recording: Arc<Recording>, name: Arc<str>, position_itrf_m: DVec3) -> Self {
        Self {
            recording,
            name,
            position_itrf_m,
        }
    }
}

impl Feed for RecordedPlace {
    fn name(&self) -> &str {
        &self.name
    }

    fn validity(&self) -> (Epoch, Epoch) {
        self.recording.validity()
    }

    fn state_at(&self, epoch: Epoch) -> Result<OrbitState, OrbitError> {
        let snapshot = self.recording.known_at(&self.name, epoch)?;
        Ok(OrbitState {
            epoch,
            frame: Frame::Gcrf,
            position_m: snapshot.itrf_from_gcrf.transpose() * self.position_itrf_m,
            velocity_m_s: DVec3::ZERO,
        })
    }
}

#[cfg(test)]
#[path = "recording_tests.rs"]
mod tests;
