//! The air's light taken from vertices, beside the same looked up for each pixel.

use crate::common::{Rig, down, gpu, map, tilted};
use glam::DVec3;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::{EarthOptions, EyeView, GpuMap, Pipelines, Sky, Subdivision};
use terrella_imagery::tile::MapLayer;
use terrella_imagery::{EarthLayers, LayerImage};

const SIZE: (u32, u32) = (320, 180);

/// Land and sea in patches as large as neighbourhoods are, under clouds in patches.
fn options() -> EarthOptions {
    let patch = |n: usize, size: usize| (n % (2 * size) < size) as u8 * 255;
    let gray = |size: usize| -> Vec<u8> {
        let texel = |at: usize| patch(at % 256, size) ^ patch(at / 256, size);
        (0..256 * 128).map(texel).collect()
    };
    let layer = |size| LayerImage::from_r8(256, 128, gray(size)).expect("a sound map");
    EarthOptions::new(EarthLayers {
        day: map(256, |lat, lon| {
            let light = 128.0 + 100.0 * (9.0 * lat).sin() * (7.0 * lon).sin();
            [light as u8, 90, 60]
        }),
        clouds: Some(layer(5)),
        normals: None,
        night_lights: Some(layer(3)),
        water: Some(layer(16)),
    })
}

fn views(aspect: f64) -> Vec<(&'static str, EyeView)> {
    let over = |lat, lon, height_km: f64| Geodetic::from_degrees(lat, lon, 1e3 * height_km);
    vec![
        (
            "420 km, towards the limb",
            tilted(over(20.0, 20.0, 420.0), 40.0, -25.0, 60.0, aspect),
        ),
        ("600 km", down(over(5.0, -12.0, 600.0), 45.0, aspect)),
        (
            "2 000 km, the Sun low",
            down(over(-10.0, 70.0, 2e3), 45.0, aspect),
        ),
        ("7 000 km", down(over(30.0, 5.0, 7e3), 60.0, aspect)),
        (
            "20 000 km over a pole",
            down(over(89.0, 0.0, 2e4), 35.0, aspect),
        ),
    ]
}

#[test]
fn no_pixel_differs_by_more_than_dithering_makes_of_half_a_code() {
    let rigs = [false, true].map(|per_pixel_air| {
        let mut options = options();
        // The same mesh: else the limb's pixels differ.
        options.subdivision = Subdivision::Cells(48);
        options.diagnostics.per_pixel_air = per_pixel_air;
        Rig::new(&options, SIZE)
    });
    let [mut interpolated, mut exact] = rigs;
    let sun = Ellipsoid::normal(0.3, 0.1);
    let mut different = 0;
    for (name, view) in views(exact.aspect()) {
        let [one, other] = [&mut interpolated, &mut exact].map(|rig| rig.draw(&view, sun).0);
        let codes = one.iter().zip(other.iter()).map(|(a, b)| a.abs_diff(*b));
        let (most, sum) = codes.fold((0, 0_u64), |(most, sum), off| {
            (most.max(off), sum + u64::from(off))
        });
        let mean = sum as f64 / one.len() as f64;
        assert!(
            most <= 1 && mean < 0.15,
            "{name}: {most} codes, {mean} on average"
        );
        different += sum;
    }
    assert!(different > 1000, "nothing was interpolated: {different}");
    // At night no cell is.
    let night = down(
        Geodetic::from_degrees(0.0, 180.0, 6e5),
        45.0,
        exact.aspect(),
    );
    let [one, other] = [&mut interpolated, &mut exact].map(|rig| rig.draw(&night, sun).0);
    assert!(one == other && DVec3::X.dot(sun) > 0.5);
}

