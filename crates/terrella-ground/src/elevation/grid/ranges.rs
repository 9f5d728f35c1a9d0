//! Lowest and highest heights of parts of a grid: a pyramid parallel to that of averages.

use super::georeference::SampleLattice;
use super::levels::{LevelShape, ranges};
use super::{HeightGrid, Level};
use crate::elevation::HeightRange;
use crate::elevation::samples::HeightSamples;

/// Tolerance for rounding in interpolation, metres: a thousand times the rounding of f64 at 10 km.
const ROUNDING_M: f64 = 1e-6;

/// Maximum cells along a side of the requested bounds in the level used.
const CELLS: f64 = 4.0;

/// Side of the block of samples that shares one flag for unfilled holes.
const FLAG_SIDE: usize = 16;

/// Maximum number of flags checked; more count as set.
const MAX_FLAGS: usize = 4096;

/// For each cell of the levels above the finest: lowest and highest of its samples and of its own mean. The means of
/// all levels between also count.
enum Cells {
    F32(Vec<Vec<[f32; 2]>>),
    /// In steps of the stored heights, rounded outwards.
    I16(Vec<Vec<[i16; 2]>>, f64, f64),
}

/// The pyramid of ranges, and the flags of unfilled holes.
pub(super) struct Ranges {
    cells: Cells,
    /// One flag per [`FLAG_SIDE`]² samples: whether some lack full confidence.
    left: Vec<bool>,
    left_columns: usize,
}

impl Ranges {
    pub fn new(samples: &HeightSamples, levels: &[Level], coverage: Option<&[u8]>) -> Self {
        let shape = levels[0].shape;
        let left_columns = shape.columns.div_ceil(FLAG_SIDE);
        let mut left = Vec::new();
        if let Some(coverage) = coverage {
            left = vec![false; left_columns * shape.rows.div_ceil(FLAG_SIDE)];
            for (row, coverage) in coverage.chunks_exact(shape.columns).enumerate() {
                for (column, believed) in coverage.iter().enumerate() {
                    left[row / FLAG_SIDE * left_columns + column / FLAG_SIDE] |= *believed < 255;
                }
            }
        }
        let cells = match samples {
            HeightSamples::F32(values) => {
                Cells::F32(pyramid(levels, |n| [values[n]; 2], |mean| [mean; 2]))
            }
            HeightSamples::I16 {
                values,
                offset_m,
                scale_m,
            } => {
                let mean = |mean: f32| {
                    let steps = (f64::from(mean) - offset_m) / scale_m;
                    // Means are between the samples; rounding is far below `ROUNDING_M`.
                    [steps.floor() as i16, steps.ceil() as i16]
                };
                Cells::I16(
                    pyramid(levels, |n| [values[n]; 2], mean),
                    *offset_m,
                    *scale_m,
                )
            }
        };
        Self {
            cells,
            left,
            left_columns,
        }
    }

    pub(super) fn bytes(&self) -> u64 {
        let cells: usize = match &self.cells {
            Cells::F32(levels) => levels.iter().map(|cells| cells.len() * 8).sum(),
            Cells::I16(levels, ..) => levels.iter().map(|cells| cells.len() * 4).sum(),
        };
        (cells + self.left.len()) as u64
    }

    /// Lowest and highest of a cell of a level above the finest.
    fn cell_m(&self, level: usize, n: usize) -> [f64; 2] {
        match &self.cells {
            Cells::F32(levels) => levels[level - 1][n].map(f64::from),
            Cells::I16(levels, offset_m, scale_m) => {
                levels[level - 1][n].map(|steps| offset_m + scale_m * f64::from(steps))
            }
        }
    }

