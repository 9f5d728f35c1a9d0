//! The pyramid of averages, and interpolation in one of its levels.

use super::georeference::SampleLattice;
use crate::elevation::floor::floor;

/// Size of a level, and the mapping from rows and columns of the finest level.
#[derive(Clone, Copy, Debug)]
pub(in crate::elevation) struct LevelShape {
    pub columns: usize,
    pub rows: usize,
    /// Samples of this level per sample of the finest, along a row and along a column.
    pub column_ratio: f64,
    pub row_ratio: f64,
    pub is_periodic: bool,
    /// Rows of the poles in this level, where the grid reaches them: at most 0, and at least the
    /// last row.
    pub north_pole: Option<f64>,
    pub south_pole: Option<f64>,
}

impl LevelShape {
    pub fn new(lattice: &SampleLattice, columns: usize, rows: usize) -> Self {
        let row_ratio = rows as f64 / lattice.rows as f64;
        let (north, south) = lattice.pole_rows();
        let own = |row: f64| (row + 0.5) * row_ratio - 0.5;
        Self {
            columns,
            rows,
            column_ratio: columns as f64 / lattice.columns as f64,
            row_ratio,
            is_periodic: lattice.is_periodic,
            north_pole: lattice.reaches_north.then_some(own(north).min(0.0)),
            south_pole: lattice
                .reaches_south
                .then_some(own(south).max((rows - 1) as f64)),
        }
    }

    pub(in crate::elevation) fn samples(&self) -> usize {
        self.columns * self.rows
    }

    /// Row and column in this level for those of the finest.
    #[inline]
    pub(in crate::elevation) fn own(&self, row: f64, column: f64) -> (f64, f64) {
        (
            (row + 0.5) * self.row_ratio - 0.5,
            (column + 0.5) * self.column_ratio - 0.5,
        )
    }

    /// Bilinear interpolation at a row and column of the finest level. Beyond the outermost samples their value applies. Towards a pole
    /// the outermost row blends into the pole's value (`poles`, north first). `at` returns the sample of a row and column.
    #[inline]
    pub(in crate::elevation) fn interpolate(
        &self,
        row: f64,
        column: f64,
        poles: [f64; 2],
        at: impl Fn(usize, usize) -> f64,
    ) -> f64 {
        let (row, column) = self.own(row, column);
        let (west, east, along) = self.neighbours(column);
        let in_row = |row: usize| {
            let west = at(row, west);
            west + along * (at(row, east) - west)
        };
        let last = (self.rows - 1) as f64;
        if row < 0.0 {
            return match self.north_pole {
                Some(pole) => to_pole(in_row(0), poles[0], row / pole),
                None => in_row(0),
            };
        }
        // A NaN row must not be used as an index.
        if row >= last || row.is_nan() {
            return match self.south_pole {
                Some(pole) => to_pole(
                    in_row(self.rows - 1),
                    poles[1],
                    (row - last) / (pole - last),
                ),
                None => in_row(self.rows - 1),
            };
        }
        let north = row as usize;
        let value = in_row(north);
        value + (row - north as f64) * (in_row(north + 1) - value)
    }

    /// The columns on both sides of a place, and its fraction from the first to the second.
    #[inline]
    fn neighbours(&self, column: f64) -> (usize, usize, f64) {
        let last = self.columns - 1;
        if self.is_periodic {
            let whole = floor(column);
            let along = column - whole;
            // −1…columns: half a sample beyond either side, with rounding.
            let west = match whole as isize {
                ..0 => last,
                west if west as usize > last => 0,
                west => west as usize,
            };
            (west, if west == last { 0 } else { west + 1 }, along)
        } else {
            let column = column.clamp(0.0, last as f64);
            let west = column as usize;
            (west, (west + 1).min(last), column - west as f64)
        }
    }
}

/// Blends a row's value into the pole's; the row may be at the pole.
#[inline]
fn to_pole(row: f64, pole: f64, part: f64) -> f64 {
    // 0/0 where the row is at the pole: all its samples then equal the pole's value.
    let part = if part.is_nan() {
        1.0
    } else {
        part.clamp(0.0, 1.0)
    };
    row + part * (pole - row)
}

/// Sizes of all levels, the finest first. Samples of level k are about 2^k of the finest spacings apart on the ground.
/// Each side is divided by the nearest power of two, so the other spacing differs by √2 at most. A side that does not
/// divide evenly gets slightly smaller parts.
pub(in crate::elevation) fn shapes(lattice: &SampleLattice) -> Vec<LevelShape> {
    let step = (
        lattice.lat_step_rad,
        lattice.lon_step_rad * lattice.widest_cos(),
    );
    let finest = step.0.min(step.1);
    let count = |all: usize, level: i32, step: f64| {
        let halvings = (f64::from(level) - (step / finest).log2()).round();
        (all as f64 / halvings.max(0.0).exp2()).ceil().max(1.0) as usize
    };
    let mut shapes = vec![LevelShape::new(lattice, lattice.columns, lattice.rows)];
    for level in 1..64 {
        if shapes.last().is_some_and(|shape| shape.samples() == 1) {
            break;
        }
        let columns = count(lattice.columns, level, step.1);
        let rows = count(lattice.rows, level, step.0);
        shapes.push(LevelShape::new(lattice, columns, rows));
    }
    shapes
}

