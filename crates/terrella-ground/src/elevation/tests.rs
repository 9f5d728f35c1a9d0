//! Slopes, and stacked grids.

use super::*;
use glam::DVec3;
use proptest::prelude::*;
use std::sync::Arc;

/// Heights from a formula.
struct Formula<F>(F, f64);

impl<F: Fn(f64, f64) -> f64 + Send + Sync> Elevation for Formula<F> {
    fn height_m(&self, lat_rad: f64, lon_rad: f64, _: f64) -> f64 {
        (self.0)(lat_rad, lon_rad)
    }

    fn range_m(&self, _: &Bounds) -> HeightRange {
        HeightRange {
            low_m: -1e4,
            high_m: 1e4,
        }
    }

    fn finest_spacing_rad(&self, _: f64, _: f64) -> f64 {
        self.1
    }
}

/// Height of the plane 0.1 x + 0.2 y + 0.3 z of the unit normal, 1000 m: smooth at the poles too.
fn smooth(lat: f64, lon: f64) -> f64 {
    Ellipsoid::normal(lat, lon).dot(DVec3::new(0.1, 0.2, 0.3)) * 1e5
}

#[test]
fn slopes_are_right_everywhere_poles_included() {
    let wgs84 = Ellipsoid::WGS84;
    let ground = Formula(smooth, 1e-5);
    for lat_deg in [-90.0, -89.99999, -60.0, 0.0, 45.0, 89.9, 89.999_999_9, 90.0] {
        for lon_deg in [-180.0, -20.0, 77.0, 180.0] {
            let (lat, lon) = (f64::to_radians(lat_deg), f64::to_radians(lon_deg));
            let n = Ellipsoid::normal(lat, lon);
            let east = DVec3::new(-lon.sin(), lon.cos(), 0.0);
            let north = n.cross(east);
            // Radii of curvature of the ellipsoid, prime vertical and meridian.
            let e2 = wgs84.eccentricity_squared();
            let w = (1.0 - e2 * n.z * n.z).sqrt();
            let across = wgs84.equatorial_radius_m / w;
            let along = wgs84.equatorial_radius_m * (1.0 - e2) / (w * w * w);
            let gradient = DVec3::new(0.1, 0.2, 0.3) * 1e5;
            let right = DVec2::new(gradient.dot(east) / across, gradient.dot(north) / along);
            for spacing in [0.0, 1e-12, 1e-4, f64::NAN] {
                let slope = ground.slope(&wgs84, lat, lon, spacing);
                let error = slope.distance(right) / right.length();
                assert!(
                    error < 1e-5,
                    "{slope} for {right} at {lat_deg} {lon_deg}, spacing {spacing}"
                );
            }
        }
    }
    // A latitude beyond the pole is the pole's.
    let beyond = ground.slope(&wgs84, 2.0, 0.3, 0.0);
    assert_eq!(beyond, ground.slope(&wgs84, 0.5 * PI, 0.3, 0.0));
}

#[test]
fn slopes_are_finite_at_any_spacing() {
    let wgs84 = Ellipsoid::WGS84;
    for finest in [0.0, 1e-300, 1e-9, 0.1, 10.0, f64::INFINITY] {
        let ground = Formula(smooth, finest);
        for spacing in [0.0, 1e-300, 1.0, 1e9, f64::INFINITY] {
            for lat in [-2.0, -0.5 * PI, 0.0, 1.57, 0.5 * PI] {
                let slope = ground.slope(&wgs84, lat, 400.0, spacing);
                assert!(slope.is_finite() && slope.length() < 0.2, "{slope}");
            }
        }
    }
    let flat = Formula(smooth, f64::INFINITY);
    assert_eq!(flat.slope(&wgs84, 0.3, 0.4, 0.1), DVec2::ZERO);
}

fn degrees(south: f64, north: f64, west: f64, width: f64) -> Bounds {
    Bounds {
        south_rad: south.to_radians(),
        north_rad: north.to_radians(),
        west_rad: west.to_radians(),
        width_rad: width.to_radians(),
    }
}

