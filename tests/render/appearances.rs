//! Terrain, light and air that change while the Earth is drawn: its images then equal those of an Earth created with them.

use crate::common::{self, gpu, map, plain};
use crate::views::{alone, eyes, hills, together};
use terrella::{Appearance, Earth, EarthError, EarthOptions, Exposure, FrameRequest, Quality};
use terrella_imagery::{EarthLayers, LayerImage};

fn layers() -> EarthLayers {
    let texels = (0..64 * 32_u32).map(|n| (n % 64 * 3 + n / 64) as u8);
    EarthLayers {
        clouds: Some(LayerImage::from_r8(64, 32, texels.collect()).expect("a sound map")),
        ..common::day_only(map(128, hills))
    }
}

fn with_appearance(options: &EarthOptions, appearance: &Appearance) -> EarthOptions {
    let mut options = options.clone();
    options.ground = appearance.ground.clone();
    options.light = appearance.light;
    options.air = appearance.air;
    options
}

/// Gives an Earth one appearance after another, and compares its images from two eyes with those of an Earth created with it.
fn each_appearance_is_as_made(options: &EarthOptions, appearances: &[Appearance]) {
    let eyes = [eyes()[0], eyes()[2]];
    let gpu = gpu();
    let mut earth = Earth::new(&gpu.device, &gpu.queue, options).expect("sound options");
    let mut views = [earth.new_view().expect("a view")];
    let mut before = together(&mut earth, &mut views, &eyes);
    for (n, appearance) in appearances.iter().enumerate() {
        let (maker, wanted) = (earth.change_maker(&gpu.queue), appearance.clone());
        let made = std::thread::spawn(move || maker.appearance(&wanted));
        let ready = made.join().expect("no panic").expect("a sound appearance");
        earth.set_ready(&gpu.queue, ready).expect("of this Earth");
        let drawn = together(&mut earth, &mut views, &eyes);
        let made_so = with_appearance(options, appearance);
        // A surface's mesh depends on its history: each eye has an Earth that drew nothing else.
        for (view, drawn) in drawn.iter().enumerate() {
            let expected = alone(&made_so, &eyes[view..=view]);
            assert!(*drawn == expected[0], "view {view} of appearance {n}");
        }
        assert!(drawn != before, "appearance {n} must be seen");
        before = drawn;
    }
}

#[test]
fn another_light_and_another_air_are_drawn_as_if_made_so() {
    let mut options = EarthOptions::new(layers());
    options.exposure = Exposure::Auto;
    let first = options.appearance();
    let mut high = first.clone();
    high.light.cloud_height_m = 15_000.0;
    high.light.cloud_shadows = true;
    let mut hazy = high.clone();
    hazy.air.aerosol_optical_depth = 0.4;
    let mut moonlit = hazy.clone();
    moonlit.light.moonlight = true;
    moonlit.light.airglow = true;
    moonlit.light.relief_exaggeration = 3.0;
    moonlit.light.wind_m_s = 15.0;
    moonlit.light.cloud_relief_m = 0.0;
    each_appearance_is_as_made(&options, &[high, hazy, moonlit, first]);
}

#[cfg(feature = "terrain")]
#[test]
fn another_ground_is_drawn_as_if_made_so() {
    use terrella::SurfaceKind;
    let options = EarthOptions::new(layers());
    let flat = options.appearance();
    let ground = |kind| Appearance {
        ground: Some(common::waves(kind)),
        ..flat.clone()
    };
    let mut appearances: Vec<_> = SurfaceKind::ALL.iter().copied().map(ground).collect();
    appearances.push(flat.clone());
    each_appearance_is_as_made(&options, &appearances);
}

