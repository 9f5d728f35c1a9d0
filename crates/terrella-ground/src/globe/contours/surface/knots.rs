//! The corners of a cell's patches, and their values beside a coarser cell.

use super::super::hermite::{Corner, estimate, restrict};
use super::ContourSurface;
use super::lattice::{AROUND, Cell, PIECES, SEGMENTS, STEP_RAD, TALL, lat_rad, lon_rad};
use crate::elevation::Elevation;

/// Knots along an edge of a cell.
pub const KNOTS: usize = PIECES as usize + 1;

/// Corners of the patches of a cell, `[row from the south][column from the west]`.
pub type Knots = [[Corner; KNOTS]; KNOTS];

/// West, east, south, north.
pub const SIDES: [(i32, i32); 4] = [(-1, 0), (1, 0), (0, -1), (0, 1)];
/// South-west, south-east, north-west, north-east.
pub const DIAGONALS: [(i32, i32); 4] = [(-1, -1), (1, -1), (-1, 1), (1, 1)];

/// The coarser neighbours of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CoarserNeighbours {
    /// A bit for each of [`SIDES`].
    pub sides: u8,
    /// A bit for each of [`DIAGONALS`]: whether the corner belongs to a coarser cell too, across a side or not.
    pub corners: u8,
}

impl CoarserNeighbours {
    /// Whether there is a coarser cell beyond a side.
    pub fn side(self, k: usize) -> bool {
        self.sides >> k & 1 == 1
    }

    /// Whether a coarser cell touches a corner.
    pub fn corner(self, k: usize) -> bool {
        self.corners >> k & 1 == 1
    }
}

/// The spacing at which heights of a cell's knots are requested, radians.
pub fn knots_spacing_rad(cell: Cell) -> f64 {
    0.25 * f64::from(cell.steps() / PIECES) * STEP_RAD
}

/// Row and column of knot `m` along a side.
fn along(side: usize, m: usize) -> [usize; 2] {
    let last = KNOTS - 1;
    [[m, 0], [m, last], [0, m], [last, m]][side]
}

/// The knot of a cell at a lattice point, which must be one of its knots.
fn knot_at(cell: Cell, knots: &Knots, [x, y]: [u32; 2]) -> Corner {
    let [x0, y0] = cell.vertex(0, 0);
    let step = cell.steps() / PIECES;
    let (i, j) = ((x + AROUND - x0) % AROUND / step, (y - y0) / step);
    knots[j as usize][i as usize]
}

impl ContourSurface {
    /// Height at a lattice point; longitudes wrap around, latitudes run to the poles.
    pub(super) fn height_m(
        &mut self,
        ground: &dyn Elevation,
        [x, y]: [u32; 2],
        spacing_rad: f64,
    ) -> f64 {
        self.samples += 1;
        // A pole is one point, whatever the size of the cells around it.
        let spacing_rad = if y == 0 || y == TALL {
            0.0
        } else {
            spacing_rad
        };
        ground.height_m(lat_rad(y), lon_rad(x), spacing_rad)
    }

    /// The knots of a cell whose neighbours are at its own level.
    pub(super) fn knots(&mut self, ground: &dyn Elevation, cell: Cell) -> Knots {
        if let Some(knots) = self.known_knots.get(cell.key(), self.now) {
            return knots;
        }
        let knots = self.read_knots(ground, cell);
        self.known_knots.put(cell.key(), self.now, knots);
        knots
    }

