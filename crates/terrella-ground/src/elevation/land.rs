//! Land by a map of open water. Land keeps its heights slightly below the sea, as polders and deltas do.
//!
//! The map has no small lakes, and no ice except ice shelves. Elevation data below the sea there are beds of lakes, down to −971 m in the Caspian
//! Sea, and rock below ice. Land is therefore kept down to [`SHALLOW_M`] only. Deeper dry land is listed in [`basins`](super::basins).

use super::Bounds;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Lowest land below the sea outside the known basins, metres. Polders and deltas reach down to −7 m.
pub const SHALLOW_M: f64 = 10.0;

/// Cells of the Earth, 5° each, for a fast test for land.
const COLUMNS: usize = 72;
const ROWS: usize = 36;

/// Land fraction of each texel of a map.
#[derive(Debug)]
pub struct LandShares {
    columns: usize,
    rows: usize,
    /// 0…255, row after row from the north and from 180° W.
    shares: Vec<u8>,
    /// Whether each cell has a texel that is mostly land.
    has_land: Vec<bool>,
}

impl LandShares {
    /// Builds it from a map of open water of the whole Earth: one byte per texel, 255 for all water. Rows run from the north and
    /// start at 180° W. `None` for a map without texels or of another size.
    pub fn of_water(columns: u32, rows: u32, water: &[u8]) -> Option<Self> {
        let (columns, rows) = (columns as usize, rows as usize);
        if columns == 0 || rows == 0 || Some(water.len()) != columns.checked_mul(rows) {
            return None;
        }
        let mut has_land = vec![false; COLUMNS * ROWS];
        for (row, of_row) in water.chunks_exact(columns).enumerate() {
            // A texel has influence up to the centres of its neighbours.
            let near_row = |n: usize| (n * ROWS / rows).min(ROWS - 1);
            let part_rows = near_row(row.saturating_sub(1))..=near_row((row + 2).min(rows - 1));
            for (column, _) in of_row.iter().enumerate().filter(|(_, water)| **water < 128) {
                let near = |n: usize| n % columns * COLUMNS / columns;
                for part_row in part_rows.clone() {
                    for n in [columns - 1, 0, 1, 2] {
                        has_land[part_row * COLUMNS + near(column + n)] = true;
                    }
                }
            }
        }
        Some(Self {
            columns,
            rows,
            shares: water.iter().map(|water| u8::MAX - water).collect(),
            has_land,
        })
    }

    /// The lowest land at a place, metres: 0 where water prevails. Continuous.
    pub(super) fn lowest_m(&self, lat_rad: f64, lon_rad: f64) -> f64 {
        let turns = lon_rad / TAU + 0.5;
        let turns = turns - turns.floor();
        let part = row_of(lat_rad) * COLUMNS + ((turns * COLUMNS as f64) as usize).min(COLUMNS - 1);
        if !self.has_land[part] {
            return 0.0;
        }
        // Between the centres of texels. Negative numbers saturate.
        let y = (FRAC_PI_2 - lat_rad) / PI * self.rows as f64 - 0.5;
        let y = y.clamp(0.0, (self.rows - 1) as f64);
        let x = turns * self.columns as f64 - 0.5;
        let x = if x < 0.0 { x + self.columns as f64 } else { x };
        let (row, column) = (y as usize, (x as usize).min(self.columns - 1));
        let (of_row, of_column) = (y - row as f64, x - column as f64);
        let east = if column + 1 < self.columns {
            column + 1
        } else {
            0
        };
        let in_row = |row: usize| {
            let of_row = &self.shares[row * self.columns..];
            f64::from(of_row[column]) * (1.0 - of_column) + f64::from(of_row[east]) * of_column
        };
        let south = (row + 1).min(self.rows - 1);
        let share = (in_row(row) * (1.0 - of_row) + in_row(south) * of_row) / 255.0;
        // Avoids a negative zero.
        0.0 - SHALLOW_M * (2.0 * share - 1.0).clamp(0.0, 1.0)
    }

