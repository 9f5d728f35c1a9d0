//! Level of detail (LOD) of bicubic patches: which cells a view cuts.

use super::knots::{DIAGONALS, SIDES, knots_spacing_rad};
use super::lattice::{AROUND, Cell, PIECES, SEGMENTS, STEP_RAD, ball, chord_m};
use super::mesh::vertices;
use super::{ContourSurface, OVERSHOOT};
use crate::elevation::{Bounds, Elevation, HeightChange, HeightRange};
use crate::globe::culling::{CullingContext, GroundBound};
use glam::DVec3;
use std::cmp::Ordering;
use std::f64::consts::FRAC_PI_2;

/// Error and bound of a cell.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CellInfo {
    /// Largest vertical distance between drawn terrain and the data, at the probes.
    pub error_m: f32,
    /// Lowest height of the ground.
    pub low_m: f32,
    /// Highest height; see [`Self::low_m`].
    pub high_m: f32,
    /// Centre of a ball that contains the cell, ITRF metres.
    pub center_m: DVec3,
    /// Radius of that ball, metres; see [`Self::center_m`].
    pub radius_m: f64,
    /// Heights have changed since the cell was evaluated. The values still bound them.
    pub is_stale: bool,
}

/// A cell that should be cut.
#[derive(Clone, Copy, Debug)]
pub(super) struct CutCandidate {
    pixels: f64,
    cell: Cell,
}

impl Ord for CutCandidate {
    fn cmp(&self, other: &Self) -> Ordering {
        let by_key = || self.cell.key().cmp(&other.cell.key());
        self.pixels.total_cmp(&other.pixels).then_with(by_key)
    }
}

impl PartialOrd for CutCandidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for CutCandidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for CutCandidate {}

/// Squares along an edge of a cell for which the range of the data is queried: one to each patch.
const PARTS: usize = PIECES as usize;

/// Approximate number of patches that are written in the time in which a cell is measured.
pub(super) const WRITTEN_PER_MEASURED: u32 = 12;

impl ContourSurface {
    /// Evaluates the error of a cell: reads it and compares what would be drawn with the data.
    pub(super) fn evaluate_cell(&mut self, ground: &dyn Elevation, cell: Cell) -> CellInfo {
        let knots = self.knots(ground, cell);
        let drawn = vertices(cell, &knots);
        let [x, y] = cell.vertex(0, 0);
        let segment = cell.steps() / SEGMENTS;
        let mut error_m = 0.0f64;
        // By part, the range of the drawn terrain and the data at the points read.
        let nothing = (f64::INFINITY, f64::NEG_INFINITY);
        let mut seen = [[nothing; PARTS]; PARTS];
        let within = |(low, high): (f64, f64), z: f64| (low.min(z), high.max(z));
        // In half segments: where a patch is farthest from its knots, and in the middle of each square, which is on the diagonal of its
        // triangles.
        for j in 0..=2 * SEGMENTS {
            for i in 0..=2 * SEGMENTS {
                let (m, n) = ((i / 2) as usize, (j / 2) as usize);
                let drawn_m = match (i & 1, j & 1) {
                    (0, 0) => drawn[n][m][0],
                    (1, 1) => 0.5 * (drawn[n][m][0] + drawn[n + 1][m + 1][0]),
                    _ => continue,
                };
                let part = |k: u32| (k as usize * PARTS / (2 * SEGMENTS as usize)).min(PARTS - 1);
                let part = &mut seen[part(j)][part(i)];
                *part = within(*part, drawn_m);
                if i % 4 == 0 && j % 4 == 0 {
                    continue;
                }
                let half = segment / 2;
                let data_m = self.height_m(ground, [(x + i * half) % AROUND, y + j * half], 0.0);
                error_m = error_m.max((drawn_m - data_m).abs());
                *part = within(*part, data_m);
            }
        }
        let size_rad = f64::from(cell.steps()) * STEP_RAD;
        // Depth of the chord of a segment below the arc, both ways.
        let arc = size_rad / f64::from(SEGMENTS);
        error_m += chord_m(&self.options.ellipsoid, arc);
        let bounds = cell.bounds();
        // At the finest spacing: averaging would include the mean of the whole Earth.
        let range = ground.range_up_to_m(&bounds, 0.0);
        // If the data are no finer than the samples read, there is nothing between them.
        let (lat, lon) = (
            0.5 * (bounds.south_rad + bounds.north_rad),
            bounds.west_rad + 0.5 * size_rad,
        );
        if arc > ground.finest_spacing_rad(lat, lon) {
            error_m = error_m.max(missed_m(ground, &bounds, &range, &seen));
        }
        // Cubics may exceed the range of their data.
        let heights = drawn.iter().flatten().map(|corner| corner[0]);
        let (low, high) = heights.fold((range.low_m, range.high_m), within);
        let (low_m, high_m) = (low as f32 - 1.0, high as f32 + 1.0);
        let (center_m, radius_m) = ball(&self.options.ellipsoid, cell, low_m.into(), high_m.into());
        let info = CellInfo {
            center_m,
            radius_m,
            error_m: error_m as f32,
            low_m,
            high_m,
            is_stale: false,
        };
        self.cell_infos.put(cell.key(), self.now, info);
        info
    }

