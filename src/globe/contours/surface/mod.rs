//! The whole Earth as q-Bézier patches: a forest over the blocks of 22.5°, chosen by the view.
//!
//! Each block is a quadtree; a cell is one bicubic patch of heights over longitude and latitude, lifted along the normal of
//! the ellipsoid. Its corners are heights and derivatives of the ground at its own scale, so that neighbours share them;
//! where a neighbour is coarser they are what the coarser edge says ([`restrict`]): the ground joins with one height and one
//! tangent plane across every edge, in each frame's own choice of levels. Neighbours, diagonal ones too, differ by one level
//! at most.
//!
//! Per frame: choose which cells to cut, coarse ones first, by the error measured when a cell was first looked at; cut more
//! until the levels are balanced; draw those that are seen. New cells are measured within a budget, so a jump of the eye
//! becomes sharp over some frames and never waits. Vertices are written anew only where what they follow from has changed.

mod lattice;
mod mesh;
mod tables;
#[cfg(test)]
mod tests;

use super::hermite::{Corner, estimate, evaluate, net, restrict};
use crate::elevation::Elevation;
use crate::frames::Ellipsoid;
use crate::globe::{GroundView, Indices, Patch, Surface, SurfaceStats};
use glam::{DVec3, DVec4};
use lattice::{AROUND, Cell, LEVELS, SEGMENTS, STEP_RAD, TALL, ball, lat_rad, lon_rad};
use mesh::Shape;
use std::sync::Arc;
use tables::{Cache, Keys};

/// How much the surface may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContourOptions {
    /// The figure.
    pub ellipsoid: Ellipsoid,
    /// Most cells that are cut for a view; patches are up to three times as many, and balancing adds to them. 16…1700.
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
            most_cuts: 500,
            measured_per_frame: 24,
            deepest: u32::from(LEVELS),
        }
    }
}

/// What is known of a cell.
#[derive(Clone, Copy, Debug, Default)]
struct Measure {
    error_m: f32,
    low_m: f32,
    high_m: f32,
    /// As fine as the data.
    last: bool,
}

