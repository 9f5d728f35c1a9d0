//! Heights at equal steps of latitude and longitude, held in memory.

pub(super) mod build;
mod georeference;
pub(super) mod holes;
pub(super) mod joins;
pub(super) mod levels;
pub mod placement;
mod ranges;
#[cfg(test)]
mod tests;

pub use build::GridLimits;
pub use georeference::{Georeference, MAX_SIDE, Registration};

use super::samples::HeightSamples;
use super::{Bounds, HeightRange};
use joins::Joins;
use levels::LevelShape;
use placement::Placement;
use ranges::Ranges;
use std::f64::consts::TAU;
use std::fmt;

/// Lowest height that is taken for one of the Earth, metres. The Challenger Deep lies at −10 935 m.
pub const LOWEST_M: f64 = -12_000.0;

/// Highest height that is taken for one of the Earth, metres. Everest has 8 849 m.
pub const HIGHEST_M: f64 = 10_000.0;

/// Over so many samples from its border inwards at least a local grid gains on what lies beneath. Over a sixteenth of its
/// width or height if that is more: the coarser grid beneath may differ by hundreds of metres, which a short passage would
/// make a cliff of. Never over more than a quarter.
pub const FEATHER_SAMPLES: f64 = 8.0;

/// Why heights make no grid. Readers add the file ([`HeightFileError`](super::HeightFileError)).
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GridError {
    /// Too few or too many samples along a side.
    #[error(
        "has {columns} x {rows} samples; expected 1 to {MAX_SIDE} along each side, of posts 2 at least"
    )]
    Size {
        /// Samples of a row.
        columns: u32,
        rows: u32,
    },
    /// No such place on Earth.
    #[error("has impossible bounds: {what}; correct bounds, spacing or registration")]
    Place {
        /// Which rule the georeference breaks.
        what: &'static str,
    },
    /// Not one height for each sample.
    #[error("has {got} heights for {expected} samples; give one for each")]
    Count {
        /// Heights that were given.
        got: u64,
        /// Rows times columns.
        expected: u64,
    },
    /// More memory than is allowed.
    #[error(
        "{columns} x {rows} samples would take {needed_mb} MB and {allowed_mb} MB are allowed; make them coarser \
         (`gdalwarp -r average -tr LON LAT IN OUT`) or allow more"
    )]
    Memory {
        /// Samples of a row.
        columns: u32,
        rows: u32,
        /// What it would take, megabytes.
        needed_mb: u64,
        /// What is allowed, megabytes.
        allowed_mb: u64,
    },
    /// Heights that no ground has.
    #[error(
        "holds heights of {low_m} m to {high_m} m; expected those of the Earth, {LOWEST_M} m to {HIGHEST_M} m: correct \
         unit, scale, offset, no-data value or byte order"
    )]
    NotEarth {
        /// Lowest height found, metres.
        low_m: f64,
        /// Highest height found, metres.
        high_m: f64,
    },
    /// No height at all.
    #[error("has no data in any sample; leave it out")]
    Empty,
}

/// Counts and range of a grid's heights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridStats {
    /// Samples without data, which were given heights.
    pub holes: u64,
    /// Those of them so far from data that the source beneath is taken, in part or alone.
    pub left_holes: u64,
    /// Lowest and highest sample.
    pub range: HeightRange,
    /// Step between heights that can be held, metres; 0 where they are floating-point numbers.
    pub quantum_m: f64,
    /// Levels of the pyramid, the finest included.
    pub levels: u32,
    /// Bytes held.
    pub bytes: u64,
}

/// A level of the pyramid.
struct Level {
    shape: LevelShape,
    /// Metres; empty in the finest level, whose samples are the grid's.
    means_m: Vec<f32>,
    /// Heights of the poles, north first: the means of the outermost rows.
    poles_m: [f64; 2],
}

/// A regular grid of heights with a pyramid of averages.
///
/// **Between samples** heights are bilinear, so continuous, and exact on planes (heights linear in latitude and
/// longitude). A grid that goes round the Earth closes on itself at its seam. Where such a grid comes within a step of a
/// pole, the mean of its outermost row stands at the pole. Beyond its border the nearest sample's height stays.
///
/// **Spacings.** Level k of the pyramid holds means over squares of 2^k of the finest spacings on the ground, rows near
/// the poles evened out along themselves as far. Asked for a spacing between those of two levels, the grid answers
/// their blend, linear in the spacing; below the finest, the finest. Interpolated between its samples, a level of
/// spacing s averages over about s to each side.
///
/// **Holes** (samples that are no numbers) up to 4 samples from a datum get the interpolated mean of the finest level
/// that has data there. Further in, that counts for less and less, and from 9 samples on the source beneath is taken
/// ([`Ground`](super::Ground)). [`Self::stats`] counts them.
///
/// **Memory**, per sample: whole metres take 2 bytes and the pyramids 2.7, other heights 4 and 4. If that is more than
/// [`GridLimits`] allow, heights are rounded to 65 500 steps between lowest and highest if 2 and 2.7 bytes are allowed.
/// One byte more where holes are left. While a grid is made, its heights and the means are held beside it.
pub struct HeightGrid {
    place: Placement,
    samples: HeightSamples,
    /// The finest first.
    levels: Vec<Level>,
    ranges: Ranges,
    /// How far each sample is believed, 255 wholly, and that of both poles; nothing where all are.
    coverage: Option<(Vec<u8>, [f64; 2])>,
    steps_per_rad: f64,
    stats: GridStats,
}

