//! An elevation tile in memory.

use super::{HeightTileError, HeightTileKey, HeightTileLayout};
use crate::elevation::floor::floor;
use crate::elevation::samples::HeightSamples;
use crate::elevation::{HIGHEST_M, HeightRange, LOWEST_M};

/// Samples along a side of the smallest squares with stored ranges.
const SQUARE: usize = 8;

/// Heights of a tile, and the ranges of its parts.
pub(in crate::elevation) struct HeldTile {
    pub key: HeightTileKey,
    samples: HeightSamples,
    /// Samples per row, including the border.
    row: usize,
    border: usize,
    side: usize,
    /// Lowest and highest of each square of samples, row by row. Squares twice as wide follow, and so on.
    ranges: Vec<[f32; 2]>,
    /// Smallest squares along a side.
    squares: usize,
    /// Range of all samples.
    pub range: HeightRange,
}

impl HeldTile {
    /// Accepts samples of a source if they match the layout.
    pub fn new(
        key: HeightTileKey,
        layout: &HeightTileLayout,
        samples: HeightSamples,
    ) -> Result<Self, HeightTileError> {
        let unsound = |what: String| HeightTileError::Unsound { key, what };
        let row = layout.row_samples();
        if samples.len() != layout.tile_samples() {
            let (got, expected) = (samples.len(), layout.tile_samples());
            return Err(unsound(format!(
                "it has {got} samples in place of {expected}"
            )));
        }
        if let HeightSamples::I16 {
            offset_m, scale_m, ..
        } = &samples
            && !(offset_m.is_finite() && scale_m.is_finite() && *scale_m > 0.0)
        {
            return Err(unsound(format!(
                "its steps are {scale_m} m from {offset_m} m"
            )));
        }
        let squares = row.div_ceil(SQUARE);
        let mut ranges = vec![[f32::INFINITY, f32::NEG_INFINITY]; squares * squares];
        let mut range = HeightRange {
            low_m: f64::INFINITY,
            high_m: f64::NEG_INFINITY,
        };
        for n in 0..samples.len() {
            let height_m = samples.at_m(n);
            // False for NaN.
            if !(LOWEST_M..=HIGHEST_M).contains(&height_m) {
                return Err(unsound(format!("it holds a height of {height_m} m")));
            }
            let [low, high] = &mut ranges[n / row / SQUARE * squares + n % row / SQUARE];
            *low = low.min((height_m as f32).next_down());
            *high = high.max((height_m as f32).next_up());
            range.low_m = range.low_m.min(height_m);
            range.high_m = range.high_m.max(height_m);
        }
        let (mut start, mut across) = (0, squares);
        while across > 1 {
            let (fine, half) = (across, across.div_ceil(2));
            for (row, column) in (0..half).flat_map(|row| (0..half).map(move |n| (row, n))) {
                let mut all = [f32::INFINITY, f32::NEG_INFINITY];
                for (j, i) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    let (row, column) =
                        ((2 * row + j).min(fine - 1), (2 * column + i).min(fine - 1));
                    let [low, high] = ranges[start + row * fine + column];
                    all = [all[0].min(low), all[1].max(high)];
                }
                ranges.push(all);
            }
            (start, across) = (start + fine * fine, half);
        }
        Ok(Self {
            key,
            samples,
            row,
            border: layout.border() as usize,
            side: layout.side() as usize,
            ranges,
            squares,
            range,
        })
    }

    pub fn sample_m(&self, n: usize) -> f64 {
        self.samples.at_m(n)
    }

    pub fn bytes(&self) -> u64 {
        self.samples.bytes() + size_of_val(self.ranges.as_slice()) as u64 + size_of::<Self>() as u64
    }

    /// The height at a place of the level, in sample steps from 180° W and from the north pole. Beyond the outermost
    /// rows it blends into the pole's height, north first.
    #[inline]
    pub fn height_m(&self, x: f64, y: f64, rows: f64, poles_m: [f64; 2]) -> f64 {
        match &self.samples {
            HeightSamples::F32(values) => {
                self.interpolate(x, y, rows, poles_m, |n| f64::from(values[n]))
            }
            HeightSamples::I16 {
                values,
                offset_m,
                scale_m,
            } => self.interpolate(x, y, rows, poles_m, |n| {
                offset_m + scale_m * f64::from(values[n])
            }),
        }
    }

    #[inline]
    fn interpolate(
        &self,
        x: f64,
        y: f64,
        rows: f64,
        poles_m: [f64; 2],
        sample_m: impl Fn(usize) -> f64,
    ) -> f64 {
        let (x, y) = (x - 0.5, y - 0.5);
        let west = floor(x);
        let north = floor(y.clamp(0.0, rows - 1.0));
        let along = x - west;
        let column = self.place(west, self.key.column).min(self.row - 2);
        let in_row = |row: f64| {
            let at = self.place(row, self.key.row) * self.row + column;
            let value = sample_m(at);
            value + along * (sample_m(at + 1) - value)
        };
        let value = in_row(north);
        if y < 0.0 {
            return value + (-2.0 * y).min(1.0) * (poles_m[0] - value);
        }
        let down = y - north;
        if y >= rows - 1.0 {
            return value + (2.0 * down).min(1.0) * (poles_m[1] - value);
        }
        value + down * (in_row(north + 1.0) - value)
    }

    /// Stored column or row for a column or row of the level. For a place in the tile, it and the next exist.
    #[inline]
    fn place(&self, of_level: f64, tile: u32) -> usize {
        let from_tile = of_level - f64::from(tile) * self.side as f64 + self.border as f64;
        // Negative numbers saturate at 0.
        (from_tile as usize).min(self.row - 1)
    }

    /// Lowest and highest of all heights interpolated between two places, in sample steps from the tile's north-western corner. May
    /// be too wide, as if the places were `detail` or [`SQUARE`] steps farther apart.
    pub fn range_m(
        &self,
        (west, east): (f64, f64),
        (north, south): (f64, f64),
        detail: f64,
    ) -> HeightRange {
        let first = |from: f64| {
            ((from - 0.5).floor() + self.border as f64).clamp(0.0, (self.row - 1) as f64) as usize
        };
        let last = |to: f64| {
            ((to - 0.5).floor() + 1.0 + self.border as f64).clamp(0.0, (self.row - 1) as f64)
                as usize
        };
        let (columns, rows) = ((first(west), last(east)), (first(north), last(south)));
        let all = (0, self.row - 1);
        if (columns, rows) == (all, all) {
            return self.range;
        }
        // None of these is NaN, for which `f64::min` would check.
        let least = |a: f64, b: f64| if b < a { b } else { a };
        let most = |a: f64, b: f64| if b > a { b } else { a };
        let (mut low_m, mut high_m) = (f64::INFINITY, f64::NEG_INFINITY);
        if columns.1 - columns.0 <= SQUARE && rows.1 - rows.0 <= SQUARE {
            for row in rows.0..=rows.1 {
                for column in columns.0..=columns.1 {
                    let height_m = self.samples.at_m(row * self.row + column);
                    (low_m, high_m) = (least(low_m, height_m), most(high_m, height_m));
                }
            }
        } else {
            let (mut start, mut across, mut side) = (0, self.squares, SQUARE);
            while across > 1 && (2 * side) as f64 <= detail {
                start += across * across;
                (across, side) = (across.div_ceil(2), 2 * side);
            }
            for row in rows.0 / side..=rows.1 / side {
                let of_row = &self.ranges[start + row * across..][..across];
                for [low, high] in &of_row[columns.0 / side..=columns.1 / side] {
                    low_m = least(low_m, f64::from(*low));
                    high_m = most(high_m, f64::from(*high));
                }
            }
        }
        HeightRange { low_m, high_m }
    }
}
