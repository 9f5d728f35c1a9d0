//! Elevation data in a pack: tiles at several levels with a range for each, deep ones only where there are finer data.
//!
//! # The format
//!
//! ```text
//! earth/
//!     heights/index.bin                            which tiles there are, with their ranges
//!     heights/<round>/r<row>/c<column>.heights     the tiles
//!     heights/86528/r37/c120.heights               for example
//! ```
//!
//! Level 0 is the finest. A level has c columns and c/2 rows of tiles, half as many as the next finer one; the coarsest has 16, 32 or 64 columns
//! and all its tiles. A tile has s × s samples of its own; s is even, 16 to 1024. Let a level have W = c s samples around the Earth (`<round>` of
//! the path; at most 2^30). Its sample (i, j), counted eastwards and southwards over the whole level, represents the cell around longitude −180° +
//! (i + ½)·360°/W and latitude 90° − (j + ½)·360°/W. A sample of a coarser level is the mean of the four finer ones in its cell, where they exist.
//! A tile exists only if the next coarser one over it does.
//!
//! A tile has a border of `border` samples (1 to 16) of its neighbours at the same level: across the date line, and beyond a pole those of the
//! opposite meridian. Next to an absent tile they are its values if it existed.
//!
//! ## A tile
//!
//! One Zstandard frame of (s + 2 border)² samples, row by row from the north-west, as residues r = v − p, where p is west + north − north-west,
//! in the first row west, in the first column north, and 0 for the first sample; all modulo 2^16 or 2^32. Samples `i16` are steps, metres = offset_m +
//! scale_m v. Samples `f32` are metres, v being their bits with the order of whole numbers: all bits of negative ones inverted, of others the
//! highest. Residues are folded, 2r for r ≥ 0 and −2r − 1 else, and written lowest bytes of all samples first, then the next.
//!
//! ## The index
//!
//! All numbers little-endian: the eight bytes `TRLHGT01`, the number of tiles (u32), then 37 bytes a tile, sorted by level, row and column: level
//! (u8), row and column (u32), bytes of its file (u32), the first 16 bytes of its BLAKE3, and the lowest and the highest height of the tile, border
//! included, and of everything beneath it, metres (f32). At most 2 097 152 tiles.
//!
//! ## The manifest
//!
//! ```toml
//! [heights]
//! sources = ["gebco.tif, 21600 x 10800"]  # at most 64
//! levels = 7
//! columns = 16                # of the coarsest
//! side = 338                  # s
//! border = 1
//! samples = "i16"             # or "f32", then without the next two
//! offset_m = -1000.0
//! scale_m = 0.25              # above 0
//! tiles = 43690
//! index_bytes = 1616542
//! index_checksum = "0123…"    # as those of tiles
//! ```

mod index;
#[cfg(feature = "terrain")]
mod source;
#[cfg(test)]
mod tests;
mod tile;

pub(super) use index::index_bytes;
pub use index::{HeightIndex, HeightRecord, MAX_HEIGHT_TILES, decode_index, encode_index};
#[cfg(feature = "terrain")]
pub use source::PackHeights;
pub use tile::{HeightValues, decode_heights, encode_heights};

use super::container::MAX_OVERHEAD_BYTES;
use super::file::TileFile;
use std::path::{Path, PathBuf};

/// Most samples of a tile's side, border not counted.
pub const MAX_HEIGHT_SIDE: u32 = 1024;

/// Most samples beyond each edge of a tile.
pub const MAX_HEIGHT_BORDER: u32 = 16;

/// Limit of levels of elevation data.
pub const MAX_HEIGHT_LEVELS: u8 = 23;

/// Most samples round the Earth.
const MAX_ROUND: u64 = 1 << 30;

/// Folder of elevation data in a pack.
pub const HEIGHTS_FOLDER: &str = "heights";

/// Name of the index below [`HEIGHTS_FOLDER`].
pub const HEIGHT_INDEX_FILE: &str = "index.bin";

