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

/// The Moon is a Sun of its own brightness: what it lights is what the Sun lights from there, in its proportion, through the same
/// air.
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

/// Looking past the limb from 400 km: green light, brightest where rays graze the layer's lower boundary, by night alone.
#[test]
fn the_air_glows_95_km_up_at_night() {
    let (eye_m, lines) = (4e5, 256);
    let place = Geodetic::from_degrees(0.0, 0.0, eye_m);
    let radius_m = 6_378_137.0;
    // The elevation of the ray that passes 95 km above the ground.
    let graze = |height_m: f64| {
        -((radius_m + height_m) / (radius_m + eye_m))
            .acos()
            .to_degrees()
    };
    let view: EyeView = tilted(place, 90.0, graze(7e4), 6.0, 0.125);
    let light = |airglow, sun| {
        let mut rig = Rig::of_light(&options(false, airglow), (32, lines));
        let light = rig.draw_light(&view, sun);
        (0..lines as usize)
            .map(|y| light[y * 32 + 16])
            .collect::<Vec<_>>()
    };
    let night = light(true, -DVec3::X);
    let green: Vec<f32> = night.iter().map(|texel| texel[1]).collect();
    let brightest = (0..green.len())
        .max_by(|a, b| green[*a].total_cmp(&green[*b]))
        .unwrap_or(0);
    let elevation = graze(7e4) + 6.0 * (0.5 - (brightest as f64 + 0.5) / f64::from(lines));
    let height_m = (radius_m + eye_m) * elevation.to_radians().cos() - radius_m;
    assert!((88e3..92e3).contains(&height_m), "{height_m} m");
    // A ray that grazes 90 km crosses 2 √(99² − 90²) km of it, in radii, 75 times its thickness: 1.14e-9 each.
    let way = 2.0 * ((radius_m + 99e3).powi(2) - (radius_m + 90e3).powi(2)).sqrt() / 9e3;
    let wanted = GAIN * 1.14e-9 * way;
    let texel = night[brightest];
    let luminance = 0.2126 * f64::from(texel[0]) + 0.7152 * f64::from(texel[1]);
    assert!(
        (0.85..1.02).contains(&(luminance / wanted)),
        "{luminance}, not {wanted}"
    );
    assert!(texel[1] > 4.0 * texel[0] && texel[2] < 1e-4, "{texel:?}");
    let (dark, day) = (
        light(false, -DVec3::X),
        [light(true, DVec3::X), light(false, DVec3::X)],
    );
    assert!(dark.iter().all(|texel| texel[1] < 1e-5));
    assert_eq!(day[0], day[1]);
}
