//! The whole Earth as bicubic patches: a forest over the blocks of 22.5°, chosen by the view.
//!
//! Each block is a quadtree. A cell is 4 × 4 bicubic patches of heights over longitude and latitude, displaced along the normal of the
//! ellipsoid. Each is drawn as 2 × 2 squares. The knots between them are heights and derivatives of the ground at the patches' own scale,
//! so that neighbours share them. Beside a coarser neighbour they are that neighbour's knots, or halfway between two of them the values of
//! its edge ([`restrict`](super::hermite::restrict)). The terrain therefore has one height and one tangent plane across every edge, for
//! each frame's choice of levels. Neighbours, diagonal ones too, differ by one level at most, so that corners of a cell are knots of the
//! coarser ones around it. Near the poles, where columns converge, vertices use the slope of the ground around them instead of the
//! derivative by longitude.
//!
//! Patches are stored and drawn in Hermite form. The parameter q of the paper's q-Bézier form changes the control values of a patch and not
//! its surface. There is therefore no q here, and no contour tree either; `measure::terrain` measures both.
//!
//! Each frame chooses the cells to cut, largest errors in pixels first, and with each the cells beside it that must be cut. A cell's error
//! is measured when it is first evaluated. Visible cells are then drawn. New cells are measured, and cut, within budgets, so a jump of the
//! eye becomes sharp over some frames and never waits. Vertices are written again only where the neighbours' levels have changed. The
//! reported error is that of the drawn cells, each on its own: at the border of the image an edge may be that of a coarser cell out of
//! sight.

mod knots;
pub(super) mod lattice;
mod lod;
pub(super) mod lookup;
mod mesh;
#[cfg(test)]
mod tests;

use crate::elevation::{Bounds, Elevation, HeightChange, HeightRange};
use crate::globe::culling::CullingContext;
use crate::globe::{GroundView, Patch, Surface, SurfaceStats, TriangleList};
use glam::DVec3;
use knots::{CoarserNeighbours, Knots};
use lattice::{Cell, MAX_LEVEL, SEGMENTS, chord_m};
use lod::{CellInfo, CutCandidate};
use lookup::{KeyMap, SetCache};
use std::collections::BinaryHeap;
use std::f64::consts::FRAC_PI_8;
use std::sync::Arc;
use terrella_frames::Ellipsoid;

/// Budgets of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContourOptions {
    /// Figure of the Earth that heights are measured from.
    pub ellipsoid: Ellipsoid,
    /// Largest number of cells that are cut for a view, 16…900. Patches are up to three times as many, and balancing adds to them.
    pub max_cuts: u32,
    /// Cells that are measured again in a frame. There are fewer, down to a quarter, where patches are rewritten for changed heights.
    pub measured_per_frame: u32,
    /// Cells that are cut in a frame and were not in the last. The cells that must be cut beside the last of them are additional.
    pub cut_per_frame: u32,
    /// Deepest level, 0…20; larger values are clamped to 20, where cells are 2.4 m wide.
    pub max_level: u32,
}

impl Default for ContourOptions {
    fn default() -> Self {
        Self {
            ellipsoid: Ellipsoid::WGS84,
            max_cuts: 600,
            measured_per_frame: 24,
            cut_per_frame: 24,
            max_level: u32::from(MAX_LEVEL),
        }
    }
}

struct PatchSlot {
    used: u64,
    /// Coarser neighbours for which its vertices were written; `None` before that.
    coarser: Option<CoarserNeighbours>,
    knots: Knots,
    /// Heights have changed since then.
    is_stale: bool,
    patch: Patch,
}

/// Contours as drawn terrain.
pub struct ContourSurface {
    options: ContourOptions,
    now: u64,
    clock: u64,
    cell_infos: SetCache<CellInfo>,
    known_knots: SetCache<Knots>,
    cut_cells: KeyMap,
    /// Cells that were cut in the last frame.
    cut_before: KeyMap,
    /// Cells still to be cut, largest errors first.
    candidates: BinaryHeap<CutCandidate>,
    queue: Vec<Cell>,
    leaves: Vec<(f64, Cell)>,
    slots: Vec<PatchSlot>,
    by_key: KeyMap,
    drawn: Vec<u32>,
    /// Number of drawn patches to be rewritten because heights have changed.
    to_rewrite: u32,
    indices: [Arc<TriangleList>; 16],
    samples: u64,
    #[cfg(test)]
    cull: bool,
}

impl ContourSurface {
    /// An empty surface. Tables take 9 MB and a patch 2 kB. Cuts are bounded whatever balancing adds, and so are patches and memory: 80 MB
    /// at most. A descent from 400 km to 2 km with the default options takes 15 MB.
    pub fn new(options: ContourOptions) -> Self {
        let options = ContourOptions {
            max_cuts: options.max_cuts.clamp(16, 900),
            max_level: options.max_level.min(u32::from(MAX_LEVEL)),
            ..options
        };
        Self {
            options,
            now: 0,
            clock: 0,
            cell_infos: SetCache::new(14),
            known_knots: SetCache::new(13),
            cut_cells: KeyMap::new(14),
            cut_before: KeyMap::new(14),
            candidates: BinaryHeap::new(),
            queue: Vec::new(),
            leaves: Vec::new(),
            slots: Vec::new(),
            by_key: KeyMap::new(15),
            drawn: Vec::new(),
            to_rewrite: 0,
            indices: mesh::indices(),
            samples: 0,
            #[cfg(test)]
            cull: true,
        }
    }

