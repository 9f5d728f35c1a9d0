//! PMTiles version 3 (<https://github.com/protomaps/PMTiles/blob/main/spec/v3/spec.md>): a header, directories of tiles in the order of
//! Hilbert's curve, and tiles.

use super::{ArchiveFile, Level, MAX_LEVEL, MAX_TILE_FILE_BYTES};
use crate::error::BuildError;
use flate2::read::MultiGzDecoder;
use std::io::Read;

const HEADER_BYTES: u64 = 127;

/// Largest directory, bytes as it is stored and as it is read. The root has 16 kB at most; leaves of real files have hundreds of kB.
const MAX_DIRECTORY_BYTES: u64 = 16 << 20;

/// Directories below one another: the root, and leaves.
const MAX_DEPTH: usize = 4;

/// A tile or a run of equal ones, or a leaf of the directory.
#[derive(Clone, Copy, Debug, Default)]
struct Entry {
    id: u64,
    offset: u64,
    length: u64,
    /// How many tiles from `id` on it is; 0 for a leaf.
    run: u64,
}

pub(in crate::mosaic) struct PmTiles {
    file: ArchiveFile,
    level: Level,
    root: Vec<Entry>,
    /// The last leaf directory that was read, and its offset.
    leaf: Option<(u64, Vec<Entry>)>,
    leaves_at: u64,
    tiles_at: u64,
    is_gzipped: bool,
    are_tiles_gzipped: bool,
}

impl PmTiles {
    pub(super) fn open(mut file: ArchiveFile) -> Result<Self, BuildError> {
        let context = file.context.clone();
        let header = file.bytes(0, HEADER_BYTES)?;
        let rejected = |cause: String| {
            let advice = "convert it (`pmtiles convert IN OUT.pmtiles`), or write its tiles as PNG, JPEG or WebP";
            Err(context.rejected(cause, advice))
        };
        let number = |at: usize| {
            let mut bytes = [0; 8];
            bytes.copy_from_slice(&header[at..at + 8]);
            u64::from_le_bytes(bytes)
        };
        let degrees = |at: usize| {
            let mut bytes = [0; 4];
            bytes.copy_from_slice(&header[at..at + 4]);
            f64::from(i32::from_le_bytes(bytes)) / 1e7
        };
        if header[7] != 3 {
            return rejected(format!("is PMTiles of version {}", header[7]));
        }
        let is_gzipped = |code: u8, what: &str| match code {
            0 | 1 => Ok(false),
            2 => Ok(true),
            3 => Err(format!("has {what} compressed by Brotli")),
            4 => Err(format!("has {what} compressed by ZSTD")),
            other => Err(format!("has {what} compressed by method {other}")),
        };
        let gzipped = is_gzipped(header[97], "directories");
        let tiles_gzipped = is_gzipped(header[98], "tiles");
        let (gzipped, tiles_gzipped) = match (gzipped, tiles_gzipped) {
            (Ok(gzipped), Ok(tiles)) => (gzipped, tiles),
            (Err(cause), _) | (_, Err(cause)) => return rejected(cause),
        };
        match header[99] {
            0 | 2..=4 => {}
            1 => return rejected("holds vector tiles".to_string()),
            5 => return rejected("holds tiles of AVIF".to_string()),
            other => return rejected(format!("holds tiles of type {other}")),
        }
        let (least, most) = (header[100], header[101]);
        if least > most || most > MAX_LEVEL {
            return Err(context.damaged(format!("levels {least} to {most}")));
        }
        let edges = [degrees(102), degrees(106), degrees(110), degrees(114)];
        let levels = (least..=most).rev().map(|level| within(level, edges));
        let Some(level) = levels.into_iter().find(Level::fits) else {
            return rejected(format!("has too many tiles at its coarsest level, {least}"));
        };
        let mut archive = Self {
            level,
            root: Vec::new(),
            leaf: None,
            leaves_at: number(40),
            tiles_at: number(56),
            is_gzipped: gzipped,
            are_tiles_gzipped: tiles_gzipped,
            file,
        };
        archive.root = archive.directory(number(8), number(16))?;
        Ok(archive)
    }

    pub(super) fn level(&self) -> &Level {
        &self.level
    }

    /// The entries of a directory.
    fn directory(&mut self, offset: u64, length: u64) -> Result<Vec<Entry>, BuildError> {
        let context = self.file.context.clone();
        let damaged = || context.damaged("a directory that contradicts itself");
        if length > MAX_DIRECTORY_BYTES {
            return Err(damaged());
        }
        let stored = self.file.bytes(offset, length)?;
        let bytes = match self.is_gzipped {
            true => unzipped(&stored, MAX_DIRECTORY_BYTES).ok_or_else(damaged)?,
            false => stored,
        };
        entries(&bytes).ok_or_else(damaged)
    }

