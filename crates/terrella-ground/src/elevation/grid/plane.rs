//! The border of a grid that was resampled from a projection: that of the projected samples, which the bounds of the grid surround.

use super::GridError;
use super::feather::Feather;
use super::georeference::SampleLattice;
use crate::elevation::projection::Projection;
use crate::elevation::warp::{ProjectedGrid, Warp};
use crate::elevation::{Georeference, Registration};

/// Radians by which a metre of the plane is stored: all planes are less than a radian wide.
const RAD_PER_M: f64 = 1e-8;

/// Parts of the resampled grid along each side that are known to have the full weight or not.
const PARTS: usize = 64;

/// The samples in the plane of their projection.
#[derive(Clone, Debug)]
pub(in crate::elevation) struct Plane {
    projection: Projection,
    /// Their feather, the northern row first, with metres as in [`RAD_PER_M`].
    pub(super) feather: Feather,
    /// Whether a part of the resampled grid is so far inside that no border counts there.
    is_deep: Vec<bool>,
}

impl Plane {
    /// The plane of a grid whose resampled lattice is given.
    ///
    /// # Errors
    /// A projected grid that places no samples.
    pub(super) fn new(warp: &Warp, resampled: &SampleLattice) -> Result<Self, GridError> {
        let grid = warp.grid();
        let mut plane = Self {
            projection: grid.projection,
            feather: Feather::of(georeference(grid).lattice()?),
            is_deep: Vec::new(),
        };
        plane.is_deep = plane.deep_parts(resampled);
        Ok(plane)
    }

    /// Whether two grids lie in one plane.
    pub(super) fn is_of(&self, other: &Self) -> bool {
        self.projection == other.projection
    }

    /// Row and column of a place.
    pub(super) fn locate(&self, lat_rad: f64, lon_rad: f64) -> (f64, f64) {
        let (east_m, north_m) = self.projection.forward_m(lat_rad, lon_rad);
        let lattice = &self.feather.lattice;
        lattice.locate(north_m * RAD_PER_M, east_m * RAD_PER_M)
    }

    /// The place of a row and column, latitude and longitude, radians.
    pub(super) fn place_at(&self, row: f64, column: f64) -> (f64, f64) {
        let lattice = &self.feather.lattice;
        let north_m = (lattice.north_rad - row * lattice.lat_step_rad) / RAD_PER_M;
        let east_m = (lattice.west_rad + column * lattice.lon_step_rad) / RAD_PER_M;
        self.projection.inverse_rad(east_m, north_m)
    }

    /// Whether a row and column of the resampled grid are far inside.
    #[inline]
    pub(super) fn is_deep(&self, resampled: &SampleLattice, row: f64, column: f64) -> bool {
        let part = |at: f64, count: usize| {
            let part = at / (count - 1).max(1) as f64 * PARTS as f64;
            (part >= 0.0 && part < PARTS as f64).then_some(part as usize)
        };
        let lattice = resampled;
        match (part(row, lattice.rows), part(column, lattice.columns)) {
            (Some(row), Some(column)) => self.is_deep[row * PARTS + column],
            _ => false,
        }
    }

    /// Whether all places between two rows and two columns of the resampled grid are far inside.
    pub(super) fn are_deep(
        &self,
        resampled: &SampleLattice,
        rows: (f64, f64),
        columns: (f64, f64),
    ) -> bool {
        let lattice = resampled;
        let parts = |(from, to): (f64, f64), count: usize| {
            let part = |at: f64| (at / (count - 1).max(1) as f64 * PARTS as f64).floor();
            (part(from) >= 0.0 && part(to) < PARTS as f64)
                .then(|| part(from) as usize..=part(to) as usize)
        };
        match (parts(rows, lattice.rows), parts(columns, lattice.columns)) {
            (Some(rows), Some(columns)) => rows
                .flat_map(|row| columns.clone().map(move |column| row * PARTS + column))
                .all(|part| self.is_deep[part]),
            _ => false,
        }
    }

    fn deep_parts(&self, resampled: &SampleLattice) -> Vec<bool> {
        let node = |row: usize, column: usize| {
            let at = |part: usize, count: usize| part as f64 / PARTS as f64 * (count - 1) as f64;
            let lattice = resampled;
            let (lat_rad, lon_rad) =
                lattice.place_at(at(row, lattice.rows), at(column, lattice.columns));
            self.locate(lat_rad, lon_rad)
        };
        let nodes: Vec<_> = (0..=PARTS)
            .flat_map(|row| (0..=PARTS).map(move |column| (row, column)))
            .map(|(row, column)| node(row, column))
            .collect();
        let is_deep = |row: usize, column: usize| {
            let corners = [(0, 0), (0, 1), (1, 0), (1, 1)]
                .map(|(down, right)| nodes[(row + down) * (PARTS + 1) + column + right]);
            let range = |of: fn(&(f64, f64)) -> f64| {
                let values = corners.iter().map(of);
                let least = values.clone().fold(f64::INFINITY, f64::min);
                // Edges of a part are bent by less than a tenth of it.
                let bend = 0.1 * (values.clone().fold(f64::NEG_INFINITY, f64::max) - least);
                (
                    least - bend,
                    values.fold(f64::NEG_INFINITY, f64::max) + bend,
                )
            };
            let (rows, columns) = (range(|at| at.0), range(|at| at.1));
            let ends = [(rows.0, columns.0), (rows.1, columns.1)];
            // NaN is not deep.
            ends.into_iter()
                .all(|(row, column)| self.feather.inside(row, column) >= 1.0)
        };
        (0..PARTS * PARTS)
            .map(|part| is_deep(part / PARTS, part % PARTS))
            .collect()
    }
}

fn georeference(grid: &ProjectedGrid) -> Georeference {
    let last_m = grid.north_m - f64::from(grid.rows - 1) * grid.row_m;
    Georeference {
        columns: grid.columns,
        rows: grid.rows,
        registration: match grid.margin > 0.0 {
            true => Registration::Cells,
            false => Registration::Posts,
        },
        north_rad: grid.north_m.max(last_m) * RAD_PER_M,
        lat_step_rad: grid.row_m.abs() * RAD_PER_M,
        west_rad: grid.east_m * RAD_PER_M,
        lon_step_rad: grid.column_m * RAD_PER_M,
    }
}
