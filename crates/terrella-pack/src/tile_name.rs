//! Name of a tile's file.

use std::path::PathBuf;
use terrella_ground::globe::{BLOCK_COUNT, Block, COLUMNS};
use terrella_imagery::pack::tile_path;
use terrella_imagery::tile::{MapLayer, Storage, TileShape};

/// A tile's file, by the parts of its path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct TileName {
    pub storage: Storage,
    pub layer: MapLayer,
    /// Texels per block.
    pub pixels: u32,
    /// Tiles along a block's side.
    pub parts: u32,
    /// Index of the block.
    pub block: u8,
    /// Part of the block.
    pub part: u16,
}

impl TileName {
    /// For the tile in a row and column of all tiles of a level.
    pub(super) fn new(
        storage: Storage,
        layer: MapLayer,
        shape: TileShape,
        row: u32,
        column: u32,
    ) -> Self {
        let parts = shape.parts;
        Self {
            storage,
            layer,
            pixels: shape.block_pixels(),
            parts,
            // 0…127, and below 256.
            block: (row / parts * COLUMNS + column / parts) as u8,
            part: (row % parts * parts + column % parts) as u16,
        }
    }

    /// Its path in the pack; `None` of a shape that no tile has.
    pub(super) fn path(self) -> Option<PathBuf> {
        let shape = self.shape()?;
        if self.part >= shape.tiles_of_block() || u32::from(self.block) >= BLOCK_COUNT {
            return None;
        }
        let block = u32::from(self.block);
        let block = Block {
            column: block % COLUMNS,
            row: block / COLUMNS,
        };
        Some(tile_path(self.storage, self.layer, shape, block, self.part))
    }

    fn shape(self) -> Option<TileShape> {
        if self.parts == 0 || !self.pixels.is_multiple_of(self.parts) {
            return None;
        }
        TileShape::cut(self.pixels / self.parts, self.parts)
    }
}
