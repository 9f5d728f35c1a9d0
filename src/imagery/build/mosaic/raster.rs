//! A raster of a mosaic, a row at a time: a file, or tiles that lie side by side.

use super::tiles::TileRows;
use crate::imagery::build::error::BuildError;
use crate::imagery::build::source::{RowSource, SourceInfo};

/// A row of a raster.
#[derive(Default)]
pub(super) struct RasterRow {
    /// Texels without alpha.
    pub bytes: Vec<u8>,
    /// 255 where there is a texel, 0 where there is none.
    pub cover: Vec<u8>,
    /// All of it is there.
    pub is_whole: bool,
}

/// Where rows come from.
pub(super) enum Raster {
    /// One file; alpha is cover.
    File {
        /// Its reader.
        rows: Box<dyn RowSource>,
        /// A row as it is read.
        bytes: Vec<u8>,
    },
    /// Tiles.
    Tiles(Box<TileRows>),
}

impl Raster {
    /// Of a file.
    pub(super) fn file(rows: Box<dyn RowSource>) -> Self {
        let bytes = vec![0; rows.info().row_bytes()];
        Self::File { rows, bytes }
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
            Self::File { rows, bytes } => {
                rows.next_row(bytes)?;
                let info = rows.info();
                without_alpha(&info, bytes, row);
                Ok(())
            }
            Self::Tiles(tiles) => tiles.next_row(row),
        }
    }

    /// Leaves out so many rows.
    pub(super) fn skip(&mut self, count: u32) -> Result<(), BuildError> {
        match self {
            Self::File { rows, bytes } => (0..count).try_for_each(|_| rows.next_row(bytes)),
            Self::Tiles(tiles) => {
                tiles.skip(count);
                Ok(())
            }
        }
    }

    /// What was left out since it was asked last.
    pub(super) fn notes(&mut self) -> Vec<String> {
        match self {
            Self::File { rows, .. } => rows.notes(),
            Self::Tiles(tiles) => tiles.notes(),
        }
    }
}

/// Parts texels from their alpha.
pub(super) fn without_alpha(info: &SourceInfo, bytes: &[u8], row: &mut RasterRow) {
    let size = info.sample.bytes();
    row.is_whole = true;
    row.cover.clear();
    row.bytes.clear();
    if matches!(info.channels, 1 | 3) {
        row.bytes.extend_from_slice(bytes);
        row.cover.resize(info.width as usize, 255);
        return;
    }
    for texel in bytes.chunks_exact(info.channels * size) {
        let (colour, alpha) = texel.split_at(texel.len() - size);
        row.bytes.extend_from_slice(colour);
        // The highest byte of an integer says enough; alpha of floats is seldom, and counts where it is not 0.
        let cover = match size {
            1 => alpha[0],
            2 => u16::from_ne_bytes([alpha[0], alpha[1]]).to_be_bytes()[0],
            _ => 255 * u8::from(alpha.iter().any(|byte| *byte != 0)),
        };
        row.is_whole &= cover == 255;
        row.cover.push(cover);
    }
}
