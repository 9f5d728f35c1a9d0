//! The feathered border of a lattice of samples.

use super::FEATHER_SAMPLES;
use super::georeference::SampleLattice;
use crate::step::smooth_step;

/// Samples, and how the weight of their heights falls towards their border.
#[derive(Clone, Copy, Debug)]
pub(in crate::elevation) struct Feather {
    pub lattice: SampleLattice,
    /// Increase of the weight per row and per column inwards, before smoothing.
    pub ramps: (f64, f64),
}

impl Feather {
    /// The feather of samples that no neighbour continues.
    pub fn of(lattice: SampleLattice) -> Self {
        let ramp = |count: usize| {
            let side = (count - 1) as f64 + 2.0 * lattice.margin();
            1.0 / FEATHER_SAMPLES.max(side / 16.0).min(0.25 * side)
        };
        Self {
            lattice,
            ramps: (ramp(lattice.rows), ramp(lattice.columns)),
        }
    }

    /// The border's factor of the weight at a row and column, 0…1.
    #[inline]
    pub fn inside(&self, row: f64, column: f64) -> f64 {
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
        let ramp =
            |from_border: f64, per_sample: f64| smooth_step([0.0, 1.0], from_border * per_sample);
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
}
