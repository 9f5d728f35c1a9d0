//! A pack as a source of height tiles.

use super::{HeightIndex, HeightKind, HeightPlace, HeightValues, HeightsEntry, decode_heights};
use crate::pack::error::PackError;
use crate::pack::file::read_whole;
use crate::pack::open::Pack;
use crate::tile::TileError;
use std::path::PathBuf;
use std::sync::Arc;
use terrella_ground::elevation::{
    HeightRange, HeightSamples, HeightTileError, HeightTileKey, HeightTileLayout, HeightTileSource,
};

/// The elevation data of a pack. Ranges are held in memory, 48 bytes a tile; tiles are read from their files on each request.
#[derive(Debug)]
pub struct PackHeights {
    dir: PathBuf,
    entry: HeightsEntry,
    layout: HeightTileLayout,
    index: HeightIndex,
}

impl Pack {
    /// The elevation data of the pack: reads their index.
    ///
    /// # Errors
    /// [`PackError::NoHeights`] if the pack has none; an index that is missing or does not match the manifest.
    pub fn height_tiles(&self) -> Result<PackHeights, PackError> {
        let entry = self.manifest().heights.clone();
        let entry = entry.ok_or_else(|| PackError::NoHeights {
            path: self.dir().into(),
        })?;
        let layout = HeightTileLayout::new(entry.levels, entry.columns, entry.side, entry.border);
        let layout = layout.map_err(|error| PackError::HeightIndex {
            path: self.dir().join(HeightsEntry::index_path()),
            cause: error.to_string(),
        })?;
        let index = HeightIndex::read(self.dir(), &entry)?;
        Ok(PackHeights {
            dir: self.dir().into(),
            entry,
            layout,
            index,
        })
    }
}

impl PackHeights {
    /// Their entry in the manifest.
    pub fn entry(&self) -> &HeightsEntry {
        &self.entry
    }
}

fn place(key: HeightTileKey) -> HeightPlace {
    HeightPlace {
        level: key.level,
        row: key.row,
        column: key.column,
    }
}

impl HeightTileSource for PackHeights {
    fn layout(&self) -> HeightTileLayout {
        self.layout
    }

    fn range_m(&self, key: HeightTileKey) -> Option<HeightRange> {
        let record = self.index.get(place(key))?;
        Some(HeightRange {
            low_m: f64::from(record.low_m),
            high_m: f64::from(record.high_m),
        })
    }

    fn read(
        &self,
        key: HeightTileKey,
        cancelled: &dyn Fn() -> bool,
    ) -> Result<HeightSamples, HeightTileError> {
        let record = self.index.get(place(key));
        let record = record.ok_or(HeightTileError::Absent(key))?;
        let path = self.dir.join(self.entry.path(record.place));
        let bytes = read_whole(&path, record.file, cancelled).map_err(|error| match error {
            TileError::Cancelled => HeightTileError::Cancelled(key),
            error => HeightTileError::Unreadable {
                key,
                cause: Arc::new(error),
            },
        })?;
        if cancelled() {
            return Err(HeightTileError::Cancelled(key));
        }
        let unsound = |what: String| HeightTileError::Unsound {
            key,
            what: format!("{}: {what}", path.display()),
        };
        let values = decode_heights(&bytes, &self.entry).map_err(unsound)?;
        // Terrain culled by its range must not exceed it.
        record
            .check_range(&values, self.entry.kind)
            .map_err(unsound)?;
        Ok(match (values, self.entry.kind) {
            (HeightValues::I16(values), HeightKind::I16 { offset_m, scale_m }) => {
                HeightSamples::I16 {
                    values,
                    offset_m,
                    scale_m,
                }
            }
            (HeightValues::F32(values), _) => HeightSamples::F32(values),
            (HeightValues::I16(_), HeightKind::F32) => {
                return Err(unsound("it has steps in place of metres".into()));
            }
        })
    }
}