    /// A lower bound of the land heights within bounds, metres.
    pub(super) fn lowest_in_m(&self, bounds: &Bounds) -> f64 {
        let first = ((bounds.west_rad / TAU + 0.5).rem_euclid(1.0) * COLUMNS as f64) as usize;
        let count = (bounds.width_rad.clamp(0.0, TAU) / TAU * COLUMNS as f64) as usize + 2;
        let count = count.min(COLUMNS);
        let has_land = (row_of(bounds.north_rad)..=row_of(bounds.south_rad)).any(|row| {
            let of_row = &self.has_land[row * COLUMNS..(row + 1) * COLUMNS];
            (first..first + count).any(|column| of_row[column % COLUMNS])
        });
        if has_land { -SHALLOW_M } else { 0.0 }
    }
}

fn row_of(lat_rad: f64) -> usize {
    // Negative numbers saturate at 0.
    (((FRAC_PI_2 - lat_rad) * (ROWS as f64 / PI)) as usize).min(ROWS - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Land in the east, and an island of one texel at 32° S 98° W; the last column and the first are also land.
    fn shares() -> LandShares {
        let (columns, rows) = (90, 45);
        let water = (0..columns * rows).map(|n| {
            let (row, column) = (n / columns, n % columns);
            let is_land = column > 60 || column == 0 || (row, column) == (30, 20);
            if is_land { 0 } else { 255 }
        });
        let water: Vec<u8> = water.collect();
        LandShares::of_water(columns, rows, &water).expect("a map")
    }

    #[test]
    fn land_is_kept_and_water_is_not() {
        let shares = shares();
        let lowest = |lat: f64, lon: f64| shares.lowest_m(lat.to_radians(), lon.to_radians());
        for (lat, lon, right) in [
            (0.0, 120.0, -SHALLOW_M),
            (89.9, 120.0, -SHALLOW_M),
            (-90.0, 480.0, -SHALLOW_M),
            (12.0, 180.0, -SHALLOW_M),
            (12.0, -180.0, -SHALLOW_M),
            (0.0, 0.0, 0.0),
            (45.0, -120.0, 0.0),
            (-32.0, -98.0, -SHALLOW_M),
            // Where land and water meet, 2° from the centres of both texels, the sea begins.
            (0.0, 64.0, 0.0),
            // Midway from there to the centre of the land.
            (0.0, 65.0, -SHALLOW_M / 2.0),
        ] {
            let found = lowest(lat, lon);
            assert!((found - right).abs() < 1e-9, "{lat} {lon}: {found}");
        }
        for (columns, rows, bytes) in [(0, 0, 0), (2, 2, 3), (0, 5, 0)] {
            assert!(LandShares::of_water(columns, rows, &vec![0; bytes]).is_none());
        }
    }

    #[test]
    fn bounds_hold_the_lowest_within_them_and_it_is_continuous() {
        let shares = shares();
        for n in 0..40_000 {
            let x = f64::from(n);
            let (lat, lon) = (90.0 * (x * 0.618).sin(), (x * 7.31) % 720.0 - 360.0);
            let bounds = Bounds {
                south_rad: (lat - 0.3_f64).max(-90.0).to_radians(),
                north_rad: (lat + 0.2_f64).min(90.0).to_radians(),
                west_rad: (lon - 0.4).to_radians(),
                width_rad: 0.7_f64.to_radians(),
            };
            let low_m = shares.lowest_in_m(&bounds);
            let at_m = shares.lowest_m(lat.to_radians(), lon.to_radians());
            assert!(low_m <= at_m, "{lat} {lon}: {low_m} above {at_m}");
            let near_m = shares.lowest_m(lat.to_radians(), (lon + 1e-4).to_radians());
            // 4° from texel to texel: 20 m over 4°.
            assert!(
                (near_m - at_m).abs() < 1e-3,
                "{lat} {lon}: {near_m} beside {at_m}"
            );
        }
        let middle_of_sea = Bounds {
            south_rad: 0.5,
            north_rad: 0.6,
            west_rad: -1.0,
            width_rad: 0.3,
        };
        assert_eq!(shares.lowest_in_m(&middle_of_sea), 0.0);
        assert_eq!(shares.lowest_in_m(&Bounds::GLOBE), -SHALLOW_M);
    }
}