impl fmt::Debug for HeightGrid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Not the samples.
        f.debug_struct("HeightGrid")
            .field("lattice", &self.place.lattice)
            .field("stats", &self.stats)
            .finish_non_exhaustive()
    }
}

impl HeightGrid {
    /// Height at a place, metres, averaged over about `spacing_rad` to each side. Always finite for finite places.
    pub fn height_m(&self, lat_rad: f64, lon_rad: f64, spacing_rad: f64) -> f64 {
        let (row, column) = self.place.lattice.locate(lat_rad, lon_rad);
        self.at(row, column, spacing_rad)
    }

    /// Height at a row and column of the finest level.
    #[inline]
    fn at(&self, row: f64, column: f64, spacing_rad: f64) -> f64 {
        let steps = spacing_rad * self.steps_per_rad;
        // Also where the spacing is not a number.
        if steps.is_nan() || steps <= 1.0 || self.levels.len() == 1 {
            return self.at_level(0, row, column);
        }
        let coarsest = self.levels.len() - 1;
        // steps = 2^level·(1 + part), read from the number's own form.
        let level = ((steps.to_bits() >> 52) as usize).saturating_sub(1023);
        if level >= coarsest {
            return self.at_level(coarsest, row, column);
        }
        let part = steps / (1u64 << level) as f64 - 1.0;
        let fine = self.at_level(level, row, column);
        fine + part * (self.at_level(level + 1, row, column) - fine)
    }

    #[inline]
    fn at_level(&self, level: usize, row: f64, column: f64) -> f64 {
        let Level {
            shape,
            means_m,
            poles_m,
        } = &self.levels[level];
        if level > 0 {
            return shape.interpolate(row, column, *poles_m, |row, column| {
                f64::from(means_m[row * shape.columns + column])
            });
        }
        match &self.samples {
            HeightSamples::F32(values) => {
                shape.interpolate(row, column, *poles_m, |row, column| {
                    f64::from(values[row * shape.columns + column])
                })
            }
            HeightSamples::I16 {
                values,
                offset_m,
                scale_m,
            } => {
                let poles = poles_m.map(|pole_m| (pole_m - offset_m) / scale_m);
                let steps = shape.interpolate(row, column, poles, |row, column| {
                    f64::from(values[row * shape.columns + column])
                });
                offset_m + scale_m * steps
            }
        }
    }

    /// How much a place's height counts against that of what lies beneath, 0…1, continuous: 0 outside the grid and on
    /// its border, 1 from some samples inside on ([`FEATHER_SAMPLES`]), except in holes.
    pub fn weight(&self, lat_rad: f64, lon_rad: f64) -> f64 {
        self.joined_weight(lat_rad, lon_rad, &Joins::default())
    }

    /// The same of a grid that others go on from.
    pub(super) fn joined_weight(&self, lat_rad: f64, lon_rad: f64, joins: &Joins) -> f64 {
        let (row, column) = self.place.lattice.locate(lat_rad, lon_rad);
        self.weight_at(row, column, joins)
    }

    /// Where the grid lies.
    pub fn placement(&self) -> &Placement {
        &self.place
    }

    /// Height and weight of a place; no height where the weight is 0.
    #[inline]
    pub fn weighted(
        &self,
        lat_rad: f64,
        lon_rad: f64,
        spacing_rad: f64,
        joins: &Joins,
    ) -> Option<(f64, f64)> {
        let (row, column) = self.place.lattice.locate(lat_rad, lon_rad);
        let weight = self.weight_at(row, column, joins);
        (weight > 0.0).then(|| (self.at(row, column, spacing_rad), weight))
    }

    #[inline]
    fn weight_at(&self, row: f64, column: f64, joins: &Joins) -> f64 {
        let inside = joins.inside(&self.place, row, column);
        match &self.coverage {
            Some((coverage, poles)) if inside > 0.0 => {
                let shape = &self.levels[0].shape;
                let of_255 = shape.interpolate(row, column, *poles, |row, column| {
                    f64::from(coverage[row * shape.columns + column])
                });
                inside * (of_255 * (1.0 / 255.0))
            }
            _ => inside,
        }
    }

