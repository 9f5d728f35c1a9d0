//! Clouds over an eye that is below them, in its sky and not on its ground, and around an eye within them.

use crate::common::{Rig, map, tilted};
use glam::DVec3;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::{EarthOptions, EyeView, SurfaceLight};
use terrella_imagery::{EarthLayers, LayerImage};

const SIZE: (u32, u32) = (96, 54);
const CLOUDS_M: f64 = 6000.0;

/// Dark ground under clouds of one cover, and the light without exposure.
fn rig(cover: u8) -> Rig {
    let mut options = EarthOptions::new(EarthLayers {
        day: map(64, |_, _| [40; 3]),
        clouds: Some(LayerImage::from_r8(64, 32, vec![cover; 64 * 32]).expect("a sound map")),
        normals: None,
        night_lights: None,
        water: None,
    });
    options.light = SurfaceLight {
        cloud_height_m: CLOUDS_M,
        ..SurfaceLight::PLAIN
    };
    Rig::of_light(&options, SIZE)
}

fn view(height_m: f64, pitch_deg: f64) -> EyeView {
    let place = Geodetic::from_degrees(10.0, 20.0, height_m);
    tilted(place, 90.0, pitch_deg, 40.0, 16.0 / 9.0)
}

/// Mean light of an image, under a high Sun behind the eye.
fn mean(rig: &mut Rig, view: &EyeView) -> DVec3 {
    let sun = Ellipsoid::normal(10_f64.to_radians(), -10_f64.to_radians());
    let light = rig.draw_light(view, sun);
    let sum: DVec3 = light
        .iter()
        .map(|[r, g, b, _]| DVec3::new(f64::from(*r), f64::from(*g), f64::from(*b)))
        .sum();
    sum / light.len() as f64
}

#[test]
fn an_eye_below_clouds_sees_them_in_its_sky_alone() {
    let (mut clear, mut broken, mut thick) = (rig(0), rig(60), rig(255));
    let blue = |light: DVec3| light.z / light.x;
    let up = view(1000.0, 40.0);
    let sky = [&mut clear, &mut broken, &mut thick].map(|rig| mean(rig, &up));
    println!("{sky:?}");
    assert!(blue(sky[0]) > 2.0 && blue(sky[2]) < 1.6, "grey hides blue");
    assert!(sky[1].x > sky[0].x && sky[2].x > sky[0].x);
    assert!(sky[1].x > sky[2].x, "a thick layer lets less light down");

    // The ground equals that under a clear sky except for the light reflected between clouds and air.
    let [below, above] = [1000.0, 20_000.0].map(|height_m| view(height_m, -40.0));
    let (clear, under, over) = (
        mean(&mut clear, &below),
        mean(&mut thick, &below),
        mean(&mut thick, &above),
    );
    println!("{clear} {under} {over}");
    assert!((under / clear).max_element() < 3.0);
    assert!((over / clear).min_element() > 10.0);
}

#[test]
fn an_eye_within_thick_clouds_sees_nothing_else() {
    let sun = Ellipsoid::normal(10_f64.to_radians(), -10_f64.to_radians());
    let (mut clear, mut thick) = (rig(0), rig(255));
    for pitch_deg in [-50.0, 0.0, 50.0] {
        let lights = [-400.0, 0.0, 400.0].map(|by_m| {
            let within = view(CLOUDS_M + by_m, pitch_deg);
            let pixels = thick.draw_light(&within, sun);
            let values = pixels.iter().map(|[_, green, ..]| f64::from(*green));
            let (least, most) = values.fold((f64::MAX, 0.0), |(least, most), value| {
                (value.min(least), value.max(most))
            });
            println!("{pitch_deg} {by_m}: {least} … {most}");
            // The horizon, ground and sky differ by much more without the clouds.
            if by_m == 0.0 {
                assert!(most < 1.5 * least, "{pitch_deg}: {least} … {most}");
            }
            mean(&mut thick, &within).y
        });
        assert!(lights.is_sorted(), "it is brighter above: {lights:?}");
    }
    // Where the map has no clouds there are none.
    let within = view(CLOUDS_M, -10.0);
    let with = clear.draw_light(&within, sun);
    let mut without = {
        let mut options = EarthOptions::new(EarthLayers {
            day: map(64, |_, _| [40; 3]),
            clouds: None,
            normals: None,
            night_lights: None,
            water: None,
        });
        options.light = SurfaceLight::PLAIN;
        Rig::of_light(&options, SIZE)
    };
    assert_eq!(with, without.draw_light(&within, sun));
}

#[test]
fn the_way_through_their_height_is_no_step() {
    // Where they begin to be drawn around the eye, at their base, in their middle, at their top, and where that ends.
    let from_middle_m = [-1000.0, -500.0, 0.0, 500.0, 1000.0];
    for cover in [60, 255] {
        let mut rig = rig(cover);
        for pitch_deg in [-30.0, 0.0, 30.0] {
            let light = from_middle_m.map(|by_m| {
                let heights = (-10..=10).map(|n| CLOUDS_M + by_m + 5.0 * f64::from(n));
                let light = heights.map(|height_m| mean(&mut rig, &view(height_m, pitch_deg)).y);
                light.collect::<Vec<_>>()
            });
            let most = light.iter().flatten().copied().fold(0.0, f64::max);
            let least = light.iter().flatten().copied().fold(f64::MAX, f64::min);
            let steps = light.iter().flat_map(|light| light.windows(2));
            let steps = steps.map(|pair| (pair[1] - pair[0]).abs());
            let largest = steps.fold(0.0, f64::max);
            println!("{cover} {pitch_deg}: {largest} of {}", most - least);
            // A white sheet has the light 1. Out of the top of thick even clouds, a view changes by half of that within 50 m.
            assert!(
                most - least > 0.2 && largest < 0.06,
                "{cover} {pitch_deg}: {light:?}"
            );
        }
    }
}
