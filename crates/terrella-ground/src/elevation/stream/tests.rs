//! Streamed heights: continuous and within their ranges in every state, and equal to a whole grid once complete.

use super::test_source::TestTiles;
use super::*;
use crate::elevation::{
    FEATHER_SAMPLES, Georeference, GridLimits, HeightGrid, HeightSamples, HeightTileLayout,
    Registration,
};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::time::Instant;
use terrella_frames::{Ellipsoid, Geodetic};

fn streamed(tiles: TestTiles, memory_bytes: u64) -> (Arc<TestTiles>, StreamedGround) {
    let tiles = Arc::new(tiles);
    let options = HeightStreamOptions {
        memory_bytes,
        threads: 2,
    };
    let ground = StreamedGround::new(tiles.clone(), Ground::new([]), &options).expect("sound");
    (tiles, ground)
}

/// Accepts everything requested.
fn settle(ground: &StreamedGround) {
    let end = Instant::now() + Duration::from_secs(60);
    ground.take_over(usize::MAX);
    while !ground.is_settled() {
        assert!(Instant::now() < end, "not settled: {:?}", ground.counters());
        ground.wait(Duration::from_millis(20));
        ground.take_over(usize::MAX);
    }
}

/// Repeats requests, as surfaces do where heights changed, until nothing changes.
fn ask_until_settled(ground: &StreamedGround, ask: &dyn Fn()) {
    for _ in 0..60 {
        let before = ground.counters().changes;
        ask();
        settle(ground);
        if ground.counters().changes == before {
            return;
        }
    }
    panic!("tiles take turns: {:?}", ground.counters());
}

/// Loads and accepts one tile; false if none is requested.
fn one_more(tiles: &TestTiles, ground: &StreamedGround) -> bool {
    ground.take_over(usize::MAX);
    if ground.is_settled() {
        return false;
    }
    let before = ground.counters().changes;
    tiles.allow(1);
    let end = Instant::now() + Duration::from_secs(20);
    while ground.counters().changes == before && Instant::now() < end {
        ground.wait(Duration::from_millis(5));
        ground.take_over(1);
        let is_same = ground.counters().changes == before;
        if is_same && ground.cache().has_arrivals() && !tiles.may_read() {
            // The loaded tile needs a parent that the other thread is still reading.
            tiles.allow(1);
        }
    }
    assert!(ground.counters().changes > before);
    true
}

/// Places all over the Earth, including poles, date line and edges of tiles.
fn places(count: u32) -> impl Iterator<Item = (f64, f64)> {
    (0..count).map(move |k| {
        let t = f64::from(k);
        let lat = match k % 7 {
            0 => FRAC_PI_2 - t * 1e-4,
            1 => t * 1e-4 - FRAC_PI_2,
            2 => (t * 0.7).round() % 32.0 * PI / 32.0 - FRAC_PI_2,
            _ => ((t * 0.618).fract() * 2.0 - 1.0).asin(),
        };
        let lon = match k % 5 {
            0 => PI - (t * 1e-4),
            1 => (t * 3.7).round() % 64.0 * PI / 32.0 - PI,
            _ => (t * 0.7548).fract() * TAU - PI,
        };
        (lat.clamp(-FRAC_PI_2, FRAC_PI_2), lon)
    })
}

/// Tiles of a region in Europe below the coarsest levels, and one far away.
fn inset(key: HeightTileKey) -> bool {
    let level = key.level;
    let in_region = |key: HeightTileKey| {
        let scale = 1 << level;
        (30..38).contains(&(key.column * scale)) && (5..12).contains(&(key.row * scale))
    };
    level >= 2 || in_region(key)
}

#[test]
fn with_everything_there_heights_are_those_of_the_levels() {
    let (tiles, ground) = streamed(TestTiles::new(3, 16, |_| true), 1 << 30);
    let grid = tiles.grid();
    let layout = tiles.layout();
    ask_until_settled(&ground, &|| {
        for (lat, lon) in places(4000) {
            for steps in [0.5, 1.25, 2.0] {
                ground.height_m(lat, lon, steps * layout.spacing_rad(0));
            }
        }
    });
    let mut seen = 0;
    for (lat, lon) in places(4000) {
        // At the finest level the whole grid interpolates the same samples, except near poles.
        if lat.abs() < 1.5 {
            let (own, whole) = (ground.height_m(lat, lon, 0.0), grid.height_m(lat, lon, 0.0));
            assert!((own - whole).abs() < 1e-6, "{own} {whole} at {lat} {lon}");
            // Intermediate spacings interpolate between the two levels.
            let fine = layout.spacing_rad(0);
            let [a, b] = [1.0, 2.0].map(|s| ground.height_m(lat, lon, s * fine));
            let mixed = ground.height_m(lat, lon, 1.25 * fine);
            assert!((mixed - (a + 0.25 * (b - a))).abs() < 1e-6);
            seen += u32::from((a - b).abs() > 10.0);
        }
    }
    assert!(seen > 1000, "levels differ in {seen} places");
    assert_eq!(ground.missing(), []);
    let counters = ground.counters();
    assert!(counters.tiles > 100 && counters.rejected == 0 && counters.wanted == 0);
}