    pub(super) fn tile(&mut self, row: u32, column: u32) -> Result<Option<Vec<u8>>, BuildError> {
        let id = tile_id(self.level.level, column, row);
        let mut found = find(&self.root, id);
        for _ in 0..MAX_DEPTH {
            let Some(entry) = found else {
                return Ok(None);
            };
            if entry.run > 0 {
                return self.data(&entry).map(Some);
            }
            if self.leaf.as_ref().is_none_or(|(at, _)| *at != entry.offset) {
                let offset = self.leaves_at.saturating_add(entry.offset);
                let leaf = self.directory(offset, entry.length)?;
                self.leaf = Some((entry.offset, leaf));
            }
            found = self.leaf.as_ref().and_then(|(_, leaf)| find(leaf, id));
        }
        Err(self.file.context.damaged("directories in a circle"))
    }

    fn data(&mut self, entry: &Entry) -> Result<Vec<u8>, BuildError> {
        let context = self.file.context.clone();
        if entry.length > MAX_TILE_FILE_BYTES {
            return Err(context.damaged("a tile of more than 64 MB"));
        }
        let offset = self.tiles_at.saturating_add(entry.offset);
        let stored = self.file.bytes(offset, entry.length)?;
        match self.are_tiles_gzipped {
            false => Ok(stored),
            true => unzipped(&stored, MAX_TILE_FILE_BYTES)
                .ok_or_else(|| context.damaged("a tile that cannot be decompressed")),
        }
    }
}

/// The tiles of a level inside these edges: west, south, east and north in degrees.
fn within(level: u8, [west, south, east, north]: [f64; 4]) -> Level {
    let whole = Level::whole(level);
    let side = f64::from(1_u32 << level);
    let column = |lon_deg: f64| (lon_deg + 180.0) / 360.0 * side;
    let row = |lat_deg: f64| {
        let northing_deg = super::Crs::WebMercator.northing_deg(lat_deg);
        (180.0 - northing_deg) / 360.0 * side
    };
    // Edges have seven digits. Casts saturate.
    let range = |first: f64, end: f64, all: u32| {
        let first = ((first + 1e-6).floor().max(0.0) as u32).min(all - 1);
        first..((end - 1e-6).ceil().max(0.0) as u32).clamp(first + 1, all)
    };
    match west < east && south < north {
        true => Level {
            level,
            columns: range(column(west), column(east), whole.columns.end),
            rows: range(row(north), row(south), whole.rows.end),
        },
        // Not said.
        false => whole,
    }
}

fn unzipped(bytes: &[u8], most: u64) -> Option<Vec<u8>> {
    let mut all = Vec::new();
    let stream = MultiGzDecoder::new(bytes);
    stream.take(most + 1).read_to_end(&mut all).ok()?;
    (all.len() as u64 <= most).then_some(all)
}

/// A whole number of 7 bits a byte, the lowest first.
fn varint(bytes: &mut &[u8]) -> Option<u64> {
    let mut number = 0;
    for shift in (0..64).step_by(7) {
        let (byte, rest) = bytes.split_first()?;
        *bytes = rest;
        number |= u64::from(byte & 0x7F).checked_shl(shift)?;
        if byte & 0x80 == 0 {
            return Some(number);
        }
    }
    None
}

fn entries(mut bytes: &[u8]) -> Option<Vec<Entry>> {
    let count = varint(&mut bytes)?;
    // Each has four numbers of a byte at least.
    if count > bytes.len() as u64 / 4 {
        return None;
    }
    let mut entries = vec![Entry::default(); count as usize];
    let mut id = 0_u64;
    for entry in &mut entries {
        id = id.checked_add(varint(&mut bytes)?)?;
        entry.id = id;
    }
    for entry in &mut entries {
        entry.run = varint(&mut bytes)?;
    }
    for entry in &mut entries {
        entry.length = varint(&mut bytes)?;
    }
    let mut behind = None;
    for entry in &mut entries {
        entry.offset = match (varint(&mut bytes)?, behind) {
            // Behind the one before.
            (0, behind) => behind?,
            (offset, _) => offset - 1,
        };
        behind = entry.offset.checked_add(entry.length);
    }
    Some(entries)
}

/// The tile with this number, or the leaf that would have it.
fn find(entries: &[Entry], id: u64) -> Option<Entry> {
    let behind = entries.partition_point(|entry| entry.id <= id);
    let entry = *entries.get(behind.checked_sub(1)?)?;
    (entry.run == 0 || id - entry.id < entry.run).then_some(entry)
}

/// The number of a tile: those of coarser levels first, then its position on the Hilbert curve.
pub(super) fn tile_id(level: u8, column: u32, row: u32) -> u64 {
    // (4^z − 1) / 3 tiles are coarser.
    let mut id = ((1_u64 << (2 * level)) - 1) / 3;
    let (mut x, mut y) = (u64::from(column), u64::from(row));
    for bit in (0..level).rev() {
        let side = 1_u64 << bit;
        let (right, down) = (u64::from(x & side > 0), u64::from(y & side > 0));
        id += side * side * ((3 * right) ^ down);
        // The curve of a quarter is turned.
        (x, y) = (x & (side - 1), y & (side - 1));
        if down == 0 {
            if right == 1 {
                (x, y) = (side - 1 - x, side - 1 - y);
            }
            (x, y) = (y, x);
        }
    }
    id
}
