//! Levels, loads and heights of the tile pyramid.

use super::*;
use std::sync::atomic::{AtomicU64, Ordering};

/// Waves that count their reads.
struct Counted(Ground, AtomicU64);

impl Elevation for Counted {
    fn height_m(&self, lat_rad: f64, lon_rad: f64, spacing_rad: f64) -> f64 {
        self.1.fetch_add(1, Ordering::Relaxed);
        self.0.height_m(lat_rad, lon_rad, spacing_rad)
    }

    fn range_m(&self, bounds: &Bounds) -> HeightRange {
        self.0.range_m(bounds)
    }

    fn finest_spacing_rad(&self, lat_rad: f64, lon_rad: f64) -> f64 {
        self.0.finest_spacing_rad(lat_rad, lon_rad)
    }
}

fn hills() -> Counted {
    Counted(Ground::Waves(200.0, 300.0, 60e3), AtomicU64::new(0))
}

#[test]
fn levels_are_the_paper_s() {
    // d_l = 4^(l−1) d₁: level l is chosen while d_l s ≤ m.
    let (m, d1) = (10_000.0, 7.0);
    for level in 1..=12_u32 {
        let density = 4.0_f64.powi(level as i32 - 1) * d1;
        let area = m / density;
        assert_eq!(pyramid_level(m, d1, area * 0.999, 32), level);
        assert_eq!(pyramid_level(m, d1, area * 1.001, 32), level.max(2) - 1);
    }
    assert_eq!(pyramid_level(m, d1, 0.0, 32), 32);
    assert_eq!(pyramid_level(m, d1, f64::INFINITY, 32), 1);
    assert_eq!(pyramid_level(m, d1, f64::NAN, 32), 1);
    assert_eq!(pyramid_level(m, d1, 1e-300, 32), 32);
    for level in 1..=22 {
        assert!((level_of(0.5 * level_spacing_rad(level)) - f64::from(level)).abs() < 1e-12);
    }
}

#[test]
fn only_newly_uncovered_tiles_are_loaded() {
    let ground = hills();
    let mut grid = ProjectedGrid::new(&GridOptions::default());
    let mut tiles = HeightTiles::new(512);
    let mut look = Look {
        height_m: 2e3,
        pitch: 75.0,
        ..LOOK
    };
    let mut update = |look: &Look, tiles: &mut HeightTiles| {
        let frame = grid.aim(&look.view(&ground.0), &ground).unwrap();
        let before = ground.1.load(Ordering::Relaxed);
        let counts = tiles.update(&frame, &ground, u32::MAX);
        let reads = ground.1.load(Ordering::Relaxed) - before;
        assert_eq!(reads, u64::from(counts.loaded) * 65 * 65);
        assert_eq!(tiles.changed().len(), counts.loaded as usize);
        assert_eq!(counts.missing, 0);
        counts
    };
    let first = update(&look, &mut tiles);
    assert_eq!(first.wanted, first.loaded);
    // The same view again loads nothing. A step of 50 m loads a few tiles of hundreds.
    let again = update(&look, &mut tiles);
    assert_eq!((again.wanted, again.loaded), (first.wanted, 0));
    let (mut loaded, mut most) = (0, 0);
    for _ in 0..40 {
        look.lat += 50.0 / 111e3;
        let step = update(&look, &mut tiles);
        loaded += step.loaded;
        most = most.max(step.loaded);
    }
    println!("{first:?}; then {loaded} tiles in 40 steps of 50 m, at most {most} a step");
    assert!(loaded > 0 && loaded < first.loaded && most < first.loaded / 4);
    // Back again: tiles that are still there are not loaded again.
    look.lat -= 50.0 / 111e3;
    assert_eq!(update(&look, &mut tiles).loaded, 0);
}

#[test]
fn memory_is_bounded_and_loads_can_be_spread() {
    let ground = hills();
    let mut grid = ProjectedGrid::new(&GridOptions::default());
    let mut tiles = HeightTiles::new(64);
    let bytes = tiles.resident_bytes();
    let mut evicted = 0;
    for step in 0..60 {
        let look = Look {
            height_m: 4e5 * 0.9_f64.powi(step),
            lon: 11.0 + f64::from(step),
            pitch: 60.0,
            ..LOOK
        };
        let frame = grid.aim(&look.view(&ground.0), &ground).unwrap();
        let counts = tiles.update(&frame, &ground, 4);
        assert!(counts.loaded <= 4, "{counts:?}");
        evicted += counts.evicted;
        assert_eq!(tiles.resident_bytes(), bytes);
        // The coarsest level is always there: every place has a height.
        let (lat, lon) = look.place();
        if step > 0 {
            let height_m = tiles.height_m(lat, lon, 1e-5);
            assert!(height_m != 0.0 && height_m.abs() < 600.0, "{height_m}");
        }
    }
    assert!(evicted > 0);
    println!("{bytes} bytes, {evicted} tiles gave way");
}

#[test]
fn heights_of_tiles_are_the_ground_s() {
    let ground = hills();
    for (lat, lon, height_m, pitch) in [
        (47.0, 11.0, 2e3, 75.0),
        (0.0, 179.999, 2e3, 60.0),
        (-33.0, -70.0, 4e5, 0.0),
        (10.0, 20.0, 50.0, 85.0),
        (89.9, 20.0, 2e3, 75.0),
        (-90.0, 20.0, 4e5, 30.0),
    ] {
        let look = Look {
            lat,
            lon,
            height_m,
            pitch,
            ..LOOK
        };
        let mut grid = ProjectedGrid::new(&GridOptions::default());
        let frame = grid.aim(&look.view(&ground.0), &ground).unwrap();
        let mut tiles = HeightTiles::new(512);
        tiles.update(&frame, &ground, u32::MAX);
        let (mut worst_px, mut seen) = (0.0_f64, 0);
        for k in (0..129 * 129).step_by(7) {
            let sample = frame.sample(k % 129, k / 129);
            let normal = (sample.place / frame.caster.radii_m).normalize();
            let (lat, lon) = (normal.z.asin(), normal.y.atan2(normal.x));
            let reported = tiles.height_m(lat, lon, sample.spacing_rad);
            let true_m = ground.0.height_m(lat, lon, sample.spacing_rad);
            let foot = sample.place * frame.caster.radii_m + normal * true_m - frame.eye_itrf_m;
            // In pixels of 1280 × 720, as if the height were seen from the side.
            let px = (reported - true_m).abs() / foot.length() / (40.0_f64.to_radians() / 720.0);
            worst_px = worst_px.max(px);
            seen += 1;
        }
        println!("{lat}° {height_m} m: {seen} samples, {worst_px:.2} px at most");
        // Near a pole windows are cut.
        let allowed_px = if lat.abs() > 89.0 { 4.0 } else { 1.0 };
        assert!(worst_px < allowed_px, "{lat} {height_m}: {worst_px} px");
    }
}
