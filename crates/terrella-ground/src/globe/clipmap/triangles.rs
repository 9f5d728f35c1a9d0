//! The triangles that a level draws: its extent minus that of the finer one, with an outer border at half the rate.

use super::lattice::{LatticeIndex, Triangle};
use super::level_extent::{DiamondExtent, LevelExtent};
use std::ops::Range;

/// Appends the triangles of a level in one diamond, three indices each, square by square.
///
/// The level covers whole triangles of the next coarser lattice. Each is cut in four. If the triangle across an edge is outside the extent,
/// that edge stays whole, because the coarser level draws it whole. The finer level's extent is left out.
///
/// * `extent` – the level's extent in the coarser lattice.
/// * `hole` – the finer level's extent in the lattice of this level.
/// * `slot` – index of the vertex at (i, j).
pub fn ring(
    extent: &LevelExtent,
    diamond: u8,
    hole: Option<&LevelExtent>,
    slot: impl Fn(i64, i64) -> u32,
    out: &mut Vec<u32>,
) {
    let Some(span) = extent.box_in(diamond) else {
        return;
    };
    let Some(coarse) = extent.in_diamond(diamond) else {
        return;
    };
    let hole = hole.and_then(|hole| hole.in_diamond(diamond));
    let r = extent.radius;
    for (rows, columns) in squares(span.least, span.most, SQUARE / 2) {
        for (i, j) in rows.flat_map(|i| columns.clone().map(move |j| (i, j))) {
            let at = hole
                .as_ref()
                .map_or(Hole::Off, |hole| hole_at(hole, 2 * i, 2 * j, 2));
            if at == Hole::All {
                continue;
            }
            // One distance is enough for the four corners: they are within two steps of each other.
            let inside = coarse.distance(i, j) <= r - 3;
            for far in [false, true] {
                let triangle = Triangle {
                    cell: LatticeIndex { diamond, i, j },
                    far,
                };
                let mut whole = [false; 3];
                if !inside {
                    if !extent.holds(triangle) {
                        continue;
                    }
                    let across = triangle.neighbours(extent.n);
                    whole = across.map(|across| !extent.holds(across));
                }
                let corners = triangle.corners().map(|c| (2 * c.i, 2 * c.j));
                let kept = |t: &[(i64, i64); 3]| match (&hole, at) {
                    (Some(hole), Hole::Edge) => {
                        // At a hole every edge is cut. The triangle is the near one if it has the cell's corner of smallest indices.
                        let least = (
                            t[0].0.min(t[1].0).min(t[2].0),
                            t[0].1.min(t[1].1).min(t[2].1),
                        );
                        !hole.holds(least.0, least.1, !t.contains(&least))
                    }
                    _ => true,
                };
                cut(corners, whole, |t| {
                    if kept(&t) {
                        out.extend(t.map(|(i, j)| slot(i, j)));
                    }
                });
            }
        }
    }
}

/// Appends all triangles of a diamond of `n` cells, minus those of the finer level's extent.
pub fn full(
    n: i64,
    diamond: u8,
    hole: Option<&LevelExtent>,
    slot: impl Fn(i64, i64) -> u32,
    out: &mut Vec<u32>,
) {
    let hole = hole.and_then(|hole| hole.in_diamond(diamond));
    for (rows, columns) in squares((0, 0), (n, n), SQUARE) {
        for (i, j) in rows.flat_map(|i| columns.clone().map(move |j| (i, j))) {
            for far in [false, true] {
                let cell = LatticeIndex { diamond, i, j };
                let corners = Triangle { cell, far }.corners();
                let held = hole.as_ref().is_some_and(|hole| hole.holds(i, j, far));
                if !held {
                    out.extend(corners.map(|c| slot(c.i, c.j)));
                }
            }
        }
    }
}

/// Cells along the edge of a square whose triangles are consecutive in the list.
const SQUARE: i64 = 16;

/// A box in squares of `side` cells an edge, with smaller ones at its end.
fn squares(
    least: (i64, i64),
    most: (i64, i64),
    side: i64,
) -> impl Iterator<Item = (Range<i64>, Range<i64>)> {
    let spans = move |least: i64, most: i64| {
        let starts = (least..most).step_by(side as usize);
        starts.map(move |start| start..(start + side).min(most))
    };
    spans(least.0, most.0)
        .flat_map(move |rows| spans(least.1, most.1).map(move |columns| (rows.clone(), columns)))
}

/// How much of a square of cells the hole removes.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Hole {
    Off,
    Edge,
    All,
}

/// The hole's effect on the cells from (i, j) to (i + size, j + size). A king's step is at most two of a hexagon's.
fn hole_at(hole: &DiamondExtent<'_>, i: i64, j: i64, size: i64) -> Hole {
    let beyond = hole.distance(i, j) - hole.radius();
    if beyond > 2 * size {
        Hole::Off
    } else if beyond <= -2 * size {
        Hole::All
    } else {
        Hole::Edge
    }
}

/// Cuts a triangle (corners a, b, c, all even) in four, or fewer where the edges ab, bc, ca must stay whole.
fn cut(corners: [(i64, i64); 3], whole: [bool; 3], mut out: impl FnMut([(i64, i64); 3])) {
    let mid = |x: (i64, i64), y: (i64, i64)| ((x.0 + y.0) / 2, (x.1 + y.1) / 2);
    // Rotated so that whole edges come first.
    let turn = match whole {
        [false, true, false] | [false, true, true] => 1,
        [false, false, true] | [true, false, true] => 2,
        _ => 0,
    };
    let [a, b, c] = std::array::from_fn(|k| corners[(k + turn) % 3]);
    let (ab, bc, ca) = (mid(a, b), mid(b, c), mid(c, a));
    match whole.iter().filter(|whole| **whole).count() {
        0 => [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            .into_iter()
            .for_each(out),
        1 => [[a, b, bc], [a, bc, ca], [ca, bc, c]]
            .into_iter()
            .for_each(out),
        2 => [[a, b, ca], [b, c, ca]].into_iter().for_each(out),
        _ => out([a, b, c]),
    }
}
