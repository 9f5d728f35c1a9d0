//! Heights on a grid of a map projection, made into a grid of latitudes and longitudes.
//!
//! The grid that is made is as fine as the projected one, along parallels where it is nearest to the equator. Its heights are bilinear
//! between the projected samples, and none where a place lies outside of these. All projected heights are held meanwhile.

use super::HeightFileError;
use super::error::FileContext;
use crate::elevation::projection::Projection;
use crate::elevation::{Georeference, MAX_SIDE, Registration};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Radius of the Earth that lengths are made angles with, metres.
const RADIUS_M: f64 = 6_371_000.0;

/// Most bytes of projected heights.
const MOST_BYTES: u64 = 1 << 30;

/// So many samples may be made of each.
const MOST_MADE: f64 = 32.0;

/// Places of the border that are looked at, on each side.
const BORDER: u32 = 256;

/// A grid of a projection: its first sample, and steps from column to column and from row to row, metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct ProjectedGrid {
    pub projection: Projection,
    pub columns: u32,
    pub rows: u32,
    pub east_m: f64,
    pub north_m: f64,
    /// To the east, positive, and to the south.
    pub column_m: f64,
    pub row_m: f64,
    /// How far the samples reach beyond the outermost, samples.
    pub margin: f64,
}

/// What is made of a projected grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Warp {
    grid: ProjectedGrid,
    pub place: Georeference,
}

impl ProjectedGrid {
    fn at(&self, row: f64, column: f64) -> (f64, f64) {
        let (east, north) = (
            self.east_m + column * self.column_m,
            self.north_m - row * self.row_m,
        );
        self.projection.inverse_rad(east, north)
    }

    /// Row and column of a place.
    fn locate(&self, lat_rad: f64, lon_rad: f64) -> (f64, f64) {
        let (east, north) = self.projection.forward_m(lat_rad, lon_rad);
        (
            (self.north_m - north) / self.row_m,
            (east - self.east_m) / self.column_m,
        )
    }

    fn has(&self, row: f64, column: f64) -> bool {
        let reaches = |at: f64, count: u32| {
            at >= -self.margin - 1e-6 && at <= f64::from(count - 1) + self.margin + 1e-6
        };
        reaches(row, self.rows) && reaches(column, self.columns)
    }

    /// Southern and northern latitude, western longitude and width, radians.
    fn bounds(&self) -> Option<[f64; 4]> {
        let (last_row, last_column) = (f64::from(self.rows - 1), f64::from(self.columns - 1));
        let (_, middle) = self.at(0.5 * last_row, 0.5 * last_column);
        let mut bounds = [f64::INFINITY, f64::NEG_INFINITY, 0.0, 0.0];
        for n in 0..=BORDER {
            let part = f64::from(n) / f64::from(BORDER);
            let (row, column) = (part * last_row, part * last_column);
            for (row, column) in [
                (row, 0.0),
                (row, last_column),
                (0.0, column),
                (last_row, column),
            ] {
                let (lat, lon) = self.at(row, column);
                let lon = (lon - middle + PI).rem_euclid(TAU) - PI;
                if !(lat.is_finite() && lon.is_finite()) {
                    return None;
                }
                bounds[0] = bounds[0].min(lat);
                bounds[1] = bounds[1].max(lat);
                bounds[2] = bounds[2].min(lon);
                bounds[3] = bounds[3].max(lon);
            }
        }
        bounds[3] -= bounds[2];
        bounds[2] += middle;
        if let Some((sign, (east, north))) = self.projection.pole_m() {
            let place = (
                (self.north_m - north) / self.row_m,
                (east - self.east_m) / self.column_m,
            );
            if self.has(place.0, place.1) {
                bounds[usize::from(sign > 0.0)] = sign * FRAC_PI_2;
                (bounds[2], bounds[3]) = (-PI, TAU);
            }
        }
        Some(bounds)
    }
}

