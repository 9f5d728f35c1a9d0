//! Placement of a grid, and its transition to the source beneath.

use super::georeference::SampleLattice;
use super::{FEATHER_SAMPLES, Georeference, GridError};
use crate::elevation::Bounds;
use std::f64::consts::{PI, TAU};

/// Position, spacing and feathered border of a grid, independent of its heights.
#[derive(Clone, Debug)]
pub struct Placement {
    pub(in crate::elevation) lattice: SampleLattice,
    /// Edges of the grid, without its feather.
    pub bounds: Bounds,
    /// Angle between neighbouring samples, radians: along a column or along the row nearest to the equator, whichever is less.
    pub finest_rad: f64,
    /// Increase of the weight per row and per column inwards, before smoothing.
    pub(super) ramps: (f64, f64),
}

/// Smooth step from 0 to 1 with zero slope at both ends.
#[inline]
pub(super) fn smooth(part: f64) -> f64 {
    let part = part.clamp(0.0, 1.0);
    part * part * (3.0 - 2.0 * part)
}

impl Placement {
    /// The placement of a georeference.
    ///
    /// # Errors
    /// A georeference that places no samples.
    pub fn new(georeference: &Georeference) -> Result<Self, GridError> {
        let lattice = georeference.lattice()?;
        let ramp = |count: usize| {
            let side = (count - 1) as f64 + 2.0 * lattice.margin();
            1.0 / FEATHER_SAMPLES.max(side / 16.0).min(0.25 * side)
        };
        Ok(Self {
            lattice,
            bounds: georeference.bounds(),
            finest_rad: lattice
                .lat_step_rad
                .min(lattice.lon_step_rad * lattice.widest_cos()),
            ramps: (ramp(lattice.rows), ramp(lattice.columns)),
        })
    }

    /// The border's factor of the weight at a row and column, 0…1.
    #[inline]
    pub(in crate::elevation) fn inside(&self, row: f64, column: f64) -> f64 {
        let SampleLattice {
            columns,
            rows,
            is_periodic,
            reaches_north,
            reaches_south,
            ..
        } = self.lattice;
        if is_periodic && reaches_north && reaches_south {
            return 1.0;
        }
        let margin = self.lattice.margin();
        let ramp = |from_border: f64, per_sample: f64| smooth(from_border * per_sample);
        let mut weight = 1.0;
        if !is_periodic {
            let west = column + margin;
            let east = (columns - 1) as f64 + margin - column;
            weight *= ramp(west.min(east), self.ramps.1);
        }
        let north = if reaches_north {
            f64::INFINITY
        } else {
            row + margin
        };
        let south = if reaches_south {
            f64::INFINITY
        } else {
            (rows - 1) as f64 + margin - row
        };
        weight * ramp(north.min(south), self.ramps.0)
    }

    /// Samples of a row, and rows.
    pub fn size(&self) -> (u32, u32) {
        (self.lattice.columns as u32, self.lattice.rows as u32)
    }

    /// Bounds from the first to the last sample each way.
    pub fn sample_bounds(&self) -> Bounds {
        let lattice = &self.lattice;
        let tall_rad = (lattice.rows - 1) as f64 * lattice.lat_step_rad;
        Bounds {
            south_rad: lattice.north_rad - tall_rad,
            north_rad: lattice.north_rad,
            west_rad: lattice.west_rad,
            width_rad: (lattice.columns - 1) as f64 * lattice.lon_step_rad,
        }
    }

    /// Angle over which the grid's contribution varies, inside it, radians. This is [`Self::finest_rad`] except for a `uniform` grid: one
    /// height, without unfilled holes. For that grid it is the width of the feathered border, or infinite if the grid covers the whole
    /// Earth.
    pub fn detail_rad(&self, uniform: bool) -> f64 {
        if !uniform {
            return self.finest_rad;
        }
        let Bounds {
            south_rad,
            north_rad,
            width_rad,
            ..
        } = self.bounds;
        if width_rad >= TAU - 1e-9 && north_rad - south_rad >= PI - 1e-9 {
            return f64::INFINITY;
        }
        ((north_rad - south_rad).min(width_rad) / 16.0).max(self.finest_rad)
    }
}
