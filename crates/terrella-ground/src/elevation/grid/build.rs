//! Builds a grid from heights.

use super::georeference::{Georeference, SampleLattice};
use super::holes::{coverage, fill};
use super::levels::{LevelShape, average, even_out, shapes};
use super::placement::Placement;
use super::ranges::Ranges;
use super::{GridError, GridStats, HIGHEST_M, HeightGrid, LOWEST_M, Level};
use crate::elevation::HeightRange;
use crate::elevation::samples::HeightSamples;

/// Memory limits of one grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridLimits {
    /// Maximum size in bytes, pyramids included. During construction another 6 bytes per sample are in use.
    pub bytes: u64,
}

impl Default for GridLimits {
    /// 1 GB: 21 600 × 10 800 samples of whole metres.
    fn default() -> Self {
        Self {
            bytes: 1_100_000_000,
        }
    }
}

impl GridLimits {
    /// Rejects sizes that exceed the limits with any heights.
    ///
    /// # Errors
    /// [`GridError::Size`] and [`GridError::Memory`].
    pub fn check(&self, columns: u32, rows: u32) -> Result<(), GridError> {
        let sides = 1..=super::MAX_SIDE;
        if !sides.contains(&columns) || !sides.contains(&rows) {
            return Err(GridError::Size { columns, rows });
        }
        let needed = estimated_bytes(u64::from(columns) * u64::from(rows), true);
        self.allow(columns, rows, needed)
    }

    fn allow(&self, columns: u32, rows: u32, needed: u64) -> Result<(), GridError> {
        if needed > self.bytes {
            return Err(GridError::Memory {
                columns,
                rows,
                needed_mb: needed.div_ceil(1_000_000),
                allowed_mb: self.bytes / 1_000_000,
            });
        }
        Ok(())
    }
}

/// Bytes of samples and pyramids: each pyramid has a third of the samples, plus a little for odd sizes.
fn estimated_bytes(samples: u64, is_short: bool) -> u64 {
    let (sample, range) = if is_short { (2, 4) } else { (4, 8) };
    samples * sample + (samples / 3 + samples / 64 + 4096) * (4 + range)
}

impl HeightGrid {
    /// Builds a grid. `heights_m` are metres, the northern row first, each from west to east. A value that is not finite
    /// is a hole.
    ///
    /// # Errors
    /// [`GridError`]. A wrong size or place is rejected before any large allocation.
    pub fn new(
        georeference: &Georeference,
        heights_m: Vec<f32>,
        limits: &GridLimits,
    ) -> Result<Self, GridError> {
        let Georeference { columns, rows, .. } = *georeference;
        let place = Placement::new(georeference)?;
        let lattice = place.lattice;
        limits.check(columns, rows)?;
        let expected = u64::from(columns) * u64::from(rows);
        if heights_m.len() as u64 != expected {
            return Err(GridError::Count {
                got: heights_m.len() as u64,
                expected,
            });
        }
        let mut heights_m = heights_m;
        if lattice.columns < columns as usize {
            drop_last_column(&mut heights_m, columns as usize);
        }
        let range = known_range(&mut heights_m)?;
        let is_whole = heights_m
            .iter()
            .all(|height| height.is_nan() || height.fract() == 0.0);
        let is_short = is_whole || estimated_bytes(expected, false) > limits.bytes;

        let shapes = shapes(&lattice);
        let (coverage, holes, left_holes) = fill_holes(&lattice, &shapes, &mut heights_m);
        one_value_at_poles(&lattice, &mut heights_m);
        let samples = match (is_short, is_whole) {
            (false, _) => HeightSamples::F32(heights_m),
            (true, true) => short(&heights_m, 0.0, 1.0),
            (true, false) => {
                // Slightly less than the 65 536 values: rounding of means in f32 may exceed the highest height.
                let scale_m = ((range.high_m - range.low_m) / 65_500.0).max(1e-3);
                short(&heights_m, 0.5 * (range.low_m + range.high_m), scale_m)
            }
        };
        let levels = pyramid(&lattice, &shapes, &samples);
        let ranges = Ranges::new(&samples, &levels, coverage.as_ref().map(|c| c.0.as_slice()));
        let bytes = samples.bytes()
            + levels
                .iter()
                .map(|level| level.means_m.len() as u64 * 4)
                .sum::<u64>()
            + ranges.bytes()
            + coverage.as_ref().map_or(0, |c| c.0.len() as u64);
        limits.allow(columns, rows, bytes)?;
        let stats = GridStats {
            holes,
            left_holes,
            range,
            quantum_m: match samples {
                HeightSamples::F32(_) => 0.0,
                HeightSamples::I16 { scale_m, .. } => scale_m,
            },
            levels: levels.len() as u32,
            bytes,
        };
        Ok(Self {
            steps_per_rad: 1.0 / place.finest_rad,
            place,
            samples,
            levels,
            ranges,
            coverage,
            stats,
        })
    }
}

/// Removes the last sample of every row.
fn drop_last_column(values: &mut Vec<f32>, columns: usize) {
    let mut n = 0;
    values.retain(|_| {
        n += 1;
        n % columns != 0
    });
}

/// Lowest and highest height; infinities become holes.
fn known_range(heights_m: &mut [f32]) -> Result<HeightRange, GridError> {
    let mut known = KnownHeights::default();
    known.add(heights_m);
    known.range()
}

/// Range of heights that are read in parts.
#[derive(Clone, Copy, Debug)]
pub(in crate::elevation) struct KnownHeights {
    low: f32,
    high: f32,
}

