//! Continuity, ranges and weights of grids of all kinds.

use super::super::*;
use super::{degrees, grid_of, noise};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

/// Grids of all kinds with extreme heights.
pub fn kinds() -> Vec<HeightGrid> {
    let globe = Bounds::GLOBE;
    let local = degrees(30.0, 41.0, 170.0, 20.0);
    use Registration::{Cells, Posts};
    vec![
        grid_of(Cells, &globe, (37, 18), noise),
        grid_of(Posts, &globe, (37, 19), noise),
        grid_of(Cells, &globe, (3, 2), noise),
        grid_of(Cells, &globe, (1, 1), noise),
        grid_of(Cells, &degrees(-60.0, 60.0, 0.0, 360.0), (48, 12), noise),
        grid_of(Cells, &local, (40, 22), noise),
        grid_of(Posts, &local, (21, 13), noise),
        grid_of(Cells, &local, (40, 4), noise),
        grid_of(Cells, &local, (1, 1), noise),
        grid_of(Posts, &local, (3, 2), noise),
        grid_of(Cells, &degrees(80.0, 90.0, 10.0, 30.0), (9, 9), noise),
        grid_of(Cells, &local, (17, 1), |lat, lon| noise(lat, lon).round()),
        grid_of(Cells, &local, (70, 70), |lat, lon| {
            // A quarter without data.
            if lon > 3.1 && lat > 0.63 {
                f64::NAN
            } else {
                noise(lat, lon).round()
            }
        }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    /// Neighbouring places have similar heights, at every spacing, also across cells, the date line and poles.
    #[test]
    fn heights_are_continuous(
        kind in 0usize..13,
        v in 0.0..1.0f64,
        u in -2.0..2.0f64,
        turn in 0.0..std::f64::consts::TAU,
        steps in prop_oneof![Just(0.0), 0.5..40.0f64],
    ) {
        let grids = kinds();
        let grid = &grids[kind];
        let step = grid.finest_spacing_rad();
        // Half of the places are next to a pole, the date line or a row or column.
        let bounds = grid.bounds();
        let mut lat = bounds.south_rad + v * (bounds.north_rad - bounds.south_rad);
        let mut lon = u * PI;
        if turn < 1.0 { lat = (lat / step).round() * step }
        if turn > 5.0 { lon = PI }
        lat = lat.clamp(-FRAC_PI_2, FRAC_PI_2);
        // The far side of a local grid is skipped: there its nearer border changes.
        if !grid.place.lattice.is_periodic {
            lon = bounds.west_rad + (0.5 + 0.2 * u) * bounds.width_rad;
        }
        // On a column and on a row: there interpolation changes from one pair of samples to the
        // next.
        let super::super::georeference::SampleLattice { west_rad, lon_step_rad, north_rad, lat_step_rad, columns, rows, .. } = grid.place.lattice;
        let column = west_rad + (u.abs() * 0.5 * columns as f64).floor() * lon_step_rad;
        let row = north_rad - (v * rows as f64).floor() * lat_step_rad;
        let tiny = 1e-9;
        let (east, north) = (tiny * turn.cos(), tiny * turn.sin());
        let steepest = 20_000.0 / step * 60.0;
        let here = grid.height_m(lat, lon, steps * step);
        for (lat, lon) in [(lat, lon), (lat, column), (row, lon)] {
            let lat = lat.clamp(-FRAC_PI_2, FRAC_PI_2);
            let here = grid.height_m(lat - north, lon - east, steps * step);
            for (lat2, lon2) in [(lat + north, lon + east), (lat - north, lon + east), (lat + north, lon - east)] {
                let there = grid.height_m(lat2, lon2, steps * step);
                prop_assert!((here - there).abs() <= 2.0 * steepest * tiny, "{here} and {there}");
            }
        }
        // Continuous in the spacing too.
        let there = grid.height_m(lat, lon, steps * step + tiny * step);
        prop_assert!((here - there).abs() < 1e-3, "{here} and {there}");
        let edge = grid.height_m(lat, lon, 4.0 * step * (1.0 - 1e-12));
        let there = grid.height_m(lat, lon, 4.0 * step * (1.0 + 1e-12));
        prop_assert!((edge - there).abs() < 1e-3);
    }

    /// At a pole all longitudes meet, at every spacing.
    #[test]
    fn poles_have_one_height(lon in -10.0..10.0f64, steps in 0.0..64.0f64, kind in 0usize..4) {
        let grids = kinds();
        let grid = &grids[kind];
        let spacing = steps * grid.finest_spacing_rad();
        for pole in [FRAC_PI_2, -FRAC_PI_2] {
            let here = grid.height_m(pole, 0.0, spacing);
            let there = grid.height_m(pole, lon, spacing);
            prop_assert!((here - there).abs() < 1e-6, "{here} and {there}");
            // Beyond the pole the height is constant.
            prop_assert_eq!(there, grid.height_m(pole * 1.3, lon, spacing));
        }
    }

    /// No height inside the bounds lies outside the range.
    #[test]
    fn ranges_hold_all_heights(
        kind in 0usize..13,
        corner in (-FRAC_PI_2..FRAC_PI_2, -7.0..7.0f64),
        size in (0.0..1.0f64, 0.0..1.0f64),
        fine in 0..3,
        places in prop::collection::vec((0.0..=1.0f64, 0.0..=1.0f64, 0.0..7.0f64), 20),
    ) {
        let grids = kinds();
        let grid = &grids[kind];
        let part = 0.1f64.powi(fine);
        let south_rad = corner.0;
        let asked = Bounds {
            south_rad,
            north_rad: (south_rad + size.0 * part * PI).min(FRAC_PI_2),
            west_rad: corner.1,
            width_rad: size.1 * part * std::f64::consts::TAU,
        };
        let range = grid.range_m(&asked, f64::INFINITY);
        prop_assert!(range.low_m <= range.high_m);
        let whole = grid.stats().range;
        prop_assert!(range.low_m > whole.low_m - 0.01 && range.high_m < whole.high_m + 0.01);
        for (v, u, level) in places {
            let lat = asked.south_rad + v * (asked.north_rad - asked.south_rad);
            let lon = asked.west_rad + u * asked.width_rad;
            for spacing in [0.0, grid.finest_spacing_rad() * level.exp2()] {
                let height = grid.height_m(lat, lon, spacing);
                let up_to = grid.range_m(&asked, spacing);
                prop_assert!(up_to.low_m <= height && height <= up_to.high_m);
                prop_assert!(up_to.low_m >= range.low_m && up_to.high_m <= range.high_m);
                prop_assert!(
                    range.low_m <= height && height <= range.high_m,
                    "{height} at {lat} {lon}, spacing {spacing}, is not in {range:?}"
                );
            }
        }
    }

    /// Weights are as documented: continuous, 0 at the border and beyond, 1 well inside.
    #[test]
    fn weights_are_continuous(
        kind in 0usize..13, v in -0.1..1.1f64, u in -0.1..1.1f64, turn in 0.0..6.3f64,
    ) {
        let grids = kinds();
        let grid = &grids[kind];
        let bounds = grid.bounds();
        let lat = bounds.south_rad + v * (bounds.north_rad - bounds.south_rad);
        let lon = bounds.west_rad + u * bounds.width_rad;
        let weight = grid.weight(lat, lon);
        prop_assert!((0.0..=1.0).contains(&weight));
        let there = grid.weight(lat + 1e-10 * turn.sin(), lon + 1e-10 * turn.cos());
        prop_assert!((weight - there).abs() < 1e-5);
        let is_outside = !(0.0..=1.0).contains(&u) && !grid.place.lattice.is_periodic;
        prop_assert!(!is_outside || weight == 0.0);
        // If the grid alone determines the bounds, it does so at each of their places.
        let asked = Bounds { south_rad: lat, north_rad: lat + 0.01, west_rad: lon, width_rad: 0.02 };
        if grid.rules(&asked) {
            for (v, u) in [(0.0, 0.0), (0.5, 0.3), (1.0, 1.0), (0.0, 1.0), (1.0, 0.0)] {
                let weight = grid.weight(lat + 0.01 * v, lon + 0.02 * u);
                prop_assert_eq!(weight, 1.0);
            }
        }
    }
}

#[test]
fn ranges_are_narrow_where_asked_for_little() {
    let ramp = |_: f64, lon: f64| 1000.0 * lon;
    let grid = grid_of(
        Registration::Cells,
        &degrees(0.0, 10.0, 0.0, 10.0),
        (512, 512),
        ramp,
    );
    for (width, most) in [(0.001, 3.0), (0.5, 4.0), (2.0, 3.0)] {
        let asked = degrees(5.0, 5.0 + width, 5.0, width);
        let range = grid.range_m(&asked, width.to_radians());
        let true_m = 1000.0 * width.to_radians();
        let wide = (range.high_m - range.low_m) / (true_m + 1000.0 * grid.finest_spacing_rad());
        assert!(wide < most, "{wide} times too wide at {width}°");
    }
    let flat = grid_of(Registration::Cells, &Bounds::GLOBE, (8, 4), |_, _| 7.0);
    let range = flat.range_m(&Bounds::GLOBE, f64::INFINITY);
    assert!((range.low_m - 7.0).abs() < 1e-5 && (range.high_m - 7.0).abs() < 1e-5);
    assert!(flat.is_flat());
}