#[test]
fn at_any_time_heights_are_continuous_and_within_their_ranges() {
    let (tiles, ground) = streamed(TestTiles::new(4, 16, inset).gated(), 1 << 30);
    let source = tiles.layout();
    // Bound of the slope, metres per radian: the steepest samples of any level, plus the feathers.
    let finest = source.spacing_rad(0);
    let steepest = 2.0 * 9000.0 / finest;
    let check = |step: u32| {
        let (_, now) = ground.now();
        for (n, (lat, lon)) in places(700).enumerate() {
            let spacing = [0.0, 1.3 * finest, 3.1 * finest, 0.0][n % 4];
            let height = now.height_m(lat, lon, spacing);
            let again = now.height_m(lat, lon, spacing);
            assert_eq!(height.to_bits(), again.to_bits());
            for (k, away) in [1e-9_f64, 1e-7].into_iter().enumerate() {
                let way = f64::from(step + n as u32 + k as u32);
                // A step on the ground, across a pole if one is near.
                let place = Ellipsoid::normal(lat, lon);
                let aside = place.any_orthonormal_vector();
                let aside = aside * way.cos() + place.cross(aside) * way.sin();
                let to = (place + aside * away).normalize();
                let (to_lat, to_lon) = (to.z.atan2(to.truncate().length()), to.y.atan2(to.x));
                let there = now.height_m(to_lat, to_lon, spacing);
                let most = steepest * away / lat.cos().max(2e-3) + 1e-6;
                assert!(
                    (there - height).abs() <= most,
                    "{height} {there} at {lat} {lon}, {away}"
                );
            }
            // At the date line and at the poles places have several coordinates.
            if lat.abs() == FRAC_PI_2 {
                let other = now.height_m(lat, lon + 1.0, spacing);
                assert!((other - height).abs() < 1e-6, "{other} {height} at a pole");
            }
            let around = Bounds {
                south_rad: (lat - 0.01 * f64::from(step % 3)).max(-FRAC_PI_2),
                north_rad: (lat + 0.003).min(FRAC_PI_2),
                west_rad: lon - 0.002,
                width_rad: 0.01 * f64::from(step % 5) + 0.002,
            };
            for range in [
                now.range_m(&around),
                now.range_up_to_m(&around, 4.0 * finest),
            ] {
                assert!(
                    range.low_m <= height && height <= range.high_m,
                    "{range:?} {height}"
                );
            }
        }
    };
    let ever: Vec<_> = places(700)
        .map(|(lat, lon)| {
            let around = Bounds::around(lat, lon, 0.02);
            (around, ground.range_m(&around))
        })
        .collect();
    let mut steps = 0;
    check(0);
    while one_more(&tiles, &ground) {
        steps += 1;
        if steps < 40 || steps % 16 == 0 {
            check(steps);
        }
    }
    check(steps + 1);
    assert!(steps > 60, "{steps} tiles came");
    // The initial ranges still hold at the end.
    for (around, range) in ever {
        let (lat, lon) = (around.north_rad, around.west_rad + 0.5 * around.width_rad);
        for spacing in [0.0, 2.0 * finest] {
            let height = ground.height_m(lat, lon, spacing);
            assert!(range.low_m <= height && height <= range.high_m);
        }
    }
}

#[test]
fn all_levels_over_a_place_are_asked_for_at_once_and_come_in_any_order() {
    for spacing_steps in [0.0, 1.0] {
        let (tiles, ground) = streamed(TestTiles::new(4, 16, |_| true).gated(), 1 << 30);
        let finest = tiles.layout().spacing_rad(0);
        // In the middle of a tile of the finest level, where only that tile counts.
        let (lat, lon) = (0.27, 0.1227);
        ground.height_m(lat, lon, spacing_steps * finest);
        ground.take_over(usize::MAX);
        let asked: Vec<_> = ground.missing().iter().map(|key| key.level).collect();
        assert_eq!(asked, [2, 1, 0], "coarse ones first");
        tiles.allow(3);
        settle(&ground);
        assert_eq!(ground.counters().tiles, 3);
        let whole = tiles.grid().height_m(lat, lon, 0.0);
        assert!((ground.height_m(lat, lon, 0.0) - whole).abs() < 1e-6);
    }
}

