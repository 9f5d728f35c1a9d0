//! Culling of blocks for an eye, by horizon, then frustum. Free functions over plain data; the tests are those of
//! [`culling`](super::culling).

use super::Visibility;
use super::blocks::{Block, BlockGrid, COLUMNS};
use super::culling::{Frustum, GroundShell, Horizon, max_toward};
use crate::height::HeightRange;
use glam::{DMat4, DVec3};
use std::f64::consts::PI;

/// Result of [`select_blocks`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Selection {
    /// Blocks that pass the horizon test.
    pub visible: u32,
}

/// Chooses the blocks to draw and appends them to `drawn`, which is cleared first; room for 128 is enough.
///
/// `eye_itrf_m` is the eye in ITRF metres; `clip_from_eye` takes eye-relative ITRF metres to clip space with z in 0…w.
/// Neither test drops a block with a visible facet, unless the paper's rule is requested.
pub fn select_blocks(
    grid: &BlockGrid,
    visibility: Visibility,
    eye_itrf_m: DVec3,
    clip_from_eye: &DMat4,
    drawn: &mut Vec<Block>,
) -> Selection {
    drawn.clear();
    let ellipsoid = grid.ellipsoid();
    let horizon = Horizon::new(&ellipsoid, eye_itrf_m, GroundShell::SMOOTH);
    let frustum = Frustum::new(clip_from_eye).scaled(&ellipsoid, eye_itrf_m);
    let mut visible = 0;
    for block in Block::all() {
        let seen = match visibility {
            Visibility::Conservative => is_above_horizon(grid, block, &horizon),
            Visibility::Paper => paper_rule(grid, block, eye_itrf_m),
        };
        if !seen {
            continue;
        }
        visible += 1;
        let rect = &grid.rects[block.index() as usize];
        if !frustum.excludes_rect(rect, &GroundShell::SMOOTH) {
            drawn.push(block);
        }
    }
    Selection { visible }
}

impl BlockGrid {
    /// Distance from the eye to the block's nearest point on the ellipsoid, metres. Exact on a sphere; on the Earth
    /// too large by at most 0.34 %.
    pub fn distance_m(&self, block: Block, eye_itrf_m: DVec3) -> f64 {
        let eye = self.ellipsoid().scaled_from_itrf() * eye_itrf_m;
        let rect = &self.rects[block.index() as usize];
        rect.distance(eye) * self.ellipsoid().equatorial_radius_m
    }

    /// Smallest and largest sine of the Sun's elevation over the block. Exact on a sphere; on the Earth to 0.004.
    pub fn sun_range(&self, block: Block, sun_itrf: DVec3) -> (f64, f64) {
        let rect = &self.rects[block.index() as usize];
        (-rect.max_dot(-sun_itrf), rect.max_dot(sun_itrf))
    }
}

/// True if a point of the block, or a facet of its mesh, faces the eye.
///
/// The mesh is inscribed, so near the limb a facet can face the eye though no point of its block is above the horizon. That is tested too,
/// a band of cells at a time, since all cells of one row have the same tilt. For an eye below the ellipsoid only facets count: no point of
/// the ellipsoid faces it.
fn is_above_horizon(grid: &BlockGrid, block: Block, horizon: &Horizon) -> bool {
    let rect = &grid.rects[block.index() as usize];
    if horizon.is_eye_above() && !horizon.hides_rect(rect) {
        return true;
    }
    let n = grid.subdivision();
    let eye_scaled = horizon.eye_scaled();
    let half_width_rad = rect.half_width_rad - half_cell_rad(grid);
    let k = max_toward(rect.lon, eye_scaled, half_width_rad);
    let first = (block.row * n) as usize;
    grid.bands[first..first + n as usize]
        .iter()
        .any(|band| band.n_rho * k + band.n_z * eye_scaled.z > band.d)
}

/// The paper's rule: (e − v)·n > 0 at one of the four corners.
fn paper_rule(grid: &BlockGrid, block: Block, eye_itrf_m: DVec3) -> bool {
    let n = grid.subdivision();
    [(0, 0), (n, 0), (0, n), (n, n)].into_iter().any(|(i, j)| {
        let v = grid.vertex_itrf_m(block, i, j);
        // Only the normal's direction matters: D⁻²v.
        let d = grid.ellipsoid().scaled_from_itrf();
        (eye_itrf_m - v).dot(d * d * v) > 0.0
    })
}

/// As [`select_blocks`], for ground between two heights above the ellipsoid. No block with visible ground is dropped, including ground
/// visible over the horizon.
pub fn select_blocks_between(
    grid: &BlockGrid,
    range: HeightRange,
    eye_itrf_m: DVec3,
    clip_from_eye: &DMat4,
    drawn: &mut Vec<Block>,
) {
    drawn.clear();
    let ellipsoid = grid.ellipsoid();
    let shell = GroundShell::new(
        &ellipsoid,
        HeightRange {
            low_m: range.low_m - sag_m(grid, range),
            ..range
        },
    );
    let horizon = Horizon::new(&ellipsoid, eye_itrf_m, shell);
    let frustum = Frustum::new(clip_from_eye).scaled(&ellipsoid, eye_itrf_m);
    drawn.extend(Block::all().filter(|block| {
        let rect = &grid.rects[block.index() as usize];
        !horizon.hides_rect(rect) && !frustum.excludes_rect(rect, &shell)
    }));
}

/// Largest depth of a cell's middle below its corners, metres: 2R(1 − cos x) = 4R sin²(x/2).
fn sag_m(grid: &BlockGrid, range: HeightRange) -> f64 {
    let (a, b) = (
        grid.ellipsoid().equatorial_radius_m,
        grid.ellipsoid().polar_radius_m,
    );
    // In parametric latitude a cell is wider than in geodetic by at most the ratio of the axes.
    let widest_rad = half_cell_rad(grid) * a.max(b) / a.min(b);
    4.0 * (a.max(b) + range.high_m.max(0.0)) * (0.5 * widest_rad).sin().powi(2)
}

/// Half the width of a cell in longitude.
fn half_cell_rad(grid: &BlockGrid) -> f64 {
    PI / (f64::from(COLUMNS) * f64::from(grid.subdivision()))
}
