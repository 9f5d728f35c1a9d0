//! What is wanted, fitted to the pools.

use super::{Fitted, Level, Stage, TileCache, Waiting, Want, place_of};
use crate::globe::BLOCK_COUNT;
use crate::imagery::tile::{MAX_LEVELS, TileKey};
use std::time::Instant;

impl TileCache {
    /// Begins a frame with what is wanted, most urgent first. `reserved_bytes` is what the host counts for tiles that
    /// are under way or waiting.
    ///
    /// Wants for the picture come before those that are only expected. Each is promised a slot: at the level asked for,
    /// or, where the pool is promised to others or there is no such tile, at the next coarser one that can be had. A tile
    /// that could not be read is passed over likewise; when it is due to be tried again it is loaded beside its stand-in.
    pub fn fit(&mut self, now: Instant, wants: &[Want], reserved_bytes: u64) {
        self.frame += 1;
        self.promises = 0;
        self.counters.wanted = [0; MAX_LEVELS];
        (self.counters.hits, self.counters.fallbacks) = (0, 0);
        for room in &mut self.rooms {
            (room.promised, room.held, room.lacking_drawn) = (0, 0, 0);
            room.is_pressed = false;
        }
        self.queue.clear();
        self.targets.clear();
        for drawn in [true, false] {
            for want in wants.iter().filter(|want| want.drawn == drawn) {
                self.fit_one(now, want);
            }
        }
        for room in &mut self.rooms {
            room.loose = room.places.len() as u32 - room.held;
        }
        self.let_go();
        self.relieve(reserved_bytes);
        self.sort_waiting();
    }

    fn fit_one(&mut self, now: Instant, want: &Want) {
        let (frame, TileKey { layer, block, .. }) = (self.frame, want.key);
        let levels = self.maps[layer.index()].levels.len() as u8;
        if levels == 0 || u32::from(block) >= BLOCK_COUNT {
            return;
        }
        let coarsest = levels - 1;
        let asked = want.key.level.min(coarsest);
        let at = |level| TileKey {
            layer,
            level,
            block,
        };
        let fitted = layer.index() * BLOCK_COUNT as usize + usize::from(block);
        if want.drawn && self.fitted[fitted].frame == frame {
            return;
        }
        let state = &mut self.tiles[place_of(at(asked))];
        if asked < coarsest && state.asked != frame {
            state.asked = frame;
            self.counters.wanted[usize::from(asked)] += 1;
        }
        let (mut target, mut goal, mut retry) = (None, None, None);
        for level in asked..coarsest {
            if !self.has_room(at(level)) {
                continue;
            }
            target.get_or_insert(level);
            match self.tiles[place_of(at(level))].retry_at {
                None => {
                    goal = Some(level);
                    break;
                }
                Some(due) if due <= now && retry.is_none() => retry = Some(level),
                Some(_) => {}
            }
        }
        for level in [goal, retry].into_iter().flatten() {
            if self.has_room(at(level)) {
                self.promise(at(level), want.drawn);
            }
        }
        if want.drawn {
            let target = target.unwrap_or(coarsest);
            self.fitted[fitted] = Fitted {
                frame,
                target,
                goal: goal.unwrap_or(coarsest),
            };
            if target < coarsest {
                self.targets.push(at(target));
            }
        }
    }

    /// There is such a tile, and its pool has a slot for it that is not promised to a more urgent one.
    fn has_room(&self, key: TileKey) -> bool {
        let Some(level) = self.level(key) else {
            return false;
        };
        let Some(pool) = level.pool else { return false };
        let room = &self.rooms[usize::from(pool)];
        level.present.contains(key.block)
            && (self.tiles[place_of(key)].is_promised(self.frame)
                || room.promised < room.places.len() as u32)
    }

    fn promise(&mut self, key: TileKey, is_drawn: bool) {
        let Some(pool) = self.pool_of(key) else {
            return;
        };
        let (state, room) = (&mut self.tiles[place_of(key)], &mut self.rooms[pool]);
        if state.is_promised(self.frame) {
            return;
        }
        (state.promised, state.is_drawn, state.rank) = (self.frame, is_drawn, self.promises);
        self.promises += 1;
        room.promised += 1;
        match state.slot() {
            Some(slot) => {
                room.held += 1;
                room.places[usize::from(slot)].used = self.frame;
            }
            None => room.lacking_drawn += u32::from(is_drawn),
        }
        if state.stage == Stage::Away {
            self.queue.push(key);
        }
    }

    /// Lets go of what is under way and no longer wanted.
    fn let_go(&mut self) {
        for flight in &mut self.flights {
            flight.cancel = !self.tiles[place_of(flight.key)].is_promised(self.frame);
            flight.was_cancelled |= flight.cancel;
        }
        self.drop_waiting(|cache, waiting| {
            !cache.tiles[place_of(waiting.key)].is_promised(cache.frame)
        });
    }

    /// Sees to it that decoded tiles without a slot do not keep out a load of this frame's picture for ever.
    fn relieve(&mut self, reserved_bytes: u64) {
        let Some(head) = self.queue.first().copied() else {
            return;
        };
        let bytes = self.level(head).map_or(0, Level::bytes);
        let is_starved = self.tiles[place_of(head)].is_drawn
            && reserved_bytes > 0
            && reserved_bytes.saturating_add(bytes) > self.decoded_limit;
        if !is_starved {
            return;
        }
        self.drop_waiting(|cache, waiting| {
            waiting.is_blocked && !cache.tiles[place_of(waiting.key)].is_drawn
        });
        for place in 0..self.waiting.len() {
            let Waiting {
                key, is_blocked, ..
            } = self.waiting[place];
            if let (true, Some(pool)) = (is_blocked, self.pool_of(key)) {
                self.rooms[pool].is_pressed = true;
            }
        }
    }

    /// Drops decoded tiles, and empties their slots.
    fn drop_waiting(&mut self, drops: impl Fn(&Self, &Waiting) -> bool) {
        let mut place = 0;
        while place < self.waiting.len() {
            if !drops(self, &self.waiting[place]) {
                place += 1;
                continue;
            }
            let Waiting { key, tile, .. } = self.waiting.swap_remove(place);
            self.spent.push(tile);
            self.counters.cancelled += 1;
            let pool = self.pool_of(key);
            let state = &mut self.tiles[place_of(key)];
            if let (Some(slot), Some(pool)) = (state.slot(), pool) {
                self.rooms[pool].places[usize::from(slot)].tile = None;
            }
            state.stage = Stage::Away;
        }
    }
}
