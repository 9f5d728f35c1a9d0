//! Chunks of values: read and decoded one at a time.

use super::filters::Filters;
use super::source::Fault;
use std::io::{Read, Seek, SeekFrom};

/// Location of a chunk.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Its address, later its byte in the file.
    pub at: u64,
    /// Stored size.
    pub bytes: u64,
    /// Filters that were not applied to it, as bits.
    pub skipped: u32,
}

impl Entry {
    /// A chunk that was never written.
    pub const ABSENT: Self = Self {
        at: 0,
        bytes: 0,
        skipped: 0,
    };
}

/// All chunks of a variable, in row order.
pub struct Chunks {
    /// Rows and columns of a chunk.
    pub chunk: (usize, usize),
    /// Chunks per row.
    pub across: usize,
    /// Bytes of a chunk's values.
    pub bytes: usize,
    pub entries: Vec<Entry>,
    pub filters: Filters,
    /// Value of samples that were never written.
    pub fill: Vec<u8>,
}

impl Chunks {
    pub fn count(&self) -> usize {
        self.entries.len()
    }

    /// First row and column of a chunk.
    pub fn first(&self, number: usize) -> (usize, usize) {
        let (down, across) = (number / self.across, number % self.across);
        (down * self.chunk.0, across * self.chunk.1)
    }

    /// Bytes of the chunk list, and of one chunk as stored, decompressed and reordered.
    pub fn working_bytes(&self) -> u64 {
        let largest = self.entries.iter().map(|entry| entry.bytes).max();
        let list = size_of_val(self.entries.as_slice()) as u64;
        list + largest.unwrap_or(0) + 2 * self.bytes as u64
    }

    /// The values of a chunk.
    pub fn chunk<R: Read + Seek>(&self, reader: &mut R, number: usize) -> Result<Vec<u8>, Fault> {
        let entry = &self.entries[number];
        if entry.bytes == 0 {
            return Ok(self.fill.repeat(self.bytes / self.fill.len()));
        }
        // At most twice the size of a chunk, which is limited.
        let mut stored = vec![0; entry.bytes as usize];
        reader.seek(SeekFrom::Start(entry.at))?;
        reader.read_exact(&mut stored)?;
        let damaged = |what| Fault::Damaged { what, at: entry.at };
        let values = self.filters.undo(stored, entry.skipped, self.bytes);
        let values = values.map_err(|wrong| damaged(wrong.0))?;
        match values.len() == self.bytes {
            true => Ok(values),
            false => Err(damaged("a chunk of another number of values")),
        }
    }
}