/// Samples each way that a cell is measured at.
const PROBES: u32 = 8;
/// From this level on the chord of a segment lies less than 6 cm below the arc, however coarse the data.
const ROUND: u8 = 7;
/// Below any ground: what the horizon is reckoned with.
const DEPTH_M: f64 = 12_000.0;

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
    /// An empty surface. Tables take 10 MB, patches 8 kB each.
    pub fn new(options: ContourOptions) -> Self {
        let options = ContourOptions {
            most_cuts: options.most_cuts.clamp(16, 1_700),
            deepest: options.deepest.min(u32::from(LEVELS)),
            ..options
        };
        Self {
            options,
            now: 0,
            clock: 0,
            measures: Cache::new(14),
            corners: Cache::new(16),
            inner: Keys::new(15),
            settled: Keys::new(16),
            settled_corners: Vec::new(),
            queue: Vec::new(),
            leaves: Vec::new(),
            slots: Vec::new(),
            by_key: Keys::new(14),
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

    fn measure(&mut self, ground: &dyn Elevation, cell: Cell) -> Measure {
        let corners: [Corner; 4] =
            std::array::from_fn(|k| self.free(ground, cell.corner(k), cell.level));
        let steps = f64::from(cell.steps());
        let net = net(&corners, steps, steps);
        let segment = 1.0 / f64::from(SEGMENTS);
        let mut error_m = 0.0f64;
        for j in 0..PROBES {
            for i in 0..PROBES {
                // In the middle of every other square: what is drawn there is about the mean of its corners.
                let (u, v) = (
                    f64::from(2 * i) * segment,
                    f64::from(2 * j + (i & 1)) * segment,
                );
                let mut drawn = 0.0;
                for (du, dv) in [
                    (0.0, 0.0),
                    (segment, 0.0),
                    (0.0, segment),
                    (segment, segment),
                ] {
                    drawn += 0.25 * evaluate(&net, u + du, v + dv)[0];
                }
                let [x, y] = cell.vertex(0, 0);
                let to = |t: f64| ((t + 0.5 * segment) * steps) as u32;
                let data = self.height_m(ground, (x + to(u)) % AROUND, y + to(v), 0.0);
                error_m = error_m.max((drawn - data).abs());
            }
        }
        let size_rad = steps * STEP_RAD;
        // The chord of a segment below the arc, both ways.
        let arc = size_rad * segment;
        error_m += 0.25 * arc * arc * self.options.ellipsoid.equatorial_radius_m;
        let bounds = cell.bounds();
        let range = ground.range_m(&bounds);
        let (lat, lon) = (
            0.5 * (bounds.south_rad + bounds.north_rad),
            bounds.west_rad + 0.5 * size_rad,
        );
        let spacing_rad = ground.finest_spacing_rad(lat, lon);
        // Cubics may leave the range of their data: by no more than their Bézier heights do.
        let (low, high) = net
            .iter()
            .flatten()
            .fold((range.low_m, range.high_m), |(low, high), z| {
                (low.min(*z), high.max(*z))
            });
        let measure = Measure {
            error_m: error_m as f32,
            low_m: low as f32 - 1.0,
            high_m: high as f32 + 1.0,
            last: spacing_rad.is_finite() && size_rad <= spacing_rad && cell.level >= ROUND,
        };
        self.measures.put(cell.key(), self.now, measure);
        measure
    }

    /// What is known of a cell, or else of the nearest one above it.
    fn known(&mut self, mut cell: Cell) -> Measure {
        loop {
            if let Some(measure) = self.measures.get(cell.key(), self.now) {
                return measure;
            }
            if cell.level == 0 {
                return Measure {
                    error_m: 0.0,
                    low_m: -12_000.0,
                    high_m: 9_000.0,
                    last: true,
                };
            }
            cell = cell.parent();
        }
    }

    fn is_cut(&self, cell: Cell) -> bool {
        self.inner.get(cell.key()).is_some()
    }

    /// Marks a cell and all above it as cut; false if there is no room.
    fn cut(&mut self, mut cell: Cell) -> bool {
        while !self.is_cut(cell) {
            if !self.inner.set(cell.key(), 0) {
                return false;
            }
            self.queue.push(cell);
            if cell.level == 0 {
                break;
            }
            cell = cell.parent();
        }
        true
    }

    /// Chooses the cells to cut, and measures new ones within the budget.
    fn choose(&mut self, view: &Seen, ground: &dyn Elevation) {
        self.inner.clear();
        self.queue.clear();
        // Blocks are known from the first frame on.
        let mut budget = self.options.measured_per_frame;
        self.queue.extend(Cell::roots());
        let mut next = 0;
        while next < self.queue.len() {
            let cell = self.queue[next];
            next += 1;
            let known = self.measures.get(cell.key(), self.now);
            let measure = match known {
                Some(measure) => measure,
                None if cell.level == 0 => self.measure(ground, cell),
                None => {
                    // Not seen with what is known from above: not worth measuring.
                    let above = self.known(cell);
                    if budget == 0 || view.distance_m(self, cell, &above).is_none() {
                        continue;
                    }
                    budget -= 1;
                    self.measure(ground, cell)
                }
            };
            let Some(distance_m) = view.distance_m(self, cell, &measure) else {
                continue;
            };
            let pixels = f64::from(measure.error_m) / (distance_m * view.pixel_rad);
            if pixels > view.tolerance_px
                && !measure.last
                && u32::from(cell.level) < self.options.deepest
                && self.inner.len() < self.options.most_cuts as usize
                && self.inner.set(cell.key(), 0)
            {
                self.queue.extend(cell.children());
            }
        }
        self.balance();
    }

    /// Cuts more cells until neighbours differ by one level at most.
    fn balance(&mut self) {
        let mut cut = std::mem::take(&mut self.queue);
        cut.retain(|cell| self.is_cut(*cell));
        self.queue = cut;
        let mut next = 0;
        while next < self.queue.len() {
            let cell = self.queue[next];
            next += 1;
            for (dx, dy) in AROUND_A_CELL {
                if let Some(beside) = cell.beside(dx, dy)
                    && beside.level > 0
                    && !self.cut(beside.parent())
                {
                    // Beyond what the tables hold: the blocks as they are, which is always whole.
                    self.inner.clear();
                    return;
                }
            }
        }
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

const AROUND_A_CELL: [(i32, i32); 8] = [
    (-1, -1),
    (0, -1),
    (1, -1),
    (-1, 0),
    (1, 0),
    (-1, 1),
    (0, 1),
    (1, 1),
];

/// What a view sees.
struct Seen {
    eye_m: DVec3,
    sides: [DVec4; 4],
    pixel_rad: f64,
    tolerance_px: f64,
    ellipsoid: Ellipsoid,
}

impl Seen {
    fn new(view: &GroundView, ellipsoid: Ellipsoid) -> Self {
        let rows = view.clip_from_eye.transpose();
        Self {
            eye_m: view.eye_itrf_m,
            sides: [
                rows.w_axis + rows.x_axis,
                rows.w_axis - rows.x_axis,
                rows.w_axis + rows.y_axis,
                rows.w_axis - rows.y_axis,
            ],
            pixel_rad: view.pixel_rad.max(1e-9),
            tolerance_px: view.tolerance_px.max(0.0),
            ellipsoid,
        }
    }

    /// Distance to the nearest of a cell, at least 1 m; none if it is certainly not seen.
    fn distance_m(&self, surface: &ContourSurface, cell: Cell, measure: &Measure) -> Option<f64> {
        let (low, high) = (f64::from(measure.low_m), f64::from(measure.high_m));
        let (center, radius) = ball(&self.ellipsoid, cell, low, high);
        let from_eye = center - self.eye_m;
        let distance = (from_eye.length() - radius).max(1.0);
        #[cfg(test)]
        if !surface.cull {
            return Some(distance);
        }
        #[cfg(not(test))]
        let _ = surface;
        let beside = self.sides.iter().any(|side| {
            let n = side.truncate();
            n.dot(from_eye) + side.w < -radius * n.length()
        });
        // Below the horizon of a sphere that lies inside all ground: both tangents add up.
        let inside = self.ellipsoid.polar_radius_m - DEPTH_M;
        let eye = self.eye_m.length();
        let far = center.length();
        let hidden = eye > inside && far > radius && {
            let top = (self.ellipsoid.equatorial_radius_m + high).max(inside);
            let reach = (inside / eye).acos() + (inside / top).acos();
            let apart = self.eye_m.angle_between(center);
            apart - (radius / far).min(1.0).asin() > reach
        };
        (!beside && !hidden).then_some(distance)
    }
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
            let Some(distance_m) = seen.distance_m(self, cell, &measure) else {
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
