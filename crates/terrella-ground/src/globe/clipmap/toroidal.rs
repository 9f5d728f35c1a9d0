//! A level's samples in one diamond: a square of slots that wraps round, as in the papers of 2004 and 2014.

use super::lattice::LatticeIndex;
use crate::globe::surface::{GroundVertex, Patch};
use glam::DVec3;
use std::ops::Range;

/// Of a slot that holds nothing.
const NOTHING: [u32; 2] = [u32::MAX; 2];

/// Unchanged vertices that are sent along between two changed ones sooner than open a new range.
const GAP: u32 = 16;

/// Slots of the points of a box, without a division each.
pub struct Slots {
    least: (i64, i64),
    rows: [u32; MOST_SIDE],
    columns: [u32; MOST_SIDE],
}

/// Slots of a row at most.
const MOST_SIDE: usize = 257;

impl Slots {
    /// Those of the box from (i, j), as wide as a buffer at most, in buffers with rows of `side` slots.
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

/// The samples of a level that lie in one diamond. Point (i, j) lives in slot (i mod side, j mod side): what stays within
/// reach stays where it is.
pub struct ToroidalBuffer {
    pub diamond: u8,
    side: u32,
    /// Whose sample each slot holds.
    tags: Vec<[u32; 2]>,
    /// The samples as they are; [`Patch::vertices`] are those as they are drawn.
    own: Vec<GroundVertex>,
    pub patch: Patch,
    /// A bit for each sample whose height has changed since it was read; empty where none has.
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

    /// Takes the buffer for another diamond; all it held is gone. `revision` must be later than any that went out.
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

    /// Whether a slot, that of point (i, j), holds its sample.
    pub fn has(&self, slot: usize, i: i64, j: i64) -> bool {
        self.tags[slot] == [i as u32, j as u32]
    }

    /// The sample of a point that is held.
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

    /// Notes that heights of samples have changed, those of the points that `is_changed`.
    pub fn mark_stale(&mut self, mut is_changed: impl FnMut(i64, i64) -> bool) {
        for (slot, tag) in self.tags.iter().enumerate() {
            let [i, j] = tag.map(i64::from);
            if *tag != NOTHING && is_changed(i, j) {
                self.stale.resize(self.dirty.len(), 0);
                self.stale[slot / 64] |= 1 << (slot % 64);
            }
        }
    }

    /// Drops samples whose heights have changed, of the points that `is_meant`: they are read as if they had never been held.
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

    /// Gives points to `read`, which puts them again, whose heights have changed and that `is_meant`, while there is budget.
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
                    // Lost since then.
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

    /// Sets how a vertex is drawn.
    pub fn draw(&mut self, slot: usize, vertex: GroundVertex) {
        // Bits and not values: −0 is not 0 here.
        if bytemuck::bytes_of(&self.patch.vertices[slot]) != bytemuck::bytes_of(&vertex) {
            self.patch.vertices[slot] = vertex;
            self.dirty[slot / 64] |= 1 << (slot % 64);
            self.is_dirty = true;
        }
    }

    /// Moves the origin. Sums of origin and offset stay the same to the last bit; samples for which they would not, because
    /// they lie farther than `most_m` from it along some axis, are dropped.
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

    /// Makes what changed the patch's next revision.
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
