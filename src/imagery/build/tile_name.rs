//! What a tile's file is named by.

use crate::globe::{Block, COLUMNS};
use crate::imagery::pack::tile_path;
use crate::imagery::tile::{MapLayer, Storage, TileShape};
use std::path::PathBuf;

/// A tile's file, by what its path is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct TileName {
    pub storage: Storage,
    pub layer: MapLayer,
    /// Texels per block.
    pub pixels: u32,
    /// Index of the block.
    pub block: u8,
}

impl TileName {
    /// Its path in the pack; `None` of a shape that no tile has.
    pub(super) fn path(self) -> Option<PathBuf> {
        let shape = TileShape::new(self.pixels)?;
        let block = u32::from(self.block);
        let block = Block {
            column: block % COLUMNS,
            row: block / COLUMNS,
        };
        Some(tile_path(self.storage, self.layer, shape, block, 0))
    }
}