impl Default for KnownHeights {
    fn default() -> Self {
        Self {
            low: f32::INFINITY,
            high: f32::NEG_INFINITY,
        }
    }
}

impl KnownHeights {
    /// Adds some heights; infinities become holes.
    pub(in crate::elevation) fn add(&mut self, heights_m: &mut [f32]) {
        for height in heights_m {
            if height.is_finite() {
                self.low = self.low.min(*height);
                self.high = self.high.max(*height);
            } else {
                *height = f32::NAN;
            }
        }
    }

    /// Rejects heights outside the Earth's range, as soon as one occurs.
    pub fn check(&self) -> Result<(), GridError> {
        let (low_m, high_m) = (f64::from(self.low), f64::from(self.high));
        if low_m < LOWEST_M || high_m > HIGHEST_M {
            return Err(GridError::NotEarth { low_m, high_m });
        }
        Ok(())
    }

    /// Lowest and highest height so far.
    pub fn range(&self) -> Result<HeightRange, GridError> {
        if self.low > self.high {
            return Err(GridError::Empty);
        }
        self.check()?;
        Ok(HeightRange {
            low_m: f64::from(self.low),
            high_m: f64::from(self.high),
        })
    }
}

type Coverage = Option<(Vec<u8>, [f64; 2])>;

/// Fills holes. Returns the confidence of samples, the number of holes, and how many are left to the source
/// beneath.
fn fill_holes(
    lattice: &SampleLattice,
    shapes: &[LevelShape],
    heights_m: &mut [f32],
) -> (Coverage, u64, u64) {
    let is_hole: Vec<bool> = heights_m.iter().map(|height| height.is_nan()).collect();
    let holes = is_hole.iter().filter(|hole| **hole).count() as u64;
    if holes == 0 {
        return (None, 0, 0);
    }
    // Up the levels until no hole is left, then down again.
    let mut means: Vec<Vec<f32>> = Vec::new();
    for pair in shapes.windows(2) {
        let fine = means.last().map_or(&*heights_m, Vec::as_slice);
        let coarse = average(lattice, &pair[0], fine, &pair[1]);
        let is_whole = coarse.iter().all(|height| !height.is_nan());
        means.push(coarse);
        if is_whole {
            break;
        }
    }
    for level in (0..means.len()).rev() {
        let (finer, coarser) = means.split_at_mut(level);
        let fine = finer.last_mut().map_or(&mut *heights_m, Vec::as_mut_slice);
        fill(&shapes[level], fine, &shapes[level + 1], &coarser[0]);
    }
    let coverage = coverage(&shapes[0], &is_hole);
    let left = coverage
        .iter()
        .flatten()
        .filter(|believed| **believed < 255)
        .count() as u64;
    let columns = lattice.columns;
    let coverage = coverage.map(|mut coverage| {
        let least = |row: &[u8]| row.iter().copied().min().unwrap_or(0);
        let north = least(&coverage[..columns]);
        let south = least(&coverage[coverage.len() - columns..]);
        if lattice.is_pole(0) {
            coverage[..columns].fill(north);
        }
        if lattice.is_pole(lattice.rows - 1) {
            let start = coverage.len() - columns;
            coverage[start..].fill(south);
        }
        (coverage, [f64::from(north), f64::from(south)])
    });
    (coverage, holes, left)
}

/// Sets all samples of a row at a pole to their mean.
fn one_value_at_poles(lattice: &SampleLattice, heights_m: &mut [f32]) {
    for (row, heights_m) in heights_m.chunks_exact_mut(lattice.columns).enumerate() {
        if lattice.is_pole(row) {
            let mean = mean(heights_m.iter().copied());
            heights_m.fill(mean as f32);
        }
    }
}

pub(in crate::elevation) fn mean(heights_m: impl ExactSizeIterator<Item = f32>) -> f64 {
    let count = heights_m.len() as f64;
    heights_m.map(f64::from).sum::<f64>() / count
}

fn short(heights_m: &[f32], offset_m: f64, scale_m: f64) -> HeightSamples {
    let steps = |height: &f32| ((f64::from(*height) - offset_m) / scale_m).round() as i16;
    HeightSamples::I16 {
        values: heights_m.iter().map(steps).collect(),
        offset_m,
        scale_m,
    }
}

/// Builds all levels from the stored samples.
fn pyramid(lattice: &SampleLattice, shapes: &[LevelShape], samples: &HeightSamples) -> Vec<Level> {
    let finest: Vec<f32>;
    let finest = match samples {
        HeightSamples::F32(values) => values.as_slice(),
        HeightSamples::I16 { values, .. } => {
            finest = (0..values.len()).map(|n| samples.at_m(n) as f32).collect();
            finest.as_slice()
        }
    };
    let poles_m = |shape: &LevelShape, values: &[f32]| {
        let rows = [0, shape.rows - 1];
        rows.map(|row| {
            let row = &values[row * shape.columns..(row + 1) * shape.columns];
            mean(row.iter().copied())
        })
    };
    let mut levels = vec![Level {
        shape: shapes[0],
        means_m: Vec::new(),
        poles_m: poles_m(&shapes[0], finest),
    }];
    // Means are computed from means before evening out; repeated evening out would accumulate.
    let mut plain: Vec<f32> = Vec::new();
    for pair in shapes.windows(2) {
        let below = if levels.len() == 1 { finest } else { &plain };
        plain = average(lattice, &pair[0], below, &pair[1]);
        let mut means_m = plain.clone();
        even_out(lattice, &pair[1], &mut means_m);
        levels.push(Level {
            shape: pair[1],
            poles_m: poles_m(&pair[1], &means_m),
            means_m,
        });
    }
    levels
}
