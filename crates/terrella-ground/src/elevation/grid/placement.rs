//! Placement of a grid, and its transition to the source beneath.

use super::feather::Feather;
use super::georeference::SampleLattice;
use super::plane::Plane;
use super::{Georeference, GridError};
use crate::elevation::Bounds;
use crate::elevation::warp::Warp;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Position, spacing and feathered border of a grid, independent of its heights.
#[derive(Clone, Debug)]
pub struct Placement {
    pub(in crate::elevation) lattice: SampleLattice,
    /// Edges of the grid, without its feather.
    pub bounds: Bounds,
    /// Angle between neighbouring samples, radians: along a column or along the row nearest to the equator, whichever is less.
    pub finest_rad: f64,
    feather: Feather,
    /// The plane of the samples that the grid was resampled from, which has the border.
    pub(super) plane: Option<Arc<Plane>>,
}

impl Placement {
    /// The placement of a georeference.
    ///
    /// # Errors
    /// A georeference that places no samples.
    pub fn new(georeference: &Georeference) -> Result<Self, GridError> {
        let lattice = georeference.lattice()?;
        Ok(Self {
            lattice,
            bounds: georeference.bounds(),
            finest_rad: lattice
                .lat_step_rad
                .min(lattice.lon_step_rad * lattice.widest_cos()),
            feather: Feather::of(lattice),
            plane: None,
        })
    }

    /// The placement of a georeference that was resampled from projected samples, or was not.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub(in crate::elevation) fn of(
        georeference: &Georeference,
        warp: Option<&Warp>,
    ) -> Result<Self, GridError> {
        Self::new(georeference)?.with_border_of(warp)
    }

    /// The same placement with the border of the projected samples that the grid was resampled from, if it was.
    ///
    /// # Errors
    /// A projected grid that places no samples.
    pub(in crate::elevation) fn with_border_of(
        mut self,
        warp: Option<&Warp>,
    ) -> Result<Self, GridError> {
        if let Some(warp) = warp {
            self.plane = Some(Arc::new(Plane::new(warp, &self.lattice)?));
        }
        Ok(self)
    }

    /// The feather along the border.
    pub(super) fn border(&self) -> &Feather {
        self.plane
            .as_ref()
            .map_or(&self.feather, |plane| &plane.feather)
    }

    /// The border's row and column of a place, radians.
    pub(super) fn border_at(&self, lat_rad: f64, lon_rad: f64) -> (f64, f64) {
        match &self.plane {
            None => self.lattice.locate(lat_rad, lon_rad),
            Some(plane) => plane.locate(lat_rad, lon_rad),
        }
    }

    /// The place of a row and column of the border, latitude and longitude, radians.
    pub(super) fn place_of_border(&self, row: f64, column: f64) -> (f64, f64) {
        match &self.plane {
            None => self.lattice.place_at(row, column),
            Some(plane) => plane.place_at(row, column),
        }
    }

    /// Whether all places between two rows and two columns are so far inside that no border counts; `None` if the border is the grid's own.
    pub(super) fn are_deep(&self, rows: (f64, f64), columns: (f64, f64)) -> Option<bool> {
        let plane = self.plane.as_ref()?;
        Some(plane.are_deep(&self.lattice, rows, columns))
    }

    /// Calls `weight` with the row and column of the border.
    #[inline]
    pub(super) fn at_border(
        &self,
        row: f64,
        column: f64,
        weight: impl FnOnce(&Feather, f64, f64) -> f64,
    ) -> f64 {
        match &self.plane {
            None => weight(&self.feather, row, column),
            Some(plane) if plane.is_deep(&self.lattice, row, column) => 1.0,
            Some(plane) => {
                let (lat_rad, lon_rad) = self.lattice.place_at(row, column);
                let (row, column) = plane.locate(lat_rad, lon_rad);
                weight(&plane.feather, row, column)
            }
        }
    }

    /// The border's factor of the weight at a row and column, 0…1.
    #[inline]
    pub(in crate::elevation) fn inside(&self, row: f64, column: f64) -> f64 {
        self.at_border(row, column, Feather::inside)
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