fn grid(
    bounds: &Bounds,
    (columns, rows): (u32, u32),
    height_m: impl Fn(u32) -> f32,
) -> Arc<HeightGrid> {
    let place = Georeference::from_bounds(Registration::Cells, bounds, columns, rows).unwrap();
    let heights = (0..columns * rows).map(height_m).collect();
    Arc::new(HeightGrid::new(&place, heights, &GridLimits::default()).unwrap())
}

#[test]
fn nothing_is_the_sea() {
    let sea = Ground::new([]);
    for (lat, lon) in [
        (0.0, 0.0),
        (2.0, -9.0),
        (f64::NAN, 0.0),
        (0.0, f64::INFINITY),
    ] {
        assert_eq!(sea.height_m(lat, lon, 0.1), 0.0);
        assert_eq!(sea.finest_spacing_rad(lat, lon), f64::INFINITY);
    }
    assert_eq!(
        sea.range_m(&Bounds::GLOBE),
        HeightRange {
            low_m: 0.0,
            high_m: 0.0
        }
    );
    assert_eq!(sea.slope(&Ellipsoid::WGS84, 0.1, 0.2, 0.0), DVec2::ZERO);
    assert_eq!(sea.bytes(), 0);
}

#[test]
fn the_finest_lies_on_top_and_of_equal_ones_the_first() {
    let globe = grid(&Bounds::GLOBE, (36, 18), |_| 100.0);
    let coarse = grid(&degrees(-10.0, 50.0, -10.0, 60.0), (60, 60), |_| 200.0);
    let first = grid(&degrees(10.0, 30.0, 10.0, 20.0), (80, 80), |_| 300.0);
    let second = grid(&degrees(10.0, 30.0, 20.0, 20.0), (80, 80), |_| 400.0);
    let at = |ground: &Ground, lat: f64, lon: f64| {
        ground.height_m(lat.to_radians(), lon.to_radians(), 0.0)
    };
    let grids = [globe, coarse, first, second];
    let ground = Ground::new(grids.clone());
    assert_eq!(at(&ground, 20.0, 25.0), 300.0);
    assert_eq!(at(&ground, 20.0, 35.0), 400.0);
    assert_eq!(at(&ground, 35.0, 12.0), 200.0);
    assert_eq!(at(&ground, -35.0, 12.0), 100.0);
    let [globe, coarse, first, second] = grids;
    let ground = Ground::new([second, first, coarse, globe]);
    assert_eq!(at(&ground, 20.0, 25.0), 400.0);
    assert_eq!(at(&ground, 20.0, 15.0), 300.0);
    // Flat inside, but not where one grid blends into the next.
    let finest = |lat: f64, lon: f64| ground.finest_spacing_rad(lat.to_radians(), lon.to_radians());
    assert!((finest(20.0, 25.0).to_degrees() - 20.0 / 16.0).abs() < 0.05);
    assert!((finest(20.0, 20.5).to_degrees() - 0.25 * 10_f64.to_radians().cos()).abs() < 0.01);
    // In the middle of a grid only its own heights count.
    let inner = ground.range_up_to_m(&degrees(19.0, 20.0, 12.5, 1.0), 0.0);
    assert!((inner.low_m - 300.0).abs() < 1e-5 && (inner.high_m - 300.0).abs() < 1e-5);
    let border = ground.range_m(&degrees(19.0, 20.0, 9.5, 1.0));
    assert!((border.low_m - 200.0).abs() < 1e-5 && (border.high_m - 300.0).abs() < 1e-5);
}

