//! Terrain with streamed elevation data: frames never wait for it, images do, and equal those with all data in memory.

use crate::common::{Rig, down, gpu, plain, tilted};
use glam::DVec3;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use terrella::frames::Geodetic;
use terrella::{
    Atmosphere, EarthOptions, EyeView, FrameRequest, GroundOptions, Sky, Subdivision, SurfaceKind,
};
use terrella_ground::elevation::{
    Ground, HeightRange, HeightSamples, HeightStreamOptions, HeightTileError, HeightTileKey,
    HeightTileLayout, HeightTileSource, StreamedGround,
};

const SIZE: (u32, u32) = (320, 180);

/// Hills in tiles, which take their time.
struct Hills {
    layout: HeightTileLayout,
    /// No tile below the coarsest level comes while this is set.
    is_shut: AtomicBool,
}

impl Hills {
    fn height_m(lat_rad: f64, lon_rad: f64, spacing_rad: f64) -> f32 {
        let wave = |frequency: f64, height_m: f64| {
            let fades = (-(0.5 * frequency * spacing_rad).powi(2)).exp();
            fades * height_m * (frequency * lat_rad).sin() * (frequency * lon_rad).cos()
        };
        (wave(30.0, 2500.0) + wave(97.0, 900.0) + wave(303.0, 400.0)) as f32
    }
}

impl HeightTileSource for Hills {
    fn layout(&self) -> HeightTileLayout {
        self.layout
    }

    fn range_m(&self, _: HeightTileKey) -> Option<HeightRange> {
        Some(HeightRange {
            low_m: -3800.0,
            high_m: 3800.0,
        })
    }

    fn read(
        &self,
        key: HeightTileKey,
        cancelled: &dyn Fn() -> bool,
    ) -> Result<HeightSamples, HeightTileError> {
        let is_coarsest = key.level == self.layout.coarsest();
        while !is_coarsest && self.is_shut.load(Ordering::Relaxed) {
            if cancelled() {
                return Err(HeightTileError::Cancelled(key));
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        let step = self.layout.spacing_rad(key.level);
        let bounds = self.layout.bounds(key);
        let border = f64::from(self.layout.border());
        let row = self.layout.row_samples();
        let sample = |n: usize| {
            let (i, j) = (
                (n % row) as f64 - border + 0.5,
                (n / row) as f64 - border + 0.5,
            );
            // Beyond a pole, and round the date line, the same function.
            Self::height_m(
                bounds.north_rad - j * step,
                bounds.west_rad + i * step,
                step,
            )
        };
        Ok(HeightSamples::F32((0..row * row).map(sample).collect()))
    }
}

fn streamed(is_shut: bool) -> (Arc<Hills>, Arc<StreamedGround>) {
    let layout = HeightTileLayout::new(5, 16, 32, 1).expect("sound");
    let is_shut = AtomicBool::new(is_shut);
    let source = Arc::new(Hills { layout, is_shut });
    let options = HeightStreamOptions::default();
    let ground = StreamedGround::new(source.clone(), Ground::new([]), &options);
    (
        source,
        Arc::new(ground.expect("the coarsest level is there")),
    )
}

fn options(ground: &Arc<StreamedGround>, kind: SurfaceKind) -> EarthOptions {
    let mut options = EarthOptions::new(plain([120; 3]));
    options.atmosphere = Atmosphere::None;
    options.ground = Some(GroundOptions {
        elevation: ground.clone(),
        surface: kind.settings(Subdivision::Auto),
        tolerance_px: 1.0,
    });
    options
}

fn views(aspect: f64) -> [EyeView; 2] {
    let at = Geodetic::from_degrees;
    [
        tilted(at(46.0, 9.0, 3e4), 70.0, -20.0, 50.0, aspect),
        down(at(-20.0, 179.9, 4e5), 50.0, aspect),
    ]
}

/// The Sun over the eye.
fn above(view: &EyeView) -> DVec3 {
    view.to_itrf().0.normalize()
}

#[test]
fn pictures_wait_for_heights_and_are_as_if_they_had_always_been_there() {
    for kind in SurfaceKind::ALL {
        let (_, ground) = streamed(false);
        let mut rig = Rig::new(&options(&ground, *kind), SIZE);
        for view in views(rig.aspect()) {
            let sun = above(&view);
            let (coarse, first) = rig.draw(&view, sun);
            let (picture, stats, missing) = rig.draw_complete(&view, sun);
            assert!(missing.is_empty() && rig.earth.missing_heights().is_empty());
            assert!(rig.earth.is_settled(), "{kind:?}: {stats:?}");
            if *kind != SurfaceKind::Blocks {
                assert!(
                    stats.height_tiles.changes > first.height_tiles.changes,
                    "{kind:?}"
                );
                assert!(coarse != picture, "{kind:?}: nothing has become finer");
            }
            let mut fresh = Rig::new(&options(&ground, *kind), SIZE);
            let (other, ..) = fresh.draw_complete(&view, sun);
            let differ = picture.pixels().zip(other.pixels());
            let differ = differ.filter(|(a, b)| a != b).count();
            // Leaves of a quadtree that were once divided stay so a little longer.
            let most = if *kind == SurfaceKind::Quadtree {
                600
            } else {
                0
            };
            assert!(differ <= most, "{kind:?}: {differ} pixels differ");
        }
    }
}

#[test]
fn frames_do_not_wait_and_what_is_missing_is_reported() {
    let (source, ground) = streamed(true);
    let mut rig = Rig::new(&options(&ground, SurfaceKind::Quadtree), SIZE);
    let [view, _] = views(rig.aspect());
    let sun = above(&view);
    for _ in 0..4 {
        rig.draw(&view, sun);
    }
    let (_, stats) = rig.draw(&view, sun);
    assert!(
        stats.height_tiles.wanted > 0 && stats.height_tiles.tiles == 0,
        "{stats:?}"
    );
    assert!(!rig.earth.is_settled() && !rig.earth.missing_heights().is_empty());
    let begin = Instant::now();
    let wait = Duration::from_millis(300);
    let sky = Sky::new(sun);
    rig.earth
        .prepare_complete(&gpu().queue, FrameRequest::new(&view, &sky, SIZE), wait);
    assert!(begin.elapsed() >= wait);
    assert!(!rig.earth.missing_heights().is_empty());
    source.is_shut.store(false, Ordering::Relaxed);
    let (.., missing) = rig.draw_complete(&view, sun);
    assert!(missing.is_empty() && rig.earth.missing_heights().is_empty());
}