#[cfg(all(feature = "terrain", feature = "packs"))]
#[test]
fn tiles_stay_when_the_ground_changes() {
    use crate::common::tiles::FunctionTiles;
    use crate::views::{SIZE, sky};
    use std::sync::Arc;
    use std::time::Duration;
    use terrella::{SurfaceKind, TileOptions};
    use terrella_imagery::tile::TileSource;
    let tiles = Arc::new(FunctionTiles::new(&[256, 128, 64, 32], hills));
    let mut options = EarthOptions::new(common::day_only(tiles.whole(3)));
    options.tiles = Some(TileOptions {
        texture_bytes: 64_000_000,
        ..TileOptions::new(tiles as Arc<dyn TileSource>)
    });
    let eye = [eyes()[0]];
    let gpu = gpu();
    let mut earth = Earth::new(&gpu.device, &gpu.queue, &options).expect("sound options");
    together(&mut earth, &mut [], &eye);
    for kind in SurfaceKind::ALL.iter().copied() {
        let appearance = Appearance {
            ground: Some(common::waves(kind)),
            ..options.appearance()
        };
        let mut ready = earth
            .change_maker(&gpu.queue)
            .appearance(&appearance)
            .expect("sound");
        let is_settled = ready.settle(&eye[0], SIZE, Duration::from_secs(20));
        assert!(is_settled, "{kind:?}");
        earth.set_ready(&gpu.queue, ready).expect("of this Earth");
        // The first frame has all its tiles: they are still resident.
        let stats = earth.prepare(&gpu.queue, FrameRequest::new(&eye[0], &sky(), SIZE));
        assert_eq!(stats.tiles.requested, stats.tiles.resident, "{kind:?}");
        let drawn = together(&mut earth, &mut [], &eye);
        let expected = alone(&with_appearance(&options, &appearance), &eye);
        assert!(drawn == expected, "{kind:?}");
    }
}

#[cfg(feature = "terrain")]
#[test]
fn ground_that_was_settled_by_the_thread_is_there_at_once() {
    use crate::views::{SIZE, sky};
    use std::time::Duration;
    use terrella::SurfaceKind;
    let options = EarthOptions::new(plain([120, 130, 90]));
    let eye = eyes()[2];
    let gpu = gpu();
    let appearance = Appearance {
        ground: Some(common::waves(SurfaceKind::Quadtree)),
        ..options.appearance()
    };
    let mut triangles = Vec::new();
    for settles in [true, false] {
        let mut earth = Earth::new(&gpu.device, &gpu.queue, &options).expect("sound options");
        let mut ready = earth
            .change_maker(&gpu.queue)
            .appearance(&appearance)
            .expect("sound");
        if settles {
            assert!(ready.settle(&eye, SIZE, Duration::from_secs(20)));
        } else {
            assert!(!ready.settle(&eye, SIZE, Duration::ZERO), "it takes time");
        }
        earth.set_ready(&gpu.queue, ready).expect("of this Earth");
        let at_once = earth
            .prepare(&gpu.queue, FrameRequest::new(&eye, &sky(), SIZE))
            .triangles;
        let wait = Duration::from_secs(20);
        let (after, _) =
            earth.prepare_complete(&gpu.queue, FrameRequest::new(&eye, &sky(), SIZE), wait);
        assert!(earth.is_settled());
        triangles.push((at_once, after.triangles));
    }
    assert_eq!(triangles[0].0, triangles[0].1);
    assert!(triangles[1].0 < triangles[1].1, "{triangles:?}");
}

#[test]
fn looks_that_cannot_be_drawn_leave_the_earth_as_it_was() {
    let options = EarthOptions::new(plain([90, 120, 60]));
    let gpu = gpu();
    let eye = [eyes()[0]];
    let mut earth = Earth::new(&gpu.device, &gpu.queue, &options).expect("sound options");
    let before = together(&mut earth, &mut [], &eye);
    let mut hazy = options.appearance();
    hazy.air.aerosol_optical_depth = f64::NAN;
    let error = earth
        .set_appearance(&gpu.queue, &hazy)
        .expect_err("no number");
    assert!(matches!(error, EarthError::Aerosol(_)), "{error}");
    let mut stormy = options.appearance();
    stormy.light.wind_m_s = 1e9;
    earth
        .set_appearance(&gpu.queue, &stormy)
        .expect_err("a storm");
    stormy.light.wind_m_s = 20.0;
    // Made before the quality changed, it does not fit any more.
    let late = earth
        .change_maker(&gpu.queue)
        .appearance(&stormy)
        .expect("sound");
    assert_eq!(late.appearance().light.wind_m_s, 20.0);
    let quality = Quality {
        subdivision: terrella::Subdivision::Cells(7),
        ..*earth.quality()
    };
    let first = *earth.quality();
    earth.set_quality(&gpu.queue, &quality).expect("sound");
    let error = earth.set_ready(&gpu.queue, late).expect_err("late");
    assert!(matches!(error, EarthError::OutOfDate), "{error}");
    earth.set_quality(&gpu.queue, &first).expect("sound");
    assert!(together(&mut earth, &mut [], &eye) == before);
    // A quality after a appearance keeps the appearance.
    earth.set_appearance(&gpu.queue, &stormy).expect("sound");
    earth.set_quality(&gpu.queue, &quality).expect("sound");
    assert_eq!(earth.appearance().light, stormy.light);
    assert_eq!(earth.quality(), &quality);
}
