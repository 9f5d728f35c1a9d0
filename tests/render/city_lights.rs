//! City lights as points, beside the map whose place they take.

use crate::common::{Rig, down, gpu, plain, tilted};
use crate::views::{alone, together};
use glam::DVec3;
use std::sync::Arc;
use terrella::frames::Geodetic;
use terrella::{
    Atmosphere, Earth, EarthLayers, EarthOptions, EyeView, GpuMap, LayerImage, MapLayer, Pipelines,
    SurfaceLight,
};
use terrella_imagery::{CityLights, Place};

const SIZE: (u32, u32) = (96, 96);

fn even(value: u8) -> LayerImage {
    LayerImage::from_r8(512, 256, vec![value; 512 * 256]).expect("a good map")
}

/// Even light everywhere, and a place of every size in some texels.
fn options(atmosphere: Atmosphere, clouds: Option<u8>, as_points: bool) -> EarthOptions {
    let places: Vec<Place> = (0..4000)
        .map(|n| Place {
            lat_deg: f64::from(n % 80) - 40.0 + 0.013 * f64::from(n % 7),
            lon_deg: 0.09 * f64::from(n) - 180.0,
            population: 1e3 * f64::from(1 << (n % 13)),
            country: *b"FR",
        })
        .collect();
    let lights = even(70);
    EarthOptions {
        city_lights: as_points.then(|| Arc::new(CityLights::new(&lights, &places))),
        atmosphere,
        light: SurfaceLight {
            detail: as_points,
            night_gain: 1e5,
            night_fades_by_day: false,
            ..SurfaceLight::default()
        },
        ..EarthOptions::new(EarthLayers {
            night_lights: Some(lights),
            clouds: clouds.map(even),
            ..plain([0; 3])
        })
    }
}

/// Mean luminance of a picture at midnight.
fn mean_light(options: &EarthOptions, size: (u32, u32), view: &EyeView) -> f64 {
    let light = Rig::of_light(options, size).draw_light(view, DVec3::NEG_X);
    let luminance = |[r, g, b, _]: &[f32; 4]| f64::from(0.2126 * r + 0.7152 * g + 0.0722 * b);
    light.iter().map(luminance).sum::<f64>() / light.len() as f64
}

fn from(height_m: f64, fov_deg: f64) -> EyeView {
    down(Geodetic::from_degrees(4.0, 7.0, height_m), fov_deg, 1.0)
}

#[test]
fn points_are_as_bright_as_the_map_from_everywhere() {
    let slanted = tilted(
        Geodetic::from_degrees(4.0, 7.0, 6e5),
        30.0,
        -35.0,
        40.0,
        1.0,
    );
    let [points, map] = [true, false].map(|as_points| options(Atmosphere::None, None, as_points));
    for (view, name) in [
        (from(8e5, 40.0), "one by one"),
        (from(6e6, 40.0), "texels"),
        (from(4e7, 14.0), "groups of texels"),
        (slanted, "slanted"),
    ] {
        let ratio = mean_light(&points, SIZE, &view) / mean_light(&map, SIZE, &view);
        assert!((ratio - 1.0).abs() < 0.05, "{name}: {ratio}");
    }
}

/// Half of an optical depth of 0.25.
#[test]
fn between_points_is_what_the_air_scatters() {
    let [points, map] = [true, false].map(|as_points| {
        let options = options(Atmosphere::None, None, as_points);
        let light = Rig::of_light(&options, SIZE).draw_light(&from(4e5, 30.0), DVec3::NEG_X);
        light.iter().map(|texel| texel[1]).fold(f32::MAX, f32::min)
    });
    assert!((points / map - 0.125).abs() < 0.005, "{}", points / map);
}

#[test]
fn a_point_is_as_bright_in_pictures_of_any_size() {
    let points = options(Atmosphere::None, None, true);
    let view = from(8e5, 40.0);
    let sizes = [(48, 48), (96, 96), (192, 192)].map(|size| mean_light(&points, size, &view));
    for light in sizes {
        assert!((light / sizes[1] - 1.0).abs() < 0.02, "{sizes:?}");
    }
}

