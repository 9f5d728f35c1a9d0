//! Resampling of a projected grid to latitudes and longitudes of equal resolution. Along parallels the resolution is that nearest to
//! the equator.

use super::projection::Projection;
use super::{Georeference, MAX_SIDE, Registration};
use glam::DVec2;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Maximum samples of a projected grid.
const MOST_SAMPLES: u64 = 1 << 28;

/// Maximum number of output samples per input sample.
const MOST_MADE: f64 = 32.0;

/// Half of the places of a row between which projected ones are interpolated.
const HALF_SPAN: u32 = 16;
/// Greatest error of the interpolation where it is checked, samples.
const INTERPOLATION_ERROR: f64 = 1e-4;

/// Samples around a grid of heights that its neighbour may lie beyond.
pub const AROUND: f64 = 2.0;

/// Border points that are checked on each side.
const BORDER: u32 = 256;

/// A projected grid: its first sample, and steps from column to column and from row to row, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProjectedGrid {
    /// Projection of the coordinates.
    pub projection: Projection,
    /// Samples of a row.
    pub columns: u32,
    /// Rows.
    pub rows: u32,
    /// Easting of the first sample.
    pub east_m: f64,
    /// Northing of the first sample.
    pub north_m: f64,
    /// Step from column to column, to the east, positive.
    pub column_m: f64,
    /// Step from row to row, to the south; negative where the southern row comes first.
    pub row_m: f64,
    /// Extent of the data beyond the outermost samples, samples.
    pub margin: f64,
}

