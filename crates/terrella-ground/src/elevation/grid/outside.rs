//! Where neighbours continue a grid whose border, or theirs, is not along parallels and meridians: by places beyond the border.

use super::placement::Placement;
use std::f64::consts::TAU;

pub(super) const WEST: usize = 0;
pub(super) const EAST: usize = 1;
pub(super) const NORTH: usize = 2;
pub(super) const SOUTH: usize = 3;

/// Largest gap between touching grids, in samples of the coarser: the outermost posts of tiles that share none.
pub(super) const TOUCH: f64 = 1.01;

/// Intervals along a side between places that are tried.
const INTERVALS: usize = 32;

/// Halvings of such an interval, and of a gap.
const HALVINGS: usize = 14;

/// Tolerance, in samples, within which a place counts as covered.
const ROOM: f64 = 0.02;

/// Places just beyond each side of a grid: row or column along the side, and latitude and longitude, radians.
pub(super) struct Outside {
    sides: [Vec<(f64, (f64, f64))>; 4],
}

impl Outside {
    pub fn of(grid: &Placement) -> Self {
        let side = |side| {
            let (count, _) = along_and_width(grid, side);
            let margin = grid.border().lattice.margin();
            let tried = (0..=INTERVALS).map(|n| {
                let part = n as f64 / INTERVALS as f64;
                let along = -margin + part * ((count - 1) as f64 + 2.0 * margin);
                (along, place(grid, side, along, TOUCH))
            });
            tried.collect()
        };
        // Grids without a plane have none.
        let sides = match grid.border().lattice.is_periodic {
            true => [Vec::new(), Vec::new(), side(NORTH), side(SOUTH)],
            false => [side(WEST), side(EAST), side(NORTH), side(SOUTH)],
        };
        Self { sides }
    }

    /// The stretches of a side that a neighbour covers, in rows or columns, and the gap between the two, samples.
    pub fn covered(
        &self,
        side: usize,
        grid: &Placement,
        other: &Placement,
        is_above: bool,
    ) -> (Vec<(f64, f64)>, f64) {
        // The upper grid blends into the lower one where that extends far enough beneath it.
        let (_, width) = along_and_width(grid, side);
        let is_covered = |along: f64, beyond| {
            covers(other, beyond) && !(is_above && covers(other, place(grid, side, along, -width)))
        };
        let at = |along: f64| is_covered(along, place(grid, side, along, TOUCH));
        let mut stretches = Vec::new();
        let mut begun: Option<f64> = None;
        let mut gap: f64 = 0.0;
        let mut before: Option<f64> = None;
        for &(along, beyond) in &self.sides[side] {
            let is_in = is_covered(along, beyond);
            match (is_in, begun) {
                (true, None) => {
                    begun = Some(before.map_or(along, |out| change(&at, along, out)));
                }
                (false, Some(from)) => {
                    let last = before.unwrap_or(from);
                    stretches.push((from, change(&at, last, along)));
                    begun = None;
                }
                _ => {}
            }
            if is_in {
                gap = gap.max(gap_at(grid, other, side, along));
            }
            before = Some(along);
        }
        if let (Some(from), Some(last)) = (begun, before) {
            stretches.push((from, last));
        }
        (stretches, gap)
    }
}

/// Samples along a side, and the width of its feather, samples.
fn along_and_width(grid: &Placement, side: usize) -> (usize, f64) {
    let border = grid.border();
    match side {
        WEST | EAST => (border.lattice.rows, 1.0 / border.ramps.1),
        _ => (border.lattice.columns, 1.0 / border.ramps.0),
    }
}

/// The place so many samples beyond a side.
fn place(grid: &Placement, side: usize, along: f64, beyond: f64) -> (f64, f64) {
    let lattice = &grid.border().lattice;
    let out = lattice.margin() + beyond;
    let last = |count: usize| (count - 1) as f64;
    let (row, column) = match side {
        WEST => (along, -out),
        EAST => (along, last(lattice.columns) + out),
        NORTH => (-out, along),
        _ => (last(lattice.rows) + out, along),
    };
    grid.place_of_border(row, column)
}

/// Whether a grid covers a place.
fn covers(grid: &Placement, (lat_rad, lon_rad): (f64, f64)) -> bool {
    let bounds = &grid.bounds;
    // Costs less than the projection.
    let is_near = lat_rad >= bounds.south_rad - 1e-9
        && lat_rad <= bounds.north_rad + 1e-9
        && (lon_rad - bounds.west_rad + 1e-9).rem_euclid(TAU) <= bounds.width_rad + 2e-9;
    if !is_near {
        return false;
    }
    let (row, column) = grid.border_at(lat_rad, lon_rad);
    let lattice = &grid.border().lattice;
    let room = lattice.margin() + ROOM;
    let within = |at: f64, count: usize| at >= -room && at <= (count - 1) as f64 + room;
    within(row, lattice.rows) && (lattice.is_periodic || within(column, lattice.columns))
}

/// Where along a side the cover changes, from a place that is covered to one that is not.
fn change(at: &impl Fn(f64) -> bool, mut covered: f64, mut open: f64) -> f64 {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (covered + open);
        match at(middle) {
            true => covered = middle,
            false => open = middle,
        }
    }
    covered
}

/// The gap between a side and the neighbour beyond it, samples.
fn gap_at(grid: &Placement, other: &Placement, side: usize, along: f64) -> f64 {
    let is_in = |beyond: f64| covers(other, place(grid, side, along, beyond));
    if is_in(0.0) {
        return 0.0;
    }
    let (mut near, mut far) = (0.0, TOUCH);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (near + far);
        match is_in(middle) {
            true => far = middle,
            false => near = middle,
        }
    }
    // Without the room that covered places have.
    far + ROOM
}
