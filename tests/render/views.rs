//! Several views of one Earth in a frame: each is, byte for byte, the image of a separate Earth.

use crate::common::{Rig, gpu, map, plain, tilted};
use glam::DVec3;
use image::RgbaImage;
use std::time::Duration;
use terrella::frames::Geodetic;
use terrella::{
    Earth, EarthOptions, EarthView, Exposure, EyeView, FrameRequest, FrameTargets, Quality, Sky,
    ViewFrame, Viewport,
};

pub const SIZE: (u32, u32) = (160, 90);
const WAIT: Duration = Duration::from_secs(180);

pub fn hills(lat: f64, lon: f64) -> [u8; 3] {
    let wave = |angle: f64| (120.0 + 80.0 * angle.sin()).round() as u8;
    [wave(0.3 * lat), wave(0.25 * lon), wave(0.2 * (lat + lon))]
}

/// From orbit, from far, from within the air, and from another side.
pub fn eyes() -> [EyeView; 4] {
    let eye = |lat, lon, height_m, pitch_deg, fov_deg| {
        let place = Geodetic::from_degrees(lat, lon, height_m);
        tilted(place, 70.0, pitch_deg, fov_deg, 16.0 / 9.0)
    };
    [
        eye(10.0, 20.0, 4e5, -30.0, 60.0),
        eye(-20.0, 60.0, 2e7, -90.0, 50.0),
        eye(30.0, 10.0, 5e3, -5.0, 70.0),
        eye(45.0, -30.0, 1.5e6, -60.0, 4.0),
    ]
}

pub fn sky() -> Sky {
    Sky::new(DVec3::new(0.8, 0.55, 0.25).normalize())
}

/// Complete images of a separate Earth for each eye.
pub fn alone(options: &EarthOptions, eyes: &[EyeView]) -> Vec<RgbaImage> {
    let mut rig = Rig::new(options, SIZE);
    let sun = sky().sun_itrf;
    let drawn = eyes.iter().map(|eye| rig.draw_complete(eye, sun));
    drawn
        .map(|(picture, _, missing)| {
            assert!(missing.is_empty(), "{missing:?}");
            picture
        })
        .collect()
}

