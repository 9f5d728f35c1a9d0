//! Interpolation, continuity, ranges, holes and sizes of grids.

use super::*;
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

fn degrees(south: f64, north: f64, west: f64, width: f64) -> Bounds {
    Bounds {
        south_rad: south.to_radians(),
        north_rad: north.to_radians(),
        west_rad: west.to_radians(),
        width_rad: width.to_radians(),
    }
}

fn grid_of(
    registration: Registration,
    bounds: &Bounds,
    (columns, rows): (u32, u32),
    height_m: impl Fn(f64, f64) -> f64,
) -> HeightGrid {
    let place = Georeference::from_bounds(registration, bounds, columns, rows).unwrap();
    let mut heights = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let lat = place.north_rad - f64::from(row) * place.lat_step_rad;
            let lon = place.west_rad + f64::from(column) * place.lon_step_rad;
            heights.push(height_m(lat, lon) as f32);
        }
    }
    HeightGrid::new(&place, heights, &GridLimits::default()).unwrap()
}

/// Heights without any order, the same for the same place, −11 000…9 000 m.
fn noise(lat: f64, lon: f64) -> f64 {
    let mut bits = (lat * 1e5).round() as i64 as u64 ^ ((lon * 1e5).round() as i64 as u64) << 32;
    for _ in 0..3 {
        bits = (bits ^ (bits >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    }
    (bits >> 11) as f64 / (1u64 << 53) as f64 * 20_000.0 - 11_000.0
}

#[test]
fn planes_are_exact_in_both_registrations_and_storages() {
    let bounds = degrees(-3.0, 4.0, 8.0, 5.0);
    // Multiples of a metre on the posts of whole degrees, and not.
    for (slope, tolerance) in [(100.0, 1e-9), (0.37, 1e-4)] {
        let plane = |lat: f64, lon: f64| slope * (2.0 * lat + 3.0 * lon).to_degrees();
        let posts = grid_of(Registration::Posts, &bounds, (6, 8), plane);
        let cells = grid_of(Registration::Cells, &bounds, (10, 14), plane);
        assert_eq!(
            posts.stats().quantum_m,
            if slope == 100.0 { 1.0 } else { 0.0 }
        );
        for n in 0..1000 {
            let (u, v) = (f64::from(n) * 0.618 % 1.0, f64::from(n) / 1000.0);
            // The outermost half cell has no samples on both sides.
            let lat = (-2.7 + 6.4 * v).to_radians();
            let lon = (8.3 + 4.4 * u).to_radians();
            for grid in [&posts, &cells] {
                let error = (grid.height_m(lat, lon, 0.0) - plane(lat, lon)).abs();
                assert!(error < tolerance, "{error} at {lat} {lon}");
            }
        }
        // Beyond the border the nearest sample stays; on the outermost posts themselves heights are theirs.
        let corner = (bounds.north_rad, bounds.west_rad);
        let at = |lat, lon| posts.height_m(lat, lon, 0.0);
        assert!((at(corner.0, corner.1) - plane(corner.0, corner.1)).abs() < tolerance);
        assert_eq!(at(corner.0 + 0.1, corner.1 - 0.2), at(corner.0, corner.1));
    }
}

#[test]
fn a_plane_stays_one_in_coarser_levels() {
    let bounds = degrees(-8.0, 8.0, 20.0, 16.0);
    let plane = |lat: f64, lon: f64| 50.0 * (lat + 2.0 * lon).to_degrees();
    let grid = grid_of(Registration::Cells, &bounds, (64, 64), plane);
    let step = grid.finest_spacing_rad();
    assert!((step.to_degrees() - 0.25).abs() < 0.01);
    for spacing in [0.0, 1.0, 2.0, 3.3, 8.0] {
        let error = grid.height_m(0.013, 0.49, spacing * step) - plane(0.013, 0.49);
        // Rows away from the equator count a little less in means, and level 0 is of whole metres or not.
        assert!(error.abs() < 2.0, "{error} at spacing {spacing}");
    }
}

#[test]
fn an_average_is_over_the_spacing_asked_for() {
    // Stripes of one sample are gone at twice their spacing, and half gone between.
    let bounds = degrees(-8.0, 8.0, 0.0, 16.0);
    let stripes = |_: f64, lon: f64| ((lon.to_degrees() * 4.0).floor() % 2.0) * 200.0;
    let grid = grid_of(Registration::Cells, &bounds, (64, 64), stripes);
    let step = grid.finest_spacing_rad();
    let lon = (2.0 + 0.125_f64).to_radians();
    let at = |steps: f64| grid.height_m(0.0, lon, steps * step);
    assert_eq!(at(0.0), 0.0);
    assert_eq!(at(1.0), 0.0);
    assert!((at(1.5) - 50.0).abs() < 0.1, "{}", at(1.5));
    assert!((at(2.0) - 100.0).abs() < 0.1);
    // The mean of all, from some spacing on.
    assert!((at(1e9) - 100.0).abs() < 0.1);
    assert_eq!(at(f64::INFINITY), at(1e9));
    assert_eq!(at(f64::NAN), 0.0);
}

#[test]
fn rows_near_a_pole_are_averaged_over_ground() {
    // Stripes along meridians: 64 samples wide at 89° N, where that is less ground than a row's step.
    let stripes = |_: f64, lon: f64| if (lon * 8.0).sin() > 0.0 { 1000.0 } else { 0.0 };
    let grid = grid_of(Registration::Cells, &Bounds::GLOBE, (1024, 512), stripes);
    let (lat, lon) = (89.5_f64.to_radians(), 0.2);
    assert!(grid.height_m(lat, lon, 0.0) > 999.0);
    let coarse = grid.height_m(lat, lon, 8.0 * grid.finest_spacing_rad());
    assert!((coarse - 500.0).abs() < 60.0, "{coarse}");
    let equator = grid.height_m(0.0, lon, 8.0 * grid.finest_spacing_rad());
    assert!(equator > 990.0, "{equator}");
}

/// Grids of all kinds, wild heights in them.
fn kinds() -> Vec<HeightGrid> {
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
            // A quarter of it without data.
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

    /// Neighbouring places have neighbouring heights, at every spacing, also across cells, the date line and poles.
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
        // Half of the places next to a pole, the date line or a row or column.
        let bounds = grid.bounds();
        let mut lat = bounds.south_rad + v * (bounds.north_rad - bounds.south_rad);
        let mut lon = u * PI;
        if turn < 1.0 { lat = (lat / step).round() * step }
        if turn > 5.0 { lon = PI }
        lat = lat.clamp(-FRAC_PI_2, FRAC_PI_2);
        // A local grid's far side is not asked for: there its nearer border changes.
        if !grid.place.is_periodic {
            lon = bounds.west_rad + (0.5 + 0.2 * u) * bounds.width_rad;
        }
        // On a column and on a row: there interpolation goes from one pair of samples to the next.
        let Snapped { west_rad, lon_step_rad, north_rad, lat_step_rad, columns, rows, .. } = grid.place;
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
        // In the spacing too.
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
            // Beyond it nothing changes.
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

    /// Weights are those of the documentation: continuous, 0 at the border and beyond, 1 well inside.
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
        let is_outside = !(0.0..=1.0).contains(&u) && !grid.place.is_periodic;
        prop_assert!(!is_outside || weight == 0.0);
        // Alone in its bounds means alone in each place of them.
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

#[test]
fn holes_are_filled_and_counted() {
    let bounds = degrees(0.0, 10.0, 0.0, 10.0);
    let place = Georeference::from_bounds(Registration::Cells, &bounds, 40, 40).unwrap();
    let plane = |n: usize| (n % 40) as f32 * 10.0;
    let mut heights: Vec<f32> = (0..1600).map(plane).collect();
    // One sample, and an infinity: both from what is round them.
    heights[20 * 40 + 20] = f32::NAN;
    heights[10 * 40 + 30] = f32::INFINITY;
    let grid = HeightGrid::new(&place, heights.clone(), &GridLimits::default()).unwrap();
    assert_eq!((grid.stats().holes, grid.stats().left_holes), (2, 0));
    let at = |row: f64, column: f64| {
        (
            (10.0 - (row + 0.5) / 4.0).to_radians(),
            ((column + 0.5) / 4.0).to_radians(),
        )
    };
    let (lat, lon) = at(20.0, 20.0);
    assert!((grid.height_m(lat, lon, 0.0) - 200.0).abs() < 11.0);
    assert_eq!(grid.weight(lat, lon), 1.0);

    // A wedge of the north-east: near data it is filled, from 9 samples on it is left.
    for row in 0..20 {
        heights[row * 40 + 20..(row + 1) * 40].fill(f32::NAN);
    }
    let grid = HeightGrid::new(&place, heights, &GridLimits::default()).unwrap();
    assert_eq!(grid.stats().holes, 401);
    assert_eq!(grid.stats().left_holes, 16 * 16);
    let weight = |row: f64, column: f64| {
        let (lat, lon) = at(row, column);
        grid.weight(lat, lon)
    };
    assert_eq!(weight(10.0, 19.0), 1.0);
    assert_eq!(weight(10.0, 23.0), 1.0);
    assert!(
        (weight(10.0, 25.0) - 0.6).abs() < 1e-9,
        "{}",
        weight(10.0, 25.0)
    );
    assert_eq!(weight(10.0, 29.0), 0.0);
    let (lat, lon) = at(10.0, 30.0);
    assert!(grid.height_m(lat, lon, 0.0).is_finite());
    let inside = degrees(6.0, 7.0, 7.0, 0.5);
    assert!(!grid.rules(&inside) && grid.rules(&degrees(3.0, 4.0, 7.0, 0.5)));

    let empty = HeightGrid::new(&place, vec![f32::NAN; 1600], &GridLimits::default());
    assert_eq!(empty.unwrap_err(), GridError::Empty);
}

#[test]
fn a_hole_across_the_seam_is_measured_round_it() {
    // 20 columns without data, half of them on each side of the date line: the middle is 10 from data.
    let place = Georeference::from_bounds(Registration::Cells, &Bounds::GLOBE, 72, 36).unwrap();
    let mut heights = vec![100.0f32; 72 * 36];
    for row in heights.chunks_exact_mut(72) {
        row[..10].fill(f32::NAN);
        row[62..].fill(f32::NAN);
    }
    let grid = HeightGrid::new(&place, heights, &GridLimits::default()).unwrap();
    let weight = |lon_deg: f64| grid.weight(0.0, lon_deg.to_radians());
    assert_eq!(weight(180.0), 0.0);
    assert!((weight(-177.5) - weight(177.5)).abs() < 1e-9);
    assert!((weight(-152.5) - 0.8).abs() < 1e-9 && (weight(152.5) - 0.8).abs() < 1e-9);
    assert_eq!(weight(-132.5), 1.0);

    // Data begin east of the date line: the last column is next to them.
    let mut heights = vec![100.0f32; 72 * 36];
    for row in heights.chunks_exact_mut(72) {
        row[52..].fill(f32::NAN);
    }
    let grid = HeightGrid::new(&place, heights, &GridLimits::default()).unwrap();
    let weight = |lon_deg: f64| grid.weight(0.0, lon_deg.to_radians());
    assert_eq!((weight(177.5), weight(162.5)), (1.0, 1.0));
    assert_eq!((weight(137.5), weight(130.0)), (0.0, 0.0));
}

#[test]
fn extremes_are_held() {
    for (low, high) in [(-11_000.0, 9_000.0), (-10_999.5, 8_999.25)] {
        let grid = grid_of(Registration::Cells, &Bounds::GLOBE, (4, 2), |_, lon| {
            if lon > 0.0 { high } else { low }
        });
        assert_eq!(
            grid.stats().range,
            HeightRange {
                low_m: low,
                high_m: high
            }
        );
        assert_eq!(grid.height_m(0.0, FRAC_PI_2, 0.0), high);
        assert_eq!(grid.height_m(0.0, -FRAC_PI_2, 0.0), low);
    }
    // One sample for the whole Earth, and one for a part.
    for bounds in [Bounds::GLOBE, degrees(1.0, 2.0, 3.0, 1.0)] {
        let grid = grid_of(Registration::Cells, &bounds, (1, 1), |_, _| 5.5);
        for place in [(0.0, 0.0), (1.57, 3.0), (-2.0, 9.0), (0.026, 0.06)] {
            assert_eq!(grid.height_m(place.0, place.1, 0.3), 5.5);
        }
        assert_eq!(grid.stats().levels, 1);
    }
}

#[test]
fn no_place_is_too_far() {
    for grid in kinds() {
        for lon in [1e9, -1e17, 1e19, 1e300, f64::MAX, -f64::MAX] {
            assert!(grid.height_m(0.3, lon, 0.0).is_finite() && grid.weight(0.3, lon).is_finite());
        }
        for no_number in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            // Any answer, but one.
            grid.height_m(no_number, 0.0, 0.1);
            grid.height_m(0.0, no_number, 0.1);
            grid.weight(no_number, no_number);
        }
    }
}

#[test]
fn a_repeated_column_is_dropped_and_rows_at_poles_get_one_height() {
    let grid = grid_of(Registration::Posts, &Bounds::GLOBE, (9, 5), |lat, lon| {
        if lat > 1.5 {
            lon.cos() * 100.0
        } else {
            10.0 * lon.cos()
        }
    });
    assert_eq!((grid.place.columns, grid.place.is_periodic), (8, true));
    assert!(grid.height_m(FRAC_PI_2, 1.0, 0.0).abs() < 1e-4);
    // 21 601 x 10 801 files that call their posts cells: half a cell too large all round.
    let place = Georeference {
        columns: 9,
        rows: 5,
        registration: Registration::Cells,
        north_rad: FRAC_PI_2,
        lat_step_rad: PI / 4.0,
        west_rad: -PI,
        lon_step_rad: PI / 4.0,
    };
    let grid = HeightGrid::new(&place, vec![1.0; 45], &GridLimits::default()).unwrap();
    assert_eq!((grid.place.columns, grid.weight(1.5, 3.1)), (8, 1.0));
}

#[test]
fn heights_are_rounded_where_memory_is_short() {
    let bounds = degrees(0.0, 10.0, 0.0, 10.0);
    let place = Georeference::from_bounds(Registration::Cells, &bounds, 256, 256).unwrap();
    let heights: Vec<f32> = (0..65_536).map(|n| n as f32 * 0.01 + 0.005).collect();
    let make = |bytes| HeightGrid::new(&place, heights.clone(), &GridLimits { bytes });
    let whole = make(1 << 20).unwrap().stats();
    assert_eq!(whole.quantum_m, 0.0);
    assert_eq!(whole.bytes, 65_536 * 4 + 21_845 * 12);
    let rounded = make(400_000).unwrap();
    assert!((rounded.stats().quantum_m - 0.01).abs() < 1e-3);
    assert!(rounded.stats().bytes <= 400_000);
    let (lat, lon) = (5.0_f64.to_radians(), 5.0_f64.to_radians());
    let error = rounded.height_m(lat, lon, 0.0) - make(1 << 20).unwrap().height_m(lat, lon, 0.0);
    assert!(error.abs() <= 0.006 && error != 0.0, "{error}");
    assert_eq!(
        make(300_000).unwrap_err().to_string(),
        "256 x 256 samples would take 1 MB and 0 MB are allowed; make them coarser (`gdalwarp -r average -tr LON LAT \
         IN OUT`) or allow more"
    );
}

#[test]
fn what_makes_no_grid_is_said() {
    let globe = |columns, rows| {
        Georeference::from_bounds(Registration::Cells, &Bounds::GLOBE, columns, rows)
    };
    let sizes = "expected 1 to 1048576 along each side, of posts 2 at least";
    assert!(globe(0, 4).unwrap_err().to_string().contains(sizes));
    assert!(globe(2_000_000, 4).unwrap_err().to_string().contains(sizes));
    let posts = Georeference::from_bounds(Registration::Posts, &Bounds::GLOBE, 1, 4);
    assert!(posts.unwrap_err().to_string().contains(sizes));

    let good = globe(8, 4).unwrap();
    let said = |place: &Georeference, heights| {
        HeightGrid::new(place, heights, &GridLimits::default())
            .unwrap_err()
            .to_string()
    };
    let place = |change: fn(&mut Georeference)| {
        let mut place = good;
        change(&mut place);
        said(&place, vec![0.0; 32])
    };
    assert!(place(|p| p.north_rad += 0.6).contains("beyond a pole"));
    assert!(place(|p| p.lon_step_rad *= 1.3).contains("more than a full turn"));
    assert!(place(|p| p.lon_step_rad = -1.0).contains("not positive"));
    assert!(place(|p| p.lat_step_rad = f64::NAN).contains("not positive"));
    assert!(place(|p| p.lat_step_rad = 1e-300).contains("beyond all measure"));
    assert!(place(|p| p.west_rad = 1e30).contains("beyond all measure"));
    assert_eq!(
        said(&good, vec![0.0; 31]),
        "has 31 heights for 32 samples; give one for each"
    );
    for (height, told) in [(29_029.0, "29029 m"), (-32_768.0, "-32768 m")] {
        let mut heights = vec![0.0; 32];
        heights[3] = height;
        let said = said(&good, heights);
        assert!(
            said.contains(told)
                && said.contains("correct unit, scale, offset, no-data value or byte order")
        );
    }
    let huge = GridLimits::default().check(1 << 20, 1 << 20);
    assert!(matches!(huge, Err(GridError::Memory { .. })));
}