/// A border between grids that differ by 1600 m: the transition has the documented width, and no more than the resulting
/// slope.
#[test]
fn borders_go_over_within_a_sixteenth() {
    let inner = grid(&degrees(10.0, 20.0, 10.0, 10.0), (320, 320), |_| 1600.0);
    let ground = Ground::new([inner]);
    let at = |samples: f64| {
        let lon = (10.0 + samples / 32.0).to_radians();
        ground.height_m(15_f64.to_radians(), lon, 0.0)
    };
    assert_eq!((at(-0.5), at(20.0), at(160.0)), (0.0, 1600.0, 1600.0));
    assert!((at(10.0) - 800.0).abs() < 1e-6);
    let steepest = (0..400).map(|n| at(0.05 * f64::from(n + 1)) - at(0.05 * f64::from(n)));
    let steepest = steepest.fold(0.0, f64::max);
    assert!(
        (steepest / 0.05 - 1.5 * 1600.0 / 20.0).abs() < 0.1,
        "{steepest}"
    );
}

/// Extreme ground: the whole Earth, three stacked local grids, one across the date line, one at a pole, one with
/// holes, one of a single sample.
fn wild() -> Ground {
    let noise = |seed: u32| {
        move |n: u32| {
            let bits = (n ^ seed).wrapping_mul(0x9e37_79b9);
            let bits = (bits ^ (bits >> 15)).wrapping_mul(0x85eb_ca6b);
            (bits >> 16) as f32 / 65_536.0 * 20_000.0 - 11_000.0
        }
    };
    let holes = |n: u32| {
        if n % 60 > 30 && n / 60 > 20 {
            f32::NAN
        } else {
            noise(6)(n)
        }
    };
    Ground::new([
        grid(&Bounds::GLOBE, (36, 18), noise(1)),
        grid(&degrees(-20.0, 20.0, 160.0, 40.0), (40, 40), noise(2)),
        grid(&degrees(-10.0, 15.0, 170.0, 25.0), (50, 50), noise(3)),
        grid(&degrees(-10.0, 3.0, 175.0, 25.0), (50, 26), noise(4)),
        grid(&degrees(70.0, 90.0, -10.0, 60.0), (30, 20), noise(5)),
        grid(&degrees(-60.0, -30.0, 165.0, 30.0), (60, 60), holes),
        grid(&degrees(-30.0, 10.0, -185.0, 2.0), (1, 1), noise(7)),
        grid(&degrees(-5.0, 5.0, 150.0, 15.0), (3, 2), noise(8)),
    ])
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_whole_is_continuous(
        lat in prop_oneof![-91.0..91.0f64, -10.0..15.0f64, 89.9999..90.0f64, Just(90.0)],
        lon in prop_oneof![145.0..205.0f64, -400.0..400.0f64, Just(180.0), Just(-185.0)],
        turn in 0.0..std::f64::consts::TAU,
        spacing in prop_oneof![Just(0.0), 0.001..0.5f64],
    ) {
        let ground = wild();
        let (lat, lon) = (lat.to_radians(), lon.to_radians());
        let here = ground.height_m(lat, lon, spacing);
        prop_assert!(here.is_finite());
        // A step on the ground: near a pole it is a larger change of longitude.
        let tiny = 1e-10;
        let there = ground.height_m(lat + tiny * turn.sin(), lon + tiny * turn.cos(), spacing);
        prop_assert!((here - there).abs() < 0.01, "{here} and {there}");
        let turned = ground.height_m(lat, lon + std::f64::consts::TAU, spacing);
        prop_assert!((here - turned).abs() < 0.01);
        if lat >= 0.5 * PI {
            let other = ground.height_m(lat, lon + turn, spacing);
            prop_assert!((here - other).abs() < 1e-6, "{here} and {other} at the pole");
        }
    }

    #[test]
    fn the_whole_keeps_to_its_ranges(
        south in prop_oneof![-90.0..90.0f64, -20.0..20.0f64],
        west in prop_oneof![140.0..200.0f64, -400.0..400.0f64],
        size in (-2.0..2.0f64, -2.0..2.5f64),
        places in prop::collection::vec((0.0..=1.0f64, 0.0..=1.0f64, 0.0..0.3f64), 12),
    ) {
        let ground = wild();
        let (height, width) = (10f64.powf(size.0), 10f64.powf(size.1));
        let asked = degrees(south, (south + height).min(90.0), west, width.min(360.0));
        let range = ground.range_m(&asked);
        let finest = ground.finest_spacing_in(&asked);
        for (v, u, spacing) in places {
            let lat = asked.south_rad + v * (asked.north_rad - asked.south_rad);
            let lon = asked.west_rad + u * asked.width_rad;
            prop_assert!(finest <= ground.finest_spacing_rad(lat, lon));
            for spacing in [0.0, spacing] {
                let height = ground.height_m(lat, lon, spacing);
                prop_assert!(range.low_m <= height && height <= range.high_m, "{height} {range:?}");
                let up_to = ground.range_up_to_m(&asked, spacing);
                prop_assert!(up_to.low_m <= height && height <= up_to.high_m, "{height} {up_to:?}");
            }
        }
    }

    #[test]
    fn slopes_of_wild_ground_are_finite(
        lat in -91.0..91.0f64, lon in -200.0..200.0f64, spacing in 0.0..0.5f64,
    ) {
        let ground = wild();
        let slope = ground.slope(&Ellipsoid::WGS84, lat.to_radians(), lon.to_radians(), spacing);
        prop_assert!(slope.is_finite());
    }
}