#[test]
fn air_and_clouds_before_points_take_as_much_as_before_the_map() {
    // Above the air and in it; few of the clouds' structures fit into the second picture.
    for (atmosphere, clouds, view) in [
        (Atmosphere::Billboard, None, from(8e5, 40.0)),
        (Atmosphere::Billboard, None, from(6e4, 90.0)),
        (Atmosphere::None, Some(150), from(8e5, 40.0)),
    ] {
        let left = [true, false].map(|as_points| {
            let mut before = options(atmosphere, clouds, as_points);
            let mut clear = options(Atmosphere::None, None, as_points);
            // For clouds too: it changes their mean.
            (before.light.detail, clear.light.detail) = (true, true);
            mean_light(&before, SIZE, &view) / mean_light(&clear, SIZE, &view)
        });
        assert!(left[1] < 0.95, "{left:?}");
        assert!((left[0] / left[1] - 1.0).abs() < 0.05, "{left:?}");
    }
}

#[test]
fn there_are_none_by_day_and_none_behind_the_limb() {
    let view = from(8e5, 40.0);
    let [points, map] = [true, false].map(|as_points| options(Atmosphere::None, None, as_points));
    let by_day =
        [&points, &map].map(|options| Rig::of_light(options, SIZE).draw_light(&view, DVec3::X));
    assert_eq!(by_day[0], by_day[1]);
    // Half of the picture is above the horizon.
    let level = tilted(Geodetic::from_degrees(4.0, 7.0, 4e5), 0.0, 0.0, 40.0, 1.0);
    let light = Rig::of_light(&points, SIZE).draw_light(&level, DVec3::NEG_X);
    let rows = light.len() / 2;
    assert!(light[..rows].iter().all(|pixel| pixel[0] == 0.0));
}

#[test]
fn another_map_of_lights_is_rejected_while_they_are_points() {
    let gpu = gpu();
    let map = GpuMap::upload(
        &gpu.device,
        &gpu.queue,
        MapLayer::NightLights,
        &even(9),
        Default::default(),
    );
    let map = map.expect("a good map");
    let mut drawn_as_points = Rig::new(&options(Atmosphere::None, None, true), SIZE).earth;
    let error = drawn_as_points
        .set_map(&gpu.queue, &map)
        .expect_err("points");
    assert!(
        error.to_string().contains("EarthOptions::city_lights"),
        "{error}"
    );
    let mut drawn_as_map = Rig::new(&options(Atmosphere::None, None, false), SIZE).earth;
    drawn_as_map.set_map(&gpu.queue, &map).expect("a map");
}

/// Views one after the other, each over other cells.
#[test]
fn points_that_are_made_when_needed_are_drawn_as_those_made_at_once() {
    let at_once = EarthOptions {
        color_format: gpu().float_format(),
        ..options(Atmosphere::None, None, true)
    };
    let when_needed = EarthOptions {
        pipelines: Pipelines::WhenNeeded,
        city_lights: options(Atmosphere::None, None, true).city_lights,
        ..at_once.clone()
    };
    let [mut at_once, mut when_needed] =
        [at_once, when_needed].map(|options| Rig::with_pipelines(&options, SIZE));
    for lon_deg in [7.0, 12.0, -60.0, 7.0] {
        let view = down(Geodetic::from_degrees(4.0, lon_deg, 4e5), 60.0, 1.0);
        let [first, second] =
            [&mut at_once, &mut when_needed].map(|rig| rig.draw_light(&view, DVec3::NEG_X));
        assert!(first.iter().any(|[red, ..]| *red > 0.0), "{lon_deg}");
        assert_eq!(first, second, "{lon_deg}");
    }
}

/// Points that come after the first frame, as in a page: a view that was made before has them too.
#[test]
fn points_given_later_are_drawn_as_those_given_at_first() {
    let with_points = options(Atmosphere::Billboard, Some(80), true);
    let lights = with_points.city_lights.clone().expect("points");
    let with_map = EarthOptions {
        city_lights: None,
        ..with_points.clone()
    };
    let gpu = gpu();
    let eyes = [-145.0, -120.0].map(|lon_deg| {
        let place = Geodetic::from_degrees(4.0, lon_deg, 6e5);
        down(place, 50.0, 16.0 / 9.0)
    });
    let mut earth = Earth::new(&gpu.device, &gpu.queue, &with_map).expect("an Earth");
    let mut views = [earth.new_view().expect("a view")];
    assert!(together(&mut earth, &mut views, &eyes) == alone(&with_map, &eyes));
    earth
        .set_city_lights(&gpu.queue, lights)
        .expect("pipelines of points");
    let drawn = together(&mut earth, &mut views, &eyes);
    assert!(drawn == alone(&with_points, &eyes));
    assert!(drawn != alone(&with_map, &eyes));
}
