//! Selection of the tiles to draw.

use super::{TileCache, TileStage};
use crate::stream::{ResidentTile, TileSlot};
use crate::tile::{MapLayer, TileKey};
use terrella_ground::globe::BLOCK_COUNT;

impl TileCache {
    /// The tile to draw a block of a map with; `None` is the whole coarsest map: see [`super::super::TileStream::draw`].
    pub fn draw(&mut self, layer: MapLayer, block: u8) -> Option<ResidentTile> {
        let levels = self.maps[layer.index()].levels.len() as u8;
        if levels == 0 || u32::from(block) >= BLOCK_COUNT {
            return None;
        }
        let allocation =
            self.allocations[layer.index() * BLOCK_COUNT as usize + usize::from(block)];
        if allocation.frame != self.frame {
            return None;
        }
        let coarsest = levels - 1;
        let coarser = allocation.goal..coarsest;
        // A map without finer requests is drawn as a whole. Parts are not tiles of the whole block.
        let finer = if allocation.goal < coarsest {
            self.maps[layer.index()].cut as u8..allocation.goal
        } else {
            0..0
        };
        let drawn = coarser.chain(finer.rev()).find_map(|level| {
            let key = TileKey::whole(layer, level, block);
            let slot = self.drawable(key, level < allocation.goal)?;
            Some(ResidentTile { level, slot })
        });
        let level = drawn.map_or(coarsest, |tile| tile.level);
        if level <= allocation.target {
            self.counters.hits += 1;
        } else {
            self.counters.fallbacks += 1;
        }
        drawn
    }

    /// The slot of a tile that may be drawn; marks it.
    pub(super) fn drawable(&mut self, key: TileKey, is_finer: bool) -> Option<TileSlot> {
        let pool = self.pool_of(key)?;
        let state = &self.tiles[self.places.of(key)];
        let TileStage::Resident(index) = state.stage else {
            return None;
        };
        let pool_state = &mut self.pool_states[pool];
        let slot = &mut pool_state.slots[usize::from(index)];
        if !state.is_promised(self.frame) && slot.drawn != self.frame {
            // Slots that those who wait can have without this one.
            let is_spare = pool_state.available > pool_state.promised - pool_state.held;
            if (is_finer || pool_state.is_starved) && !is_spare {
                return None;
            }
            pool_state.available -= 1;
        }
        (slot.drawn, slot.used) = (self.frame, self.frame);
        let pool = pool as u16;
        Some(TileSlot { pool, index })
    }
}
