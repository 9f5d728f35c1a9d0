//! The whole Earth as q-Bézier patches: a forest over the blocks of 22.5°, chosen by the view.
//!
//! Each block is a quadtree; a cell is one bicubic patch of heights over longitude and latitude, lifted along the normal of
//! the ellipsoid. Its corners are heights and derivatives of the ground at its own scale, so that neighbours share them;
//! where a neighbour is coarser they are what the coarser edge says ([`restrict`]): the ground joins with one height and one
//! tangent plane across every edge, in each frame's own choice of levels. Neighbours, diagonal ones too, differ by one level
//! at most.
//!
//! Per frame: choose which cells to cut, largest errors in pixels first, as measured when a cell was first looked at; cut more
//! until the levels are balanced; draw those that are seen. New cells are measured within a budget, so a jump of the eye
//! becomes sharp over some frames and never waits. Vertices are written anew only where what they follow from has changed.

mod choose;
pub(super) mod lattice;
mod mesh;
mod seen;
pub(super) mod tables;
#[cfg(test)]
mod tests;

use super::hermite::{Corner, estimate, restrict};
use crate::elevation::Elevation;
use crate::frames::Ellipsoid;
use crate::globe::{GroundView, Indices, Patch, Surface, SurfaceStats};
use choose::{Measure, Wanted};
use glam::DVec3;
use lattice::{AROUND, Cell, LEVELS, STEP_RAD, TALL, lat_rad, lon_rad};
use mesh::Shape;
use seen::Seen;
use std::collections::BinaryHeap;
use std::sync::Arc;
use tables::{Cache, Keys};

/// How much the surface may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContourOptions {
    /// The figure.
    pub ellipsoid: Ellipsoid,
    /// Most cells that are cut for a view; patches are up to three times as many, and balancing adds to them. 16…900.
    pub most_cuts: u32,
    /// Cells that are measured anew in a frame.
    pub measured_per_frame: u32,
    /// Deepest level, 0…20; more counts as 20, where cells are 2.4 m wide.
    pub deepest: u32,
}

impl Default for ContourOptions {
    fn default() -> Self {
        Self {
            ellipsoid: Ellipsoid::WGS84,
            most_cuts: 450,
            measured_per_frame: 12,
            deepest: u32::from(LEVELS),
        }
    }
}

struct Slot {
    used: u64,
    shape: Shape,
    patch: Patch,
}

/// Contours as drawn ground.
pub struct ContourSurface {
    options: ContourOptions,
    now: u64,
    clock: u64,
    measures: Cache<Measure>,
    corners: Cache<Corner>,
    /// Cells that are cut.
    inner: Keys,
    /// This frame's corners by place.
    settled: Keys,
    settled_corners: Vec<Corner>,
    /// Cells still to be cut, largest errors first.
    wanted: BinaryHeap<Wanted>,
    queue: Vec<Cell>,
    leaves: Vec<(f64, Cell)>,
    slots: Vec<Slot>,
    by_key: Keys,
    drawn: Vec<u32>,
    indices: [Arc<Indices>; 16],
    samples: u64,
    #[cfg(test)]
    cull: bool,
}

impl ContourSurface {
    /// An empty surface. Tables take 7 MB and a patch 3 kB. Cuts are bounded whatever balancing adds, and so are patches and
    /// memory: 80 MB at most, 12 MB on a descent from 400 km to 2 km with the default options.
    pub fn new(options: ContourOptions) -> Self {
        let options = ContourOptions {
            most_cuts: options.most_cuts.clamp(16, 900),
            deepest: options.deepest.min(u32::from(LEVELS)),
            ..options
        };
        Self {
            options,
            now: 0,
            clock: 0,
            measures: Cache::new(14),
            corners: Cache::new(16),
            inner: Keys::new(14),
            settled: Keys::new(16),
            settled_corners: Vec::new(),
            wanted: BinaryHeap::new(),
            queue: Vec::new(),
            leaves: Vec::new(),
            slots: Vec::new(),
            by_key: Keys::new(15),
            drawn: Vec::new(),
            indices: mesh::indices(),
            samples: 0,
            #[cfg(test)]
            cull: true,
        }
    }

    /// Height of a lattice place, longitudes of any turn, latitudes to the poles.
    fn height_m(&mut self, ground: &dyn Elevation, x: u32, y: u32, spacing_rad: f64) -> f64 {
        self.samples += 1;
        ground.height_m(lat_rad(y), lon_rad(x), spacing_rad)
    }

