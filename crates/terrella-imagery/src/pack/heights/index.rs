//! The existing elevation tiles, with their files and ranges.

use super::{HeightKind, HeightPlace, HeightValues, HeightsEntry};
use crate::pack::error::PackError;
use crate::pack::file::read_whole;
use crate::pack::manifest::TileFile;
use crate::tile::TileError;
use std::path::Path;

/// Limit of elevation tiles of a pack: an index of 78 MB.
pub const MAX_HEIGHT_TILES: u32 = 1 << 21;

const MAGIC: &[u8; 8] = b"TRLHGT01";
const HEAD_BYTES: usize = 12;
const RECORD_BYTES: usize = 37;

/// Largest plausible elevation on Earth, metres.
const MOST_M: f32 = 100_000.0;

/// A tile of the index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeightRecord {
    /// Which tile.
    pub place: HeightPlace,
    /// Length and checksum of its file.
    pub file: TileFile,
    /// Lowest height of the tile and of everything beneath it, metres.
    pub low_m: f32,
    /// Highest.
    pub high_m: f32,
}

impl HeightRecord {
    /// Rejects samples that are not within the tile's range.
    pub(in crate::pack) fn check_range(
        &self,
        values: &HeightValues,
        kind: HeightKind,
    ) -> Result<(), String> {
        let (low_m, high_m) = values.range_m(kind).ok_or("it has no samples")?;
        let (least_m, most_m) = (f64::from(self.low_m), f64::from(self.high_m));
        if low_m < least_m || high_m > most_m {
            return Err(format!(
                "it has heights from {low_m} m to {high_m} m, and the index says {least_m} m to {most_m} m"
            ));
        }
        Ok(())
    }
}

/// All tiles, sorted by their places.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightIndex {
    records: Vec<HeightRecord>,
}

impl HeightIndex {
    /// A tile, if it is there.
    pub fn get(&self, place: HeightPlace) -> Option<&HeightRecord> {
        let found = self
            .records
            .binary_search_by_key(&place, |record| record.place);
        found.ok().map(|at| &self.records[at])
    }

    /// All of them, the finest level first.
    pub fn records(&self) -> &[HeightRecord] {
        &self.records
    }

    /// Reads the index of the pack in a folder.
    pub fn read(dir: &Path, entry: &HeightsEntry) -> Result<Self, PackError> {
        let path = dir.join(HeightsEntry::index_path());
        let reject = |cause: String| PackError::HeightIndex {
            path: path.clone(),
            cause,
        };
        let bytes = read_whole(&path, entry.index, &|| false).map_err(|error| match error {
            TileError::Unreadable { source, .. } => PackError::Read {
                path: path.clone(),
                source,
            },
            TileError::Corrupt { cause, .. } => reject(cause),
            other => reject(other.to_string()),
        })?;
        decode_index(&bytes, entry).map_err(reject)
    }
}

pub(in crate::pack) fn index_bytes(tiles: u32) -> u64 {
    HEAD_BYTES as u64 + u64::from(tiles) * RECORD_BYTES as u64
}

/// The bytes of an index; the records must be sorted by place.
pub fn encode_index(records: &[HeightRecord]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(HEAD_BYTES + records.len() * RECORD_BYTES);
    bytes.extend_from_slice(MAGIC);
    // At most `MAX_HEIGHT_TILES`, and their files far below 4 GB.
    bytes.extend_from_slice(&(records.len() as u32).to_le_bytes());
    for record in records {
        let HeightPlace { level, row, column } = record.place;
        bytes.push(level);
        for number in [row, column, record.file.bytes as u32] {
            bytes.extend_from_slice(&number.to_le_bytes());
        }
        bytes.extend_from_slice(&record.file.checksum);
        for height_m in [record.low_m, record.high_m] {
            bytes.extend_from_slice(&height_m.to_le_bytes());
        }
    }
    bytes
}

