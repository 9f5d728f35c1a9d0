//! The grid's triangles, in an order that keeps neighbours together, and the blocks that they may touch.

use super::GridFrame;
use crate::globe::{IndexRange, TriangleList, blocks_near};
use glam::DVec3;
use std::ops::Range;

/// Number of squares that a grid is divided into, each way.
const SQUARES: u32 = 8;
/// Points of a square that are tested, each way, besides the first.
const LOOKS: u32 = 4;

/// Cells of the squares along one side of the grid.
fn spans(samples: u32) -> impl Iterator<Item = Range<u32>> + Clone {
    let cells = samples - 1;
    let side = cells.div_ceil(SQUARES);
    (0..cells.div_ceil(side)).map(move |k| k * side..((k + 1) * side).min(cells))
}

/// Two triangles a cell, counter-clockwise with x to the right and y upwards; square by square.
pub fn indices((columns, rows): (u32, u32)) -> TriangleList {
    let mut triangles = Vec::with_capacity(6 * (columns as usize - 1) * (rows as usize - 1));
    for down in spans(rows) {
        for across in spans(columns) {
            for row in down.clone() {
                for column in across.clone() {
                    let corner = row * columns + column;
                    let above = corner + columns;
                    triangles.extend([corner, corner + 1, above + 1, corner, above + 1, above]);
                }
            }
        }
    }
    TriangleList { triangles }
}

/// The squares of a frame's triangles, and the blocks that they may touch at any height.
///
/// In each square 5 × 5 points are tested. Points between them are in the bounding box of the tested ones, or outside it by less than half
/// of the distance between adjacent ones.
pub fn grid_ranges(frame: &GridFrame, out: &mut Vec<IndexRange>) {
    out.clear();
    let (columns, rows) = frame.samples;
    let radii_m = frame.caster.radii_m;
    let mut start = 0;
    for down in spans(rows) {
        for across in spans(columns) {
            let at = |span: &Range<u32>, k: u32| span.start + (span.end - span.start) * k / LOOKS;
            let mut places = [[DVec3::ZERO; LOOKS as usize + 1]; LOOKS as usize + 1];
            let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            for (row, places) in (0..).zip(&mut places) {
                for (column, place) in (0..).zip(places) {
                    let sample = frame.sample(at(&across, column), at(&down, row));
                    *place = sample.place * radii_m;
                    (low, high) = (low.min(*place), high.max(*place));
                }
            }
            let aside = places.iter().flat_map(|row| row.windows(2));
            let aside = aside.map(|pair| pair[0].distance(pair[1]));
            let above = places
                .windows(2)
                .flat_map(|rows| rows[0].iter().zip(&rows[1]));
            let above = above.map(|(one, other)| one.distance(*other));
            let gap_m = aside.chain(above).fold(0.0, f64::max);
            let radius_m = 0.5 * low.distance(high) + 0.5 * gap_m;
            let cells = (down.end - down.start) * (across.end - across.start);
            let end = start + 6 * cells;
            out.push(IndexRange {
                indices: start..end,
                blocks: blocks_near(&frame.ellipsoid, 0.5 * (low + high), radius_m),
            });
            start = end;
        }
    }
}
