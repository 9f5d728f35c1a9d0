//! Decoded tiles on their way into slots.

use super::{Stage, TileCache, Waiting, place_of};
use crate::imagery::stream::{TileSlot, Upload};
use crate::imagery::tile::{TILE_MIPS, TileKey};

impl TileCache {
    /// Gives parts of decoded tiles to `write`: see [`super::super::TileStream::upload`].
    pub fn upload(&mut self, budget: u64, write: &mut dyn FnMut(Upload<'_>)) -> u64 {
        let (mut written, mut next) = (0, 0);
        while let Some(waiting) = self.waiting.get(next) {
            // At least one row, however small the budget.
            let (_, row_bytes) = rows_of(waiting);
            let is_within = u64::from(row_bytes) <= budget.saturating_sub(written)
                || written == 0 && budget > 0;
            if !is_within {
                break;
            }
            let Some(slot) = self.slot_for(waiting.key) else {
                next += 1;
                continue;
            };
            let waiting = &mut self.waiting[next];
            let is_whole = write_rows(waiting, slot, budget, &mut written, write);
            if !is_whole {
                break;
            }
            let Waiting { key, tile, .. } = self.waiting.remove(next);
            self.spent.push(tile);
            self.tiles[place_of(key)].stage = Stage::Resident(slot.index);
            self.counters.resident[usize::from(key.level)] += 1;
            self.counters.completed += 1;
        }
        for place in 0..self.waiting.len() {
            let key = self.waiting[place].key;
            let has_slot = self.tiles[place_of(key)].slot().is_some();
            self.waiting[place].is_blocked = !has_slot && !self.has_slot_to_take(key);
        }
        self.counters.uploaded_bytes += written;
        written
    }

    /// The slot that a tile is being written to; takes one if it has none yet.
    fn slot_for(&mut self, key: TileKey) -> Option<TileSlot> {
        let pool = self.pool_of(key)?;
        let index = match self.tiles[place_of(key)].slot() {
            Some(index) => index,
            None => self.take_slot(key, pool)?,
        };
        let pool = pool as u16;
        Some(TileSlot { pool, index })
    }

    /// A slot could be taken for a tile without disturbing what is drawn. A tile that is only expected leaves enough for
    /// those of the picture.
    fn has_slot_to_take(&self, key: TileKey) -> bool {
        let Some(pool) = self.pool_of(key) else {
            return false;
        };
        let room = &self.rooms[pool];
        let kept = if self.tiles[place_of(key)].is_drawn {
            0
        } else {
            room.lacking_drawn
        };
        room.loose > kept
    }

    /// Takes the slot that was used longest ago, an empty one first, and evicts what it held.
    fn take_slot(&mut self, key: TileKey, pool: usize) -> Option<u16> {
        if !self.has_slot_to_take(key) {
            return None;
        }
        let (frame, tiles) = (self.frame, &self.tiles);
        let places = self.rooms[pool].places.iter().enumerate();
        let (index, place) = places
            .filter(|(_, place)| match place.tile {
                None => true,
                Some(held) => place.drawn != frame && !tiles[place_of(held)].is_promised(frame),
            })
            .min_by_key(|(_, place)| place.tile.map(|_| place.used))?;
        if let Some(held) = place.tile {
            self.tiles[place_of(held)].stage = Stage::Away;
            self.counters.resident[usize::from(held.level)] -= 1;
            self.counters.evictions += 1;
        }
        let room = &mut self.rooms[pool];
        let place = &mut room.places[index];
        (place.tile, place.used) = (Some(key), frame);
        room.loose -= 1;
        room.held += 1;
        let state = &mut self.tiles[place_of(key)];
        room.lacking_drawn -= u32::from(state.is_drawn);
        let index = index as u16;
        state.stage = Stage::Uploading(index);
        Some(index)
    }
}

/// Rows of units of the mip level that comes next, and bytes of each.
fn rows_of(waiting: &Waiting) -> (u32, u32) {
    let Waiting { tile, mip, .. } = waiting;
    tile.format.rows(tile.shape.mip_side(*mip))
}

/// Writes rows up to the budget; true if that was the last.
fn write_rows(
    waiting: &mut Waiting,
    slot: TileSlot,
    budget: u64,
    written: &mut u64,
    write: &mut dyn FnMut(Upload<'_>),
) -> bool {
    let key: TileKey = waiting.key;
    while waiting.mip < TILE_MIPS {
        let (all_rows, row_bytes) = rows_of(waiting);
        let (mip, first_row) = (waiting.mip, waiting.row);
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
            texels: &waiting.tile.mip(mip)[start..start + len],
        });
        *written += len as u64;
        waiting.row += rows;
        if waiting.row == all_rows {
            (waiting.mip, waiting.row) = (mip + 1, 0);
        }
        if *written >= budget && waiting.mip < TILE_MIPS {
            return false;
        }
    }
    true
}