    /// Range of all heights that the grid returns between these rows and columns of the finest level, up to
    /// a level.
    pub(super) fn over(
        &self,
        grid: &HeightGrid,
        rows: (f64, f64),
        columns: (f64, f64),
        coarsest: usize,
    ) -> HeightRange {
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        let mut add = |[low, high]: [f64; 2]| {
            range = [range[0].min(low), range[1].max(high)];
        };
        let spans = |level: &Level| {
            let shape = &level.shape;
            (rows.1 - rows.0) * shape.row_ratio <= CELLS
                && (columns.1 - columns.0) * shape.column_ratio <= CELLS
        };
        let looked_up = grid.levels.iter().position(spans);
        let looked_up = looked_up.unwrap_or(grid.levels.len() - 1);
        let levels = &grid.levels[..=coarsest.max(looked_up)];
        for (number, level) in levels.iter().enumerate() {
            let shape = &level.shape;
            let own = (shape.own(rows.0, columns.0), shape.own(rows.1, columns.1));
            let (north, south) = (own.0.0, own.1.0);
            if shape.north_pole.is_some() && north < 0.0 {
                add([level.poles_m[0]; 2]);
            }
            if shape.south_pole.is_some() && south > (shape.rows - 1) as f64 {
                add([level.poles_m[1]; 2]);
            }
            // The cells already checked cover the finer levels.
            if number < looked_up {
                continue;
            }
            // Interpolation uses samples within one of the place. For finer levels, cells half a cell beyond also
            // count.
            let more = if number == looked_up && number > 0 {
                1.0
            } else {
                0.0
            };
            let first_row = inside(north.floor() - more, shape.rows);
            let last_row = inside(south.floor() + 1.0 + more, shape.rows);
            for column in columns_of(shape, own.0.1.floor() - more, own.1.1.floor() + 1.0 + more) {
                for row in first_row..=last_row {
                    let n = row * shape.columns + column;
                    if number == 0 {
                        add([grid.samples.at_m(n); 2]);
                    } else if number == looked_up {
                        add(self.cell_m(number, n));
                    } else {
                        add([f64::from(level.means_m[n]); 2]);
                    }
                }
            }
        }
        HeightRange {
            low_m: range[0] - ROUNDING_M,
            high_m: range[1] + ROUNDING_M,
        }
    }

    /// Whether a place between these rows and columns may use the source beneath.
    pub(super) fn has_left_hole(
        &self,
        lattice: &SampleLattice,
        rows: (f64, f64),
        columns: (f64, f64),
    ) -> bool {
        let first_row = inside(rows.0.floor(), lattice.rows) / FLAG_SIDE;
        let last_row = inside(rows.1.floor() + 1.0, lattice.rows) / FLAG_SIDE;
        let first_column = columns.0.floor();
        let last_column = columns.1.floor() + 1.0;
        let flags_across = (last_column - first_column) as usize / FLAG_SIDE + 2;
        if flags_across * (last_row + 1 - first_row) > MAX_FLAGS {
            return true;
        }
        // At a pole the whole outermost row counts.
        let poles = lattice.reaches_north && rows.0 < 0.0
            || lattice.reaches_south && rows.1 > (lattice.rows - 1) as f64;
        if poles {
            return true;
        }
        let count = lattice.columns as f64;
        (0..=flags_across).any(|n| {
            let column = (first_column + (n * FLAG_SIDE) as f64).min(last_column);
            let column = if lattice.is_periodic {
                (column.rem_euclid(count) as usize).min(lattice.columns - 1)
            } else {
                inside(column, lattice.columns)
            } / FLAG_SIDE;
            // The block after the last column of a periodic row may be narrow.
            (first_row..=last_row).any(|row| {
                let at = |column: usize| self.left[row * self.left_columns + column];
                at(column) || lattice.is_periodic && at((column + 1) % self.left_columns)
            })
        })
    }
}

/// The nearest valid index of a row or column.
fn inside(n: f64, count: usize) -> usize {
    // Negative numbers saturate at 0.
    (n as usize).min(count - 1)
}

/// Columns from one to another, each once.
fn columns_of(shape: &LevelShape, first: f64, last: f64) -> impl Iterator<Item = usize> {
    let count = shape.columns;
    let (first, number) = if shape.is_periodic {
        let number = ((last - first) as usize + 1).min(count);
        (
            (first.rem_euclid(count as f64) as usize).min(count - 1),
            number,
        )
    } else {
        let first = inside(first, count);
        (first, inside(last, count) + 1 - first)
    };
    (first..first + number).map(move |column| column % count)
}

/// The ranges of all levels above the finest.
fn pyramid<T: Copy + PartialOrd>(
    levels: &[Level],
    sample: impl Fn(usize) -> [T; 2],
    mean: impl Fn(f32) -> [T; 2],
) -> Vec<Vec<[T; 2]>> {
    let wider = |a: [T; 2], b: [T; 2]| {
        [
            if b[0] < a[0] { b[0] } else { a[0] },
            if b[1] > a[1] { b[1] } else { a[1] },
        ]
    };
    let mut all: Vec<Vec<[T; 2]>> = Vec::with_capacity(levels.len());
    for pair in levels.windows(2) {
        let (fine, coarse) = (&pair[0].shape, &pair[1].shape);
        let below = all.last();
        let at = |n: usize| below.map_or_else(|| sample(n), |cells| cells[n]);
        let columns: Vec<_> = ranges(fine.columns, coarse.columns).collect();
        let mut cells = Vec::with_capacity(coarse.samples());
        for (north, south) in ranges(fine.rows, coarse.rows) {
            for (west, east) in &columns {
                let mut cell = mean(pair[1].means_m[cells.len()]);
                for row in north..south {
                    for column in *west..*east {
                        cell = wider(cell, at(row * fine.columns + column));
                    }
                }
                cells.push(cell);
            }
        }
        all.push(cells);
    }
    all
}
