//! Which cells are cut for a view.

use super::super::hermite::{Corner, cubic, net};
use super::ContourSurface;
use super::lattice::{AROUND, Cell, LEVELS, SEGMENTS, STEP_RAD, ball};
use super::seen::Seen;
use crate::elevation::Elevation;
use glam::DVec3;
use std::cmp::Ordering;

/// What is known of a cell.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Measure {
    /// Largest vertical distance of what is drawn from the data, where probed.
    pub error_m: f32,
    /// Lowest and highest that the ground reaches.
    pub low_m: f32,
    /// See [`Self::low_m`].
    pub high_m: f32,
    /// The highest of the heights it is drawn with, and of the data where probed.
    pub top_m: f32,
    /// A ball that holds it, ITRF metres.
    pub center_m: DVec3,
    /// See [`Self::center_m`].
    pub radius_m: f64,
    /// A quarter of the spacing of the data: finer shows nothing more.
    pub last: bool,
}

/// From this level on the chord of a segment lies less than 6 cm below the arc, however coarse the data.
const ROUND: u8 = 8;

/// A cell that should be cut.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    pixels: f64,
    cell: Cell,
}

impl Ord for Wanted {
    fn cmp(&self, other: &Self) -> Ordering {
        let by_key = || self.cell.key().cmp(&other.cell.key());
        self.pixels.total_cmp(&other.pixels).then_with(by_key)
    }
}

impl PartialOrd for Wanted {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Wanted {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Wanted {}

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

impl ContourSurface {
    pub(super) fn measure(&mut self, ground: &dyn Elevation, cell: Cell) -> Measure {
        let corners: [Corner; 4] =
            std::array::from_fn(|k| self.free(ground, cell.corner(k), cell.level));
        let steps = f64::from(cell.steps());
        let net = net(&corners, steps, steps);
        let mut error_m = 0.0f64;
        let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
        let side = f64::from(SEGMENTS);
        let row = |j: u32| -> [f64; SEGMENTS as usize + 1] {
            let columns = net.map(|column| cubic(column, f64::from(j) / side).0);
            std::array::from_fn(|i| cubic(columns, i as f64 / side).0)
        };
        let [x, y] = cell.vertex(0, 0);
        let (mut south, middle) = (row(0), cell.steps() / SEGMENTS / 2);
        for j in 0..SEGMENTS {
            let north = row(j + 1);
            for i in 0..SEGMENTS as usize {
                // In the middle of a square: what is drawn there is about the mean of its corners.
                let drawn = 0.25 * (south[i] + south[i + 1] + north[i] + north[i + 1]);
                let step = cell.steps() / SEGMENTS;
                let at = (x + i as u32 * step + middle) % AROUND;
                let data = self.height_m(ground, at, y + j * step + middle, 0.0);
                error_m = error_m.max((drawn - data).abs());
                lowest = lowest.min(data.min(drawn));
                highest = highest.max(data.max(drawn));
            }
            south = north;
        }
        let size_rad = steps * STEP_RAD;
        // The chord of a segment below the arc, both ways.
        let arc = size_rad / side;
        error_m += 0.25 * arc * arc * self.options.ellipsoid.equatorial_radius_m;
        let bounds = cell.bounds();
        // Of the data at their finest: at any spacing the mean of the whole Earth would count too.
        let range = ground.range_up_to_m(&bounds, 0.0);
        // What the probes have missed, a single summit, say. Only from a source whose ranges become narrower with the
        // bounds; one that answers the same for all quarters knows no more than that.
        let is_telling = cell.level < LEVELS
            && cell
                .children()
                .iter()
                .any(|c| ground.range_up_to_m(&c.bounds(), 0.0) != range);
        if is_telling {
            error_m = error_m
                .max(range.high_m - highest)
                .max(lowest - range.low_m);
        }
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
        let top = net.iter().flatten().fold(f64::MIN, |top, z| top.max(*z));
        let (low_m, high_m) = (low as f32 - 1.0, high as f32 + 1.0);
        let figure = &self.options.ellipsoid;
        let (center_m, radius_m) = ball(figure, cell, low_m.into(), high_m.into());
        let measure = Measure {
            center_m,
            radius_m,
            error_m: error_m as f32,
            top_m: (top + error_m) as f32 + 1.0,
            low_m,
            high_m,
            last: spacing_rad.is_finite() && size_rad <= 0.25 * spacing_rad && cell.level >= ROUND,
        };
        self.measures.put(cell.key(), self.now, measure);
        measure
    }

    /// What is known of a cell, or else of the nearest one above it, with its own ball.
    pub(super) fn known(&mut self, cell: Cell) -> Measure {
        let mut above = cell;
        let nothing = Measure {
            low_m: -12_000.0,
            high_m: 9_000.0,
            top_m: 9_000.0,
            ..Measure::default()
        };
        let found = loop {
            if let Some(measure) = self.measures.get(above.key(), self.now) {
                break measure;
            }
            if above.level == 0 {
                break nothing;
            }
            above = above.parent();
        };
        if above == cell && found.radius_m > 0.0 {
            return found;
        }
        let (low, high) = (f64::from(found.low_m), f64::from(found.high_m));
        let (center_m, radius_m) = ball(&self.options.ellipsoid, cell, low, high);
        Measure {
            center_m,
            radius_m,
            ..found
        }
    }

    pub(super) fn is_cut(&self, cell: Cell) -> bool {
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

    /// Chooses the cells to cut, those of the largest errors in pixels first, and measures new ones within the budget.
    pub(super) fn choose(&mut self, view: &Seen, ground: &dyn Elevation) {
        self.inner.clear();
        self.wanted.clear();
        self.queue.clear();
        let mut budget = self.options.measured_per_frame;
        for root in Cell::roots() {
            // Blocks are known from the first frame on.
            budget += u32::from(self.measures.get(root.key(), self.now).is_none());
            self.want(view, ground, root, &mut budget);
        }
        while let Some(Wanted { cell, .. }) = self.wanted.pop() {
            if self.inner.len() >= self.options.most_cuts as usize || !self.inner.set(cell.key(), 0)
            {
                break;
            }
            self.queue.push(cell);
            for child in cell.children() {
                self.want(view, ground, child, &mut budget);
            }
        }
        self.balance();
    }

    /// Puts a cell among those to cut if its error shows.
    fn want(&mut self, view: &Seen, ground: &dyn Elevation, cell: Cell, budget: &mut u32) {
        let measure = match self.measures.get(cell.key(), self.now) {
            Some(measure) => measure,
            None => {
                // Not seen with what is known from above: not worth measuring.
                let above = self.known(cell);
                if *budget == 0 || view.distance_m(self, &above).is_none() {
                    return;
                }
                *budget -= 1;
                self.measure(ground, cell)
            }
        };
        let Some(distance_m) = view.distance_m(self, &measure) else {
            return;
        };
        let pixels = f64::from(measure.error_m) / (distance_m * view.pixel_rad);
        let is_deepest = measure.last || u32::from(cell.level) >= self.options.deepest;
        if pixels > view.tolerance_px && !is_deepest {
            self.wanted.push(Wanted { pixels, cell });
        }
    }

    /// Cuts more cells until neighbours differ by one level at most.
    fn balance(&mut self) {
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
}