#[test]
fn what_was_read_before_says_nothing_of_a_height() {
    let (tiles, ground) = streamed(TestTiles::new(4, 16, inset).gated(), 1 << 30);
    let finest = tiles.layout().spacing_rad(0);
    let read = |now: &Ground, n: usize, (lat, lon): (f64, f64)| {
        let spacing = [0.0, 1.3, 5.1, 0.0, 2.0][n % 5] * finest;
        let height = now.height_m(lat, lon, spacing);
        (height.to_bits(), now.finest_spacing_rad(lat, lon).to_bits())
    };
    let mut rounds = 0;
    for (lat, lon) in places(400) {
        ground.height_m(lat, lon, 0.0);
    }
    while rounds < 60 && one_more(&tiles, &ground) {
        rounds += 1;
        let (_, now) = ground.now();
        let all: Vec<_> = places(400).enumerate().collect();
        let forth: Vec<_> = all.iter().map(|(n, at)| read(&now, *n, *at)).collect();
        for ((n, at), height) in all.iter().zip(&forth).rev() {
            assert_eq!(read(&now, *n, *at), *height, "backwards at {at:?}");
        }
        let (n, at) = all[rounds % 400];
        let fresh = std::thread::scope(|scope| scope.spawn(|| read(&now, n, at)).join());
        assert_eq!(
            fresh.expect("sound"),
            forth[n],
            "as the first of a thread at {at:?}"
        );
    }
    assert!(rounds > 50, "{rounds} tiles came");
}

#[test]
fn what_changes_lies_within_the_changes_that_are_reported() {
    let (tiles, ground) = streamed(TestTiles::new(4, 16, inset).gated(), 40_000 + 700_000);
    let layout = tiles.layout();
    let spacings = [0.0, 1.0, 1.9, 2.0, 3.9, 4.1, 9.0].map(|s| s * layout.spacing_rad(0));
    let read = |now: &Ground| -> Vec<f64> {
        let all = places(900).enumerate();
        all.map(|(n, (lat, lon))| now.height_m(lat, lon, spacings[n % 7]))
            .collect()
    };
    let (mut version, mut now) = ground.now();
    let mut before = read(&now);
    let (mut others, mut rounds) = (0, 0);
    while rounds < 150 && one_more(&tiles, &ground) {
        rounds += 1;
        // The heights of a frame stay unchanged.
        assert_eq!(read(&now), before);
        let changes = ground.changes_since(version).expect("not long ago");
        let last = now.clone();
        (version, now) = ground.now();
        let after = read(&now);
        for (n, (lat, lon)) in places(900).enumerate() {
            if before[n].to_bits() == after[n].to_bits() {
                continue;
            }
            others += 1;
            let reported = changes.iter().any(|change| {
                spacings[n % 7] < change.below_rad && change.touches_place(lat, lon, 0.0)
            });
            assert!(reported, "{} {} at {lat} {lon}", before[n], after[n]);
            let range = last.range_up_to_m(&Bounds::around(lat, lon, 0.0), 0.0);
            let reported = changes.iter().map(|change| change.range);
            let low = reported
                .clone()
                .map(|r| r.low_m)
                .fold(range.low_m, f64::min);
            let high = reported.map(|r| r.high_m).fold(range.high_m, f64::max);
            let is_within = low <= after[n] && after[n] <= high;
            assert!(
                is_within || spacings[n % 7] > layout.spacing_rad(2),
                "{range:?}"
            );
        }
        before = after;
    }
    assert!(
        others > 200 && rounds > 50,
        "{others} heights in {rounds} rounds"
    );
    assert!(ground.changes_since(0).is_some() || version > 256);
}