    /// The slot of a cell, new or existing.
    fn slot(&mut self, cell: Cell) -> usize {
        if let Some(slot) = self.by_key.get(cell.key()) {
            return slot as usize;
        }
        // The least recently drawn slot, except for a reserve that avoids rebuilding.
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
        if let Some(slot) = oldest {
            let vertices = std::mem::take(&mut self.slots[slot].patch.vertices);
            let changed = std::mem::take(&mut self.slots[slot].patch.changed);
            self.slots[slot].coarser = None;
            self.slots[slot].is_stale = false;
            self.slots[slot].patch = Patch {
                vertices,
                changed,
                ..patch
            };
            return slot;
        }
        self.slots.push(PatchSlot {
            used: 0,
            coarser: None,
            knots: Knots::default(),
            is_stale: false,
            patch,
        });
        self.slots.len() - 1
    }
}

/// Largest overshoot of a bicubic patch, as a fraction of the range of its heights. The weights of a cubic halfway between four values have
/// absolute sum 5/4, those in two directions 25/16.
const OVERSHOOT: f64 = 9.0 / 32.0;

/// Slots kept in addition to the drawn ones.
const RESERVE: usize = 256;

impl Surface for ContourSurface {
    fn name(&self) -> &'static str {
        "contours"
    }

    fn prepare(&mut self, view: &GroundView, ground: &dyn Elevation) -> SurfaceStats {
        self.now += 1;
        self.samples = 0;
        let range = ground.range_m(&Bounds::GLOBE);
        let overshoot_m = OVERSHOOT * (range.high_m - range.low_m);
        let arc_rad = FRAC_PI_8 / f64::from(SEGMENTS);
        let drawn = HeightRange {
            low_m: range.low_m - overshoot_m - chord_m(&self.options.ellipsoid, arc_rad),
            ..range
        };
        let pixel_rad = view.pixel_rad.max(1e-9);
        let view = GroundView { pixel_rad, ..*view };
        let culling = CullingContext::new(&view, &self.options.ellipsoid, drawn).without_depth();
        self.select_lod(&culling, view.tolerance_px.max(0.0), ground);
        self.leaves.clear();
        self.queue.clear();
        self.queue.extend(Cell::roots());
        let mut stats = SurfaceStats::default();
        let (mut error_m, mut error_px) = (0.0f64, 0.0f64);
        while let Some(cell) = self.queue.pop() {
            let info = self.nearest_info(cell);
            let Some(distance_m) = self.visible_distance_m(&culling, &info) else {
                continue;
            };
            if self.is_cut(cell) {
                self.queue.extend(cell.children());
                continue;
            }
            self.leaves.push((distance_m, cell));
            error_m = error_m.max(f64::from(info.error_m));
            error_px = error_px.max(f64::from(info.error_m) / (distance_m * pixel_rad));
        }
        self.leaves
            .sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.key().cmp(&b.1.key())));
        // Existing ones first, so that none of them is evicted.
        for k in 0..self.leaves.len() {
            if let Some(slot) = self.by_key.get(self.leaves[k].1.key()) {
                self.slots[slot as usize].used = self.now;
            }
        }
        self.drawn.clear();
        for k in 0..self.leaves.len() {
            let cell = self.leaves[k].1;
            let coarser = self.coarser_neighbours(cell);
            let slot = self.slot(cell);
            self.slots[slot].used = self.now;
            let is_other = self.slots[slot].coarser != Some(coarser);
            if is_other || self.slots[slot].is_stale {
                let knots = self.stitched_knots(ground, cell, coarser);
                self.slots[slot].is_stale = false;
                if !is_other && knots == self.slots[slot].knots && !mesh::reads_slopes(cell) {
                    // The change is between its knots, or beside it.
                    self.drawn.push(slot as u32);
                    continue;
                }
                self.clock += 1;
                let PatchSlot {
                    coarser: was,
                    knots: known,
                    patch,
                    ..
                } = &mut self.slots[slot];
                (*was, *known) = (Some(coarser), knots);
                patch.revision = self.clock;
                patch.indices = self.indices[usize::from(coarser.sides)].clone();
                let figure = &self.options.ellipsoid;
                self.samples += mesh::write(figure, ground, cell, coarser, &knots, patch);
            }
            self.drawn.push(slot as u32);
        }
        for slot in &self.drawn {
            let patch = &self.slots[*slot as usize].patch;
            stats.patches += 1;
            stats.vertices += patch.vertices.len() as u32;
            stats.triangles += patch.indices.triangles.len() as u32 / 3;
        }
        self.by_key.clear();
        for (k, slot) in self.slots.iter().enumerate() {
            // Without room a patch is only rebuilt.
            let _ = self.by_key.set(slot.patch.key, k as u32);
        }
        stats.samples_read = self.samples;
        let a_slot =
            size_of::<PatchSlot>() + mesh::VERTICES * size_of::<crate::globe::GroundVertex>();
        stats.resident_bytes = self.cell_infos.bytes()
            + self.known_knots.bytes()
            + self.cut_cells.bytes()
            + self.cut_before.bytes()
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

    fn heights_changed(&mut self, changes: &[HeightChange], _: &dyn Elevation) {
        self.forget_changed(changes);
    }

    /// Does nothing: the cells that were cut affect only how many more a frame may cut.
    fn forget_views(&mut self) {}

    fn for_each_patch(&self, draw: &mut dyn FnMut(&Patch)) {
        for slot in &self.drawn {
            draw(&self.slots[*slot as usize].patch);
        }
    }
}
