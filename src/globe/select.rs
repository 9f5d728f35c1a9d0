//! Which blocks an eye needs: horizon, then frustum. Free functions over plain data.

use super::Visibility;
use super::blocks::{Block, BlockGrid, COLUMNS, Extent};
use glam::{DMat4, DVec2, DVec3, DVec4};
use std::f64::consts::PI;

/// What [`select_blocks`] found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Selection {
    /// Blocks left by the horizon test.
    pub visible: u32,
}

/// Chooses the blocks to draw and appends them to `drawn` (cleared first; 128 places are enough).
///
/// `eye_itrf_m` is the eye in ITRF metres; `clip_from_eye` takes eye-relative ITRF metres to clip space with z in 0…w.
/// Neither test ever loses a block of which a facet can be seen, except by the paper's rule if that is asked for.
pub fn select_blocks(
    grid: &BlockGrid,
    visibility: Visibility,
    eye_itrf_m: DVec3,
    clip_from_eye: &DMat4,
    drawn: &mut Vec<Block>,
) -> Selection {
    drawn.clear();
    let eye_scaled = grid.ellipsoid().scaled_from_itrf() * eye_itrf_m;
    let planes = frustum_planes(
        clip_from_eye,
        eye_itrf_m,
        grid.ellipsoid().itrf_from_scaled(),
    );
    let mut visible = 0;
    for block in Block::all() {
        let seen = match visibility {
            Visibility::Conservative => above_horizon(grid, block, eye_scaled),
            Visibility::Paper => paper_rule(grid, block, eye_itrf_m),
        };
        if !seen {
            continue;
        }
        visible += 1;
        let extent = &grid.extents[block.index() as usize];
        if planes
            .iter()
            .all(|plane| max_dot(extent, plane.truncate()) + plane.w >= 0.0)
        {
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
        let length = eye.length();
        // |e|² + 1 − 2m = (|e| − 1)² + 2(|e| − m), where nothing cancels for an eye above the block: m = |e|.
        let beside = (length - max_dot(&self.extents[block.index() as usize], eye)).max(0.0);
        ((length - 1.0).powi(2) + 2.0 * beside).sqrt() * self.ellipsoid().equatorial_radius_m
    }

    /// Smallest and largest sine of the Sun's elevation over the block. Exact on a sphere; on the Earth to 0.004.
    pub fn sun_range(&self, block: Block, sun_itrf: DVec3) -> (f64, f64) {
        let extent = &self.extents[block.index() as usize];
        (-max_dot(extent, -sun_itrf), max_dot(extent, sun_itrf))
    }
}

/// True if a point of the block, or a facet of its mesh, faces the eye.
///
/// A point P of the ellipsoid is above the horizon iff P′·e′ ≥ 1 in scaled space. The mesh is inscribed, so near the
/// limb a facet can face the eye though no point of its block is above the horizon: that is tested too, a band of
/// cells at a time, since all cells of one row are tilted alike.
fn above_horizon(grid: &BlockGrid, block: Block, eye_scaled: DVec3) -> bool {
    let extent = &grid.extents[block.index() as usize];
    if eye_scaled.length_squared() >= 1.0 && max_dot(extent, eye_scaled) >= 1.0 {
        return true;
    }
    let n = grid.subdivision();
    let half_cell = PI / (f64::from(COLUMNS) * f64::from(n));
    let k = toward(extent.lon, eye_scaled, PI / f64::from(COLUMNS) - half_cell);
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
        // The direction of the normal is all that counts: D⁻²v.
        let d = grid.ellipsoid().scaled_from_itrf();
        (eye_itrf_m - v).dot(d * d * v) > 0.0
    })
}

/// Ground between two heights, for which no block may be lost that shows any of it.
struct Shell {
    /// Radii in scaled space, where the ellipsoid is the unit sphere: below all ground, above all ground.
    low: f64,
    high: f64,
}

impl Shell {
    /// What a place moves by in scaled space, at most, when it is lifted along the ellipsoid's normal: the difference
    /// between normal and radius, e²/2, times 11 km over the Earth's radius.
    const SIDEWAYS: f64 = 1e-5;