#[test]
fn the_budget_holds_and_no_two_tiles_take_turns() {
    let tiles = TestTiles::new(4, 16, |_| true);
    let (coarsest, all) = {
        let (_, ground) = streamed(TestTiles::new(4, 16, |_| true), 1 << 30);
        (ground.counters().bytes, tiles.count())
    };
    let budget = coarsest + 100_000;
    let (tiles, ground) = streamed(tiles, budget);
    let viewer = ground.viewer();
    let look = |lat_deg, lon_deg| {
        let eye = Geodetic::from_degrees(lat_deg, lon_deg, 20_000.0);
        viewer.look(HeightEye {
            eye_itrf_m: Ellipsoid::WGS84.itrf_from_geodetic(eye),
            tolerance_rad: 1e-3,
        });
    };
    let ask = || {
        let spots = [(45.0_f64, 10.0_f64), (-30.0, -120.0)];
        let spots = spots.map(|(lat, lon)| (lat.to_radians(), lon.to_radians()));
        for (lat, lon) in places(3000).chain(spots) {
            ground.height_m(lat, lon, 0.0);
        }
        assert!(ground.counters().bytes <= budget);
    };
    let fly = |lat_deg, lon_deg| {
        look(lat_deg, lon_deg);
        ask_until_settled(&ground, &ask);
    };
    fly(45.0, 10.0);
    let counters = ground.counters();
    assert!(
        counters.rejected > 0 && (counters.tiles as usize) < all,
        "{counters:?}"
    );
    assert!(counters.tiles > 20, "{counters:?}");
    // Repeating the same eye changes nothing.
    let reads = tiles.reads.load(std::sync::atomic::Ordering::SeqCst);
    let version = counters.changes;
    for _ in 0..10 {
        ask();
        settle(&ground);
    }
    assert_eq!(ground.counters().changes, version);
    assert_eq!(tiles.reads.load(std::sync::atomic::Ordering::SeqCst), reads);
    // Near the eye the heights are the finest; those near its earlier position are evicted.
    let finest = |lat_deg: f64, lon_deg: f64| {
        let (lat, lon) = (lat_deg.to_radians(), lon_deg.to_radians());
        let whole = tiles.grid().height_m(lat, lon, 0.0);
        (ground.height_m(lat, lon, 0.0) - whole).abs() < 1e-6
    };
    assert!(finest(45.0, 10.0));
    fly(-30.0, -120.0);
    assert!(finest(-30.0, -120.0));
    assert!(!finest(45.0, 10.0));
}

#[test]
fn far_eyes_do_not_ask_for_the_finest() {
    let (_, ground) = streamed(TestTiles::new(4, 16, |_| true), 1 << 30);
    let viewer = ground.viewer();
    viewer.look(HeightEye {
        eye_itrf_m: Ellipsoid::WGS84.itrf_from_geodetic(Geodetic::from_degrees(0.0, 0.0, 4e7)),
        tolerance_rad: 8e-3,
    });
    for (lat, lon) in places(2000) {
        ground.height_m(lat, lon, 0.0);
    }
    settle(&ground);
    assert_eq!(ground.counters().tiles, 0);
    // A request with an explicit spacing loads regardless of the eye.
    for (lat, lon) in places(2000) {
        ground.height_m(lat, lon, 1e-6);
    }
    settle(&ground);
    assert!(ground.counters().tiles > 100);
    drop(viewer);
}

/// A source that fails.
struct Broken(TestTiles);

impl HeightTileSource for Broken {
    fn layout(&self) -> HeightTileLayout {
        self.0.layout()
    }

    fn range_m(&self, key: HeightTileKey) -> Option<HeightRange> {
        self.0.range_m(key)
    }

    fn read(
        &self,
        key: HeightTileKey,
        c: &dyn Fn() -> bool,
    ) -> Result<HeightSamples, HeightTileError> {
        match (key.level, key.column % 4) {
            (0, 0) => panic!("a fault of a source"),
            (0, 1) => Ok(HeightSamples::F32(vec![1.0; 7])),
            (0, 2) => Ok(HeightSamples::F32(vec![
                f32::NAN;
                self.layout().tile_samples()
            ])),
            _ => self.0.read(key, c),
        }
    }
}

#[test]
fn tiles_that_cannot_be_read_are_reported_and_not_waited_for() {
    let source = Arc::new(Broken(TestTiles::new(2, 16, |_| true)));
    let options = HeightStreamOptions::default();
    let ground = StreamedGround::new(source, Ground::new([]), &options).expect("sound");
    let over = [0.02, 0.22, 0.42, 0.62];
    ask_until_settled(&ground, &|| {
        for lon in over {
            ground.height_m(0.1, lon, 0.0);
        }
    });
    let counters = ground.counters();
    assert!(
        counters.unreadable >= 3 && counters.tiles >= 1,
        "{counters:?}"
    );
    assert_eq!(ground.missing().len() as u32, counters.unreadable);
    assert!(ground.height_m(0.1, 0.02, 0.0).is_finite());
}

