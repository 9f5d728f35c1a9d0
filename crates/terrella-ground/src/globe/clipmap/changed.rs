//! Updates of levels where heights have changed.
//!
//! Samples are read again within the budget of a frame, those of the finest levels first. Until then they stay unchanged. Within a level
//! that opens no crack: neighbours share their vertices. Only points on the edges of diamonds have a copy in each diamond; these are read
//! again all at once. A level's border is the coarser level's surface, and is updated with it.

use super::lattice::{Icosahedron, LatticeIndex};
use super::level::{EDGE_RAD, HeightSource, Level};
use super::toroidal::ToroidalBuffer;
use crate::elevation::{Bounds, HeightChange};
use glam::DVec3;

/// Points along a side of the squares that are tested together.
const SQUARE: i64 = 16;

/// Marks the samples whose heights may have changed, and reads those on diamond edges again. Marked samples that are not drawn are dropped.
pub fn heights_changed(levels: &mut [Level], changes: &[HeightChange], source: &HeightSource<'_>) {
    for level in levels {
        // Heights are averaged over half a cell.
        let half_cell_rad = 0.5 * EDGE_RAD / level.n as f64;
        if !changes
            .iter()
            .any(|change| half_cell_rad < change.below_rad)
        {
            continue;
        }
        let (n, number) = (level.n, level.number);
        let extent = level.extent.clone();
        for buffer in &mut level.buffers {
            let diamond = buffer.diamond;
            let mut known: Vec<((i64, i64), bool)> = Vec::new();
            buffer.mark_stale(|i, j| {
                let square = (i / SQUARE, j / SQUARE);
                match known.last() {
                    Some((last, is_changed)) if *last == square => return *is_changed,
                    _ => {}
                }
                let found = known.iter().position(|(of, _)| *of == square);
                let is_changed = match found {
                    Some(at) => known.remove(at).1,
                    None => is_square_changed(diamond, square, n, changes, source),
                };
                known.push((square, is_changed));
                is_changed
            });
            let part = extent
                .as_ref()
                .and_then(|extent| extent.in_diamond(diamond));
            let radius = extent.as_ref().map_or(0, |extent| extent.radius);
            let is_drawn =
                |i, j| number == 0 || part.as_ref().is_some_and(|p| p.distance(i, j) <= radius);
            buffer.drop_stale(|i, j| !is_drawn(i, j));
            level.is_read_anew = true;
        }
        let on_edge = |i: i64, j: i64| i == 0 || j == 0 || i == n || j == n;
        let mut unbounded = u64::MAX;
        read_stale(level, on_edge, source, &mut unbounded);
    }
}

/// Whether heights or slopes in a square of points may have changed.
fn is_square_changed(
    diamond: u8,
    square: (i64, i64),
    n: i64,
    changes: &[HeightChange],
    source: &HeightSource<'_>,
) -> bool {
    let half_cell_rad = 0.5 * EDGE_RAD / n as f64;
    let at = |i: i64, j: i64| {
        let index = LatticeIndex {
            diamond,
            i: (square.0 * SQUARE + i).min(n),
            j: (square.1 * SQUARE + j).min(n),
        };
        place(source.icosahedron, index, n)
    };
    let last = SQUARE - 1;
    let corners = [(0, 0), (last, 0), (0, last), (last, last)].map(|(i, j)| at(i, j));
    let (middle, lat_rad, lon_rad) = at(SQUARE / 2, SQUARE / 2);
    let spread = corners
        .iter()
        .map(|(corner, ..)| corner.angle_between(middle));
    let radius_rad = 1.05 * spread.fold(2.0 * half_cell_rad, f64::max);
    // Slopes are computed over the spacing of the data, if that is larger.
    let all = corners
        .iter()
        .map(|(_, lat, lon)| (*lat, *lon))
        .chain([(lat_rad, lon_rad)]);
    let spacings = all.map(|(lat, lon)| source.ground.finest_spacing_rad(lat, lon));
    let step_rad = spacings
        .filter(|s| s.is_finite())
        .fold(half_cell_rad, f64::max);
    let around = Bounds::around(lat_rad, lon_rad, radius_rad);
    changes
        .iter()
        .any(|change| change.touches(&around, step_rad, half_cell_rad))
}

fn place(icosahedron: &Icosahedron, index: LatticeIndex, n: i64) -> (DVec3, f64, f64) {
    let normal = icosahedron.direction(index, n);
    let lat_rad = normal.z.atan2(normal.x.hypot(normal.y));
    (normal, lat_rad, normal.y.atan2(normal.x))
}

/// Reads the remaining stale samples again within a budget, the finest levels first, and updates the drawn vertices. Returns the number of
/// samples.
pub fn read_left(levels: &mut [Level], source: &HeightSource<'_>, budget: &mut u64) -> u64 {
    let mut read = 0;
    for level in levels.iter_mut().rev() {
        read += read_stale(level, |_, _| true, source, budget);
    }
    for number in 1..levels.len() {
        let (coarse, fine) = levels.split_at_mut(number);
        let coarse = &coarse[number - 1];
        if coarse.is_read_anew || fine[0].is_read_anew {
            fine[0].blend_into(Some(coarse));
        }
    }
    for level in levels {
        level.is_read_anew = false;
    }
    read
}

fn read_stale(
    level: &mut Level,
    is_meant: impl Fn(i64, i64) -> bool,
    source: &HeightSource<'_>,
    budget: &mut u64,
) -> u64 {
    let (n, quantum_m) = (level.n, Level::quantum_m(level.number));
    let is_globe = level.number == 0;
    let mut read = 0;
    let mut read_one = |buffer: &mut ToroidalBuffer, i: i64, j: i64| {
        let index = LatticeIndex {
            diamond: buffer.diamond,
            i,
            j,
        };
        let (point_m, mut vertex) = source.sample(index, n);
        let point_m = (point_m / quantum_m).round() * quantum_m;
        vertex.from_origin_m = (point_m - buffer.patch.origin_itrf_m).as_vec3();
        buffer.put(index, vertex);
        if is_globe {
            buffer.draw(buffer.slot(i, j), vertex);
        }
        read += 1;
    };
    for buffer in &mut level.buffers {
        buffer.take_stale(&is_meant, budget, &mut read_one);
    }
    level.is_read_anew |= read > 0;
    read
}
