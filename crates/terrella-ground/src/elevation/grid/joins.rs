//! Where another grid of similar spacing continues a grid beyond its border.
//!
//! A grid is feathered along its border into the source beneath. If a neighbour touches it, both would fade into the sea along their seam. The
//! feather is therefore measured from the open stretches of the border, which no neighbour covers:
//! ```text
//!   weight = s(d_x) s(d_y),   d = the distance to the nearest open stretch, in widths of the feather
//! ```
//!
//! with s smooth from 0 to 1. On a border without a neighbour, d is the distance to the border. Joined grids have the same feather
//! width, so that weights continue from one to the other.

use super::feather::Feather;
use super::outside::{EAST, NORTH, Outside, SOUTH, TOUCH, WEST};
use super::placement::Placement;
use crate::elevation::{Bounds, PlacedBounds};
use crate::step::smooth_step;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Spacings within this factor are similar. Otherwise the finer grid blends into the coarser one.
const LIKE: f64 = 2.0;

/// Connections of a grid with other grids.
#[derive(Clone, Debug, Default)]
pub struct Joins(Option<Box<Joined>>);

#[derive(Clone, Debug)]
struct Joined {
    /// Stretches of the western, eastern, northern and southern border without a neighbour, in rows or
    /// columns.
    open: [Vec<(f64, f64)>; 4],
    /// How far the grid extends beyond a border with a neighbour, samples: half of the gap.
    reach: [Option<f64>; 4],
    /// Increase of the weight per row and per column inwards, before smoothing.
    ramps: (f64, f64),
}

impl Joins {
    /// Joins of stacked grids, the uppermost first.
    pub fn of(grids: &[&Placement]) -> Vec<Self> {
        let mut all: Vec<Joined> = grids
            .iter()
            .map(|grid| Joined::alone(grid.border()))
            .collect();
        let outsides: Vec<_> = match grids.iter().any(|grid| grid.plane.is_some()) {
            true => grids.iter().map(|grid| Outside::of(grid)).collect(),
            false => Vec::new(),
        };
        let placed = PlacedBounds::new(grids.iter().map(|grid| grid.bounds));
        let (mut pairs, mut is_joined) = (Vec::new(), vec![false; grids.len()]);
        for (n, grid) in grids.iter().enumerate() {
            for m in placed.near(&grid.reach()) {
                let other = grids[m];
                if n == m || !is_like(grid, other) {
                    continue;
                }
                let (joins, is_one_frame) = match (&grid.plane, &other.plane) {
                    (None, None) => (all[n].join(grid, other, n < m), true),
                    (own, its) => (
                        all[n].join_outside(&outsides[n], grid, other, n < m),
                        own.as_ref()
                            .zip(its.as_ref())
                            .is_some_and(|(a, b)| a.is_of(b)),
                    ),
                };
                if joins {
                    (is_joined[n], is_joined[m]) = (true, true);
                    // Widths are shared within one frame.
                    if is_one_frame {
                        pairs.push((n, m));
                    }
                }
            }
        }
        for joined in &mut all {
            for open in &mut joined.open {
                // Removes gaps between two neighbours that touch.
                open.retain(|(from, to)| to - from > 2.0 * TOUCH);
            }
        }
        share_widths(grids, &pairs, &mut all);
        let joins = all.into_iter().zip(is_joined);
        joins
            .map(|(joined, is_joined)| Self(is_joined.then(|| Box::new(joined))))
            .collect()
    }

    /// The border's factor of the weight at a row and column, 0…1.
    #[inline]
    pub(in crate::elevation) fn inside(&self, place: &Placement, row: f64, column: f64) -> f64 {
        match &self.0 {
            None => place.inside(row, column),
            Some(joined) => place.at_border(row, column, |border, row, column| {
                joined.inside(border, row, column)
            }),
        }
    }
}

impl Placement {
    /// Bounds within which a grid of similar spacing touches: this grid's bounds plus a little more than a sample of such a grid. This
    /// grid gives no heights beyond them.
    pub fn reach(&self) -> Bounds {
        let more = |step_rad: f64| 2.0 * LIKE * TOUCH * step_rad;
        // Steps along parallels may differ more than steps on the ground.
        let (tall, wide) = (
            more(self.lattice.lat_step_rad),
            4.0 * more(self.lattice.lon_step_rad),
        );
        Bounds {
            south_rad: (self.bounds.south_rad - tall).max(-FRAC_PI_2),
            north_rad: (self.bounds.north_rad + tall).min(FRAC_PI_2),
            west_rad: self.bounds.west_rad - wide,
            width_rad: (self.bounds.width_rad + 2.0 * wide).min(TAU),
        }
    }
}