    /// A corner that no coarser edge binds, for cells of a level.
    fn free(&mut self, ground: &dyn Elevation, [x, y]: [u32; 2], level: u8) -> Corner {
        let key = u64::from(level) << 56 | u64::from(y) << 28 | u64::from(x % AROUND);
        if let Some(corner) = self.corners.get(key, self.now) {
            return corner;
        }
        let root = Cell { level, x: 0, y: 0 };
        let steps = root.steps();
        let spacing_rad = 0.25 * f64::from(steps) * STEP_RAD;
        let ys = [y.saturating_sub(steps), y, (y + steps).min(TALL)];
        let xs = [(x + AROUND - steps) % AROUND, x, (x + steps) % AROUND];
        let mut heights = [[0.0; 3]; 3];
        for (row, y) in heights.iter_mut().zip(ys) {
            for (height, x) in row.iter_mut().zip(xs) {
                *height = self.height_m(ground, x, y, spacing_rad);
            }
        }
        let step = f64::from(steps);
        let south_north = [f64::from(y - ys[0]), f64::from(ys[2] - y)];
        let mut corner = estimate(&heights, [step; 2], south_north);
        if y == 0 || y == TALL {
            // One place for all longitudes.
            corner = [corner[0], 0.0, corner[2], 0.0];
        }
        self.corners.put(key, self.now, corner);
        corner
    }

    fn rank(&self, cell: Option<Cell>) -> Rank {
        match cell {
            Some(cell) if cell.level > 0 && !self.is_cut(cell.parent()) => Rank::Coarser,
            Some(cell) if self.is_cut(cell) => Rank::Finer,
            Some(_) => Rank::Equal,
            None => Rank::Equal,
        }
    }

    /// What corner `k` of a leaf is this frame.
    fn corner(&mut self, ground: &dyn Elevation, cell: Cell, k: usize) -> Corner {
        let place = cell.corner(k);
        let key = u64::from(place[1]) << 28 | u64::from(place[0]);
        if let Some(index) = self.settled.get(key) {
            return self.settled_corners[index as usize];
        }
        let (ix, iy) = (k as u32 & 1, k as u32 >> 1);
        let (dx, dy) = (2 * ix as i32 - 1, 2 * iy as i32 - 1);
        let (a, b) = (cell.beside(dx, 0), cell.beside(0, dy));
        let (rank_a, rank_b) = (self.rank(a), self.rank(b));
        let odd_x = (cell.x + ix) & 1 == 1;
        let odd_y = (cell.y + iy) & 1 == 1;
        let corner = match (a, b) {
            (Some(a), _) if rank_a == Rank::Coarser && odd_y => {
                let [from, to] = if dx > 0 { [0, 2] } else { [1, 3] };
                self.middle(ground, a.parent(), from, to, false)
            }
            (_, Some(b)) if rank_b == Rank::Coarser && odd_x => {
                let [from, to] = if dy > 0 { [0, 1] } else { [2, 3] };
                self.middle(ground, b.parent(), from, to, true)
            }
            _ => {
                let finer = [rank_a, rank_b, self.rank(cell.beside(dx, dy))].contains(&Rank::Finer);
                self.free(ground, place, cell.level + u8::from(finer))
            }
        };
        if self.settled.set(key, self.settled_corners.len() as u32) {
            self.settled_corners.push(corner);
        }
        corner
    }

    fn middle(
        &mut self,
        ground: &dyn Elevation,
        of: Cell,
        a: usize,
        b: usize,
        along_u: bool,
    ) -> Corner {
        let (a, b) = (self.corner(ground, of, a), self.corner(ground, of, b));
        restrict(&a, &b, f64::from(of.steps()), 0.5, along_u)
    }

    fn shape(&mut self, ground: &dyn Elevation, cell: Cell) -> Shape {
        let corners = std::array::from_fn(|k| self.corner(ground, cell, k));
        let mut shape = Shape {
            corners,
            ..Shape::default()
        };
        // West, east, south, north: the facing corners of the neighbour.
        let sides = [
            ((-1, 0), [1, 3]),
            ((1, 0), [0, 2]),
            ((0, -1), [2, 3]),
            ((0, 1), [0, 1]),
        ];
        for (side, ((dx, dy), [a, b])) in sides.into_iter().enumerate() {
            let beside = cell.beside(dx, dy);
            if self.rank(beside) == Rank::Coarser
                && let Some(beside) = beside
            {
                let of = beside.parent();
                let ends = [self.corner(ground, of, a), self.corner(ground, of, b)];
                shape.coarse[side] = Some(ends);
            }
        }
        for (k, touched) in shape.touched.iter_mut().enumerate() {
            let (dx, dy) = (2 * (k as i32 & 1) - 1, 2 * (k as i32 >> 1) - 1);
            *touched = [(dx, 0), (0, dy), (dx, dy)]
                .into_iter()
                .any(|(dx, dy)| self.rank(cell.beside(dx, dy)) == Rank::Coarser);
        }
        shape
    }

