//! Spatial index: finds the rectangles near a place.

use super::Bounds;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Cells of the Earth, along a parallel and along a meridian: 5° each.
const COLUMNS: usize = 72;
const ROWS: usize = 36;

/// Margin on each side for rounding, radians.
const MORE_RAD: f64 = 1e-9;

/// Rectangles by the cells that they overlap.
#[derive(Debug)]
pub struct PlacedBounds(Vec<Vec<u32>>);

impl PlacedBounds {
    /// Index of rectangles, numbered from 0.
    pub fn new(bounds: impl IntoIterator<Item = Bounds>) -> Self {
        let mut parts = vec![Vec::new(); COLUMNS * ROWS];
        for (number, bounds) in bounds.into_iter().enumerate() {
            for part in parts_of(&bounds) {
                // A grid cannot number more.
                parts[part].push(number as u32);
            }
        }
        Self(parts)
    }

    /// Indices of all rectangles that may overlap these bounds, ascending and unique.
    pub fn near(&self, bounds: &Bounds) -> Vec<usize> {
        let mut numbers: Vec<usize> = parts_of(bounds)
            .flat_map(|part| &self.0[part])
            .map(|number| *number as usize)
            .collect();
        numbers.sort_unstable();
        numbers.dedup();
        numbers
    }
}

/// The cells that bounds overlap.
fn parts_of(bounds: &Bounds) -> impl Iterator<Item = usize> + use<> {
    // Negative numbers saturate at 0.
    let row = |lat_rad: f64| (((FRAC_PI_2 - lat_rad) * (ROWS as f64 / PI)) as usize).min(ROWS - 1);
    let rows = row(bounds.north_rad + MORE_RAD)..=row(bounds.south_rad - MORE_RAD);
    let step_rad = TAU / COLUMNS as f64;
    let west = (bounds.west_rad - MORE_RAD).rem_euclid(TAU) / step_rad;
    let width = (bounds.width_rad + 2.0 * MORE_RAD).clamp(0.0, TAU) / step_rad;
    let first = west as usize;
    let count = ((west + width) as usize - first + 1).min(COLUMNS);
    // All meridians meet at a pole.
    let pole = FRAC_PI_2 - MORE_RAD;
    let (north, south) = (bounds.north_rad >= pole, bounds.south_rad <= -pole);
    let poles = [(0, north), (ROWS - 1, south)].into_iter();
    let of_poles = poles
        .filter(|(_, is_there)| *is_there)
        .flat_map(|(row, _)| (0..COLUMNS).map(move |column| row * COLUMNS + column));
    let of_rows = rows.flat_map(move |row| {
        (first..first + count).map(move |column| row * COLUMNS + column % COLUMNS)
    });
    of_rows.chain(of_poles)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_that_overlaps_is_left_out() {
        let of = |south: f64, north: f64, west: f64, width: f64| Bounds {
            south_rad: south.to_radians(),
            north_rad: north.to_radians(),
            west_rad: west.to_radians(),
            width_rad: width.to_radians(),
        };
        let mut all = vec![
            of(-90.0, 90.0, -180.0, 360.0),
            of(89.0, 90.0, 0.0, 1.0),
            of(-90.0, -89.5, 715.0, 3.0),
        ];
        for n in 0..300 {
            let part = f64::from(n);
            let south = (part * 7.3) % 170.0 - 90.0;
            all.push(of(
                south,
                south + 1.0 + part % 9.0,
                part * 13.7 - 500.0,
                0.5 + part % 40.0,
            ));
        }
        let placed = PlacedBounds::new(all.iter().copied());
        for bounds in &all {
            let near = placed.near(bounds);
            for (n, other) in all.iter().enumerate() {
                assert!(
                    !other.overlaps(bounds) || near.contains(&n),
                    "{bounds:?} {other:?}"
                );
            }
            assert!(near.windows(2).all(|pair| pair[0] < pair[1]));
        }
        // A query of one degree does not compare all rectangles.
        assert!(placed.near(&of(10.0, 11.0, 10.0, 1.0)).len() < 60);
    }
}