    /// For ground between these heights, drawn with a grid's facets, which reach below it.
    fn new(grid: &BlockGrid, low_m: f64, high_m: f64) -> Self {
        let radius_m = grid.ellipsoid().polar_radius_m;
        let half_cell_rad = PI / (f64::from(COLUMNS) * f64::from(grid.subdivision()));
        // The middle of a cell lies below its corners by up to 2(1 − cos x) = 4 sin²(x/2) radii.
        let sag = 4.0 * (0.5 * half_cell_rad).sin().powi(2);
        Self {
            low: (1.0 + low_m / radius_m - sag).clamp(0.0, 1.0),
            high: (1.0 + high_m / radius_m).max(1.0),
        }
    }

    /// The blocks whose ground can be seen: beyond the horizon as far as the highest ground reaches over it.
    fn select(
        &self,
        grid: &BlockGrid,
        eye_itrf_m: DVec3,
        clip_from_eye: &DMat4,
        drawn: &mut Vec<Block>,
    ) {
        drawn.clear();
        let eye_scaled = grid.ellipsoid().scaled_from_itrf() * eye_itrf_m;
        let distance = eye_scaled.length();
        let planes = frustum_planes(
            clip_from_eye,
            eye_itrf_m,
            grid.ellipsoid().itrf_from_scaled(),
        );
        // A sphere of radius r hides what lies farther round than acos(r/d) + acos(r/R), R the highest ground.
        let farthest_cos = if distance <= self.low {
            -1.0
        } else {
            let angle = (self.low / distance).acos() + (self.low / self.high).acos();
            angle.min(PI).cos()
        };
        for block in Block::all() {
            let extent = &grid.extents[block.index() as usize];
            let is_round_the_limb =
                max_dot(extent, eye_scaled) + Self::SIDEWAYS * distance < farthest_cos * distance;
            let is_inside = |plane: &DVec4| {
                let normal = plane.truncate();
                let most = max_dot(extent, normal) + Self::SIDEWAYS * normal.length();
                (self.low * most).max(self.high * most) + plane.w >= 0.0
            };
            if !is_round_the_limb && planes.iter().all(is_inside) {
                drawn.push(block);
            }
        }
    }
}

/// As [`select_blocks`], for ground between two heights above the ellipsoid, metres: no block is lost of whose ground
/// anything can be seen, over the horizon too.
pub fn select_blocks_between(
    grid: &BlockGrid,
    (low_m, high_m): (f64, f64),
    eye_itrf_m: DVec3,
    clip_from_eye: &DMat4,
    drawn: &mut Vec<Block>,
) {
    Shell::new(grid, low_m, high_m).select(grid, eye_itrf_m, clip_from_eye, drawn);
}

/// Largest value of P·v over the block's points P on the unit sphere.
fn max_dot(extent: &Extent, v: DVec3) -> f64 {
    let k = toward(extent.lon, v, PI / f64::from(COLUMNS));
    // Maximise k cos β + v_z sin β between the southern and the northern edge.
    let (north, south) = (extent.north, extent.south);
    let along = DVec2::new(k, v.z);
    if south.perp_dot(along) >= 0.0 && along.perp_dot(north) >= 0.0 {
        along.length()
    } else {
        along.dot(north).max(along.dot(south))
    }
}

/// Largest horizontal component of `v` towards any meridian within `half_width_rad` of the meridian `lon` (cos, sin).
fn toward(lon: DVec2, v: DVec3, half_width_rad: f64) -> f64 {
    let x = lon.x * v.x + lon.y * v.y;
    let y = (lon.x * v.y - lon.y * v.x).abs();
    let (sin, cos) = half_width_rad.sin_cos();
    if x > 0.0 && y * cos <= x * sin {
        x.hypot(y)
    } else {
        x * cos + y * sin
    }
}

/// The six clip planes as (normal, offset) on the unit sphere of scaled space: inside where n·P + w ≥ 0.
fn frustum_planes(clip_from_eye: &DMat4, eye_itrf_m: DVec3, itrf_from_scaled: DVec3) -> [DVec4; 6] {
    let (x, y, z, w) = (
        clip_from_eye.row(0),
        clip_from_eye.row(1),
        clip_from_eye.row(2),
        clip_from_eye.row(3),
    );
    [w + x, w - x, w + y, w - y, z, w - z].map(|plane| {
        let normal = plane.truncate();
        (normal * itrf_from_scaled).extend(plane.w - normal.dot(eye_itrf_m))
    })
}
