//! Triangles over one cell.

use super::super::hermite::{Corner, restrict};
use super::knots::{CoarserNeighbours, KNOTS, Knots};
use super::lattice::{
    Cell, ORIGIN_HEIGHT_M, ORIGIN_STEP_M, PIECES, SEGMENTS, STEP_RAD, TALL, cos_sin_lat, lat_rad,
    lon_rad,
};
use crate::elevation::Elevation;
use crate::globe::{GroundVertex, Patch, TriangleList};
use glam::{DVec2, DVec3};
use std::sync::Arc;
use terrella_frames::Ellipsoid;

const SIDE: usize = SEGMENTS as usize + 1;
/// Vertices of a cell.
pub const VERTICES: usize = SIDE * SIDE;
/// Heights at a pole are rounded to this, so that cells of all levels represent them exactly.
const POLE_GRAIN_M: f64 = 1.0 / 64.0;
/// Cosines of the latitudes between which slopes change to those of the ground around a vertex. Towards a pole the columns converge, until
/// the heights of two of them differ more by the data's rounding than by a slope.
const POLAR: (f64, f64) = (0.10, 0.18);

/// Heights and derivatives at the vertices of a cell, `[row from the south][column from the west]`.
pub type Vertices = [[Corner; SIDE]; SIDE];

/// Each patch by its corners, the middles of its edges and its own middle: each is halfway between two. On an edge they depend on the two
/// ends alone, by the same operations for the cells on both sides.
pub fn vertices(cell: Cell, knots: &Knots) -> Vertices {
    let steps = f64::from(cell.steps() / PIECES);
    let halved = |row: &[Corner; KNOTS]| -> [Corner; SIDE] {
        std::array::from_fn(|i| match i & 1 {
            0 => row[i / 2],
            _ => restrict(&row[i / 2], &row[i / 2 + 1], steps, 0.5, true),
        })
    };
    let rows = knots.each_ref().map(halved);
    std::array::from_fn(|j| match j & 1 {
        0 => rows[j / 2],
        _ => {
            let (south, north) = (&rows[j / 2], &rows[j / 2 + 1]);
            std::array::from_fn(|i| restrict(&south[i], &north[i], steps, 0.5, false))
        }
    })
}

/// Sixteen index lists: on sides in the mask (west, east, south, north) only every other vertex is used.
pub fn indices() -> [Arc<TriangleList>; 16] {
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
        Arc::new(TriangleList { triangles })
    })
}

/// Whether some vertices of a cell use the slope of the ground around them, so that its knots alone do not determine them.
pub fn reads_slopes(cell: Cell) -> bool {
    [0, SEGMENTS]
        .iter()
        .any(|j| cos_sin_lat(cell.vertex(0, *j)[1]).0 < POLAR.1)
}

/// Writes the vertices of a cell into a patch, and returns the number of heights read.
///
/// Positions follow from lattice points and heights, in f64, and are rounded to the grain of the coarsest cell that contains them
/// ([`Cell::grain_m`]). The origin is a multiple of all grains, so origin + f32 is the same f64 on both sides.
pub fn write(
    ellipsoid: &Ellipsoid,
    ground: &dyn Elevation,
    cell: Cell,
    coarser: CoarserNeighbours,
    knots: &Knots,
    patch: &mut Patch,
) -> u64 {
    let (own_m, parents_m) = (cell.grain_m(), cell.parent().grain_m());
    let lons: [(f64, f64); SIDE] = std::array::from_fn(|i| {
        let (s, c) = lon_rad(cell.vertex(i as u32, 0)[0]).sin_cos();
        (c, s)
    });
    let snap = |p: DVec3, grain: f64| (p / grain).round() * grain;
    let place = |(c, s): (f64, f64), (lon_c, lon_s): (f64, f64), height_m: f64| {
        let surface = ellipsoid.surface_point(DVec3::new(c, 0.0, s));
        let rho = surface.x + height_m * c;
        DVec3::new(rho * lon_c, rho * lon_s, surface.z + height_m * s)
    };
    let half = SIDE / 2;
    let middle = cos_sin_lat(cell.vertex(0, half as u32)[1]);
    let origin = snap(place(middle, lons[half], ORIGIN_HEIGHT_M), ORIGIN_STEP_M);
    patch.origin_itrf_m = origin;
    patch.block = Some(cell.block());
    patch.vertices.clear();
    let e2 = ellipsoid.eccentricity_squared();
    let segment_rad = f64::from(cell.steps() / SEGMENTS) * STEP_RAD;
    let mut samples = 0;
    for (j, row) in vertices(cell, knots).iter().enumerate() {
        let y = cell.vertex(0, j as u32)[1];
        let (c, s) = cos_sin_lat(y);
        // Radii of curvature: along the prime vertical N, times cos φ, and along the meridian M.
        let w2 = 1.0 - e2 * s * s;
        let east_m = ellipsoid.equatorial_radius_m * c / w2.sqrt() * STEP_RAD;
        let north_m = ellipsoid.equatorial_radius_m * (1.0 - e2) / (w2 * w2.sqrt()) * STEP_RAD;
        let polar = ((POLAR.1 - c) / (POLAR.1 - POLAR.0)).clamp(0.0, 1.0);
        for (i, [height_m, zu, zv, _]) in row.iter().copied().enumerate() {
            let shared = shared(coarser, i, j);
            let position = if y == 0 || y == TALL {
                let z = place((c, s), lons[i], height_m).z;
                DVec3::new(0.0, 0.0, (z / POLE_GRAIN_M).round() * POLE_GRAIN_M)
            } else {
                let grain = if shared { parents_m } else { own_m };
                snap(place((c, s), lons[i], height_m), grain)
            };
            let mut slope = DVec2::new(zu / east_m.max(1e-9), zv / north_m);
            if polar > 0.0 {
                // As wide as the derivatives of the cells' knots, or the coarser one's if it has the vertex too.
                let spacing_rad = if shared { 4.0 } else { 2.0 } * segment_rad;
                let lon = lon_rad(cell.vertex(i as u32, 0)[0]);
                let about = ground.slope(ellipsoid, lat_rad(y), lon, spacing_rad);
                slope = if polar < 1.0 {
                    slope.lerp(about, polar)
                } else {
                    about
                };
                samples += 4;
            }
            patch.vertices.push(GroundVertex {
                from_origin_m: (position - origin).as_vec3(),
                height_m: height_m as f32,
                slope: slope.as_vec2(),
            });
        }
    }
    patch.changed.clear();
    patch.changed.push(0..VERTICES as u32);
    samples
}

/// Whether a coarser cell has the vertex too.
fn shared(coarser: CoarserNeighbours, i: usize, j: usize) -> bool {
    let n = SIDE - 1;
    if (i == 0 || i == n) && (j == 0 || j == n) {
        return coarser.corner(usize::from(i == n) + 2 * usize::from(j == n));
    }
    let sides = [i == 0, i == n, j == 0, j == n];
    (0..4).any(|k| sides[k] && coarser.side(k))
}