#[test]
fn fine_data_are_found_where_they_reach_and_nowhere_else() {
    let bounds = degrees(10.0, 12.0, 20.0, 2.0);
    let rough = |height_m: fn(u32) -> f32| Ground::new([grid(&bounds, (33, 33), height_m)]);
    let ground = rough(|n| (n % 7) as f32);
    let step = (2.0_f64 / 33.0).to_radians();
    let around = |lat: f64, lon: f64, angle: f64| {
        let bounds = Bounds::around(lat.to_radians(), lon.to_radians(), angle.to_radians());
        ground.finest_spacing_in(&bounds)
    };
    assert!((around(11.0, 21.0, 0.1) / step - 1.0).abs() < 0.05);
    assert!(around(14.0, 21.0, 2.1).is_finite() && around(14.0, 21.0, 1.9).is_infinite());
    assert!(around(11.0, 384.0, 2.1).is_finite() && around(11.0, 384.0, 1.9).is_infinite());
    assert!(around(89.0, -150.0, 80.0).is_finite());
    // Where all heights are the same, only the transition to the border is relief, as wide as a sixteenth of
    // the grid.
    let flat = rough(|_| 5.0);
    let inside = Bounds::around(11_f64.to_radians(), 21_f64.to_radians(), 0.004);
    assert!((flat.finest_spacing_in(&inside).to_degrees() - 2.0 / 16.0).abs() < 0.01);
    assert!((flat.finest_spacing_in(&bounds) / step - 1.0).abs() < 0.05);
}

proptest! {
    #[test]
    fn bounds_around_a_place_hold_its_circle(
        lat in -90.0..=90.0f64, lon in -360.0..360.0f64, angle in 0.0..2.0f64, azimuth in 0.0..6.3f64,
    ) {
        let bounds = Bounds::around(lat.to_radians(), lon.to_radians(), angle);
        let up = Ellipsoid::normal(lat.to_radians(), lon.to_radians());
        let aside = up.any_orthonormal_vector();
        let aside = aside * azimuth.cos() + up.cross(aside) * azimuth.sin();
        let near = up * (0.999 * angle).cos() + aside * (0.999 * angle).sin();
        let (lat, lon) = (near.z.clamp(-1.0, 1.0).asin(), near.y.atan2(near.x));
        prop_assert!(bounds.contains(lat, lon), "{bounds:?} {lat} {lon}");
    }
}

