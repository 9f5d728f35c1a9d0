//! Clouds over an eye that is below them: in its sky, and not on its ground.

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
fn the_way_through_their_height_is_no_step() {
    let mut rig = rig(128);
    for pitch_deg in [-30.0, 30.0] {
        let heights = (0..=24).map(|n| CLOUDS_M - 300.0 + 25.0 * f64::from(n));
        let light: Vec<f64> = heights
            .map(|height_m| mean(&mut rig, &view(height_m, pitch_deg)).y)
            .collect();
        let whole = (light[24] - light[0]).abs();
        let steps = light.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        let most = steps.fold(0.0, f64::max);
        println!("{pitch_deg}: {most} of {whole}");
        // A smooth step of 400 m changes by at most 0.094 of the whole in steps of 25 m.
        assert!(
            whole > 0.05 && most < 0.13 * whole,
            "{pitch_deg}: {light:?}"
        );
    }
}
