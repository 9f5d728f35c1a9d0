//! Triangles over one cell.

use super::super::hermite::{Corner, cubic, edge, net};
use super::lattice::{
    Cell, ORIGIN_HEIGHT_M, ORIGIN_STEP_M, SEGMENTS, STEP_RAD, TALL, cos_sin_lat, lon_rad,
};
use crate::frames::Ellipsoid;
use crate::globe::{GroundVertex, Indices, Patch};
use glam::{DVec3, Vec2};
use std::sync::Arc;

const SIDE: usize = SEGMENTS as usize + 1;
/// Vertices of a cell.
pub const VERTICES: usize = SIDE * SIDE;
/// Heights at a pole are rounded to this, so that cells of all levels hold them exactly.
const POLE_GRAIN_M: f64 = 1.0 / 64.0;

/// All that the vertices of a cell follow from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shape {
    /// South-west, south-east, north-west, north-east.
    pub corners: [Corner; 4],
    /// The ends of the coarser edge at the west, east, south and north side, from the south or west; where the neighbour is
    /// coarser.
    pub coarse: [Option<[Corner; 2]>; 4],
    /// Corners that a coarser cell touches.
    pub touched: [bool; 4],
}

impl Shape {
    /// Which sides are coarser, one bit each.
    pub fn mask(&self) -> usize {
        (0..4).fold(0, |mask, k| {
            mask | usize::from(self.coarse[k].is_some()) << k
        })
    }
}

/// Sixteen index lists: on sides of the mask (west, east, south, north) only every other vertex is used.
pub fn indices() -> [Arc<Indices>; 16] {
    std::array::from_fn(|mask| {
        let n = SEGMENTS;
        let at = |i: u32, j: u32| {
            let on = |side: usize| mask >> side & 1 == 1;
            let (mut x, mut y) = (i, j);
            if i == 0 && on(0) || i == n && on(1) {
                y &= !1;
            }
            if j == 0 && on(2) || j == n && on(3) {
                x &= !1;
            }
            y * (n + 1) + x
        };
        let mut triangles = Vec::new();
        for j in 0..n {
            for i in 0..n {
                let [sw, se, nw, ne] = [at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)];
                for [a, b, c] in [[sw, se, ne], [sw, ne, nw]] {
                    if a != b && b != c && c != a {
                        triangles.extend([a, b, c]);
                    }
                }
            }
        }
        Arc::new(Indices { triangles })
    })
}