    /// Drops what was derived from changed heights. The info of cells is widened to contain the new heights, and stays until it is
    /// evaluated again.
    pub(super) fn forget_changed(&mut self, changes: &[HeightChange]) {
        let ellipsoid = self.options.ellipsoid;
        // Knots of the cell, and of a coarser one beside it, extend this far beyond it.
        let is_touched = |cell: Cell, change: &HeightChange| {
            change.touches(&cell.bounds(), cell.side_rad(), 0.0)
        };
        self.cell_infos.retain(|key, info| {
            let cell = Cell::of_key(key);
            let mut is_wider = false;
            for change in changes.iter().filter(|change| is_touched(cell, change)) {
                let HeightRange { low_m, high_m } = change.range;
                // Cubics may exceed the range of their data.
                let more_m =
                    OVERSHOOT * (high_m.max(info.high_m.into()) - low_m.min(info.low_m.into()));
                let (low, high) = (
                    (low_m - more_m) as f32 - 1.0,
                    (high_m + more_m) as f32 + 1.0,
                );
                is_wider |= low < info.low_m || high > info.high_m;
                (info.low_m, info.high_m) = (info.low_m.min(low), info.high_m.max(high));
                info.is_stale = true;
            }
            if is_wider {
                let (low, high) = (info.low_m.into(), info.high_m.into());
                (info.center_m, info.radius_m) = ball(&ellipsoid, cell, low, high);
            }
            true
        });
        // Unlike errors, knots depend on heights at their own spacing alone, except a pole's.
        let is_same = |cell: Cell| {
            let bounds = cell.bounds();
            let poleward_rad = bounds.north_rad.max(-bounds.south_rad) + cell.side_rad();
            let spacing_rad = match poleward_rad >= FRAC_PI_2 {
                true => 0.0,
                false => knots_spacing_rad(cell),
            };
            let touches = |c: &HeightChange| c.touches(&bounds, cell.side_rad(), spacing_rad);
            !changes.iter().any(touches)
        };
        self.known_knots.retain(|key, _| is_same(Cell::of_key(key)));
        for slot in &mut self.slots {
            if !slot.is_stale && !is_same(Cell::of_key(slot.patch.key)) {
                slot.is_stale = true;
                self.to_rewrite += u32::from(slot.used == self.now);
            }
        }
    }