fn read(draw: impl FnOnce(&mut wgpu::RenderPass<'_>), samples: u32) -> RgbaImage {
    let gpu = gpu();
    let targets = FrameTargets::new(&gpu.device, SIZE, samples);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    draw(&mut targets.begin_pass(&mut encoder));
    gpu.queue.submit([encoder.finish()]);
    let texels = targets.read_back(&gpu.device, &gpu.queue).expect("texels");
    RgbaImage::from_raw(SIZE.0, SIZE.1, texels).expect("of that size")
}

/// Prepares all eyes in one call, the first by the Earth itself, and draws them in the order of the views.
pub fn together(earth: &mut Earth, views: &mut [EarthView], eyes: &[EyeView]) -> Vec<RgbaImage> {
    let sky = sky();
    let mut frames: Vec<_> = views
        .iter_mut()
        .zip(&eyes[1..])
        .map(|(view, eye)| ViewFrame {
            view,
            eye,
            sky: &sky,
            target: Viewport::from(SIZE),
        })
        .collect();
    let queue = &gpu().queue;
    let (_, missing) = earth.prepare_complete(
        queue,
        FrameRequest::new(&eyes[0], &sky, SIZE).with_views(&mut frames),
        WAIT,
    );
    assert!(missing.is_empty(), "{missing:?}");
    let samples = earth.quality().samples;
    let mut pictures = vec![read(|pass| earth.render(pass), samples)];
    let others = views.iter();
    pictures.extend(others.map(|view| read(|pass| earth.render_view(view, pass), samples)));
    pictures
}

fn each_is_as_alone(options: &EarthOptions) {
    let eyes = eyes();
    let expected = alone(options, &eyes);
    let gpu = gpu();
    let mut earth = Earth::new(&gpu.device, &gpu.queue, options).expect("sound options");
    let mut views: Vec<_> = (1..eyes.len()).map(|_| earth.new_view().unwrap()).collect();
    let drawn = together(&mut earth, &mut views, &eyes);
    for (n, (drawn, expected)) in drawn.iter().zip(&expected).enumerate() {
        assert!(drawn == expected, "view {n}");
    }
    for (a, b) in (1..4).map(|n| (n - 1, n)) {
        assert!(drawn[a] != drawn[b], "views {a} and {b} must differ");
    }
    // In another order: a view's history has no effect.
    let back: Vec<_> = eyes.into_iter().rev().collect();
    let drawn = together(&mut earth, &mut views, &back);
    for (n, (drawn, expected)) in drawn.iter().zip(expected.iter().rev()).enumerate() {
        assert!(drawn == expected, "view {n} of the second frame");
    }
}

#[test]
fn views_of_whole_maps_are_as_alone() {
    let mut options = EarthOptions::new(crate::common::day_only(map(256, hills)));
    options.exposure = Exposure::Auto;
    each_is_as_alone(&options);
}

#[cfg(feature = "packs")]
#[test]
fn views_of_tiles_are_as_alone() {
    use crate::common::tiles::FunctionTiles;
    use std::sync::Arc;
    use terrella::TileOptions;
    use terrella_imagery::tile::TileSource;
    let tiles = Arc::new(FunctionTiles::new(&[256, 128, 64, 32], hills));
    let mut options = EarthOptions::new(crate::common::day_only(tiles.whole(3)));
    options.subdivision = terrella::Subdivision::Cells(48);
    options.tiles = Some(TileOptions {
        texture_bytes: 64_000_000,
        ..TileOptions::new(tiles as Arc<dyn TileSource>)
    });
    // Where two views see one block, both have the finer tile: a wide view beside a narrow one of the same place is drawn finer
    // than alone, so eyes here look at different blocks, or from alike.
    let eyes = eyes();
    let expected = alone(&options, &eyes[..2]);
    let gpu = gpu();
    let mut earth = Earth::new(&gpu.device, &gpu.queue, &options).expect("sound options");
    let mut views = [earth.new_view().unwrap()];
    let apart = [eyes[0], eyes[0]];
    let drawn = together(&mut earth, &mut views, &apart);
    assert!(drawn[0] == expected[0] && drawn[1] == expected[0]);
    // The far eye beside the near one: its picture keeps every block, and is at least as fine.
    let mixed = together(&mut earth, &mut views, &eyes[..2]);
    assert!(mixed[0] == expected[0], "the near eye's blocks are its own");
    let levels = |view: &EarthView| view.stats().day_levels;
    let finer: u32 = levels(&views[0])[..2].iter().sum();
    assert!(finer > 0, "{:?}", levels(&views[0]));
    let black = mixed[1].pixels().filter(|p| p.0[..3] == [0, 0, 0]);
    let black_alone = expected[1].pixels().filter(|p| p.0[..3] == [0, 0, 0]);
    assert!(black.count() <= black_alone.count() + 8, "no hole");
}

#[cfg(feature = "terrain")]
#[test]
fn views_of_relief_are_as_alone() {
    use terrella::SurfaceKind;
    for kind in SurfaceKind::ALL.iter().copied() {
        let mut options = EarthOptions::new(plain([120, 130, 90]));
        options.ground = Some(crate::common::waves(kind));
        let eyes = [eyes()[0], eyes()[2]];
        let gpu = gpu();
        // A surface's mesh depends on its history: each eye has an Earth that drew nothing else.
        let mut expected = alone(&options, &eyes[..1]);
        expected.extend(alone(&options, &eyes[1..]));
        let mut earth = Earth::new(&gpu.device, &gpu.queue, &options).expect("sound options");
        let mut views = [earth.new_view().unwrap()];
        let drawn = together(&mut earth, &mut views, &eyes);
        for (n, (drawn, expected)) in drawn.iter().zip(&expected).enumerate() {
            assert!(drawn == expected, "view {n} of {kind:?}");
        }
    }
}

#[test]
fn views_follow_another_quality() {
    let options = EarthOptions::new(plain([90, 120, 60]));
    let gpu = gpu();
    let eyes = eyes();
    let mut earth = Earth::new(&gpu.device, &gpu.queue, &options).expect("sound options");
    let mut views: Vec<_> = (1..eyes.len()).map(|_| earth.new_view().unwrap()).collect();
    let before = together(&mut earth, &mut views, &eyes);
    let quality = *earth.quality();
    let changed = Quality {
        samples: 4,
        subdivision: terrella::Subdivision::Cells(6),
        atmosphere: terrella::Atmosphere::None,
        ..quality
    };
    earth.set_quality(&gpu.queue, &changed).expect("sound");
    // Until it is prepared again nothing is drawn of it.
    let nothing = read(|pass| earth.render_view(&views[0], pass), 4);
    assert!(nothing.pixels().all(|p| p.0[..3] == [0, 0, 0]));
    let mut options = options.clone();
    options.samples = 4;
    options.subdivision = changed.subdivision;
    options.atmosphere = changed.atmosphere;
    let expected = alone(&options, &eyes);
    assert!(together(&mut earth, &mut views, &eyes) == expected);
    earth.set_quality(&gpu.queue, &quality).expect("sound");
    assert!(together(&mut earth, &mut views, &eyes) == before);
}

#[test]
fn a_view_has_its_own_exposure_and_no_maps_of_its_own() {
    let options = EarthOptions {
        tone: terrella::Tone::Neutral,
        ..EarthOptions::new(plain([90, 120, 60]))
    };
    let gpu = gpu();
    let [eye, ..] = eyes();
    let mut earth = Earth::new(&gpu.device, &gpu.queue, &options).expect("sound options");
    let mut views = [earth.new_view().unwrap()];
    views[0].set_exposure(Exposure::Ev(2.0)).expect("in range");
    assert!(views[0].set_exposure(Exposure::Ev(f64::NAN)).is_err());
    let drawn = together(&mut earth, &mut views, &[eye, eye]);
    let light = |picture: &RgbaImage| picture.pixels().map(|p| u64::from(p.0[1])).sum::<u64>();
    assert!(light(&drawn[1]) > light(&drawn[0]) * 3 / 2);
    assert_eq!(views[0].stats().exposure_ev, 2.0);
    let alone = Earth::new(&gpu.device, &gpu.queue, &options)
        .unwrap()
        .prepare(&gpu.queue, FrameRequest::new(&eye, &sky(), SIZE));
    assert_eq!(views[0].stats().texture_bytes, alone.texture_bytes);
}

#[test]
fn nothing_is_drawn_of_a_view_of_another_earth_or_of_no_picture() {
    let options = EarthOptions::new(plain([90, 120, 60]));
    let gpu = gpu();
    let [eye, other, ..] = eyes();
    let make = || Earth::new(&gpu.device, &gpu.queue, &options).expect("sound options");
    let (mut earth, foreign) = (make(), make());
    let mut views = [foreign.new_view().unwrap()];
    let is_black = |picture: &RgbaImage| picture.pixels().all(|p| p.0[..3] == [0, 0, 0]);
    let drawn = together(&mut earth, &mut views, &[eye, other]);
    assert!(!is_black(&drawn[0]) && is_black(&drawn[1]));
    let mut views = [earth.new_view().unwrap()];
    let mut nowhere = eye;
    nowhere.eye_world.x = f64::NAN;
    let drawn = together(&mut earth, &mut views, &[eye, nowhere]);
    assert!(!is_black(&drawn[0]) && is_black(&drawn[1]));
    // The first may have no picture and the others one.
    let drawn = together(&mut earth, &mut views, &[nowhere, eye]);
    assert!(is_black(&drawn[0]) && !is_black(&drawn[1]));
}

#[test]
fn an_earth_goes_to_threads_and_is_drawn_by_several() {
    fn is_shared<T: Send + Sync>() {}
    is_shared::<Earth>();
    is_shared::<EarthView>();
    let options = EarthOptions::new(plain([90, 120, 60]));
    let gpu = gpu();
    let eyes = eyes();
    let made = std::thread::spawn({
        let options = options.clone();
        move || Earth::new(&gpu.device, &gpu.queue, &options).expect("sound options")
    });
    let mut earth = made.join().expect("no panic");
    let mut views = [earth.new_view().unwrap()];
    let expected = together(&mut earth, &mut views, &eyes[..2]);
    let (earth, view) = (&earth, &views[0]);
    std::thread::scope(|scope| {
        let first = scope.spawn(|| read(|pass| earth.render(pass), 1));
        let second = scope.spawn(|| read(|pass| earth.render_view(view, pass), 1));
        assert!(first.join().unwrap() == expected[0]);
        assert!(second.join().unwrap() == expected[1]);
    });
}
