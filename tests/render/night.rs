//! The light of the night: the Moon's, and the air's own.

use crate::common::{Rig, down, plain, tilted};
use glam::DVec3;
use terrella::frames::Geodetic;
use terrella::{EarthOptions, EyeView, Sky, SurfaceLight};

const SIZE: (u32, u32) = (32, 32);
/// So that half floats hold the night.
const GAIN: f64 = 1e5;

fn options(moonlight: bool, airglow: bool) -> EarthOptions {
    EarthOptions {
        light: SurfaceLight {
            moonlight,
            airglow,
            night_gain: GAIN,
            night_fades_by_day: false,
            ..SurfaceLight::default()
        },
        ..EarthOptions::new(plain([120, 120, 120]))
    }
}

/// A Moon at its mean distance.
fn moon(direction: DVec3, sun: DVec3) -> Sky {
    Sky {
        moon_itrf_m: Some(direction * 3.844e8),
        ..Sky::new(sun)
    }
}

/// The Moon acts as a fainter Sun: it lights the same as the Sun from there, in proportion, through the same air.
#[test]
fn a_full_moon_lights_as_a_faint_sun_does() {
    lights_as_a_faint_sun(&down(Geodetic::from_degrees(0.0, 0.0, 2e6), 40.0, 1.0));
    // In the air, with half the picture above the horizon, and the Moon to the left.
    let place = Geodetic::from_degrees(0.0, 0.0, 8e3);
    lights_as_a_faint_sun(&tilted(place, 60.0, -2.0, 60.0, 1.0));
}

fn lights_as_a_faint_sun(view: &EyeView) {
    let from = DVec3::new(0.9, 0.3, 0.2).normalize();
    let by_sun = Rig::of_light(&options(false, false), SIZE).draw_light(view, from);
    let sky = moon(from, -from);
    let by_moon = Rig::of_light(&options(true, false), SIZE).draw_light_of(view, &sky);
    // 10^(−0.4 (26.74 − 12.73)): Allen's magnitudes of both.
    let full = GAIN * 10_f64.powf(-0.4 * 14.01);
    for (moonlit, sunlit) in by_moon.iter().zip(&by_sun) {
        for (moonlit, sunlit) in moonlit.iter().zip(sunlit).take(3) {
            let wanted = full * f64::from(*sunlit);
            let off = (f64::from(*moonlit) - wanted).abs();
            assert!(off < 0.01 * wanted + 1e-4, "{moonlit}, not {wanted}");
        }
    }
    // Without a Moon, and with one that is switched off, the night is black.
    let dark = [
        Rig::of_light(&options(true, false), SIZE).draw_light(view, -from),
        Rig::of_light(&options(false, false), SIZE).draw_light_of(view, &sky),
    ];
    for light in dark.iter().flatten() {
        assert!(light.iter().take(3).all(|value| *value < 1e-4), "{light:?}");
    }
}

#[test]
fn a_new_moon_adds_nothing_to_the_day() {
    let view = down(Geodetic::from_degrees(0.0, 0.0, 2e6), 40.0, 1.0);
    let with =
        Rig::of_light(&options(true, false), SIZE).draw_light_of(&view, &moon(DVec3::X, DVec3::X));
    let without = Rig::of_light(&options(true, false), SIZE).draw_light(&view, DVec3::X);
    for (a, b) in with.iter().flatten().zip(without.iter().flatten()) {
        assert!((a - b).abs() <= 2e-3 * b.abs() + 1e-4, "{a} {b}");
    }
}

const RADIUS_M: f64 = 6_378_137.0;
/// Height in metres, full width at half maximum and luminance of the airglow's layers, a white sheet that faces the Sun being 1: sodium
/// and OH, green oxygen, red oxygen.
const LAYERS: [(f64, f64, f64); 3] = [
    (88e3, 10e3, 3.587e-10),
    (98e3, 9e3, 1.140e-9),
    (250e3, 70e3, 8.07e-11),
];

/// Luminance of all layers seen from directly below.
const COLUMN: f64 = LAYERS[0].2 + LAYERS[1].2 + LAYERS[2].2;

/// Luminance of the layers along a ray that passes the ground at a height, summed in steps of 200 m: along all of it, or up to the point nearest to
/// the ground.
fn summed(height_m: f64, is_whole: bool) -> f64 {
    let step_m = 200.0;
    let mut sum = 0.0;
    for step in 0..10_000 {
        let along_m = (f64::from(step) + 0.5) * step_m;
        let height_m = (RADIUS_M + height_m).hypot(along_m) - RADIUS_M;
        for (middle_m, width_m, luminance) in LAYERS {
            let sigma_m = width_m / (8.0 * 2_f64.ln()).sqrt();
            let off = (height_m - middle_m) / sigma_m;
            let density =
                (-0.5 * off * off).exp() / (sigma_m * (2.0 * std::f64::consts::PI).sqrt());
            sum += luminance * density * step_m;
        }
    }
    if is_whole { 2.0 * sum } else { sum }
}