#[test]
fn a_coarsest_level_that_is_not_whole_or_too_large_is_rejected() {
    struct Holey(TestTiles);
    impl HeightTileSource for Holey {
        fn layout(&self) -> HeightTileLayout {
            self.0.layout()
        }
        fn range_m(&self, key: HeightTileKey) -> Option<HeightRange> {
            self.0.range_m(key).filter(|_| key.column != 3)
        }
        fn read(
            &self,
            key: HeightTileKey,
            c: &dyn Fn() -> bool,
        ) -> Result<HeightSamples, HeightTileError> {
            self.0.read(key, c)
        }
    }
    let options = HeightStreamOptions::default();
    let holey = Arc::new(Holey(TestTiles::new(2, 16, |_| true)));
    let rejected = StreamedGround::new(holey, Ground::new([]), &options);
    assert!(matches!(
        rejected,
        Err(StreamedGroundError::Tile(HeightTileError::Absent(_)))
    ));
    let small = HeightStreamOptions {
        memory_bytes: 10_000,
        ..options
    };
    let rejected = StreamedGround::new(
        Arc::new(TestTiles::new(2, 16, |_| true)),
        Ground::new([]),
        &small,
    );
    assert!(matches!(
        rejected,
        Err(StreamedGroundError::Coarsest(GridError::Memory { .. }))
    ));
}

#[test]
fn grids_lie_over_tiles_as_over_grids() {
    let tiles = Arc::new(TestTiles::new(2, 16, |_| true));
    let bounds = Bounds {
        south_rad: 0.7,
        north_rad: 0.9,
        west_rad: 0.1,
        width_rad: 0.3,
    };
    let place = Georeference::from_bounds(Registration::Cells, &bounds, 120, 80).expect("sound");
    let local = HeightGrid::new(&place, vec![5000.0; 120 * 80], &GridLimits::default());
    let local = Arc::new(local.expect("sound"));
    let options = HeightStreamOptions::default();
    let over = Ground::new([local.clone()]);
    let ground = StreamedGround::new(tiles.clone(), over, &options).expect("sound");
    let grids = Ground::new([local, Arc::new(tiles.grid())]);
    let mut mixed = 0;
    let spots = (0..3000_u32).map(|k| (0.6 + f64::from(k % 60) * 0.007, f64::from(k / 60) * 0.01));
    ask_until_settled(&ground, &|| {
        for (lat, lon) in spots.clone() {
            let own = ground.height_m(lat, lon, 0.0);
            let range = ground.range_m(&Bounds::around(lat, lon, 0.01));
            assert!(range.low_m <= own && own <= range.high_m);
        }
    });
    for (lat, lon) in spots {
        let (own, whole) = (
            ground.height_m(lat, lon, 0.0),
            grids.height_m(lat, lon, 0.0),
        );
        assert!((own - whole).abs() < 1e-6, "{own} {whole} at {lat} {lon}");
        mixed += u32::from(own != 5000.0);
    }
    assert!(mixed > 300 && FEATHER_SAMPLES > 0.0);
    assert_eq!(
        ground.finest_spacing_rad(0.8, 0.2),
        grids.finest_spacing_rad(0.8, 0.2)
    );
    let finest = tiles.layout().spacing_rad(0);
    assert_eq!(ground.finest_spacing_rad(-0.8, 0.2), finest);
    assert_eq!(
        ground.finest_spacing_in(&Bounds::around(-0.8, 0.2, 0.1)),
        finest
    );
    assert!(ground.streamed().is_some() && grids.streamed().is_none());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// For any request order and any memory limit: no jump across any tile edge.
    #[test]
    fn edges_of_tiles_are_never_steps(seed in 0u64..1000, memory in 50_000u64..600_000) {
        let (tiles, ground) = streamed(TestTiles::new(4, 16, inset), 1_000_000 + memory);
        let spots = places(400).skip((seed % 300) as usize).take(40);
        for (lat, lon) in spots {
            ground.height_m(lat, lon, 0.0);
            if (lat * 1e4) as i64 % 3 == 0 {
                settle(&ground);
            }
        }
        settle(&ground);
        let layout = tiles.layout();
        let edge_rad = layout.tile_rad(0);
        for k in 0..600_u32 {
            let row = f64::from((k * 37 + seed as u32) % 63) - 31.0;
            let along = f64::from(k) * 0.0104 - PI;
            let away = 1e-11;
            let (lat, lon) = match k % 2 {
                0 => (row * edge_rad, along),
                _ => (0.45 * along, row * edge_rad),
            };
            if lat.abs() > 1.5 {
                continue;
            }
            let (before, after) = match k % 2 {
                0 => ((lat - away, lon), (lat + away, lon)),
                _ => ((lat, lon - away), (lat, lon + away)),
            };
            let [a, b] = [before, after].map(|(lat, lon)| ground.height_m(lat, lon, 0.0));
            prop_assert!((a - b).abs() < 1e-3, "{} {} at {} {}", a, b, lat, lon);
        }
    }
}
