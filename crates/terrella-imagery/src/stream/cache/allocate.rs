//! Allocation of the pools' slots to requested tiles.

use super::{Allocation, Level, PendingUpload, TileCache, TileRequest, TileStage};
use crate::tile::{MAX_LEVELS, TileKey};
use terrella_files::clock::Instant;
use terrella_ground::globe::BLOCK_COUNT;

impl TileCache {
    /// Begins a frame with its requests, most urgent first. `reserved_bytes` is the host's memory for loading or waiting tiles.
    ///
    /// Requests for the image come before those that are only expected. Each gets an allocated slot: at the required level, or, if the pool is full
    /// or there is no such tile, at the next coarser level available. A tile that could not be read is skipped likewise; when it is due to be tried
    /// again it is loaded beside its stand-in. Requests for parts come after those for the tiles of whole blocks, which they need.
    pub fn allocate(&mut self, now: Instant, requests: &[TileRequest], reserved_bytes: u64) {
        self.frame += 1;
        self.promises = 0;
        self.counters.requested = [0; MAX_LEVELS];
        (self.counters.hits, self.counters.fallbacks) = (0, 0);
        for pool_state in &mut self.pool_states {
            (pool_state.promised, pool_state.held) = (0, 0);
            pool_state.lacking_drawn = 0;
            pool_state.is_starved = false;
        }
        self.queue.clear();
        self.targets.clear();
        self.stand_ins.clear();
        for drawn in [true, false] {
            let of_kind = |request: &&TileRequest| request.drawn == drawn;
            for request in requests.iter().filter(of_kind) {
                if !self.is_cut(request.key) {
                    self.allocate_one(now, request);
                }
            }
            for request in requests.iter().filter(of_kind) {
                if self.is_cut(request.key) {
                    self.allocate_part(now, request);
                }
            }
        }
        for pool_state in &mut self.pool_states {
            pool_state.available = pool_state.slots.len() as u32 - pool_state.held;
        }
        self.cancel_unrequested();
        self.relieve_memory(reserved_bytes);
        self.sort_pending();
    }

    fn is_cut(&self, key: TileKey) -> bool {
        usize::from(key.level) < self.maps[key.layer.index()].cut
    }

    fn allocate_one(&mut self, now: Instant, request: &TileRequest) {
        let (frame, TileKey { layer, block, .. }) = (self.frame, request.key);
        let levels = self.maps[layer.index()].levels.len() as u8;
        if levels == 0 || u32::from(block) >= BLOCK_COUNT {
            return;
        }
        let coarsest = levels - 1;
        let asked = request.key.level.min(coarsest);
        let at = |level| TileKey::whole(layer, level, block);
        let allocation = layer.index() * BLOCK_COUNT as usize + usize::from(block);
        if request.drawn && self.allocations[allocation].frame == frame {
            return;
        }
        let state = &mut self.tiles[self.places.of(at(asked))];
        if asked < coarsest && state.asked != frame {
            state.asked = frame;
            self.counters.requested[usize::from(asked)] += 1;
        }
        let (mut target, mut goal, mut retry) = (None, None, None);
        for level in asked..coarsest {
            if !self.can_promise(at(level)) {
                continue;
            }
            target.get_or_insert(level);
            match self.tile(at(level)).retry_at {
                None => {
                    goal = Some(level);
                    break;
                }
                Some(due) if due <= now && retry.is_none() => retry = Some(level),
                Some(_) => {}
            }
        }
        for level in [goal, retry].into_iter().flatten() {
            if self.can_promise(at(level)) {
                self.promise(at(level), request.drawn);
            }
        }
        if request.drawn {
            let target = target.unwrap_or(coarsest);
            self.allocations[allocation] = Allocation {
                frame,
                target,
                goal: goal.unwrap_or(coarsest),
            };
            if target < coarsest {
                self.targets.push(at(target));
            }
        }
    }

    /// There is such a tile, and its pool has a slot for it that is not allocated to a more urgent one.
    pub(super) fn can_promise(&self, key: TileKey) -> bool {
        let Some(level) = self.level(key) else {
            return false;
        };
        let Some(pool) = level.pool else { return false };
        let pool_state = &self.pool_states[usize::from(pool)];
        level.present.contains(key.block, key.part)
            && (self.tile(key).is_promised(self.frame)
                || pool_state.promised < pool_state.slots.len() as u32)
    }

    pub(super) fn promise(&mut self, key: TileKey, is_drawn: bool) {
        let Some(pool) = self.pool_of(key) else {
            return;
        };
        let (state, pool_state) = (
            &mut self.tiles[self.places.of(key)],
            &mut self.pool_states[pool],
        );
        if state.is_promised(self.frame) {
            return;
        }
        (state.promised, state.is_drawn, state.rank) = (self.frame, is_drawn, self.promises);
        self.promises += 1;
        pool_state.promised += 1;
        match state.slot() {
            Some(slot) => {
                pool_state.held += 1;
                pool_state.slots[usize::from(slot)].used = self.frame;
            }
            None => pool_state.lacking_drawn += u32::from(is_drawn),
        }
        if state.stage == TileStage::Away {
            self.queue.push(key);
        }
    }

    /// Cancels what is under way and no longer requested.
    fn cancel_unrequested(&mut self) {
        for load in &mut self.pending_loads {
            load.cancel = !self.tiles[self.places.of(load.key)].is_promised(self.frame);
            load.was_cancelled |= load.cancel;
        }
        self.drop_pending(|cache, pending| !cache.tile(pending.key).is_promised(cache.frame));
    }

    /// Sees to it that decoded tiles without a slot do not keep out a load of this frame's picture forever.
    fn relieve_memory(&mut self, reserved_bytes: u64) {
        let Some(head) = self.queue.first().copied() else {
            return;
        };
        let bytes = self.level(head).map_or(0, Level::bytes);
        let lacks_memory = self.tile(head).is_drawn
            && reserved_bytes > 0
            && reserved_bytes.saturating_add(bytes) > self.decoded_limit;
        if !lacks_memory {
            return;
        }
        self.drop_pending(|cache, pending| pending.is_blocked && !cache.tile(pending.key).is_drawn);
        for place in 0..self.pending_uploads.len() {
            let PendingUpload {
                key, is_blocked, ..
            } = self.pending_uploads[place];
            if let (true, Some(pool)) = (is_blocked, self.pool_of(key)) {
                self.pool_states[pool].is_starved = true;
            }
        }
    }

    /// Drops decoded tiles, and empties their slots.
    fn drop_pending(&mut self, drops: impl Fn(&Self, &PendingUpload) -> bool) {
        let mut place = 0;
        while place < self.pending_uploads.len() {
            if !drops(self, &self.pending_uploads[place]) {
                place += 1;
                continue;
            }
            let PendingUpload { key, tile, .. } = self.pending_uploads.swap_remove(place);
            self.retired.push(tile);
            self.counters.cancelled += 1;
            let pool = self.pool_of(key);
            let state = &mut self.tiles[self.places.of(key)];
            if let (Some(slot), Some(pool)) = (state.slot(), pool) {
                self.pool_states[pool].slots[usize::from(slot)].tile = None;
            }
            state.stage = TileStage::Away;
        }
    }
}