fn luminance(texel: &[f32]) -> f64 {
    let [r, g, b] = [texel[0], texel[1], texel[2]].map(f64::from);
    (0.2126 * r + 0.7152 * g + 0.0722 * b) / GAIN
}

/// Luminance of a column of pixels that looks past the limb from 400 km, and the heights at which their rays pass the ground: negative below the
/// limb.
fn past_the_limb(airglow: bool, sun: DVec3) -> Vec<(f64, f64, [f32; 3])> {
    let (eye_m, lines) = (4e5, 512);
    let place = Geodetic::from_degrees(0.0, 0.0, eye_m);
    let middle_deg = -((RADIUS_M + 7e4) / (RADIUS_M + eye_m)).acos().to_degrees();
    let view: EyeView = tilted(place, 90.0, middle_deg, 6.0, 0.0625);
    let mut rig = Rig::of_light(&options(false, airglow), (32, lines));
    let light = rig.draw_light(&view, sun);
    let of_line = |y: u32| {
        let elevation = middle_deg.to_radians().tan();
        // On the plane in front of the eye.
        let off = 3_f64.to_radians().tan() * (1.0 - (2.0 * f64::from(y) + 1.0) / f64::from(lines));
        let elevation = elevation.atan() + off.atan();
        let texel = &light[y as usize * 32 + 16];
        let height_m = (RADIUS_M + eye_m) * elevation.cos() - RADIUS_M;
        (
            height_m,
            luminance(&texel[..]),
            [texel[0], texel[1], texel[2]],
        )
    };
    (0..lines).map(of_line).collect()
}

/// Looking past the limb from 400 km: soft layers, brightest at 94 to 96 km, by night alone.
#[test]
fn the_air_glows_in_soft_layers_at_night() {
    let night = past_the_limb(true, -DVec3::X);
    let brightest = night.iter().max_by(|a, b| a.1.total_cmp(&b.1));
    let (height_m, most, texel) = *brightest.expect("pixels");
    assert!((94e3..96e3).contains(&height_m), "{height_m} m");
    assert!(texel[1] > 2.0 * texel[0] && texel[2] < 1e-4, "{texel:?}");
    // The top falls softly.
    let falls_to = |part: f64| {
        let above = night.iter().filter(|(height, _, _)| *height > height_m);
        let bright = above.filter(|(_, light, _)| *light > part * most);
        bright.map(|(height, _, _)| *height).fold(0.0, f64::max)
    };
    let fall_m = falls_to(0.1) - falls_to(0.9);
    assert!((6e3..9e3).contains(&fall_m), "{fall_m} m");
    // As summed in steps, where the air below takes nothing.
    for (height_m, light, _) in &night {
        if *height_m > 6e4 && *light > 0.02 * most {
            let wanted = summed(*height_m, true);
            assert!(
                (light / wanted - 1.0).abs() < 0.03,
                "{height_m} m: {light}, not {wanted}"
            );
        }
    }
    let (dark, day) = (
        past_the_limb(false, -DVec3::X),
        [
            past_the_limb(true, DVec3::X),
            past_the_limb(false, DVec3::X),
        ],
    );
    assert!(dark.iter().all(|(_, light, _)| *light < 1e-10));
    assert_eq!(day[0], day[1]);
}

/// Before the dark ground the eye sees the half of the layers that is on its side, and straight down the vertical column.
#[test]
fn the_air_glows_before_the_ground_too() {
    let night = past_the_limb(true, -DVec3::X);
    let inside = night.iter().find(|(height, _, _)| *height < -2e3);
    let (_, light, _) = *inside.expect("ground in the picture");
    let half = summed(0.0, false);
    assert!((light / half - 1.0).abs() < 0.05, "{light}, not {half}");
    // Rays just above the ground have that half too, and the other half through the lower air.
    let outside = night.iter().rfind(|(height, _, _)| *height > 5e4);
    let (height_m, light, _) = *outside.expect("air in the picture");
    let wanted = summed(height_m, true);
    assert!((light / wanted - 1.0).abs() < 0.03, "{light}, not {wanted}");
    let view = down(Geodetic::from_degrees(0.0, 0.0, 1e6), 1.0, 1.0);
    let mut rig = Rig::of_light(&options(false, true), SIZE);
    let texel = rig.draw_light(&view, -DVec3::X)[16 * 32 + 16];
    let column = luminance(&texel[..]);
    assert!((column / COLUMN - 1.0).abs() < 0.02, "{column}");
    // An eye on the ground has all of it above itself, and none in front of the ground.
    let place = Geodetic::from_degrees(0.0, 0.0, 100.0);
    let mut low = Rig::of_light(&options(false, true), (32, 64));
    let light = low.draw_light(&tilted(place, 90.0, 0.0, 60.0, 0.5), -DVec3::X);
    assert!(luminance(&light[16][..]) > 0.8 * COLUMN);
    assert!(luminance(&light[63 * 32 + 16][..]) < 1e-12);
}
