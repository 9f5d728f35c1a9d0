//! A raster of a mosaic, one row at a time: a file, or adjacent tiles.

use super::row::{AlphaMeans, RasterRow, without_alpha};
use super::tiles::TileRows;
use crate::error::BuildError;
use crate::source::{RowSource, SourceInfo};

/// Source of rows.
pub(super) enum Raster {
    File {
        /// Its reader.
        rows: Box<dyn RowSource>,
        /// A row as it is read.
        bytes: Vec<u8>,
        alpha: AlphaMeans,
    },
    Tiles(Box<TileRows>),
}

impl Raster {
    pub(super) fn file(rows: Box<dyn RowSource>, alpha: AlphaMeans) -> Self {
        let bytes = vec![0; rows.info().row_bytes()];
        Self::File { rows, bytes, alpha }
    }

    /// Difference of a file's colours from sRGB, if it declares one.
    pub(super) fn colour_note(&self) -> Option<String> {
        match self {
            Self::File { rows, .. } => rows.colour_note(),
            Self::Tiles(_) => None,
        }
    }

    /// Its size and texels, alpha among them.
    pub(super) fn info(&self) -> SourceInfo {
        match self {
            Self::File { rows, .. } => rows.info(),
            Self::Tiles(tiles) => tiles.info(),
        }
    }

    /// Fills the next row.
    pub(super) fn next_row(&mut self, row: &mut RasterRow) -> Result<(), BuildError> {
        match self {
            Self::File { rows, bytes, alpha } => {
                rows.next_row(bytes)?;
                let info = rows.info();
                without_alpha(&info, *alpha, bytes, row);
                Ok(())
            }
            Self::Tiles(tiles) => tiles.next_row(row),
        }
    }

    /// Leaves out so many rows.
    pub(super) fn skip(&mut self, count: u32) -> Result<(), BuildError> {
        match self {
            Self::File { rows, bytes, .. } => (0..count).try_for_each(|_| rows.next_row(bytes)),
            Self::Tiles(tiles) => {
                tiles.skip(count);
                Ok(())
            }
        }
    }

    /// Remarks about omitted parts since the last call.
    pub(super) fn notes(&mut self) -> Vec<String> {
        match self {
            Self::File { rows, .. } => rows.notes(),
            Self::Tiles(tiles) => tiles.notes(),
        }
    }
}
