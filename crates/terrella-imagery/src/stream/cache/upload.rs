//! Where a decoded tile becomes resident: its upload into a slot, part by part; the tile used longest ago is evicted where
//! no slot is empty.

use super::{PendingUpload, TileCache, TileStage};
use crate::stream::{TileSlot, Upload};
use crate::tile::{TILE_MIPS, TileKey};

impl TileCache {
    /// Gives parts of decoded tiles to `write`: see [`super::super::TileStream::upload`].
    pub fn upload(&mut self, budget: u64, write: &mut dyn FnMut(Upload<'_>)) -> u64 {
        let (mut written, mut next) = (0, 0);
        while let Some(pending) = self.pending_uploads.get(next) {
            // At least one row, however small the budget.
            let (_, row_bytes) = rows_of(pending);
            let is_within = u64::from(row_bytes) <= budget.saturating_sub(written)
                || written == 0 && budget > 0;
            if !is_within {
                break;
            }
            let Some(slot) = self.slot_for(pending.key) else {
                next += 1;
                continue;
            };
            let pending = &mut self.pending_uploads[next];
            let is_whole = write_rows(pending, slot, budget, &mut written, write);
            if !is_whole {
                break;
            }
            let PendingUpload { key, tile, .. } = self.pending_uploads.remove(next);
            self.retired.push(tile);
            self.tile_mut(key).stage = TileStage::Resident(slot.index);
            self.counters.resident[usize::from(key.level)] += 1;
            self.counters.completed += 1;
        }
        for place in 0..self.pending_uploads.len() {
            let key = self.pending_uploads[place].key;
            let has_slot = self.tile(key).slot().is_some();
            self.pending_uploads[place].is_blocked = !has_slot && !self.has_slot_to_take(key);
        }
        self.counters.uploaded_bytes += written;
        written
    }

    /// The slot that a tile is being written to; takes one if it has none yet.
    fn slot_for(&mut self, key: TileKey) -> Option<TileSlot> {
        let pool = self.pool_of(key)?;
        let index = match self.tile(key).slot() {
            Some(index) => index,
            None => self.take_slot(key, pool)?,
        };
        let pool = pool as u16;
        Some(TileSlot { pool, index })
    }

    /// A slot could be taken for a tile without affecting drawn tiles. A tile that is only expected leaves enough slots for those of the image.
    fn has_slot_to_take(&self, key: TileKey) -> bool {
        let Some(pool) = self.pool_of(key) else {
            return false;
        };
        let pool_state = &self.pool_states[pool];
        let kept = if self.tile(key).is_drawn {
            0
        } else {
            pool_state.lacking_drawn
        };
        pool_state.available > kept
    }

    /// Takes the slot that was used longest ago, an empty one first, and evicts what it held.
    fn take_slot(&mut self, key: TileKey, pool: usize) -> Option<u16> {
        if !self.has_slot_to_take(key) {
            return None;
        }
        let (frame, tiles, places) = (self.frame, &self.tiles, self.places);
        let slots = self.pool_states[pool].slots.iter().enumerate();
        let (index, slot) = slots
            .filter(|(_, slot)| match slot.tile {
                None => true,
                Some(held) => slot.drawn != frame && !tiles[places.of(held)].is_promised(frame),
            })
            .min_by_key(|(_, slot)| slot.tile.map(|_| slot.used))?;
        if let Some(held) = slot.tile {
            self.tile_mut(held).stage = TileStage::Away;
            self.counters.resident[usize::from(held.level)] -= 1;
            self.counters.evictions += 1;
        }
        let pool_state = &mut self.pool_states[pool];
        let slot = &mut pool_state.slots[index];
        (slot.tile, slot.used) = (Some(key), frame);
        pool_state.available -= 1;
        pool_state.held += 1;
        let state = &mut self.tiles[self.places.of(key)];
        pool_state.lacking_drawn -= u32::from(state.is_drawn);
        let index = index as u16;
        state.stage = TileStage::Uploading(index);
        Some(index)
    }
}

/// Rows of units of the mip level that comes next, and bytes of each.
fn rows_of(pending: &PendingUpload) -> (u32, u32) {
    let PendingUpload { tile, mip, .. } = pending;
    tile.format.rows(tile.shape.mip_side(*mip))
}

/// Writes rows up to the budget; true if that was the last.
fn write_rows(
    pending: &mut PendingUpload,
    slot: TileSlot,
    budget: u64,
    written: &mut u64,
    write: &mut dyn FnMut(Upload<'_>),
) -> bool {
    let key: TileKey = pending.key;
    while pending.mip < TILE_MIPS {
        let (all_rows, row_bytes) = rows_of(pending);
        let (mip, first_row) = (pending.mip, pending.row);
        let affordable = budget.saturating_sub(*written) / u64::from(row_bytes);
        let least = u64::from(*written == 0);
        let rows = u64::from(all_rows - first_row).min(affordable.max(least)) as u32;
        if rows == 0 {
            return false;
        }
        let start = first_row as usize * row_bytes as usize;
        let len = rows as usize * row_bytes as usize;
        write(Upload {
            slot,
            key,
            mip,
            first_row,
            rows,
            row_bytes,
            texels: &pending.tile.mip(mip)[start..start + len],
        });
        *written += len as u64;
        pending.row += rows;
        if pending.row == all_rows {
            (pending.mip, pending.row) = (mip + 1, 0);
        }
        if *written >= budget && pending.mip < TILE_MIPS {
            return false;
        }
    }
    true
}