    fn read_knots(&mut self, ground: &dyn Elevation, cell: Cell) -> Knots {
        let step = cell.steps() / PIECES;
        let spacing_rad = knots_spacing_rad(cell);
        let [x, y] = cell.vertex(0, 0);
        // One more on each side; beyond a pole, the pole again.
        let xs: [u32; KNOTS + 2] =
            std::array::from_fn(|i| (x + AROUND + i as u32 * step - step) % AROUND);
        let ys: [u32; KNOTS + 2] =
            std::array::from_fn(|j| (y + j as u32 * step).saturating_sub(step).min(TALL));
        let heights: [[f64; KNOTS + 2]; KNOTS + 2] =
            ys.map(|y| xs.map(|x| self.height_m(ground, [x, y], spacing_rad)));
        let west_east = [f64::from(step); 2];
        std::array::from_fn(|j| {
            let [south, middle, north] = [ys[j], ys[j + 1], ys[j + 2]];
            let south_north = [f64::from(middle - south), f64::from(north - middle)];
            std::array::from_fn(|i| {
                let near = std::array::from_fn(|b| std::array::from_fn(|a| heights[j + b][i + a]));
                let mut corner = estimate(&near, west_east, south_north);
                if middle == 0 || middle == TALL {
                    // One point for all longitudes; along each of them the ground rises differently.
                    let twist = near[2][2] - near[2][0] - near[0][2] + near[0][0];
                    corner[1] = 0.0;
                    corner[3] = twist / (2.0 * f64::from(step) * f64::from(step));
                }
                corner
            })
        })
    }

    /// Whether a neighbour is a quarter of a cell that is not cut.
    fn is_coarser(&self, beside: Option<Cell>) -> bool {
        beside.is_some_and(|cell| cell.level > 0 && !self.is_cut(cell.parent()))
    }

    /// The sides and corners of a leaf that coarser cells touch.
    pub(super) fn coarser_neighbours(&self, cell: Cell) -> CoarserNeighbours {
        let is_coarser = |(dx, dy)| u8::from(self.is_coarser(cell.beside(dx, dy)));
        let mut coarser = CoarserNeighbours::default();
        for (k, side) in SIDES.into_iter().enumerate() {
            coarser.sides |= is_coarser(side) << k;
        }
        for (k, diagonal) in DIAGONALS.into_iter().enumerate() {
            let sides = coarser.sides >> (k & 1) | coarser.sides >> (2 + (k >> 1));
            coarser.corners |= (sides & 1 | is_coarser(diagonal)) << k;
        }
        coarser
    }

    /// The knots of a leaf. Where a coarser cell has one too, its knot is used; halfway between two of those, the values of the coarser
    /// edge. Corners of a cell are knots of the coarser ones around it, so nothing farther away matters.
    pub(super) fn stitched_knots(
        &mut self,
        ground: &dyn Elevation,
        cell: Cell,
        coarser: CoarserNeighbours,
    ) -> Knots {
        let mut knots = self.knots(ground, cell);
        let two = 2 * SEGMENTS / PIECES;
        for (side, (dx, dy)) in SIDES.into_iter().enumerate() {
            let Some(beside) = cell.beside(dx, dy).filter(|_| coarser.side(side)) else {
                continue;
            };
            let beside = beside.parent();
            let theirs = self.knots(ground, beside);
            for m in (0..KNOTS).step_by(2) {
                let [row, column] = along(side, m);
                let place = cell.vertex(column as u32 * two / 2, row as u32 * two / 2);
                knots[row][column] = knot_at(beside, &theirs, place);
            }
            let steps = f64::from(beside.steps() / PIECES);
            for m in (1..KNOTS).step_by(2) {
                let [a, b] = [m - 1, m + 1].map(|m| {
                    let [row, column] = along(side, m);
                    knots[row][column]
                });
                let [row, column] = along(side, m);
                knots[row][column] = restrict(&a, &b, steps, 0.5, side >= 2);
            }
        }
        for (k, (dx, dy)) in DIAGONALS.into_iter().enumerate() {
            let beside = cell.beside(dx, dy);
            let by_side = coarser.side(k & 1) || coarser.side(2 + (k >> 1));
            if let Some(beside) = beside.filter(|_| coarser.corner(k) && !by_side) {
                let theirs = self.knots(ground, beside.parent());
                let last = KNOTS - 1;
                knots[(k >> 1) * last][(k & 1) * last] =
                    knot_at(beside.parent(), &theirs, cell.corner(k));
            }
        }
        knots
    }
}
