//! A level's samples in one diamond: a square of slots that wraps round, as in the papers of 2004 and 2014.

use super::lattice::LatticeIndex;
use crate::globe::surface::{GroundVertex, Patch};
use glam::DVec3;
use std::ops::Range;

/// Tag of an empty slot.
const NOTHING: [u32; 2] = [u32::MAX; 2];

/// Longest run of unchanged vertices that is sent between two changed ones instead of opening a new range.
const GAP: u32 = 16;

/// Slots of the points of a box, without a division for each point.
pub struct Slots {
    least: (i64, i64),
    rows: [u32; MOST_SIDE],
    columns: [u32; MOST_SIDE],
}

/// Largest number of slots in a row.
const MOST_SIDE: usize = 257;

impl Slots {
    /// Slots of the box from (i, j), at most as wide as a buffer, in buffers with rows of `side` slots.
    pub fn new(least: (i64, i64), side: u32) -> Self {
        let (mut rows, mut columns) = ([0; MOST_SIDE], [0; MOST_SIDE]);
        for k in 0..side {
            rows[k as usize] = (least.0 as u32 + k) % side * side;
            columns[k as usize] = (least.1 as u32 + k) % side;
        }
        Self {
            least,
            rows,
            columns,
        }
    }

    /// The slot of point (i, j).
    pub fn of(&self, i: i64, j: i64) -> usize {
        let (row, column) = (i - self.least.0, j - self.least.1);
        (self.rows[row as usize] + self.columns[column as usize]) as usize
    }
}

/// The samples of a level in one diamond. Point (i, j) is in slot (i mod side, j mod side): samples that stay within the extent keep their
/// slots.
pub struct ToroidalBuffer {
    pub diamond: u8,
    side: u32,
    /// The point whose sample each slot holds.
    tags: Vec<[u32; 2]>,
    /// The level's own samples; [`Patch::vertices`] are the drawn ones.
    own: Vec<GroundVertex>,
    pub patch: Patch,
    /// A bit for each sample whose height has changed since it was read; empty if none has.
    stale: Vec<u64>,
    /// A bit for each vertex that differs from the revision before.
    dirty: Vec<u64>,
    pub is_dirty: bool,
}

impl ToroidalBuffer {
    pub fn new(side: u32, diamond: u8, key: u64, origin_itrf_m: DVec3) -> Self {
        let slots = (side * side) as usize;
        Self {
            diamond,
            side,
            tags: vec![NOTHING; slots],
            own: vec![GroundVertex::default(); slots],
            patch: Patch {
                key,
                revision: 0,
                origin_itrf_m,
                vertices: vec![GroundVertex::default(); slots],
                changed: Vec::with_capacity(side as usize),
                indices: Default::default(),
                block: None,
            },
            stale: Vec::new(),
            dirty: vec![0; slots.div_ceil(64)],
            is_dirty: false,
        }
    }

    /// Reuses the buffer for another diamond and drops its content. `revision` must be later than any published one.
    pub fn retake(&mut self, diamond: u8, key: u64, revision: u64) {
        self.diamond = diamond;
        self.tags.fill(NOTHING);
        self.stale = Vec::new();
        self.patch.key = key;
        self.patch.revision = revision;
        self.dirty.fill(u64::MAX);
        self.is_dirty = true;
    }

    pub fn slot(&self, i: i64, j: i64) -> usize {
        ((i as u32 % self.side) * self.side + j as u32 % self.side) as usize
    }

    /// Slots of a row.
    pub fn side(&self) -> u32 {
        self.side
    }

    /// Whether the slot of point (i, j) holds its sample.
    pub fn has(&self, slot: usize, i: i64, j: i64) -> bool {
        self.tags[slot] == [i as u32, j as u32]
    }

    /// The sample of a point; the buffer must hold it.
    pub fn own(&self, i: i64, j: i64) -> &GroundVertex {
        debug_assert!(
            self.has(self.slot(i, j), i, j),
            "sample {i}, {j} of {} is not here",
            self.diamond
        );
        &self.own[self.slot(i, j)]
    }

    /// The sample of a slot.
    pub fn own_in(&self, slot: usize) -> &GroundVertex {
        &self.own[slot]
    }

    pub fn put(&mut self, index: LatticeIndex, vertex: GroundVertex) {
        let slot = self.slot(index.i, index.j);
        self.tags[slot] = [index.i as u32, index.j as u32];
        self.own[slot] = vertex;
        if let Some(bits) = self.stale.get_mut(slot / 64) {
            *bits &= !(1 << (slot % 64));
        }
    }