fn is_like(a: &Placement, b: &Placement) -> bool {
    let ratio = a.finest_rad / b.finest_rad;
    (1.0 / LIKE..=LIKE).contains(&ratio)
}

/// Gives joined grids the narrowest feather among them.
fn share_widths(grids: &[&Placement], pairs: &[(usize, usize)], all: &mut [Joined]) {
    // Each round propagates a width by one grid.
    for _ in 0..grids.len() {
        let mut is_done = true;
        for &(n, m) in pairs {
            let steps = |at: usize| {
                let lattice = &grids[at].border().lattice;
                (lattice.lat_step_rad, lattice.lon_step_rad)
            };
            // Weight per radian.
            let of = |at: usize| (all[at].ramps.0 / steps(at).0, all[at].ramps.1 / steps(at).1);
            let (one, two) = (of(n), of(m));
            let steepest = (one.0.max(two.0), one.1.max(two.1));
            for at in [n, m] {
                let ramps = (steepest.0 * steps(at).0, steepest.1 * steps(at).1);
                let old = all[at].ramps;
                is_done &= ramps.0 <= old.0 * (1.0 + 1e-12) && ramps.1 <= old.1 * (1.0 + 1e-12);
                all[at].ramps = ramps;
            }
        }
        if is_done {
            return;
        }
    }
}

impl Joined {
    fn alone(place: &Feather) -> Self {
        let lattice = &place.lattice;
        let margin = lattice.margin();
        let whole = |count: usize, is_border: bool| match is_border {
            true => vec![(-margin, (count - 1) as f64 + margin)],
            false => Vec::new(),
        };
        let sides = whole(lattice.rows, !lattice.is_periodic);
        Self {
            open: [
                sides.clone(),
                sides,
                whole(lattice.columns, !lattice.reaches_north),
                whole(lattice.columns, !lattice.reaches_south),
            ],
            reach: [None; 4],
            ramps: place.ramps,
        }
    }

    /// Removes the stretches that a neighbour covers. Returns whether there are any.
    fn join(&mut self, place: &Placement, other: &Placement, is_above: bool) -> bool {
        let lattice = &place.lattice;
        let (own, its) = (&place.bounds, &other.bounds);
        let lat_near = TOUCH * lattice.lat_step_rad.max(other.lattice.lat_step_rad);
        let lon_near = TOUCH * lattice.lon_step_rad.max(other.lattice.lon_step_rad);
        let widths = (
            lattice.lat_step_rad / place.border().ramps.0,
            lattice.lon_step_rad / place.border().ramps.1,
        );
        let mut joins = false;
        for side in [WEST, EAST, NORTH, SOUTH] {
            if self.open[side].is_empty() {
                continue;
            }
            let (overlap, near, step, width) = match side {
                WEST | EAST => (
                    overlap_along_parallel(own, its, side, lon_near),
                    lon_near,
                    lattice.lon_step_rad,
                    widths.1,
                ),
                _ => (
                    overlap_along_meridian(own, its, side, lat_near),
                    lat_near,
                    lattice.lat_step_rad,
                    widths.0,
                ),
            };
            let Some(overlap) = overlap.filter(|overlap| *overlap >= -near) else {
                continue;
            };
            // The upper grid blends into the lower one where that extends far enough beneath it.
            if is_above && overlap >= width {
                continue;
            }
            let covered = match side {
                WEST | EAST => rows_of(place, its),
                _ => columns_of(place, its),
            };
            let gap = (-overlap).max(0.0) / step;
            joins |= self.cover(side, covered, gap, is_above);
        }
        joins
    }

    /// The same where a border is not along parallels and meridians.
    fn join_outside(
        &mut self,
        outside: &Outside,
        grid: &Placement,
        other: &Placement,
        is_above: bool,
    ) -> bool {
        let mut joins = false;
        for side in [WEST, EAST, NORTH, SOUTH] {
            if !self.open[side].is_empty() {
                let (covered, gap) = outside.covered(side, grid, other, is_above);
                joins |= self.cover(side, covered, gap, is_above);
            }
        }
        joins
    }

