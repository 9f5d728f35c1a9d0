//! Files that hold the tiles of a map: MBTiles and PMTiles.
//!
//! | file | what |
//! |---|---|
//! | `pmtiles.rs` | PMTiles version 3 |
//! | `mbtiles.rs` | the table of tiles in an MBTiles file |
//! | `sqlite.rs` | rows of SQLite's tables |
//!
//! Both hold square tiles of Web Mercator, from one tile at level 0 to 2^z × 2^z. One level is read: the finest that fits into a raster,
//! and of it what is there.

mod mbtiles;
mod pmtiles;
mod sqlite;
#[cfg(test)]
mod tests;

use super::place::Crs;
use crate::error::BuildError;
use crate::source::{FileContext, MAX_PIECE_SIDE};
use mbtiles::MbTiles;
use pmtiles::PmTiles;
use std::io::{Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::Path;
use terrella_files as files;

/// Largest file of a tile, bytes.
pub const MAX_TILE_FILE_BYTES: u64 = 64 << 20;

/// Deepest level: 2^24 tiles of 256 texels are 2 m apart.
const MAX_LEVEL: u8 = 24;

/// Least side of a tile that levels are chosen by, texels.
const LEAST_SIDE: u32 = 256;

/// Properties of a level of a tile archive.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Level {
    pub level: u8,
    /// Columns from the west, and rows from the north.
    pub columns: Range<u32>,
    pub rows: Range<u32>,
}

impl Level {
    /// The columns and rows of the whole Earth.
    fn whole(level: u8) -> Self {
        let side = 1 << level;
        Self {
            level,
            columns: 0..side,
            rows: 0..side,
        }
    }

    /// Whether its tiles form a supported raster.
    fn fits(&self) -> bool {
        let most = u64::from(MAX_PIECE_SIDE / LEAST_SIDE);
        self.columns.len() as u64 <= most && self.rows.len() as u64 <= most
    }
}

/// Whether a path has the extension of a tile archive.
pub(crate) fn is_archive(path: &Path) -> bool {
    path.extension().is_some_and(|ending| {
        ["mbtiles", "pmtiles"]
            .iter()
            .any(|known| ending.eq_ignore_ascii_case(known))
    })
}

/// A file that holds tiles, opened.
pub(super) enum Archive {
    Mb(MbTiles),
    Pm(Box<PmTiles>),
}

impl Archive {
    /// Opens a file; its format is detected from the content, not the name.
    ///
    /// # Errors
    /// [`BuildError`] for files of another format, and for archives without image tiles.
    pub(super) fn open(path: &Path) -> Result<Self, BuildError> {
        let context = FileContext::new(path);
        let mut file = ArchiveFile::open(path, context.clone())?;
        let magic = file.bytes(0, 16.min(file.length))?;
        if magic.starts_with(b"PMTiles") {
            return Ok(Self::Pm(Box::new(PmTiles::open(file)?)));
        }
        if magic.starts_with(b"SQLite format 3\0") {
            let mut log = path.as_os_str().to_owned();
            log.push("-wal");
            if std::fs::metadata(&log).is_ok_and(|log| log.len() > 0) {
                return Err(context.rejected(
                    "has a log beside it with what is not written into it yet",
                    "close the program that writes it, or write it out (`sqlite3 FILE 'PRAGMA wal_checkpoint(TRUNCATE)'`)",
                ));
            }
            return Ok(Self::Mb(MbTiles::open(file)?));
        }
        Err(context.rejected(
            "is neither MBTiles nor PMTiles of version 3",
            "convert it (`pmtiles convert IN OUT.pmtiles`)",
        ))
    }

    /// The level that is read.
    pub(super) fn level(&self) -> &Level {
        match self {
            Self::Mb(file) => file.level(),
            Self::Pm(file) => file.level(),
        }
    }

    /// The file of a tile, by its row from the north and its column; `None` if it is missing.
    ///
    /// # Errors
    /// [`BuildError`] for files that cannot be read or are corrupt.
    pub(super) fn tile(&mut self, row: u32, column: u32) -> Result<Option<Vec<u8>>, BuildError> {
        match self {
            Self::Mb(file) => file.tile(row, column),
            Self::Pm(file) => file.tile(row, column),
        }
    }
}

/// Name of a tile in messages.
pub(super) fn tile_name(path: &Path, level: u8, row: u32, column: u32) -> std::path::PathBuf {
    path.join(format!("{level}/{column}/{row}"))
}

/// A file of which parts are read.
struct ArchiveFile {
    file: std::fs::File,
    length: u64,
    context: FileContext,
}

impl ArchiveFile {
    fn open(path: &Path, context: FileContext) -> Result<Self, BuildError> {
        let file = files::open(path).map_err(|error| context.unreadable(error))?;
        let length = file.metadata().map_err(|error| context.unreadable(error))?;
        Ok(Self {
            file,
            length: length.len(),
            context,
        })
    }

    /// So many bytes from an offset, which must be there.
    fn bytes(&mut self, offset: u64, count: u64) -> Result<Vec<u8>, BuildError> {
        let end = offset.checked_add(count).filter(|end| *end <= self.length);
        if end.is_none() {
            return Err(self.context.damaged("the file ends too early"));
        }
        // No more than the file has.
        let mut bytes = vec![0; count as usize];
        self.file
            .seek(SeekFrom::Start(offset))
            .and_then(|_| self.file.read_exact(&mut bytes))
            .map_err(|error| self.context.unreadable(error))?;
        Ok(bytes)
    }
}
