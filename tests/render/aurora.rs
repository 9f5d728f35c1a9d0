//! The aurora: position, height, brightness and motion.

use crate::common::{Rig, down, plain, tilted};
use glam::DVec3;
use terrella::frames::{Duration, Epoch, Geodetic};
use terrella::{EarthOptions, Exposure, EyeView, Sky, SurfaceLight, Tone, exposure_factor};

/// So that half floats hold the night.
const GAIN: f64 = 1e5;
/// Longitude of the northern geomagnetic pole in 2025; its latitude is 80.9°.
const POLE_LON_DEG: f64 = -72.8;
const POLE_LAT_DEG: f64 = 80.9;

/// A winter midnight on the meridian of the pole.
fn midnight() -> DVec3 {
    let (lat, lon) = (-23_f64.to_radians(), (POLE_LON_DEG + 180.0).to_radians());
    DVec3::new(lat.cos() * lon.cos(), lat.cos() * lon.sin(), lat.sin())
}

fn epoch() -> Epoch {
    "2025-12-21T05:00:00Z".parse().expect("a date")
}

fn options(kp: Option<f64>) -> EarthOptions {
    EarthOptions {
        light: SurfaceLight {
            kp,
            night_gain: GAIN,
            night_fades_by_day: false,
            ..SurfaceLight::default()
        },
        ..EarthOptions::new(plain([120, 120, 120]))
    }
}

fn rig(kp: Option<f64>, size: (u32, u32)) -> Rig {
    Rig::of_light(&options(kp), size)
}

fn light_at(kp: Option<f64>, view: &EyeView, size: (u32, u32), epoch: Epoch) -> Vec<[f32; 4]> {
    let sky = Sky {
        epoch: Some(epoch),
        ..Sky::new(midnight())
    };
    rig(kp, size).draw_light_of(view, &sky)
}

fn light(kp: Option<f64>, view: &EyeView, size: (u32, u32)) -> Vec<[f32; 4]> {
    light_at(kp, view, size, epoch())
}

/// Straight down on the midnight meridian, at a geomagnetic latitude.
fn over(geomagnetic_lat_deg: f64, height_m: f64, fov_deg: f64) -> EyeView {
    let lat_deg = geomagnetic_lat_deg - 90.0 + POLE_LAT_DEG;
    down(
        Geodetic::from_degrees(lat_deg, POLE_LON_DEG, height_m),
        fov_deg,
        1.0,
    )
}

fn mean_green(light: &[[f32; 4]]) -> f64 {
    light.iter().map(|texel| f64::from(texel[1])).sum::<f64>() / light.len() as f64
}

#[test]
fn it_reaches_as_far_as_its_activity_says_and_is_not_there_without() {
    let size = (16, 16);
    // Kp 3 reaches 60.4° and Kp 7 52.2° at midnight; the poleward boundary is at 71°.
    for (lat_deg, kp, is_there) in [
        (64.0, 3.0, true),
        (57.0, 3.0, false),
        (57.0, 7.0, true),
        (48.0, 7.0, false),
        (78.0, 3.0, false),
    ] {
        let green = mean_green(&light(Some(kp), &over(lat_deg, 8e5, 3.0), size));
        assert_eq!(green > 1e-5, is_there, "{lat_deg}°, Kp {kp}: {green}");
    }
    let view = over(64.0, 8e5, 3.0);
    assert!(mean_green(&light(None, &view, size)) < 1e-7);
    // By day it is outshone.
    let day = |kp| rig(kp, size).draw_light(&view, -midnight());
    assert_eq!(day(Some(7.0)), day(None));
}

#[test]
fn the_southern_hemisphere_has_an_oval_too() {
    let place = Geodetic::from_degrees(-65.0, POLE_LON_DEG + 180.0, 8e5);
    let sun = DVec3::new(midnight().x, midnight().y, -midnight().z) * DVec3::new(-1.0, -1.0, 1.0);
    let view = down(place, 60.0, 1.0);
    let lit = rig(Some(5.0), (32, 32)).draw_light(&view, sun);
    assert!(mean_green(&lit) > 1e-5, "{}", mean_green(&lit));
}

/// Over the oval, as much light as the electrons' power gives, within the half: Kp 5 has 69 GW and 5.4 kR on average, more at midnight.
#[test]
fn seen_from_above_it_is_as_bright_as_its_power() {
    let lit = light(Some(5.0), &over(63.0, 2e6, 30.0), (96, 96));
    // Green of the line at 557.7 nm, a white sheet being 1: 1.50e-9 for 250 R.
    let wanted = GAIN * 1.504e-9 * 5.4e3 / 250.0 * 1.5;
    let green = mean_green(&lit);
    assert!(
        (0.5..1.8).contains(&(green / wanted)),
        "{green}, not {wanted}"
    );
    // Curtains are brighter than the diffuse aurora.
    let most = lit.iter().map(|texel| texel[1]).fold(0.0, f32::max);
    assert!(f64::from(most) > 3.0 * green, "{most} of {green}");
}

