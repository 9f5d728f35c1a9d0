//! Positions of the samples of a grid.

use super::GridError;
use crate::elevation::Bounds;
use crate::elevation::floor::floor;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Maximum number of samples along one side of a grid.
pub const MAX_SIDE: u32 = 1 << 20;

/// Tolerance, in spacings, at which a grid counts as reaching a pole or spanning 360°.
const SNAP: f64 = 0.1;

/// Meaning of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Registration {
    /// The mean of a cell around it: the grid extends half a spacing beyond its outermost samples.
    Cells,
    /// The height of a point: the grid ends at its outermost samples.
    Posts,
}

/// Size and position of a grid of samples at equal steps of latitude and longitude. The northern row is first; rows
/// run from west to east.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Georeference {
    /// Samples of a row, 1…[`MAX_SIDE`].
    pub columns: u32,
    /// Rows, 1…[`MAX_SIDE`].
    pub rows: u32,
    /// Meaning of a sample.
    pub registration: Registration,
    /// Geodetic latitude of the northern row, radians.
    pub north_rad: f64,
    /// Step from a row to the next towards the south, radians, positive.
    pub lat_step_rad: f64,
    /// Longitude of the western column, radians; any multiple of 2π may be added.
    pub west_rad: f64,
    /// Step from a column to the next towards the east, radians, positive.
    pub lon_step_rad: f64,
}

impl Georeference {
    /// A grid that fills the bounds: cells reach their edges, posts are on them.
    ///
    /// # Errors
    /// As [`HeightGrid::new`](super::HeightGrid::new), and for fewer than 2 posts along a side.
    pub fn from_bounds(
        registration: Registration,
        bounds: &Bounds,
        columns: u32,
        rows: u32,
    ) -> Result<Self, GridError> {
        let (gaps, half) = match registration {
            Registration::Cells => ((columns, rows), 0.5),
            Registration::Posts => ((columns.saturating_sub(1), rows.saturating_sub(1)), 0.0),
        };
        if gaps.0 == 0 || gaps.1 == 0 {
            return Err(GridError::Size { columns, rows });
        }
        let lat_step_rad = (bounds.north_rad - bounds.south_rad) / f64::from(gaps.1);
        let lon_step_rad = bounds.width_rad / f64::from(gaps.0);
        let georeference = Self {
            columns,
            rows,
            registration,
            north_rad: bounds.north_rad - half * lat_step_rad,
            lat_step_rad,
            west_rad: bounds.west_rad + half * lon_step_rad,
            lon_step_rad,
        };
        georeference.lattice()?;
        Ok(georeference)
    }

    /// The bounds that the grid covers.
    pub fn bounds(&self) -> Bounds {
        let half = match self.registration {
            Registration::Cells => 0.5,
            Registration::Posts => 0.0,
        };
        let south_rad = self.north_rad - f64::from(self.rows - 1) * self.lat_step_rad;
        Bounds {
            south_rad: (south_rad - half * self.lat_step_rad).max(-FRAC_PI_2),
            north_rad: (self.north_rad + half * self.lat_step_rad).min(FRAC_PI_2),
            west_rad: self.west_rad - half * self.lon_step_rad,
            width_rad: ((f64::from(self.columns - 1) + 2.0 * half) * self.lon_step_rad).min(TAU),
        }
    }

    /// The checked lattice of the samples. It moves by at most [`SNAP`] spacings where the grid almost reaches a pole or its own start after
    /// 360°.
    pub(in crate::elevation) fn lattice(&self) -> Result<SampleLattice, GridError> {
        let Self { columns, rows, .. } = *self;
        let sides = 1..=MAX_SIDE;
        let least = u32::from(self.registration == Registration::Posts) + 1;
        if !sides.contains(&columns) || !sides.contains(&rows) || columns.min(rows) < least {
            return Err(GridError::Size { columns, rows });
        }
        let fault = |what| Err(GridError::Place { what });
        let (lat_step, lon_step) = (self.lat_step_rad, self.lon_step_rad);
        let numbers = [self.north_rad, self.west_rad, lat_step, lon_step];
        let is_finite = numbers.iter().all(|n| n.is_finite());
        if !(is_finite && lat_step > 0.0 && lon_step > 0.0) {
            return fault("its steps are not positive or its corner is not a number");
        }
        // A micrometre of ground: below it f64 cannot separate neighbours.
        if lat_step.min(lon_step) < 1e-13 || self.west_rad.abs() > 1e3 {
            return fault("its steps or its corner are beyond all measure");
        }
        let gaps = f64::from(rows - 1);
        let (mut north, mut south) = (self.north_rad, self.north_rad - gaps * lat_step);
        for target in [FRAC_PI_2, FRAC_PI_2 - 0.5 * lat_step] {
            if (north - target).abs() < SNAP * lat_step {
                north = target;
            }
            if (south + target).abs() < SNAP * lat_step {
                south = -target;
            }
        }
        if north > FRAC_PI_2 || south < -FRAC_PI_2 || lat_step > PI + 1e-9 {
            return fault("its rows reach beyond a pole");
        }
        let lat_step = if rows > 1 {
            (north - south) / gaps
        } else {
            lat_step
        };
        let turn = TAU / lon_step;
        let all = f64::from(columns);
        let (columns_used, is_periodic) = if (all - turn).abs() < SNAP {
            (columns, true)
        } else if columns > 1 && (all - 1.0 - turn).abs() < SNAP {
            (columns - 1, true)
        } else if all - 1.0 > turn || (self.registration == Registration::Cells && all > turn) {
            return fault("its columns cover more than a full turn");
        } else {
            (columns, false)
        };
        let lon_step = if is_periodic {
            TAU / f64::from(columns_used)
        } else {
            lon_step
        };
        // A row less than a step from a pole extends to the pole.
        let reaches = |row: f64| is_periodic && FRAC_PI_2 - row < lat_step * (1.0 + 1e-9);
        Ok(SampleLattice {
            columns: columns_used as usize,
            rows: rows as usize,
            registration: self.registration,
            north_rad: north,
            lat_step_rad: lat_step,
            west_rad: self.west_rad,
            lon_step_rad: lon_step,
            is_periodic,
            reaches_north: reaches(north),
            reaches_south: reaches(-south),
            rows_per_rad: 1.0 / lat_step,
            columns_per_rad: 1.0 / lon_step,
            middle_rad: self.west_rad + 0.5 * f64::from(columns_used - 1) * lon_step,
        })
    }
}