    /// Removes covered stretches of a side, with a gap to the neighbour of so many samples. Returns whether there were any.
    fn cover(&mut self, side: usize, covered: Vec<(f64, f64)>, gap: f64, is_above: bool) -> bool {
        let open = &mut self.open[side];
        let before = open.clone();
        for stretch in covered {
            *open = open.iter().flat_map(|one| without(*one, stretch)).collect();
        }
        if *open == before {
            return false;
        }
        // On the seam itself only the upper grid counts.
        let rounding = if is_above { 1e-6 } else { -5e-7 };
        let reach = 0.5 * gap + rounding;
        self.reach[side] = Some(self.reach[side].map_or(reach, |known| known.max(reach)));
        true
    }

    fn inside(&self, place: &Feather, row: f64, column: f64) -> f64 {
        let lattice = &place.lattice;
        let margin = lattice.margin();
        let (last_row, last_column) = ((lattice.rows - 1) as f64, (lattice.columns - 1) as f64);
        // Depths from each border inwards, samples.
        let depths = [
            column + margin,
            last_column + margin - column,
            row + margin,
            last_row + margin - row,
        ];
        let is_border = [
            !lattice.is_periodic,
            !lattice.is_periodic,
            !lattice.reaches_north,
            !lattice.reaches_south,
        ];
        let mut nearest = [f64::INFINITY; 2];
        for (side, depth) in depths.into_iter().enumerate() {
            if !is_border[side] {
                continue;
            }
            let reach = self.reach[side].unwrap_or(0.0);
            if depth.is_nan() || depth < -reach {
                return 0.0;
            }
            let (along, across_ramp, along_ramp) = match side {
                WEST | EAST => (row, self.ramps.1, self.ramps.0),
                _ => (column, self.ramps.0, self.ramps.1),
            };
            for (from, to) in &self.open[side] {
                let beside = (from - along).max(along - to).max(0.0);
                // Beyond its border a grid counts only beside a neighbour.
                if beside <= 0.0 && depth <= 0.0 {
                    return 0.0;
                }
                let distance = (depth.max(0.0) * across_ramp).hypot(beside * along_ramp);
                let axis = &mut nearest[side / 2];
                *axis = axis.min(distance);
            }
        }
        smooth_step([0.0, 1.0], nearest[0]) * smooth_step([0.0, 1.0], nearest[1])
    }
}

/// How far a neighbour that continues a grid beyond its western or eastern border reaches inside it, radians. Negative for a gap.
fn overlap_along_parallel(own: &Bounds, its: &Bounds, side: usize, near: f64) -> Option<f64> {
    if its.width_rad >= TAU - 1e-9 {
        return Some(f64::INFINITY);
    }
    let inside = match side {
        // From the neighbour's far side to a place just beyond the border.
        WEST => (its.west_rad + its.width_rad) - (own.west_rad - near),
        _ => own.west_rad + own.width_rad + near - its.west_rad,
    };
    let inside = inside.rem_euclid(TAU);
    (inside <= its.width_rad).then_some(inside - near)
}

/// The same for the northern or southern border.
fn overlap_along_meridian(own: &Bounds, its: &Bounds, side: usize, near: f64) -> Option<f64> {
    match side {
        NORTH => {
            let beyond = (own.north_rad + near).min(FRAC_PI_2);
            (its.north_rad >= beyond - 1e-12).then_some(own.north_rad - its.south_rad)
        }
        _ => {
            let beyond = (own.south_rad - near).max(-FRAC_PI_2);
            (its.south_rad <= beyond + 1e-12).then_some(its.north_rad - own.south_rad)
        }
    }
}

/// Rows of a grid's border that a neighbour covers.
fn rows_of(place: &Placement, its: &Bounds) -> Vec<(f64, f64)> {
    let lattice = &place.lattice;
    let row = |lat_rad: f64| (lattice.north_rad - lat_rad) / lattice.lat_step_rad;
    vec![(row(its.north_rad), row(its.south_rad))]
}

/// Columns of a grid's border that a neighbour covers, modulo 360°.
fn columns_of(place: &Placement, its: &Bounds) -> Vec<(f64, f64)> {
    let lattice = &place.lattice;
    let first = (its.west_rad - lattice.west_rad).rem_euclid(TAU);
    let width = its.width_rad;
    [first - TAU, first]
        .map(|first| {
            (
                first / lattice.lon_step_rad,
                (first + width) / lattice.lon_step_rad,
            )
        })
        .to_vec()
}

/// The parts of a stretch outside another.
fn without((from, to): (f64, f64), (begin, end): (f64, f64)) -> impl Iterator<Item = (f64, f64)> {
    let left = [(from, to.min(begin)), (from.max(end), to)];
    left.into_iter().filter(|(from, to)| from < to)
}