impl Warp {
    pub(super) fn of(grid: ProjectedGrid, context: &FileContext) -> Result<Self, HeightFileError> {
        let refused = |cause: String| {
            context.refused(
                cause,
                "projected heights of at most 268 million samples that lie near the middle of their projection",
                format!("`gdalwarp -t_srs EPSG:4326 -r bilinear {} OUT.tif`", context.path().display()),
            )
        };
        let samples = u64::from(grid.columns) * u64::from(grid.rows);
        if 4 * samples > MOST_BYTES {
            return Err(refused(format!(
                "has {} x {} projected samples",
                grid.columns, grid.rows
            )));
        }
        if grid.columns < 2 || grid.rows < 2 {
            return Err(refused(
                "has only one row or column of projected samples".to_string(),
            ));
        }
        let Some([south, north, west, width]) = grid.bounds() else {
            return Err(refused(
                "lies where its projection has no places".to_string(),
            ));
        };
        let lat_step = grid.column_m.min(grid.row_m.abs()) / RADIUS_M;
        let nearest = match south <= 0.0 && north >= 0.0 {
            true => 0.0,
            false => south.abs().min(north.abs()),
        };
        let lon_step = (lat_step / nearest.cos().max(1e-3)).min(width);
        let count = |angle: f64, step: f64| (angle / step - 1e-6).ceil().max(1.0);
        let is_round = width >= TAU - 1e-9;
        let (rows, columns) = (
            count(north - south, lat_step) + 1.0,
            count(width, lon_step) + 1.0,
        );
        let most = f64::from(MAX_SIDE);
        if rows > most || columns > most || rows * columns > MOST_MADE * samples as f64 + 1e6 {
            return Err(refused(format!(
                "would make {columns} x {rows} samples of {samples}"
            )));
        }
        // Both in range. A last column that repeats the first is not made.
        let (rows, gaps) = (rows as u32, columns as u32 - 1);
        let place = Georeference {
            columns: if is_round { gaps } else { gaps + 1 },
            rows,
            registration: Registration::Posts,
            north_rad: north,
            lat_step_rad: (north - south) / f64::from(rows - 1),
            west_rad: west,
            lon_step_rad: width / f64::from(gaps),
        };
        Ok(Self { grid, place })
    }

    /// Bytes of the projected heights.
    pub(super) fn working_bytes(&self) -> u64 {
        4 * u64::from(self.grid.columns) * u64::from(self.grid.rows)
    }

    /// Projected heights, none of which is known yet.
    pub(super) fn hold(&self) -> Held {
        Held {
            columns: self.grid.columns as usize,
            heights_m: vec![f32::NAN; self.grid.columns as usize * self.grid.rows as usize],
        }
    }

    /// Hands over all rows.
    pub(super) fn rows<E>(
        &self,
        held: &Held,
        put: &mut impl FnMut(usize, usize, &mut [f32]) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut heights_m = vec![0.0; self.place.columns as usize];
        for row in 0..self.place.rows {
            let lat_rad = self.place.north_rad - f64::from(row) * self.place.lat_step_rad;
            for (column, height_m) in heights_m.iter_mut().enumerate() {
                let lon_rad = self.place.west_rad + column as f64 * self.place.lon_step_rad;
                *height_m = self.height_m(held, lat_rad, lon_rad);
            }
            put(row as usize, 0, &mut heights_m)?;
        }
        Ok(())
    }

    fn height_m(&self, held: &Held, lat_rad: f64, lon_rad: f64) -> f32 {
        let (row, column) = self.grid.locate(lat_rad, lon_rad);
        if !self.grid.has(row, column) {
            return f32::NAN;
        }
        let within = |at: f64, count: u32| at.clamp(0.0, f64::from(count - 1));
        let (row, column) = (
            within(row, self.grid.rows),
            within(column, self.grid.columns),
        );
        // Two neighbours at least: there are two rows and columns.
        let (top, left) = (
            (row as usize).min(self.grid.rows as usize - 2),
            (column as usize).min(self.grid.columns as usize - 2),
        );
        let (down, right) = (row - top as f64, column - left as f64);
        let at = |row: usize, column: usize| f64::from(held.heights_m[row * held.columns + column]);
        let across = |row: usize| at(row, left) + right * (at(row, left + 1) - at(row, left));
        let height = across(top) + down * (across(top + 1) - across(top));
        match height.is_nan() {
            // Beside a hole the nearest counts.
            true => at(
                top + usize::from(down > 0.5),
                left + usize::from(right > 0.5),
            ) as f32,
            false => height as f32,
        }
    }
}

/// Heights as they are projected.
pub(super) struct Held {
    columns: usize,
    heights_m: Vec<f32>,
}

impl Held {
    /// Takes heights of a row from a column on.
    pub(super) fn put(&mut self, row: usize, column: usize, heights_m: &[f32]) {
        let start = row * self.columns + column;
        self.heights_m[start..start + heights_m.len()].copy_from_slice(heights_m);
    }
}