/// Resampling of a projected grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Warp {
    grid: ProjectedGrid,
    /// How far beyond the outermost samples their values are taken, samples.
    reach: f64,
    /// The target grid; its samples are posts.
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

    /// The smallest angle between neighbours, in the middle and at the corners.
    fn finest_rad(&self) -> f64 {
        let (last_row, last_column) = (f64::from(self.rows - 1), f64::from(self.columns - 1));
        let mut finest = f64::INFINITY;
        for (row, column) in [(0.5, 0.5), (0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)] {
            let (row, column) = (row * last_row, column * last_column);
            let (lat, lon) = self.at(row, column);
            for (lat_2, lon_2) in [self.at(row + 1.0, column), self.at(row, column + 1.0)] {
                let along = (lon_2 - lon + PI).rem_euclid(TAU) - PI;
                let apart = (lat_2 - lat).hypot(along * lat.cos());
                if apart > 0.0 {
                    finest = finest.min(apart);
                }
            }
        }
        finest
    }

    /// Whether a row and column are among the samples, or so many samples around them.
    fn reaches(&self, row: f64, column: f64, margin: f64) -> bool {
        let reaches = |at: f64, count: u32| {
            at >= -margin - 1e-6 && at <= f64::from(count - 1) + margin + 1e-6
        };
        reaches(row, self.rows) && reaches(column, self.columns)
    }

    /// Southern and northern latitude, western longitude and width, radians, of the samples and of so many samples around them.
    fn bounds(&self, beyond: f64) -> Option<[f64; 4]> {
        let (last_row, last_column) = (
            f64::from(self.rows - 1) + beyond,
            f64::from(self.columns - 1) + beyond,
        );
        let (_, middle) = self.at(0.5 * last_row, 0.5 * last_column);
        let mut bounds = [f64::INFINITY, f64::NEG_INFINITY, 0.0, 0.0];
        for n in 0..=BORDER {
            let part = f64::from(n) / f64::from(BORDER);
            let along = |last: f64| part * (last + beyond) - beyond;
            let (row, column) = (along(last_row), along(last_column));
            for (row, column) in [
                (row, -beyond),
                (row, last_column),
                (-beyond, column),
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
        bounds[0] = bounds[0].max(-FRAC_PI_2);
        bounds[1] = bounds[1].min(FRAC_PI_2);
        bounds[3] -= bounds[2];
        bounds[2] += middle;
        if let Some((sign, (east, north))) = self.projection.pole_m() {
            let place = (
                (self.north_m - north) / self.row_m,
                (east - self.east_m) / self.column_m,
            );
            if self.reaches(place.0, place.1, self.margin.max(beyond)) {
                bounds[usize::from(sign > 0.0)] = sign * FRAC_PI_2;
                (bounds[2], bounds[3]) = (-PI, TAU);
            }
        }
        Some(bounds)
    }
}

impl Warp {
    /// The resampling of a grid.
    ///
    /// # Errors
    /// Why resampling is impossible: too many or too few samples, or no places in the projection.
    pub fn of(grid: ProjectedGrid) -> Result<Self, String> {
        Self::beyond(grid, 0.0)
    }

    /// The resampling of a grid and of so many samples around it, which have no data.
    ///
    /// # Errors
    /// As [`Self::of`].
    pub fn beyond(grid: ProjectedGrid, samples_around: f64) -> Result<Self, String> {
        let samples = u64::from(grid.columns) * u64::from(grid.rows);
        if samples > MOST_SAMPLES {
            return Err(format!(
                "has {} x {} projected samples",
                grid.columns, grid.rows
            ));
        }
        if grid.columns < 2 || grid.rows < 2 {
            return Err("has only one row or column of projected samples".to_string());
        }
        let Some([south, north, west, width]) = grid.bounds(samples_around) else {
            return Err("lies where its projection has no places".to_string());
        };
        let lat_step = grid.finest_rad();
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
            return Err(format!(
                "would make {columns} x {rows} samples of {samples}"
            ));
        }
        // Both are in range. A last column that repeats the first is omitted.
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
        // To the middle of a gap of one sample, and a sample more for the places that are interpolated between.
        let across = if samples_around > 0.0 { 1.6 } else { 0.0 };
        Ok(Self {
            grid,
            reach: grid.margin + across,
            place,
        })
    }

    /// The projected grid.
    pub fn grid(&self) -> &ProjectedGrid {
        &self.grid
    }

    /// Samples of the projected grid.
    pub fn samples(&self) -> usize {
        self.grid.columns as usize * self.grid.rows as usize
    }

    /// Columns and rows of the projected grid.
    pub fn size(&self) -> (u32, u32) {
        (self.grid.columns, self.grid.rows)
    }

    /// Latitude of a target row, radians.
    pub fn latitude_rad(&self, row: u32) -> f64 {
        self.place.north_rad - f64::from(row) * self.place.lat_step_rad
    }

    /// Longitude of a target column, radians.
    pub fn longitude_rad(&self, column: u32) -> f64 {
        self.place.west_rad + f64::from(column) * self.place.lon_step_rad
    }

    /// Row and column in the projected grid, from its first sample to its last, of each place of a target row; `None` outside it.
    ///
    /// They are projected at every 16th place and interpolated quadratically between, where that is as good; else projected
    /// one by one.
    pub fn locate_row(&self, row: u32, places: &mut Vec<Option<(f64, f64)>>) {
        let lat_rad = self.latitude_rad(row);
        let exact = |column: u32| {
            let (row, column) = self.grid.locate(lat_rad, self.longitude_rad(column));
            DVec2::new(row, column)
        };
        places.clear();
        let columns = self.place.columns;
        let mut first = 0;
        let mut at_first = exact(first);
        while first + 2 * HALF_SPAN < columns {
            let (middle, last) = (first + HALF_SPAN, first + 2 * HALF_SPAN);
            let (at_middle, at_last) = (exact(middle), exact(last));
            let bend = 0.5 * (at_first + at_last) - at_middle;
            let rise = 0.5 * (at_last - at_first);
            let between = |column: u32| {
                let part = f64::from(column) / f64::from(HALF_SPAN)
                    - f64::from(middle) / f64::from(HALF_SPAN);
                at_middle + part * (rise + part * bend)
            };
            let checked = first + HALF_SPAN / 2;
            // Not a number, as at a pole, is no good interpolation either.
            let is_good =
                (between(checked) - exact(checked)).abs().max_element() < INTERPOLATION_ERROR;
            let found = (first..last).map(|column| match is_good {
                true => between(column),
                false => exact(column),
            });
            places.extend(found.map(|at| self.within(at)));
            (first, at_first) = (last, at_last);
        }
        places.extend((first..columns).map(|column| self.within(exact(column))));
    }

    /// A place of the projected grid, moved from its margin to the outermost samples; `None` outside it.
    fn within(&self, at: DVec2) -> Option<(f64, f64)> {
        let within = |at: f64, count: u32| at.clamp(0.0, f64::from(count - 1));
        self.grid.reaches(at.x, at.y, self.reach).then(|| {
            (
                within(at.x, self.grid.rows),
                within(at.y, self.grid.columns),
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elevation::projection::Projection;

    /// Every place of a row is that of its own projection, to a thousandth of a sample.
    #[test]
    fn rows_are_where_each_of_their_places_is_projected() {
        let grid = |projection, east_m, north_m, step_m| ProjectedGrid {
            projection,
            columns: 900,
            rows: 700,
            east_m,
            north_m,
            column_m: step_m,
            row_m: step_m,
            margin: 0.5,
        };
        let of = |epsg| Projection::of_code(epsg).expect("a projection");
        let mut interpolated = 0;
        for grid in [
            grid(of(32633), 2e5, 6e6, 300.0),
            grid(of(32760), 4e5, 9e6, 1000.0),
            // About the pole, and across the date line.
            grid(of(3413), -2.2e6, 1.7e6, 5000.0),
        ] {
            let warp = Warp::of(grid).expect("a resampling");
            let mut places = Vec::new();
            for row in (0..warp.place.rows).step_by(37) {
                warp.locate_row(row, &mut places);
                assert_eq!(places.len(), warp.place.columns as usize);
                for (column, place) in (0..).zip(&places) {
                    let (lat_rad, lon_rad) = (warp.latitude_rad(row), warp.longitude_rad(column));
                    let exact = grid.locate(lat_rad, lon_rad);
                    let at = warp.within(exact.into());
                    if let (Some(place), Some(at)) = (place, at) {
                        let off = (place.0 - at.0).hypot(place.1 - at.1);
                        assert!(off < 1e-3, "{row} {column}: {place:?}, not {at:?}");
                        interpolated += u32::from(off > 0.0);
                    } else {
                        // At the edge of the grid.
                        let edge = |at: f64, count: u32| at.min(f64::from(count - 1) - at).abs();
                        let off = edge(exact.0, grid.rows).min(edge(exact.1, grid.columns));
                        let is_same = place.is_none() == at.is_none();
                        assert!(
                            is_same || (off - grid.margin).abs() < 1e-3,
                            "{row} {column}"
                        );
                    }
                }
            }
        }
        assert!(interpolated > 1000, "{interpolated}");
    }
}