    /// Marks held samples as stale, those of the points where `is_changed` returns true.
    pub fn mark_stale(&mut self, mut is_changed: impl FnMut(i64, i64) -> bool) {
        for (slot, tag) in self.tags.iter().enumerate() {
            let [i, j] = tag.map(i64::from);
            if *tag != NOTHING && is_changed(i, j) {
                self.stale.resize(self.dirty.len(), 0);
                self.stale[slot / 64] |= 1 << (slot % 64);
            }
        }
    }

    /// Drops stale samples of the points where `is_meant` returns true; they are read again as new.
    pub fn drop_stale(&mut self, is_meant: impl Fn(i64, i64) -> bool) {
        for word in 0..self.stale.len() {
            let mut left = self.stale[word];
            while left != 0 {
                let slot = word * 64 + left.trailing_zeros() as usize;
                left &= left - 1;
                let [i, j] = self.tags[slot].map(i64::from);
                if self.tags[slot] == NOTHING || is_meant(i, j) {
                    self.tags[slot] = NOTHING;
                    self.stale[word] &= !(1 << (slot % 64));
                }
            }
        }
    }

    /// Passes stale points where `is_meant` returns true to `read`, which stores them again, while the budget lasts.
    pub fn take_stale(
        &mut self,
        is_meant: &impl Fn(i64, i64) -> bool,
        budget: &mut u64,
        read: &mut impl FnMut(&mut Self, i64, i64),
    ) {
        let mut are_any_left = false;
        for word in 0..self.stale.len() {
            let mut left = self.stale[word];
            while left != 0 {
                let slot = word * 64 + left.trailing_zeros() as usize;
                left &= left - 1;
                let [i, j] = self.tags[slot].map(i64::from);
                if self.tags[slot] == NOTHING {
                    // Dropped since then.
                    self.stale[word] &= !(1 << (slot % 64));
                } else if is_meant(i, j) && *budget > 0 {
                    *budget -= 1;
                    read(self, i, j);
                } else {
                    are_any_left = true;
                }
            }
        }
        if !are_any_left && !self.stale.is_empty() {
            self.stale = Vec::new();
        }
    }

    /// Sets a drawn vertex.
    pub fn draw(&mut self, slot: usize, vertex: GroundVertex) {
        // Compare bits, not values: −0 is not 0 here.
        if bytemuck::bytes_of(&self.patch.vertices[slot]) != bytemuck::bytes_of(&vertex) {
            self.patch.vertices[slot] = vertex;
            self.dirty[slot / 64] |= 1 << (slot % 64);
            self.is_dirty = true;
        }
    }

    /// Moves the origin. Sums of origin and offset stay the same to the last bit. Samples farther than `most_m` from it along some axis,
    /// for which they would not, are dropped.
    pub fn rebase(&mut self, origin_itrf_m: DVec3, most_m: f64) {
        let shift = self.patch.origin_itrf_m - origin_itrf_m;
        self.patch.origin_itrf_m = origin_itrf_m;
        for (tag, own) in self.tags.iter_mut().zip(&mut self.own) {
            let moved = own.from_origin_m.as_dvec3() + shift;
            if moved.abs().max_element() > most_m {
                *tag = NOTHING;
            } else {
                own.from_origin_m = moved.as_vec3();
            }
        }
        self.is_dirty = true;
    }

    /// Publishes the changes as the patch's next revision.
    pub fn publish(&mut self) {
        if !std::mem::take(&mut self.is_dirty) {
            return;
        }
        self.patch.changed.clear();
        let mut open: Option<Range<u32>> = None;
        for (word, bits) in self.dirty.iter_mut().enumerate() {
            let mut left = std::mem::take(bits);
            while left != 0 {
                let at = (word * 64) as u32 + left.trailing_zeros();
                left &= left - 1;
                match &mut open {
                    Some(range) if at <= range.end + GAP => range.end = at + 1,
                    _ => self.patch.changed.extend(open.replace(at..at + 1)),
                }
            }
        }
        let slots = self.patch.vertices.len() as u32;
        self.patch.changed.extend(open);
        // Retaken buffers set bits beyond the last slot.
        if let Some(last) = self.patch.changed.last_mut() {
            last.end = last.end.min(slots);
        }
        self.patch.revision += 1;
    }

    pub fn bytes(&self) -> usize {
        self.own.capacity() * size_of::<GroundVertex>()
            + self.patch.vertices.capacity() * size_of::<GroundVertex>()
            + self.tags.capacity() * size_of::<[u32; 2]>()
            + self.dirty.capacity() * 8
            + self.patch.changed.capacity() * size_of::<Range<u32>>()
    }
}