#[test]
fn the_sea_s_surface_covers_its_floor_and_not_a_local_grid() {
    let globe = Georeference::from_bounds(Registration::Cells, &Bounds::GLOBE, 8, 4);
    let globe = globe.expect("sound");
    let heights: Vec<f32> = (0..32)
        .map(|n| if n % 8 < 4 { -4000.0 } else { 900.0 })
        .collect();
    let limits = GridLimits::default();
    let globe = Arc::new(HeightGrid::new(&globe, heights, &limits).expect("sound"));
    let here = Bounds {
        south_rad: -0.1,
        north_rad: 0.1,
        west_rad: -0.1,
        width_rad: 0.2,
    };
    let hollow = Georeference::from_bounds(Registration::Cells, &here, 64, 64).expect("sound");
    let hollow = HeightGrid::new(&hollow, vec![-430.0; 64 * 64], &limits).expect("sound");
    let bare = Ground::new([globe.clone(), Arc::new(hollow)]);
    let wet = bare.clone().with_sea_surface(None);
    let (sea, land) = (-2.0, 2.0);
    assert!(bare.height_m(0.3, sea, 0.0) < -3000.0);
    assert_eq!(wet.height_m(0.3, sea, 0.0), 0.0);
    assert_eq!(wet.height_m(0.3, land, 0.0), bare.height_m(0.3, land, 0.0));
    assert_eq!(wet.height_m(0.0, 0.0, 0.0), -430.0);
    // The same without other grids.
    let alone = Ground::new([globe.clone()]).with_sea_surface(None);
    assert_eq!(alone.height_m(0.3, sea, 0.0), 0.0);
    assert!(alone.height_m(0.3, land, 0.0) > 800.0);
    let range = wet.range_m(&Bounds::GLOBE);
    assert!(range.low_m <= -430.0 && range.low_m > -1000.0 && range.high_m >= 900.0);
}

#[test]
fn dry_land_below_the_sea_stays_below_it_in_grids_of_the_whole_earth() {
    let globe = Georeference::from_bounds(Registration::Cells, &Bounds::GLOBE, 720, 360);
    let deep = vec![-400.0; 720 * 360];
    let limits = GridLimits::default();
    let globe = HeightGrid::new(&globe.expect("sound"), deep, &limits).expect("sound");
    // Land north of 40° N except for 10° of the Atlantic.
    let water = (0..720 * 360).map(|n| match (n / 720, n % 720) {
        (..100, ..300 | 320..) => 0,
        _ => 255,
    });
    let water: Vec<u8> = water.collect();
    let land = LandShares::of_water(720, 360, &water).map(Arc::new);
    assert!(land.is_some());
    let bare = Ground::new([Arc::new(globe)]);
    let (alone, with_land) = (
        bare.clone().with_sea_surface(None),
        bare.with_sea_surface(land),
    );
    for (ground, name, lat_deg, lon_deg, height_m) in [
        (&alone, "Dead Sea", 31.5_f64, 35.5_f64, -400.0),
        (&alone, "Turpan", 42.66, 89.27, -160.0),
        (&alone, "Mediterranean", 33.0, 32.0, 0.0),
        (&alone, "Lake Superior", 47.7, -87.3, 0.0),
        (&with_land, "Dead Sea", 31.5, 35.5, -400.0),
        (&with_land, "Turpan", 42.66, 89.27, -160.0),
        (&with_land, "Mediterranean", 33.0, 32.0, 0.0),
        (&with_land, "Atlantic", 45.0, -25.0, 0.0),
        (&with_land, "delta of the Danube", 45.2, 29.3, -10.0),
        (&with_land, "bed of Lake Superior", 47.7, -87.3, -10.0),
    ] {
        let (lat, lon) = (lat_deg.to_radians(), lon_deg.to_radians());
        let found_m = ground.height_m(lat, lon, 0.0);
        assert!((found_m - height_m).abs() < 1e-3, "{name}: {found_m}");
        let about = Bounds {
            south_rad: lat - 1e-3,
            north_rad: lat + 1e-3,
            west_rad: lon - 1e-3,
            width_rad: 2e-3,
        };
        let range = ground.range_m(&about);
        assert!(
            range.low_m <= height_m + 1e-3 && range.low_m >= height_m - 50.0,
            "{name}: {range:?}"
        );
    }
}
