//! A line-based progress file, locked against other processes.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;
use terrella_files as files;

/// The journal of a build of every possible tile is shorter: 5 maps × 128 blocks × 346 tiles of all levels × 2 storages × 100 bytes, and as much
/// for each of 2 097 152 elevation tiles. That of a fetch of a million tiles has 90 MB.
const MAX_BYTES: u64 = 256 << 20;

/// An open journal.
pub(super) struct LockedJournal {
    file: File,
    text: String,
    bytes: u64,
}

impl LockedJournal {
    /// Opens or makes it and reads what it holds.
    pub(super) fn open(path: &Path) -> Result<Self, TryLockError> {
        let mut options = OpenOptions::new();
        options.read(true).append(true).create(true);
        let mut file = files::open_with(&options, path).map_err(TryLockError::Error)?;
        match file.try_lock() {
            // A file system without locks: one does without.
            Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => {}
            locked => locked?,
        }
        let (text, bytes) = read_text(&mut file).map_err(TryLockError::Error)?;
        Ok(Self { file, text, bytes })
    }

    /// Its content when it was opened, as far as it is text.
    pub(super) fn text(&self) -> &str {
        &self.text
    }

    /// Whether its content was only a part of this beginning: nothing was ever recorded.
    pub(super) fn is_empty(&self, beginning: &str) -> bool {
        self.text.len() as u64 == self.bytes && beginning.starts_with(&self.text)
    }

    /// Empties it and writes its first lines.
    pub(super) fn begin(&mut self, beginning: &str) -> io::Result<()> {
        self.text.clear();
        self.bytes = 0;
        self.file.set_len(0)?;
        self.append(beginning)?;
        self.file.sync_all()
    }

    /// Truncates its content to the first `good` bytes, so that new lines start correctly, and frees its text.
    pub(super) fn cut(&mut self, good: usize) {
        self.text = String::new();
        if (good as u64) < self.bytes {
            // If this fails, the next line is appended to the truncated one and will be invalid: its work is done again.
            let _ = self.file.set_len(good as u64);
            let _ = self.file.seek(SeekFrom::End(0));
        }
    }

    /// Writes whole lines.
    pub(super) fn append(&mut self, lines: &str) -> io::Result<()> {
        self.file.write_all(lines.as_bytes())
    }

    /// Waits until what was written is on the disk.
    pub(super) fn sync(&self) -> io::Result<()> {
        self.file.sync_data()
    }
}

/// Content of a journal, as far as it is text, and its length in bytes: a power failure may leave arbitrary bytes after its last line.
pub(super) fn read_text(file: &mut File) -> io::Result<(String, u64)> {
    let mut bytes = Vec::new();
    file.take(MAX_BYTES).read_to_end(&mut bytes)?;
    let length = bytes.len() as u64;
    let text = String::from_utf8(bytes).unwrap_or_else(|error| {
        let good = error.utf8_error().valid_up_to();
        let mut bytes = error.into_bytes();
        bytes.truncate(good);
        String::from_utf8(bytes).unwrap_or_default()
    });
    Ok((text, length))
}
