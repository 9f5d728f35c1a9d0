//! Index of a saved simulation: offsets and times of messages, and data that is sent once. Nothing else of the file is kept in memory.

use super::error::RecordingError;
use crate::basilisk::message::{
    EpochDate, Location, MAX_MESSAGE_BYTES, epoch, read_location, time_stamp,
};
use crate::basilisk::wire::{WireFault, varint};
use std::io::{self, BufReader, ErrorKind, Read, Seek, SeekFrom};
use std::path::Path;

/// Most places that are noted of a file.
pub const MAX_NOTED: usize = 65_536;
/// Most bytes of a field that is said once.
const MAX_ONCE_BYTES: u64 = 1 << 20;
/// Most changes of epoch or of ground locations.
const MAX_CHANGES: usize = 4096;

/// A message that has been found: where, and when it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noted {
    /// Byte of its length.
    pub offset: u64,
    pub elapsed_s: f64,
}

/// Something that is said once and holds from then on.
#[derive(Clone, Debug)]
pub enum Change {
    Epoch(EpochDate),
    Place(Location),
}

/// The index of a file.
#[derive(Debug)]
pub struct Index {
    /// Messages by time, one in so many where there are many; at least one.
    pub noted: Vec<Noted>,
    /// The last one that is played.
    pub last: Noted,
    /// How many are played.
    pub messages: u64,
    /// Data that is sent once, and the simulated second from which it applies.
    pub changes: Vec<(f64, Change)>,
    /// Notes for the user about the file.
    pub notes: Vec<String>,
}

/// A seekable reader.
pub trait ReadSeek: Read + Seek + Send {}

impl<T: Read + Seek + Send> ReadSeek for T {}

/// A file, buffered.
pub type RecordingFile = BufReader<Box<dyn ReadSeek>>;

/// The head of a message.
struct Head {
    elapsed_s: f64,
    changes: Vec<Change>,
    /// Offset of the next message.
    end: u64,
}

fn corrupt(fault: WireFault) -> io::Error {
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
            let value = varint(&mut &bytes[..=len]).map_err(corrupt)?;
            return Ok(Some((value, len as u64 + 1)));
        }
    }
    Err(corrupt(WireFault::LongNumber))
}

/// The head of the message at `offset`, without reading the rest; `None` at the end of the file.
fn head(file: &mut RecordingFile, offset: u64, file_len: u64) -> io::Result<Option<Head>> {
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
        let (tag, tag_len) = stream_varint(file)?.ok_or(corrupt(WireFault::Short))?;
        let (field_len, len_len) = stream_varint(file)?.ok_or(corrupt(WireFault::Short))?;
        // All fields of this message are messages.
        let (number, kind) = (tag >> 3, (tag & 7) as u8);
        at = at
            .saturating_add(tag_len + len_len)
            .saturating_add(field_len);
        if kind != 2 || number == 0 || at > end {
            return Err(corrupt(WireFault::Field { number, kind }));
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
                let (_, elapsed_ns) = time_stamp(&bytes).map_err(corrupt)?;
                elapsed_s = Some(elapsed_ns * 1e-9);
            }
            8 => changes.push(Change::Epoch(epoch(&bytes).map_err(corrupt)?)),
            _ => changes.push(Change::Place(read_location(&bytes).map_err(corrupt)?)),
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

impl Index {
    /// Goes through a file once, up to where it is corrupt; `path` is what messages name.
    ///
    /// # Errors
    /// A file that cannot be read or does not begin with a message.
    pub fn of(file: &mut RecordingFile, path: &Path) -> Result<Self, RecordingError> {
        let unreadable = |source| RecordingError::Read {
            path: path.to_owned(),
            source,
        };
        let file_len = file.seek(SeekFrom::End(0)).map_err(unreadable)?;
        file.rewind().map_err(unreadable)?;
        let mut noted: Vec<Noted> = Vec::new();
        let mut changes: Vec<(f64, Change)> = Vec::new();
        let mut notes = Vec::new();
        let (mut messages, mut stride) = (0_u64, 1_u64);
        let (mut offset, mut last) = (0, None::<Noted>);
        let mut cause = "it is empty".to_owned();
        loop {
            let head = match head(file, offset, file_len) {
                Ok(Some(head)) => head,
                Ok(None) => break,
                Err(error) => {
                    cause = error.to_string();
                    notes.push(format!(
                        "{}: corrupt from byte {offset} on ({cause}); the {messages} messages before it are played",
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
        Ok(Self {
            noted,
            last,
            messages,
            changes,
            notes,
        })
    }

    /// Simulated seconds at the first message.
    pub fn first_s(&self) -> f64 {
        self.noted.first().map_or(0.0, |noted| noted.elapsed_s)
    }

    /// Offset to start the search for a time: a message at or before it.
    pub fn before(&self, elapsed_s: f64) -> u64 {
        let behind = self
            .noted
            .partition_point(|noted| noted.elapsed_s <= elapsed_s);
        let noted = self.noted.get(behind.saturating_sub(1));
        noted.map_or(0, |noted| noted.offset)
    }
}

/// The bytes of the message at `offset`, and the offset behind it.
///
/// # Errors
/// A file that cannot be read there, a message longer than one may be.
pub fn message_bytes(file: &mut RecordingFile, offset: u64) -> io::Result<(Vec<u8>, u64)> {
    let position = file.stream_position()?;
    // Within what is buffered nothing is read again.
    let ahead = offset.cast_signed().checked_sub(position.cast_signed());
    match ahead {
        Some(ahead) => file.seek_relative(ahead)?,
        None => drop(file.seek(SeekFrom::Start(offset))?),
    }
    let (len, len_len) = stream_varint(file)?.ok_or(corrupt(WireFault::Short))?;
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
}