/// Writes the vertices of a cell into a patch.
///
/// Heights of an edge are computed from the two ends of the edge alone, or of the coarser edge that it is half of, by the
/// same operations on both sides; positions from lattice places, in f64, then rounded to the grain of the coarsest cell that
/// holds them ([`Cell::grain_m`]). The origin is a multiple of all grains, so origin + f32 gives the same f64 on both sides.
pub fn write(ellipsoid: &Ellipsoid, cell: Cell, shape: &Shape, patch: &mut Patch) {
    let n = SIDE - 1;
    let steps = f64::from(cell.steps());
    let net = net(&shape.corners, steps, steps);
    let part = |k: usize| k as f64 / n as f64;
    let mut heights = [[0.0f64; SIDE]; SIDE];
    let mut rises = [[(0.0f64, 0.0f64); SIDE]; SIDE];
    for j in 0..SIDE {
        let columns = net.map(|column| cubic(column, part(j)));
        let (across, along) = (columns.map(|c| c.0), columns.map(|c| c.1));
        for i in 0..SIDE {
            let (z, zu) = cubic(across, part(i));
            heights[j][i] = z;
            rises[j][i] = (zu / steps, cubic(along, part(i)).0 / steps);
        }
    }
    for side in 0..4 {
        let along_u = side >= 2;
        let [a, b] = [[0, 2], [1, 3], [0, 1], [2, 3]][side];
        let (ends, scale, second) = match &shape.coarse[side] {
            Some(ends) => {
                let odd = if along_u { cell.x & 1 } else { cell.y & 1 };
                (*ends, 2.0, f64::from(odd))
            }
            None => ([shape.corners[a], shape.corners[b]], 1.0, 0.0),
        };
        let values = edge(&ends[0], &ends[1], scale * steps, along_u);
        for k in 1..n {
            let z = cubic(values, (part(k) + second) / scale).0;
            let (i, j) = [(0, k), (n, k), (k, 0), (k, n)][side];
            heights[j][i] = z;
        }
    }
    for (k, corner) in shape.corners.iter().enumerate() {
        heights[(k >> 1) * n][(k & 1) * n] = corner[0];
    }
    let (own, coarser) = (cell.grain_m(), cell.parent().grain_m());
    let lons: [(f64, f64); SIDE] = std::array::from_fn(|i| {
        let (s, c) = lon_rad(cell.vertex(i as u32, 0)[0]).sin_cos();
        (c, s)
    });
    let at = |i: usize, j: usize, height_m: f64| -> DVec3 {
        let y = cell.vertex(0, j as u32)[1];
        let (c, s) = cos_sin_lat(y);
        let surface = ellipsoid.surface_point(DVec3::new(c, 0.0, s));
        let rho = surface.x + height_m * c;
        let (lon_c, lon_s) = lons[i];
        DVec3::new(rho * lon_c, rho * lon_s, surface.z + height_m * s)
    };
    let snap = |p: DVec3, grain: f64| (p / grain).round() * grain;
    let half = n / 2;
    let origin = snap(at(half, half, ORIGIN_HEIGHT_M), ORIGIN_STEP_M);
    patch.origin_itrf_m = origin;
    patch.block = Some(cell.block());
    patch.vertices.clear();
    let e2 = ellipsoid.eccentricity_squared();
    for j in 0..SIDE {
        let y = cell.vertex(0, j as u32)[1];
        let (c, s) = cos_sin_lat(y);
        let surface = ellipsoid.surface_point(DVec3::new(c, 0.0, s));
        // Radii of curvature: along the prime vertical N, times cos φ, and along the meridian M.
        let w2 = 1.0 - e2 * s * s;
        let east_m = ellipsoid.equatorial_radius_m * c / w2.sqrt() * STEP_RAD;
        let north_m = ellipsoid.equatorial_radius_m * (1.0 - e2) / (w2 * w2.sqrt()) * STEP_RAD;
        for i in 0..SIDE {
            let height_m = heights[j][i];
            let position = if y == 0 || y == TALL {
                let z = surface.z + height_m * s;
                DVec3::new(0.0, 0.0, (z / POLE_GRAIN_M).round() * POLE_GRAIN_M)
            } else {
                let rho = surface.x + height_m * c;
                let p = DVec3::new(rho * lons[i].0, rho * lons[i].1, surface.z + height_m * s);
                snap(p, if shared(shape, i, j) { coarser } else { own })
            };
            let (zu, zv) = rises[j][i];
            let east = if c > 1e-6 { zu / east_m } else { 0.0 };
            patch.vertices.push(GroundVertex {
                from_origin_m: (position - origin).as_vec3(),
                height_m: height_m as f32,
                slope: Vec2::new(east as f32, (zv / north_m) as f32),
            });
        }
    }
    patch.changed.clear();
    patch.changed.push(0..VERTICES as u32);
}

/// Whether a coarser cell holds the vertex too.
fn shared(shape: &Shape, i: usize, j: usize) -> bool {
    let n = SIDE - 1;
    if (i == 0 || i == n) && (j == 0 || j == n) {
        return shape.touched[usize::from(i == n) + 2 * usize::from(j == n)];
    }
    let sides = [i == 0, i == n, j == 0, j == n];
    sides
        .iter()
        .zip(&shape.coarse)
        .any(|(on, coarse)| *on && coarse.is_some())
}