    /// Whether the grid alone says the height of every place inside the bounds. May say no too often.
    pub(super) fn rules(&self, bounds: &Bounds) -> bool {
        let (rows, columns) = self.span(bounds);
        if self.place.lattice.is_periodic {
            let whole = (0.0, (self.place.lattice.columns - 1) as f64);
            let corners = [(rows.0, whole.0), (rows.1, whole.1)];
            if corners.iter().any(|(r, c)| self.place.inside(*r, *c) < 1.0) {
                return false;
            }
        } else {
            // Inside ramps only, weights grow towards the middle: the corners have the least.
            let west = (bounds.west_rad - self.place.bounds.west_rad).rem_euclid(TAU);
            if west + bounds.width_rad > self.place.bounds.width_rad {
                return false;
            }
            let corners = [(rows.0, columns.0), (rows.1, columns.1)];
            if corners.iter().any(|(r, c)| self.place.inside(*r, *c) < 1.0) {
                return false;
            }
        }
        self.coverage.is_none()
            || !self
                .ranges
                .has_left_hole(&self.place.lattice, rows, columns)
    }

    /// Lowest and highest height that the grid answers inside the bounds at spacings up to `coarsest_rad`; infinite for
    /// any. May be too wide, never too narrow.
    pub fn range_m(&self, bounds: &Bounds, coarsest_rad: f64) -> HeightRange {
        let (rows, columns) = self.span(bounds);
        let steps = coarsest_rad * self.steps_per_rad;
        // A blend takes the level above in; a spacing that is no number asks for the finest.
        let coarsest = if steps > 1.0 {
            steps.log2().min(64.0) as usize + 1
        } else {
            0
        };
        let coarsest = coarsest.min(self.levels.len() - 1);
        self.ranges.over(self, rows, columns, coarsest)
    }

    /// First and last row, first and last column of the bounds, real numbers of the finest level. Columns of a grid that
    /// goes round may go on behind its last; of others they stay inside it.
    fn span(&self, bounds: &Bounds) -> ((f64, f64), (f64, f64)) {
        let (north, west) = self.place.lattice.locate(bounds.north_rad, bounds.west_rad);
        let (south, _) = self.place.lattice.locate(bounds.south_rad, bounds.west_rad);
        let width = bounds.width_rad.clamp(0.0, TAU) / self.place.lattice.lon_step_rad;
        let columns = self.place.lattice.columns as f64;
        let (west, east) = if self.place.lattice.is_periodic {
            (west, west + width.min(columns))
        } else {
            let turn = TAU / self.place.lattice.lon_step_rad;
            // Behind the meridian opposite the grid its other side is the nearer one.
            if west + width > 0.5 * (columns - 1.0) + 0.5 * turn {
                (0.0, columns - 1.0)
            } else {
                (west, west + width)
            }
        };
        // The last digit of an angle must not take a sample away.
        let more = 1e-6;
        ((north - more, south + more), (west - more, east + more))
    }

    /// What the grid covers.
    pub fn bounds(&self) -> Bounds {
        self.place.bounds
    }

    /// Samples of a row, and rows. A last sample that repeats the first of its row behind a full turn is not kept.
    pub fn size(&self) -> (u32, u32) {
        self.place.size()
    }

    /// A sample, metres: the first column is the western, the first row the northern. The nearest beyond the edge.
    pub fn sample_m(&self, column: u32, row: u32) -> f64 {
        let (columns, rows) = self.size();
        let (column, row) = (column.min(columns - 1), row.min(rows - 1));
        self.samples
            .at_m(row as usize * columns as usize + column as usize)
    }

    /// From the first to the last sample each way: half a spacing less than [`Self::bounds`] where samples are cells.
    pub fn sample_bounds(&self) -> Bounds {
        self.place.sample_bounds()
    }

    /// Angle between neighbouring samples, radians: along a column or along the row nearest to the equator, whichever is
    /// less.
    pub fn finest_spacing_rad(&self) -> f64 {
        self.place.finest_rad
    }

    /// Angle over which what the grid makes of the ground varies, inside it, radians: [`Self::finest_spacing_rad`], but of a
    /// grid of one height without holes the width of its feathered border, and infinite where that is of the whole Earth.
    pub fn detail_rad(&self) -> f64 {
        self.place
            .detail_rad(self.is_flat() && self.coverage.is_none())
    }

    /// Whether every height is the same.
    pub fn is_flat(&self) -> bool {
        self.stats.range.low_m == self.stats.range.high_m
    }

    /// Counts and range of the heights.
    pub fn stats(&self) -> GridStats {
        self.stats
    }
}