/// Entry of elevation data in a manifest.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightsEntry {
    /// Their sources: file names and sizes.
    pub sources: Vec<String>,
    /// How many levels there are.
    pub levels: u8,
    /// Columns of tiles of the coarsest.
    pub columns: u32,
    /// Samples of a tile's side, border not counted.
    pub side: u32,
    /// Samples beyond each edge of a tile.
    pub border: u32,
    /// How samples are kept.
    pub kind: HeightKind,
    /// How many tiles there are.
    pub tiles: u32,
    /// Length and checksum of the index.
    pub index: TileFile,
}

/// Number format of elevation samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HeightKind {
    /// Metres are offset + scale × value, everywhere in the pack.
    I16 {
        /// Metres at 0.
        offset_m: f64,
        /// Metres a step, above 0.
        scale_m: f64,
    },
    /// Metres.
    F32,
}

impl HeightKind {
    /// Bytes of a sample.
    pub fn bytes(self) -> usize {
        match self {
            Self::I16 { .. } => 2,
            Self::F32 => 4,
        }
    }
}

/// Position of an elevation tile. In the order of the index.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct HeightPlace {
    /// 0 is the finest.
    pub level: u8,
    /// From the north pole southwards.
    pub row: u32,
    /// From 180° W eastwards.
    pub column: u32,
}

impl HeightPlace {
    /// The place of the next coarser level over it.
    pub fn parent(self) -> Self {
        Self {
            level: self.level.saturating_add(1),
            row: self.row / 2,
            column: self.column / 2,
        }
    }
}

impl HeightsEntry {
    /// Whether levels, columns, side and border are those that a pack may have.
    pub fn is_possible(&self) -> bool {
        let is_side = (16..=MAX_HEIGHT_SIDE).contains(&self.side) && self.side.is_multiple_of(2);
        (1..=MAX_HEIGHT_LEVELS).contains(&self.levels)
            && [16, 32, 64].contains(&self.columns)
            && is_side
            && (1..=MAX_HEIGHT_BORDER).contains(&self.border)
            && (u64::from(self.columns) << (self.levels - 1)) * u64::from(self.side) <= MAX_ROUND
    }

    /// The number of the coarsest level.
    pub fn coarsest(&self) -> u8 {
        self.levels.saturating_sub(1)
    }

    /// Columns of tiles of a level; there are half as many rows.
    pub fn columns_of(&self, level: u8) -> u32 {
        self.columns << (self.coarsest() - level.min(self.coarsest()))
    }

    /// Samples of a level round the Earth.
    pub fn round(&self, level: u8) -> u32 {
        // At most 2^30.
        self.columns_of(level) * self.side
    }

    /// Whether such a tile is possible.
    pub fn contains(&self, place: HeightPlace) -> bool {
        let columns = self.columns_of(place.level);
        place.level < self.levels && place.column < columns && place.row < columns / 2
    }

    /// Samples of a tile's row with its border.
    pub fn row_samples(&self) -> usize {
        (self.side + 2 * self.border) as usize
    }

    /// Samples of a tile with its border.
    pub fn tile_samples(&self) -> usize {
        self.row_samples() * self.row_samples()
    }

    /// Most bytes of a tile's file.
    pub fn most_file_bytes(&self) -> usize {
        self.tile_samples() * self.kind.bytes() + MAX_OVERHEAD_BYTES
    }

    /// Path of a tile below the pack's folder.
    pub fn path(&self, place: HeightPlace) -> PathBuf {
        let HeightPlace { level, row, column } = place;
        let round = self.round(level);
        Path::new(HEIGHTS_FOLDER).join(format!("{round}/r{row}/c{column}.heights"))
    }

    /// Path of the index below the pack's folder.
    pub fn index_path() -> PathBuf {
        Path::new(HEIGHTS_FOLDER).join(HEIGHT_INDEX_FILE)
    }
}
