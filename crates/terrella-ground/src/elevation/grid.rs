//! Elevation grids at equal steps of latitude and longitude, held in memory.

pub(super) mod build;
mod feather;
mod georeference;
pub(super) mod holes;
pub(super) mod joins;
pub(super) mod levels;
mod outside;
pub mod placement;
mod plane;
mod ranges;
#[cfg(test)]
mod tests;

pub use build::GridLimits;
pub use georeference::{Georeference, MAX_SIDE, Registration};

use super::samples::HeightSamples;
use super::warp::Warp;
use super::{Bounds, HeightRange};
use joins::Joins;
use levels::LevelShape;
use placement::Placement;
use ranges::Ranges;
use std::f64::consts::TAU;
use std::fmt;

/// Lowest plausible height on Earth, metres. The Challenger Deep is at −10 935 m.
pub const LOWEST_M: f64 = -12_000.0;

/// Highest plausible height on Earth, metres. Everest is 8 849 m high.
pub const HIGHEST_M: f64 = 10_000.0;

/// Minimum width of the feathered border of a local grid, in samples. The feather is a sixteenth of the grid's width or
/// height if that is more. A coarser grid beneath may differ by hundreds of metres, and a short transition would draw a
/// cliff. The feather never exceeds a quarter.
pub const FEATHER_SAMPLES: f64 = 8.0;

/// Why heights do not form a grid. Readers add the file
/// ([`HeightFileError`](super::HeightFileError)).
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
    /// An impossible place on Earth.
    #[error("has impossible bounds: {what}; correct bounds, spacing or registration")]
    Place {
        /// Which rule the georeference breaks.
        what: &'static str,
    },
    /// The number of heights differs from the number of samples.
    #[error("has {got} heights for {expected} samples; give one for each")]
    Count {
        /// Heights that were given.
        got: u64,
        /// Rows times columns.
        expected: u64,
    },
    /// The grid exceeds the memory limit.
    #[error(
        "{columns} x {rows} samples would take {needed_mb} MB and {allowed_mb} MB are allowed; make them coarser \
         (`gdalwarp -r average -tr LON LAT IN OUT`) or allow more"
    )]
    Memory {
        /// Samples of a row.
        columns: u32,
        rows: u32,
        /// Required memory, megabytes.
        needed_mb: u64,
        /// Memory limit, megabytes.
        allowed_mb: u64,
    },
    /// Heights outside the Earth's range.
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
    /// No sample has data.
    #[error("has no data in any sample; leave it out")]
    Empty,
}

/// Counts and range of a grid's heights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridStats {
    /// Samples without data that were filled.
    pub holes: u64,
    /// Filled samples so far from data that the source beneath replaces them, partly or fully.
    pub left_holes: u64,
    /// Lowest and highest sample.
    pub range: HeightRange,
    /// Step between representable heights, metres; 0 for floating-point heights.
    pub quantum_m: f64,
    /// Levels of the pyramid, including the finest.
    pub levels: u32,
    /// Bytes in memory.
    pub bytes: u64,
}

/// A level of the pyramid.
struct Level {
    shape: LevelShape,
    /// Metres; empty in the finest level, which uses the grid's samples.
    means_m: Vec<f32>,
    /// Heights of the poles, north first: the means of the outermost rows.
    poles_m: [f64; 2],
}

/// A regular grid of heights with a pyramid of averages.
///
/// **Between samples** heights are bilinear: continuous, and exact on planes (heights linear in latitude and longitude). A grid around the whole
/// Earth closes on itself at its seam. Where such a grid comes within a step of a pole, the pole has the mean of its outermost row. Beyond the border
/// the nearest sample's height applies.
///
/// **Spacings.** Level k of the pyramid holds means over squares of 2^k of the finest spacings on the ground. Rows near the poles are averaged along
/// themselves over the same distance. For a spacing between those of two levels, the grid returns their blend, linear in the spacing. Below the
/// finest spacing it returns the finest level. Interpolated between its samples, a level of spacing s averages over about s to each side.
///
/// **Holes** are NaN samples. Up to 4 samples from a datum they get the interpolated mean of the finest level that has data there. Farther in, the
/// weight of that mean decreases, and from 9 samples on the source beneath applies ([`Ground`](super::Ground)). [`Self::stats`] counts them.
///
/// **Memory** per sample: integer metres take 2 bytes and the pyramids 2.7; other heights take 4 and 4. If that exceeds [`GridLimits`] and 2 and 2.7
/// bytes do not, heights are rounded to 65 500 steps between lowest and highest. Holes that are left take one more byte. During construction the
/// input heights and the means also take memory.
pub struct HeightGrid {
    place: Placement,
    samples: HeightSamples,
    /// The finest first.
    levels: Vec<Level>,
    ranges: Ranges,
    /// Confidence of each sample, 255 for full confidence, and of both poles. `None` if all are
    /// fully trusted.
    coverage: Option<(Vec<u8>, [f64; 2])>,
    steps_per_rad: f64,
    stats: GridStats,
}