/// The samples of a side within a coarser sample: index of the first, and the fraction of each inside.
pub(in crate::elevation) type Span = (usize, Vec<f64>);

/// The spans of all coarser samples of a side.
pub(in crate::elevation) fn spans(
    fine: usize,
    coarse: usize,
) -> impl ExactSizeIterator<Item = Span> {
    let ratio = fine as f64 / coarse as f64;
    (0..coarse).map(move |n| {
        let (start, end) = (n as f64 * ratio, (n + 1) as f64 * ratio);
        // Rounding must neither drop a sample nor add one outside the range.
        let first = ((start + 1e-9).floor() as usize).min(fine - 1);
        let last = (((end - 1e-9).ceil() as usize).max(first + 1)).min(fine);
        let part = |i: usize| (end.min((i + 1) as f64) - start.max(i as f64)).max(1e-9);
        (first, (first..last).map(part).collect())
    })
}

/// First and one past the last sample of a side that each coarser sample spans.
pub(super) fn ranges(fine: usize, coarse: usize) -> impl Iterator<Item = (usize, usize)> {
    spans(fine, coarse).map(|(first, parts)| (first, first + parts.len()))
}

/// Averages rows of a level into rows of the next coarser one.
pub(in crate::elevation) struct Averager<'a> {
    lattice: &'a SampleLattice,
    fine: &'a LevelShape,
    columns: Vec<Span>,
    sums: Vec<(f64, f64)>,
}

impl<'a> Averager<'a> {
    pub fn new(lattice: &'a SampleLattice, fine: &'a LevelShape, coarse: &LevelShape) -> Self {
        Self {
            lattice,
            fine,
            columns: spans(fine.columns, coarse.columns).collect(),
            sums: vec![(0.0, 0.0); fine.columns],
        }
    }

    /// Appends a coarser row to `out`: area-weighted means on the ground, without NaN samples. `values` holds the rows of the span in sequence.
    pub fn row(&mut self, (first, parts): &Span, values: &[f32], out: &mut Vec<f32>) {
        self.sums.fill((0.0, 0.0));
        let rows = values.chunks_exact(self.fine.columns);
        for ((n, part), values) in parts.iter().enumerate().zip(rows) {
            let row = first + n;
            let base_row = (row as f64 + 0.5) / self.fine.row_ratio - 0.5;
            let weight = part * self.lattice.latitude_rad(base_row).cos().max(1e-6);
            for (sum, value) in self.sums.iter_mut().zip(values) {
                if !value.is_nan() {
                    sum.0 += weight * f64::from(*value);
                    sum.1 += weight;
                }
            }
        }
        out.extend(self.columns.iter().map(|(first, parts)| {
            let (mut sum, mut weights) = (0.0, 0.0);
            for (part, of) in parts.iter().zip(&self.sums[*first..]) {
                sum += part * of.0;
                weights += part * of.1;
            }
            // 0/0 without any data.
            (sum / weights) as f32
        }));
    }
}

/// Computes the next coarser level.
pub(super) fn average(
    lattice: &SampleLattice,
    fine: &LevelShape,
    values: &[f32],
    coarse: &LevelShape,
) -> Vec<f32> {
    let mut out = Vec::with_capacity(coarse.samples());
    let mut averager = Averager::new(lattice, fine, coarse);
    for span in spans(fine.rows, coarse.rows) {
        let end = (span.0 + span.1.len()) * fine.columns;
        averager.row(&span, &values[span.0 * fine.columns..end], &mut out);
    }
    out
}

/// Averages each row along itself over the ground distance between columns in the row nearest to the equator. Columns
/// converge towards the poles; without this a coarse level would be coarse in one direction only.
pub(super) fn even_out(lattice: &SampleLattice, shape: &LevelShape, values: &mut [f32]) {
    let widest_cos = lattice.widest_cos();
    let columns = shape.columns;
    let mut sums = Vec::with_capacity(columns + 1);
    for (row, values) in values.chunks_exact_mut(columns).enumerate() {
        let base_row = (row as f64 + 0.5) / shape.row_ratio - 0.5;
        let cos = lattice.latitude_rad(base_row).cos().max(1e-9);
        let width = (widest_cos / cos).min(columns as f64);
        if width <= 1.0 + 1e-9 || columns < 2 {
            continue;
        }
        sums.clear();
        sums.push(0.0f64);
        let mut sum = 0.0;
        for value in values.iter() {
            sum += f64::from(*value);
            sums.push(sum);
        }
        // The sum from column 0 to a fractional column. Beyond the ends of the row, it repeats in a periodic row
        // and is constant otherwise.
        let upto = |end: f64| -> f64 {
            let (turns, end) = if shape.is_periodic {
                let turns = (end / columns as f64).floor();
                (turns, end - turns * columns as f64)
            } else {
                (0.0, end.clamp(0.0, columns as f64))
            };
            let whole = (end as usize).min(columns - 1);
            turns * sum + sums[whole] + (end - whole as f64) * (sums[whole + 1] - sums[whole])
        };
        let length = |end: f64| {
            if shape.is_periodic {
                end
            } else {
                end.clamp(0.0, columns as f64)
            }
        };
        for (column, value) in values.iter_mut().enumerate() {
            let middle = column as f64 + 0.5;
            let (start, end) = (middle - 0.5 * width, middle + 0.5 * width);
            *value = ((upto(end) - upto(start)) / (length(end) - length(start))) as f32;
        }
    }
}