/// Positions of the samples of a checked georeference.
#[derive(Clone, Copy, Debug)]
pub(in crate::elevation) struct SampleLattice {
    /// Number of stored columns, without one that repeats the first.
    pub columns: usize,
    pub rows: usize,
    pub registration: Registration,
    pub north_rad: f64,
    pub lat_step_rad: f64,
    pub west_rad: f64,
    pub lon_step_rad: f64,
    /// Whether the first column follows the last to the east.
    pub is_periodic: bool,
    pub reaches_north: bool,
    pub reaches_south: bool,
    /// Inverses of the steps, and the longitude midway between the outermost columns.
    rows_per_rad: f64,
    columns_per_rad: f64,
    middle_rad: f64,
}

impl SampleLattice {
    /// Row and column of a place as real numbers, 0 at the centre of the first sample. In a grid that is not periodic,
    /// columns are counted from the nearer side.
    #[inline]
    pub(in crate::elevation) fn locate(&self, lat_rad: f64, lon_rad: f64) -> (f64, f64) {
        let lat_rad = lat_rad.clamp(-FRAC_PI_2, FRAC_PI_2);
        let row = (self.north_rad - lat_rad) * self.rows_per_rad;
        if self.is_periodic {
            let turns = (lon_rad - self.west_rad) * (1.0 / TAU);
            (row, (turns - floor(turns)) * self.columns as f64)
        } else {
            let middle = 0.5 * (self.columns - 1) as f64;
            let from_middle = lon_rad - self.middle_rad;
            let turns = floor(from_middle * (1.0 / TAU) + 0.5);
            (
                row,
                (from_middle - turns * TAU) * self.columns_per_rad + middle,
            )
        }
    }

    /// The place of a row and column, latitude and longitude, radians.
    pub(in crate::elevation) fn place_at(&self, row: f64, column: f64) -> (f64, f64) {
        (
            self.north_rad - row * self.lat_step_rad,
            self.west_rad + column * self.lon_step_rad,
        )
    }

    /// Rows of the poles, as real numbers like those of [`Self::locate`].
    pub(in crate::elevation) fn pole_rows(&self) -> (f64, f64) {
        (
            (self.north_rad - FRAC_PI_2) / self.lat_step_rad,
            (self.north_rad + FRAC_PI_2) / self.lat_step_rad,
        )
    }

    /// Whether a row is outermost and at a pole.
    pub(in crate::elevation) fn is_pole(&self, row: usize) -> bool {
        let (north, south) = self.pole_rows();
        let on_pole = |pole: f64| (row as f64 - pole).abs() < 1e-9;
        (row == 0 || row + 1 == self.rows)
            && (self.reaches_north && on_pole(north) || self.reaches_south && on_pole(south))
    }

    /// Latitude of a row, radians.
    pub(in crate::elevation) fn latitude_rad(&self, row: f64) -> f64 {
        self.north_rad - row * self.lat_step_rad
    }

    /// The cosine of the covered latitude nearest to the equator.
    pub(in crate::elevation) fn widest_cos(&self) -> f64 {
        let south = self.latitude_rad((self.rows - 1) as f64);
        if self.north_rad >= 0.0 && south <= 0.0 {
            1.0
        } else {
            self.north_rad.cos().max(south.cos()).max(1e-6)
        }
    }

    /// Half a cell beyond the outermost samples, or 0.
    pub(in crate::elevation) fn margin(&self) -> f64 {
        match self.registration {
            Registration::Cells => 0.5,
            Registration::Posts => 0.0,
        }
    }
}