    /// The slot of a cell, new or as it was.
    fn slot(&mut self, cell: Cell) -> usize {
        if let Some(slot) = self.by_key.get(cell.key()) {
            return slot as usize;
        }
        // What was not drawn for longest, except for a reserve that saves building it again.
        let spare = self.slots.len().saturating_sub(self.leaves.len()) > RESERVE;
        let oldest = (0..self.slots.len())
            .filter(|k| spare && self.slots[*k].used < self.now)
            .min_by_key(|k| self.slots[*k].used);
        let patch = Patch {
            key: cell.key(),
            revision: 0,
            origin_itrf_m: DVec3::ZERO,
            vertices: Vec::new(),
            changed: Vec::new(),
            indices: self.indices[0].clone(),
            block: None,
        };
        let nothing = Shape {
            corners: [[f64::NAN; 4]; 4],
            ..Shape::default()
        };
        if let Some(slot) = oldest {
            let vertices = std::mem::take(&mut self.slots[slot].patch.vertices);
            let changed = std::mem::take(&mut self.slots[slot].patch.changed);
            self.slots[slot].shape = nothing;
            self.slots[slot].patch = Patch {
                vertices,
                changed,
                ..patch
            };
            return slot;
        }
        self.slots.push(Slot {
            used: 0,
            shape: nothing,
            patch,
        });
        self.slots.len() - 1
    }
}

/// Slots kept beyond those drawn.
const RESERVE: usize = 256;

/// A neighbour's level against a cell's own.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Rank {
    Coarser,
    Equal,
    Finer,
}

impl Surface for ContourSurface {
    fn name(&self) -> &'static str {
        "contours"
    }

    fn prepare(&mut self, view: &GroundView, ground: &dyn Elevation) -> SurfaceStats {
        self.now += 1;
        self.samples = 0;
        let seen = Seen::new(view, self.options.ellipsoid);
        self.choose(&seen, ground);
        self.settled.clear();
        self.settled_corners.clear();
        self.leaves.clear();
        self.queue.clear();
        self.queue.extend(Cell::roots());
        let mut stats = SurfaceStats::default();
        let (mut error_m, mut error_px) = (0.0f64, 0.0f64);
        while let Some(cell) = self.queue.pop() {
            let measure = self.known(cell);
            let Some(distance_m) = seen.distance_m(self, &measure) else {
                continue;
            };
            if self.is_cut(cell) {
                self.queue.extend(cell.children());
                continue;
            }
            self.leaves.push((distance_m, cell));
            error_m = error_m.max(f64::from(measure.error_m));
            error_px = error_px.max(f64::from(measure.error_m) / (distance_m * seen.pixel_rad));
        }
        self.leaves
            .sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.key().cmp(&b.1.key())));
        // Those there already first, so that none of them makes way.
        for k in 0..self.leaves.len() {
            if let Some(slot) = self.by_key.get(self.leaves[k].1.key()) {
                self.slots[slot as usize].used = self.now;
            }
        }
        self.drawn.clear();
        for k in 0..self.leaves.len() {
            let cell = self.leaves[k].1;
            let shape = self.shape(ground, cell);
            let slot = self.slot(cell);
            let Slot {
                used,
                shape: was,
                patch,
            } = &mut self.slots[slot];
            *used = self.now;
            if *was != shape {
                *was = shape;
                self.clock += 1;
                patch.revision = self.clock;
                patch.indices = self.indices[shape.mask()].clone();
                mesh::write(&self.options.ellipsoid, cell, &shape, patch);
            }
            stats.patches += 1;
            stats.vertices += patch.vertices.len() as u32;
            stats.triangles += patch.indices.triangles.len() as u32 / 3;
            self.drawn.push(slot as u32);
        }
        self.by_key.clear();
        for (k, slot) in self.slots.iter().enumerate() {
            // Without room a patch is only built again.
            let _ = self.by_key.set(slot.patch.key, k as u32);
        }
        stats.samples_read = self.samples;
        let a_slot = size_of::<Slot>() + mesh::VERTICES * size_of::<crate::globe::GroundVertex>();
        stats.resident_bytes = self.measures.bytes()
            + self.corners.bytes()
            + self.inner.bytes()
            + self.settled.bytes()
            + self.by_key.bytes()
            + (self.slots.len() * a_slot) as u64
            + self
                .indices
                .iter()
                .map(|i| 4 * i.triangles.len() as u64)
                .sum::<u64>();
        stats.error_m = Some(error_m);
        stats.error_px = Some(error_px);
        stats
    }

    fn visit(&self, draw: &mut dyn FnMut(&Patch)) {
        for slot in &self.drawn {
            draw(&self.slots[*slot as usize].patch);
        }
    }
}