/// Parses the bytes of an index, which must match the manifest's entry exactly.
///
/// # Errors
/// The error in it: size, order, positions, invalid ranges or ranges outside those of the coarser tile, tiles without a coarser one, missing tiles
/// of the coarsest level.
pub fn decode_index(bytes: &[u8], entry: &HeightsEntry) -> Result<HeightIndex, String> {
    let word = |at: usize| -> Option<[u8; 4]> { bytes.get(at..)?.first_chunk().copied() };
    if !bytes.starts_with(MAGIC) {
        return Err("it is no index of heights: other first bytes".into());
    }
    let count = word(8).map_or(0, u32::from_le_bytes);
    if count != entry.tiles || count > MAX_HEIGHT_TILES {
        let tiles = entry.tiles;
        return Err(format!(
            "it has {count} tiles and the manifest says {tiles}"
        ));
    }
    if bytes.len() as u64 != index_bytes(count) {
        let needed = index_bytes(count);
        return Err(format!("it has {} bytes instead of {needed}", bytes.len()));
    }
    let mut records: Vec<HeightRecord> = Vec::with_capacity(count as usize);
    for (n, bytes) in bytes[HEAD_BYTES..].chunks_exact(RECORD_BYTES).enumerate() {
        let record = record(bytes).ok_or("it ends within a tile")?;
        check(&record, records.last(), entry).map_err(|what| format!("its tile {n} {what}"))?;
        records.push(record);
    }
    let index = HeightIndex { records };
    check_parents(&index, entry)?;
    Ok(index)
}

fn record(bytes: &[u8]) -> Option<HeightRecord> {
    let word = |at: usize| -> Option<[u8; 4]> { bytes.get(at..)?.first_chunk().copied() };
    Some(HeightRecord {
        place: HeightPlace {
            level: *bytes.first()?,
            row: u32::from_le_bytes(word(1)?),
            column: u32::from_le_bytes(word(5)?),
        },
        file: TileFile {
            bytes: u64::from(u32::from_le_bytes(word(9)?)),
            checksum: *bytes.get(13..)?.first_chunk()?,
        },
        low_m: f32::from_le_bytes(word(29)?),
        high_m: f32::from_le_bytes(word(33)?),
    })
}

/// The error in a record, given the one before.
fn check(
    record: &HeightRecord,
    before: Option<&HeightRecord>,
    entry: &HeightsEntry,
) -> Result<(), String> {
    let HeightPlace { level, row, column } = record.place;
    if !entry.contains(record.place) {
        return Err(format!(
            "is at level {level}, row {row}, column {column}, where there is none"
        ));
    }
    if before.is_some_and(|before| before.place >= record.place) {
        return Err("is not in the order of levels, rows and columns".into());
    }
    if !(1..=entry.most_file_bytes() as u64).contains(&record.file.bytes) {
        return Err(format!("says that it has {} bytes", record.file.bytes));
    }
    let (low_m, high_m) = (record.low_m, record.high_m);
    // Not true either where one is no number.
    let is_range = low_m >= -MOST_M && low_m <= high_m && high_m <= MOST_M;
    if !is_range {
        return Err(format!("has heights from {low_m} m to {high_m} m"));
    }
    Ok(())
}

/// Every tile is inside a coarser one, and the coarsest level is complete.
fn check_parents(index: &HeightIndex, entry: &HeightsEntry) -> Result<(), String> {
    let mut coarsest = 0;
    for record in &index.records {
        let HeightPlace { level, row, column } = record.place;
        if level == entry.coarsest() {
            coarsest += 1;
            continue;
        }
        let Some(parent) = index.get(record.place.parent()) else {
            return Err(format!(
                "the tile of level {level}, row {row}, column {column} has no coarser one over it"
            ));
        };
        if parent.low_m > record.low_m || parent.high_m < record.high_m {
            return Err(format!(
                "the tile of level {level}, row {row}, column {column} has heights beyond those of the coarser one over it"
            ));
        }
    }
    let needed = entry.columns * entry.columns / 2;
    if coarsest != needed {
        return Err(format!(
            "the coarsest level has {coarsest} of {needed} tiles"
        ));
    }
    Ok(())
}