/// From the side: green at 100 to 150 km, red above it.
#[test]
fn seen_from_the_side_red_stands_above_green() {
    let (eye_m, lines, radius_m) = (4.1e5, 256, 6_370_000.0);
    // South of the oval, looking north over the limb.
    let place = Geodetic::from_degrees(37.0, POLE_LON_DEG, eye_m);
    let middle_deg = -((radius_m + 1.6e5) / (radius_m + eye_m))
        .acos()
        .to_degrees();
    let (half_deg, aspect) = (17_f64, 0.25);
    let view = tilted(place, 0.0, middle_deg, 2.0 * half_deg, aspect);
    let lit = light(Some(5.0), &view, (64, lines));
    let row = |y: u32| {
        let texels = &lit[y as usize * 64..(y as usize + 1) * 64];
        let mean =
            |channel: usize| texels.iter().map(|t| f64::from(t[channel])).sum::<f64>() / 64.0;
        let up = 1.0 - (2.0 * f64::from(y) + 1.0) / f64::from(lines);
        let off = (half_deg.to_radians().tan() * up).atan().to_degrees();
        let height_m = (radius_m + eye_m) * (middle_deg + off).to_radians().cos() - radius_m;
        (height_m, mean(0), mean(1))
    };
    let rows: Vec<_> = (0..lines).map(row).filter(|row| row.0 > 3e4).collect();
    let (green_m, ..) = *rows
        .iter()
        .max_by(|a, b| a.2.total_cmp(&b.2))
        .expect("rows");
    assert!((9e4..1.5e5).contains(&green_m), "{green_m}");
    let at = |height_m: f64| {
        let near = |row: &&(f64, f64, f64)| (row.0 - height_m).abs() < 8e3;
        *rows.iter().find(near).expect("such a height")
    };
    let (low, high, above) = (at(1.2e5), at(2.5e5), at(4e5));
    assert!(low.2 > 3.0 * low.1, "{low:?}");
    assert!(high.1 > 20.0 * high.2 && high.1 > 1e-5, "{high:?}");
    assert!(above.1 < 0.2 * high.1, "{above:?}");
}

/// Cameras record lines paler than they are, but as bright.
#[test]
fn a_picture_has_no_pure_green_and_its_luminance() {
    let (view, size) = (over(64.0, 8e5, 3.0), (8, 8));
    let luminance = |[red, green, blue]: [f64; 3]| 0.2126 * red + 0.7152 * green + 0.0722 * blue;
    let mean = |texels: &[[f64; 3]]| {
        let sum = |channel: usize| texels.iter().map(|texel| texel[channel]).sum::<f64>();
        [0, 1, 2].map(|channel| sum(channel) / texels.len() as f64)
    };
    let measured: Vec<_> = light(Some(5.0), &view, size)
        .iter()
        .map(|[red, green, blue, _]| [red, green, blue].map(|value| f64::from(*value)))
        .collect();
    let measured = mean(&measured);
    let ev = -luminance(measured).log2() - 2.0;
    let mut options = options(Some(5.0));
    options.tone = Tone::Linear;
    options.exposure = Exposure::Ev(ev);
    let sky = Sky {
        epoch: Some(epoch()),
        ..Sky::new(midnight())
    };
    let (picture, _) = Rig::new(&options, size).draw_of(&view, &sky);
    let decode = |code: u8| (f64::from(code) / 255.0).powf(2.2);
    let shown: Vec<_> = picture
        .pixels()
        .map(|pixel| [0, 1, 2].map(|channel| decode(pixel.0[channel])))
        .collect();
    let shown = mean(&shown);
    let pale = |light: [f64; 3]| light[2] / light[1];
    assert!(pale(measured) < 0.15, "{measured:?}");
    assert!((pale(shown) - 0.3).abs() < 0.03, "{shown:?}");
    let kept = luminance(shown) / (luminance(measured) * exposure_factor(ev));
    assert!((kept - 1.0).abs() < 0.05, "{kept}");
}

#[test]
fn it_moves_with_time_and_is_the_same_at_the_same_time() {
    let view = over(64.0, 5e5, 40.0);
    let at = |seconds: f64| {
        light_at(
            Some(5.0),
            &view,
            (64, 64),
            epoch() + Duration::from_seconds(seconds),
        )
    };
    let begin = at(0.0);
    assert!(begin == at(0.0));
    let off = |other: &[[f32; 4]]| {
        let off = begin
            .iter()
            .zip(other)
            .map(|(a, b)| f64::from((a[1] - b[1]).abs()));
        off.sum::<f64>() / begin.len() as f64 / mean_green(&begin)
    };
    // A frame later it is nearly as it was, a minute later it is not.
    let (frame, minute) = (off(&at(0.04)), off(&at(60.0)));
    assert!(frame < 0.02 && minute > 0.05, "{frame} {minute}");
}
