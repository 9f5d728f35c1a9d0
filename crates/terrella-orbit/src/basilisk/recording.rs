//! Saved simulations (`saveFile`): read on demand, not kept in memory.
//!
//! A file is a sequence of messages, each preceded by its length as a variable-length integer. It may be larger than memory. When it is opened, one
//! pass records the offsets and times of messages (of every n-th message if there are many), and data that is sent only once (epoch, ground
//! locations). Basilisk can write files that are corrupt from some message on; the messages before that are played.

mod error;
mod index;

use super::message::Message;
use super::world::{Place, Roster, Snapshot, UpdateFault, World, seconds};
use crate::{Feed, Frame, OrbitError, OrbitState};
pub use error::RecordingError;
use glam::DVec3;
use index::{Change, Index, RecordingFile, message_bytes};
use std::collections::VecDeque;
use std::fmt;
use std::io::{Read, Seek};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use terrella_files::{self as files, printable};
use terrella_frames::{Epoch, rfc3339};

/// Most messages that are kept as they were read last.
const MAX_KEPT: usize = 32;
/// A saved simulation.
pub struct Recording {
    path: PathBuf,
    index: Index,
    start: Epoch,
    craft: Option<String>,
    name: String,
    notes: Vec<String>,
    roster: Roster,
    reader: Mutex<Reader>,
}

struct Reader {
    file: RecordingFile,
    /// Instants that were read last, by the offset of their message, with the offset behind it.
    kept: VecDeque<(u64, u64, Arc<Snapshot>)>,
}

impl fmt::Debug for Recording {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (path, messages) = (&self.path, &self.index.messages);
        f.debug_struct("Recording")
            .field("path", path)
            .field("messages", messages)
            .finish_non_exhaustive()
    }
}

impl Recording {
    /// Opens a file and indexes it in one pass. `start` is the epoch of simulated time 0 if the file does not contain it. `craft` is the spacecraft
    /// that carries the cameras; `None` for the first one.
    ///
    /// # Errors
    /// A file that cannot be read or does not start with a message that can be drawn.
    pub fn open(path: &Path, start: Epoch, craft: Option<&str>) -> Result<Self, RecordingError> {
        let unreadable = |source| RecordingError::Read {
            path: path.to_owned(),
            source,
        };
        let file = files::open(path).map_err(unreadable)?;
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
        let mut file = RecordingFile::with_capacity(1 << 16, Box::new(source));
        let mut index = Index::of(&mut file, path)?;
        let notes = std::mem::take(&mut index.notes);
        let mut recording = Self {
            path: path.to_owned(),
            index,
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
        let first = recording
            .index
            .noted
            .first()
            .map_or(0, |noted| noted.offset);
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

    /// The first snapshot, and the world after it, with its notes.
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
        let places = self
            .index
            .changes
            .iter()
            .filter_map(|(_, change)| match change {
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
            cause: printable(cause),
        }
    }

    /// Notes for the user, one sentence each.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// How many messages are played.
    pub fn messages(&self) -> u64 {
        self.index.messages
    }

    /// The requested name of the spacecraft that cameras follow.
    pub fn craft(&self) -> Option<&str> {
        self.craft.as_deref()
    }

    fn read_message(
        &self,
        reader: &mut Reader,
        offset: u64,
    ) -> Result<(Message, u64), RecordingError> {
        let bytes = message_bytes(&mut reader.file, offset);
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
        // Starts with data sent before this message; data in the message itself is repeated with the same values.
        let mut world = World::new(self.start);
        let before = self
            .index
            .changes
            .iter()
            .take_while(|(s, _)| *s <= elapsed_s);
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
    /// A file that cannot be read any more, or a message in it that is corrupt.
    pub fn snapshot_at(&self, epoch: Epoch) -> Result<Option<Arc<Snapshot>>, RecordingError> {
        let elapsed_s = (epoch - self.start).to_seconds();
        let first_s = self.index.first_s();
        // Epochs are rounded to nanoseconds.
        let room_s = 1e-6;
        if elapsed_s < first_s - room_s || elapsed_s > self.index.last.elapsed_s + room_s {
            return Ok(None);
        }
        let elapsed_s = elapsed_s.clamp(first_s, self.index.last.elapsed_s);
        let mut offset = self.index.before(elapsed_s);
        let mut reader = self.reader.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            let (before, end) = self.snapshot(&mut reader, offset)?;
            if offset >= self.index.last.offset || before.elapsed_s >= elapsed_s {
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
        let first_s = self.index.first_s();
        (self.at(first_s), self.at(self.index.last.elapsed_s))
    }

    /// The snapshot at an epoch, or the error of a feed.
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
    /// A spacecraft by name; `None` for the first one.
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

/// A place on the ground of a saved simulation, with the Earth's rotation at each time.
pub struct RecordedPlace {
    recording: Arc<Recording>,
    name: Arc<str>,
    position_itrf_m: DVec3,
}

impl RecordedPlace {
    /// One at `position_itrf_m`, metres.
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
mod tests;