    /// The info of a cell, or else of its nearest known ancestor, with its own ball.
    pub(super) fn nearest_info(&mut self, cell: Cell) -> CellInfo {
        let mut above = cell;
        let nothing = CellInfo {
            low_m: -12_000.0,
            high_m: 9_000.0,
            ..CellInfo::default()
        };
        let found = loop {
            if let Some(info) = self.cell_infos.get(above.key(), self.now) {
                break info;
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
        CellInfo {
            center_m,
            radius_m,
            ..found
        }
    }

    /// Distance to the nearest point of a cell, at least 1 m; `None` if the cell is certainly not visible.
    pub(super) fn visible_distance_m(
        &self,
        culling: &CullingContext,
        info: &CellInfo,
    ) -> Option<f64> {
        let bound = GroundBound {
            center_itrf_m: info.center_m,
            radius_m: info.radius_m,
            high_m: f64::from(info.high_m),
        };
        let is_visible = culling.visibility(&bound).is_visible();
        #[cfg(test)]
        let is_visible = is_visible || !self.cull;
        is_visible.then(|| culling.distance_m(&bound).max(1.0))
    }

    pub(super) fn is_cut(&self, cell: Cell) -> bool {
        self.cut_cells.get(cell.key()).is_some()
    }

    /// Marks a cell and its ancestors as cut. It also cuts adjacent cells, so that neighbours differ by one level at most. Returns how many
    /// of all these were not cut in the last frame; `None` if there is no room.
    fn cut(&mut self, cell: Cell) -> Option<u32> {
        let mut fresh = 0;
        self.queue.clear();
        self.queue.push(cell);
        while let Some(cell) = self.queue.pop() {
            if self.is_cut(cell) {
                continue;
            }
            if !self.cut_cells.set(cell.key(), 0) {
                return None;
            }
            fresh += u32::from(self.cut_before.get(cell.key()).is_none());
            if cell.level == 0 {
                continue;
            }
            self.queue.push(cell.parent());
            for (dx, dy) in SIDES.into_iter().chain(DIAGONALS) {
                self.queue.extend(cell.beside(dx, dy).map(Cell::parent));
            }
        }
        Some(fresh)
    }

    /// Selects the cells to cut, those of the largest errors in pixels first. New cells are measured, and newly cut, within the budgets of
    /// a frame.
    pub(super) fn select_lod(
        &mut self,
        culling: &CullingContext,
        tolerance_px: f64,
        ground: &dyn Elevation,
    ) {
        std::mem::swap(&mut self.cut_cells, &mut self.cut_before);
        self.cut_cells.clear();
        self.candidates.clear();
        // Patches are rewritten all in one frame, so their time is taken from work that can wait.
        let rewritten = std::mem::take(&mut self.to_rewrite) / WRITTEN_PER_MEASURED;
        let measured = self.options.measured_per_frame;
        let mut evaluations = measured - rewritten.min(measured - measured / 4);
        let mut to_cut = self.options.cut_per_frame;
        for root in Cell::roots() {
            // Visible blocks are evaluated from the first frame on, beyond the budget.
            let is_unknown = self.cell_infos.get(root.key(), self.now).is_none();
            let mut left = evaluations + u32::from(is_unknown);
            self.consider(culling, tolerance_px, ground, root, &mut left);
            evaluations = evaluations.min(left);
        }
        while let Some(CutCandidate { cell, .. }) = self.candidates.pop() {
            if !self.is_cut(cell) {
                if self.cut_cells.len() >= self.options.max_cuts as usize {
                    break;
                }
                if to_cut == 0 && self.cut_before.get(cell.key()).is_none() {
                    continue;
                }
                let Some(fresh) = self.cut(cell) else {
                    // Beyond the capacity of the tables: draw the blocks uncut, which is always closed.
                    self.cut_cells.clear();
                    break;
                };
                to_cut = to_cut.saturating_sub(fresh);
            }
            for child in cell.children() {
                self.consider(culling, tolerance_px, ground, child, &mut evaluations);
            }
        }
    }

    /// Adds a cell to the candidates if its error is visible.
    fn consider(
        &mut self,
        culling: &CullingContext,
        tolerance_px: f64,
        ground: &dyn Elevation,
        cell: Cell,
        evaluations: &mut u32,
    ) {
        let info = match self.cell_infos.get(cell.key(), self.now) {
            // A part of the budget is reserved for cells without info.
            Some(info) if info.is_stale && *evaluations > self.options.measured_per_frame / 2 => {
                *evaluations -= 1;
                self.evaluate_cell(ground, cell)
            }
            Some(info) => info,
            None => {
                // Not visible according to the info of its ancestors: not worth measuring.
                let above = self.nearest_info(cell);
                if *evaluations == 0 || self.visible_distance_m(culling, &above).is_none() {
                    return;
                }
                *evaluations -= 1;
                self.evaluate_cell(ground, cell)
            }
        };
        let Some(distance_m) = self.visible_distance_m(culling, &info) else {
            return;
        };
        let pixels = f64::from(info.error_m) / (distance_m * culling.pixel_rad);
        if pixels > tolerance_px && u32::from(cell.level) < self.options.max_level {
            self.candidates.push(CutCandidate { pixels, cell });
        }
    }
}

/// Largest excess of a cell's data over the values seen in each part of it and around: a single summit, for example. 0 for a source that
/// returns the same range for all parts, since it is not more specific.
fn missed_m(
    ground: &dyn Elevation,
    bounds: &Bounds,
    whole: &HeightRange,
    seen: &[[(f64, f64); PARTS]; PARTS],
) -> f64 {
    let (height_rad, width_rad) = (
        (bounds.north_rad - bounds.south_rad) / PARTS as f64,
        bounds.width_rad / PARTS as f64,
    );
    let (mut is_telling, mut most) = (false, 0.0f64);
    for j in 0..PARTS {
        for i in 0..PARTS {
            let south_rad = bounds.south_rad + j as f64 * height_rad;
            let part = Bounds {
                south_rad,
                north_rad: (south_rad + height_rad).min(bounds.north_rad),
                west_rad: bounds.west_rad + i as f64 * width_rad,
                width_rad,
            };
            let range = ground.range_up_to_m(&part, 0.0);
            is_telling |= range != *whole;
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for row in &seen[j.saturating_sub(1)..=(j + 1).min(PARTS - 1)] {
                for part in &row[i.saturating_sub(1)..=(i + 1).min(PARTS - 1)] {
                    (low, high) = (low.min(part.0), high.max(part.1));
                }
            }
            // Ranges extend a little further than requested, and nothing was read beyond the cell: assume the same steepness there.
            let is_border = [i, j].iter().any(|k| *k == 0 || *k == PARTS - 1);
            let part = seen[j][i];
            let more = if is_border { part.1 - part.0 } else { 0.0 };
            most = most
                .max(range.high_m - high - more)
                .max(low - more - range.low_m);
        }
    }
    if is_telling { most } else { 0.0 }
}
