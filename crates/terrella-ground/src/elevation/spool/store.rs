//! Rows of heights in a scratch file.

use super::SpoolError;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::PathBuf;
use terrella_files::{self as files, Unfinished};

/// Marks a hole among integer metres; not a height of the Earth.
const HOLE: i16 = i16::MIN;

/// Storage format of heights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kept {
    /// Integer metres, 2 bytes.
    Whole,
    /// Metres, 4 bytes.
    Float,
}

impl Kept {
    fn bytes(self) -> usize {
        match self {
            Self::Whole => 2,
            Self::Float => 4,
        }
    }
}

/// A scratch file of rows of heights, metres; holes are NaN. Dropping this value removes the file.
#[derive(Debug)]
pub(super) struct Store {
    path: PathBuf,
    columns: usize,
    rows: usize,
    kept: Kept,
    _unfinished: Unfinished,
}

impl Store {
    /// Recreates the file at its final size.
    pub(super) fn create(
        path: PathBuf,
        (columns, rows): (usize, usize),
        kept: Kept,
    ) -> Result<Self, SpoolError> {
        let bytes = Self::bytes_of((columns, rows), kept);
        let error = |source| SpoolError::Scratch {
            path: path.clone(),
            source,
        };
        let (file, unfinished) =
            Unfinished::create(&path, |path| File::create(path)).map_err(error)?;
        let store = Self {
            path,
            columns,
            rows,
            kept,
            _unfinished: unfinished,
        };
        file.set_len(bytes).map_err(|source| store.error(source))?;
        Ok(store)
    }

    /// Bytes of a file for this size and format.
    pub(super) fn bytes_of((columns, rows): (usize, usize), kept: Kept) -> u64 {
        columns as u64 * rows as u64 * kept.bytes() as u64
    }

    /// Opens the file; each thread opens its own handle.
    pub(super) fn open(&self) -> Result<OpenStore<'_>, SpoolError> {
        let opened = files::open_with(File::options().read(true).write(true), &self.path);
        Ok(OpenStore {
            store: self,
            file: opened.map_err(|source| self.error(source))?,
            bytes: Vec::new(),
        })
    }

    fn error(&self, source: io::Error) -> SpoolError {
        SpoolError::Scratch {
            path: self.path.clone(),
            source,
        }
    }
}

impl Drop for Store {
    fn drop(&mut self) {
        // The creator of the folder removes what remains in it.
        let _ = std::fs::remove_file(&self.path);
    }
}

pub(super) struct OpenStore<'a> {
    store: &'a Store,
    file: File,
    bytes: Vec<u8>,
}

impl OpenStore<'_> {
    /// Seeks to a row and column. Returns the bytes of `count` heights.
    fn seek(&mut self, row: usize, column: usize, count: usize) -> io::Result<()> {
        let Store {
            columns,
            rows,
            kept,
            ..
        } = *self.store;
        debug_assert!(row < rows && column + count <= columns);
        let at = (row as u64 * columns as u64 + column as u64) * kept.bytes() as u64;
        self.bytes.resize(count * kept.bytes(), 0);
        self.file.seek(SeekFrom::Start(at)).map(drop)
    }

    /// Reads heights of a row from a column on.
    pub fn read(
        &mut self,
        row: usize,
        column: usize,
        heights_m: &mut [f32],
    ) -> Result<(), SpoolError> {
        self.seek(row, column, heights_m.len())
            .and_then(|()| self.file.read_exact(&mut self.bytes))
            .map_err(|source| self.store.error(source))?;
        match self.store.kept {
            Kept::Whole => {
                let (pairs, _) = self.bytes.as_chunks::<2>();
                for (height_m, pair) in heights_m.iter_mut().zip(pairs) {
                    *height_m = match i16::from_le_bytes(*pair) {
                        HOLE => f32::NAN,
                        whole => f32::from(whole),
                    };
                }
            }
            Kept::Float => {
                let (fours, _) = self.bytes.as_chunks::<4>();
                for (height_m, four) in heights_m.iter_mut().zip(fours) {
                    *height_m = f32::from_le_bytes(*four);
                }
            }
        }
        Ok(())
    }

    /// Reads some columns of a row, wrapping from its end to its beginning.
    pub(super) fn read_round(
        &mut self,
        row: usize,
        column: usize,
        heights_m: &mut [f32],
    ) -> Result<(), SpoolError> {
        let before_end = (self.store.columns - column).min(heights_m.len());
        let (before, behind) = heights_m.split_at_mut(before_end);
        self.read(row, column, before)?;
        if behind.is_empty() {
            return Ok(());
        }
        self.read(row, 0, behind)
    }

    /// Writes heights of a row from a column on. In integer storage they must be integers.
    pub(super) fn write(
        &mut self,
        row: usize,
        column: usize,
        heights_m: &[f32],
    ) -> Result<(), SpoolError> {
        self.seek(row, column, heights_m.len())
            .map_err(|source| self.store.error(source))?;
        match self.store.kept {
            Kept::Whole => {
                let (pairs, _) = self.bytes.as_chunks_mut::<2>();
                for (pair, height_m) in pairs.iter_mut().zip(heights_m) {
                    let whole = if height_m.is_nan() {
                        HOLE
                    } else {
                        *height_m as i16
                    };
                    *pair = whole.to_le_bytes();
                }
            }
            Kept::Float => {
                let (fours, _) = self.bytes.as_chunks_mut::<4>();
                for (four, height_m) in fours.iter_mut().zip(heights_m) {
                    *four = height_m.to_le_bytes();
                }
            }
        }
        self.file
            .write_all(&self.bytes)
            .map_err(|source| self.store.error(source))
    }
}
