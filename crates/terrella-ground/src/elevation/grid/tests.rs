//! Interpolation and averages of grids.

mod making;
mod properties;

use super::*;
use properties::kinds;
use std::f64::consts::FRAC_PI_2;

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

/// Noise that depends only on the place, −11 000…9 000 m.
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
    // On the posts of whole degrees: integer metres, and fractional ones.
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
            // The outermost half cell has samples on one side only.
            let lat = (-2.7 + 6.4 * v).to_radians();
            let lon = (8.3 + 4.4 * u).to_radians();
            for grid in [&posts, &cells] {
                let error = (grid.height_m(lat, lon, 0.0) - plane(lat, lon)).abs();
                assert!(error < tolerance, "{error} at {lat} {lon}");
            }
        }
        // Beyond the border the nearest sample applies; the outermost posts have their own heights.
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
        // Rows away from the equator count slightly less in means, and level 0 may hold integer metres.
        assert!(error.abs() < 2.0, "{error} at spacing {spacing}");
    }
}

#[test]
fn an_average_is_over_the_spacing_asked_for() {
    // Stripes of one sample vanish at twice their spacing, and are half as strong in between.
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
    // Large spacings return the mean of all samples.
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
            // Any value is fine, but it must return.
            grid.height_m(no_number, 0.0, 0.1);
            grid.height_m(0.0, no_number, 0.1);
            grid.weight(no_number, no_number);
        }
    }
}
