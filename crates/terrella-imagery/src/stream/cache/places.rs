//! Index of each tile's state.

use crate::tile::{LayerLayout, MAP_LAYERS, MAX_LEVELS, TileKey};
use terrella_ground::globe::BLOCK_COUNT;

/// Indices of all tiles of some maps, consecutively.
#[derive(Clone, Copy)]
pub(super) struct TilePlaces {
    /// Of each map and level: the place of its first tile, and its tiles of a block.
    levels: [[(u32, u16); MAX_LEVELS]; MAP_LAYERS],
    len: u32,
}

impl TilePlaces {
    pub fn new(layers: &[&LayerLayout]) -> Self {
        let mut places = Self {
            // One common index for non-existent tiles.
            levels: [[(0, 0); MAX_LEVELS]; MAP_LAYERS],
            len: 1,
        };
        for layer in layers {
            let of_layer = &mut places.levels[layer.layer.index()];
            for (place, level) in of_layer.iter_mut().zip(&layer.levels) {
                let of_block = level.shape.tiles_of_block();
                *place = (places.len, of_block);
                places.len += BLOCK_COUNT * u32::from(of_block);
            }
        }
        places
    }

    /// Number of places.
    pub fn len(&self) -> usize {
        self.len as usize
    }

    /// The place of a tile. All that are not there share one.
    #[inline]
    pub fn of(&self, key: TileKey) -> usize {
        let levels = &self.levels[key.layer.index()];
        let (first, of_block) = levels
            .get(usize::from(key.level))
            .copied()
            .unwrap_or_default();
        if key.part >= of_block || u32::from(key.block) >= BLOCK_COUNT {
            return 0;
        }
        first as usize + usize::from(key.block) * usize::from(of_block) + usize::from(key.part)
    }
}