impl fmt::Debug for HeightGrid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Omit the samples.
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
        // True also for a spacing that is NaN.
        if steps.is_nan() || steps <= 1.0 || self.levels.len() == 1 {
            return self.at_level(0, row, column);
        }
        let coarsest = self.levels.len() - 1;
        // steps = 2^level·(1 + part), read from the bits of the number.
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

    /// Weight of the grid's height against the source beneath, 0…1, continuous. It is 0 outside the grid and on its
    /// border. It is 1 from some samples inwards ([`FEATHER_SAMPLES`]), except in holes.
    pub fn weight(&self, lat_rad: f64, lon_rad: f64) -> f64 {
        self.joined_weight(lat_rad, lon_rad, &Joins::default())
    }

    /// The weight of a grid with neighbours that continue it.
    pub(super) fn joined_weight(&self, lat_rad: f64, lon_rad: f64, joins: &Joins) -> f64 {
        let (row, column) = self.place.lattice.locate(lat_rad, lon_rad);
        self.weight_at(row, column, joins)
    }

    /// The same grid with the border of the projected samples that it was resampled from, if it was.
    ///
    /// # Errors
    /// A projected grid that places no samples.
    pub(super) fn with_border_of(mut self, warp: Option<&Warp>) -> Result<Self, GridError> {
        self.place = self.place.with_border_of(warp)?;
        Ok(self)
    }

    /// The placement of the grid.
    pub fn placement(&self) -> &Placement {
        &self.place
    }

    /// Height and weight at a place; no height where the weight is 0.
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

    /// Whether the grid alone determines the height of every place inside the bounds. May wrongly
    /// return `false`.
    pub(super) fn rules(&self, bounds: &Bounds) -> bool {
        let (rows, columns) = self.span(bounds);
        if self.place.are_deep(rows, columns) == Some(false) {
            return false;
        }
        if self.place.lattice.is_periodic {
            let whole = (0.0, (self.place.lattice.columns - 1) as f64);
            let corners = [(rows.0, whole.0), (rows.1, whole.1)];
            if corners.iter().any(|(r, c)| self.place.inside(*r, *c) < 1.0) {
                return false;
            }
        } else {
            // Inside ramps only, weights grow towards the middle, so the corners have the smallest.
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

    /// Lowest and highest height that the grid returns inside the bounds at spacings up to `coarsest_rad`; infinity
    /// covers every spacing. May be too wide, never too narrow.
    pub fn range_m(&self, bounds: &Bounds, coarsest_rad: f64) -> HeightRange {
        let (rows, columns) = self.span(bounds);
        let steps = coarsest_rad * self.steps_per_rad;
        // A blend includes the level above; a NaN spacing requests the finest level.
        let coarsest = if steps > 1.0 {
            steps.log2().min(64.0) as usize + 1
        } else {
            0
        };
        let coarsest = coarsest.min(self.levels.len() - 1);
        self.ranges.over(self, rows, columns, coarsest)
    }

    /// First and last row, first and last column of the bounds, as real numbers of the finest level. Columns of a
    /// periodic grid may exceed its last; columns of other grids stay inside.
    fn span(&self, bounds: &Bounds) -> ((f64, f64), (f64, f64)) {
        let (north, west) = self.place.lattice.locate(bounds.north_rad, bounds.west_rad);
        let (south, _) = self.place.lattice.locate(bounds.south_rad, bounds.west_rad);
        let width = bounds.width_rad.clamp(0.0, TAU) / self.place.lattice.lon_step_rad;
        let columns = self.place.lattice.columns as f64;
        let (west, east) = if self.place.lattice.is_periodic {
            (west, west + width.min(columns))
        } else {
            let turn = TAU / self.place.lattice.lon_step_rad;
            // Past the meridian opposite to the grid, its other side is nearer.
            if west + width > 0.5 * (columns - 1.0) + 0.5 * turn {
                (0.0, columns - 1.0)
            } else {
                (west, west + width)
            }
        };
        // Rounding of an angle must not drop a sample.
        let more = 1e-6;
        ((north - more, south + more), (west - more, east + more))
    }

    /// The bounds that the grid covers.
    pub fn bounds(&self) -> Bounds {
        self.place.bounds
    }

    /// Samples of a row, and rows. A last sample that repeats the first of its row after 360° is not kept.
    pub fn size(&self) -> (u32, u32) {
        self.place.size()
    }

    /// A sample, metres: the first column is the western, the first row the northern. Beyond the edge, the nearest
    /// sample.
    pub fn sample_m(&self, column: u32, row: u32) -> f64 {
        let (columns, rows) = self.size();
        let (column, row) = (column.min(columns - 1), row.min(rows - 1));
        self.samples
            .at_m(row as usize * columns as usize + column as usize)
    }

    /// Bounds from the first to the last sample each way: half a spacing inside [`Self::bounds`] where samples are
    /// cells.
    pub fn sample_bounds(&self) -> Bounds {
        self.place.sample_bounds()
    }

    /// Angle between neighbouring samples, radians: along a column or along the row nearest to the equator, whichever is
    /// less.
    pub fn finest_spacing_rad(&self) -> f64 {
        self.place.finest_rad
    }

    /// Angle over which the grid's contribution varies, inside it, radians. This is [`Self::finest_spacing_rad`] except for
    /// a grid of one height without holes. For that grid it is the width of the feathered border, or infinite if the grid
    /// covers the whole Earth.
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