/// Blocks in deep night are drawn by a shader without sunlight, under the Moon and without one.
#[test]
fn no_pixel_of_deep_night_needs_sunlight() {
    let mut options = options();
    // The same mesh: else the limb's pixels differ.
    options.subdivision = Subdivision::Cells(48);
    options.light.moonlight = true;
    options.light.night_gain = 4e4;
    let rigs = [false, true].map(|per_pixel_air| {
        options.diagnostics.per_pixel_air = per_pixel_air;
        Rig::new(&options, SIZE)
    });
    let [mut without, mut with] = rigs;
    let night = Geodetic::from_degrees(10.0, 170.0, 8e5);
    let moon = 3.8e8 * Ellipsoid::normal(0.3, 2.7);
    for sky in [
        Sky::new(DVec3::X),
        Sky {
            moon_itrf_m: Some(moon),
            ..Sky::new(DVec3::X)
        },
    ] {
        for view in [
            down(night, 60.0, with.aspect()),
            tilted(night, 30.0, -40.0, 50.0, with.aspect()),
        ] {
            let [one, other] = [&mut without, &mut with].map(|rig| rig.draw_of(&view, &sky).0);
            let off = one.iter().zip(other.iter()).map(|(a, b)| a.abs_diff(*b));
            assert!(off.max() <= Some(1));
            let is_moonlit = one.pixels().any(|pixel| pixel.0[0] > 20);
            assert!(is_moonlit || sky.moon_itrf_m.is_none());
        }
    }
}

/// The first image has none of the pipelines that only save time. Each that is created later changes it by a code at most.
#[test]
fn pipelines_that_save_time_come_gradually() {
    let with = |pipelines| {
        let options = EarthOptions {
            pipelines,
            subdivision: Subdivision::Cells(48),
            ..options()
        };
        Rig::with_pipelines(&options, SIZE)
    };
    let mut at_once = with(Pipelines::AtOnce);
    let mut gradual = with(Pipelines::Gradually);
    let sun = Ellipsoid::normal(0.3, 0.1);
    let view = down(
        Geodetic::from_degrees(10.0, 60.0, 2e7),
        35.0,
        gradual.aspect(),
    );
    let right = at_once.draw(&view, sun).0;
    assert!(!at_once.earth.has_next_pipeline());
    let mut images = vec![gradual.draw(&view, sun).0];
    while gradual.earth.has_next_pipeline() {
        assert!(images.len() < 10, "the same pipeline is created again");
        gradual.earth.make_next_pipeline();
        images.push(gradual.draw(&view, sun).0);
    }
    gradual.earth.make_next_pipeline();
    gradual.earth.check_pipelines().expect("sound shaders");
    assert!(images.len() > 2, "{} images", images.len());
    for image in &images {
        let off = image.iter().zip(right.iter()).map(|(a, b)| a.abs_diff(*b));
        assert!(off.max() <= Some(1));
    }
    assert!(images[0] != right && images.last() == Some(&right));
}

/// Cells with only land or only open sea are drawn by shaders without the other: until a new map changes that.
#[test]
fn land_and_sea_follow_a_map_that_is_set() {
    let uniform = |value: u8| LayerImage::from_r8(64, 32, vec![value; 64 * 32]).expect("a map");
    let with_water = |value: u8| {
        let mut options = options();
        options.layers.water = Some(uniform(value));
        Rig::new(&options, SIZE)
    };
    let (mut sea, mut land) = (with_water(255), with_water(0));
    let view = down(Geodetic::from_degrees(10.0, 10.0, 6e5), 45.0, sea.aspect());
    let sun = Ellipsoid::normal(0.3, 0.1);
    let right = land.draw(&view, sun).0;
    assert_ne!(sea.draw(&view, sun).0, right);
    let gpu = gpu();
    let shading = terrella::Shading::Sunlit;
    let map = GpuMap::upload(
        &gpu.device,
        &gpu.queue,
        MapLayer::Water,
        &uniform(0),
        shading,
    );
    sea.earth
        .set_map(&gpu.queue, &map.expect("a map"))
        .expect("the Earth has such a map");
    let drawn = sea.draw(&view, sun).0;
    let off = drawn.iter().zip(right.iter()).map(|(a, b)| a.abs_diff(*b));
    assert!(off.max() <= Some(1));
}
