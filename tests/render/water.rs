//! Water: the glint where the ellipsoid mirrors the Sun, and coasts as sharp as the screen.

use crate::common::{Rig, down, looks_at, map, ray, tilted};
use glam::{DMat3, DVec2, DVec3};
use image::RgbaImage;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::{Atmosphere, EarthOptions, EyeView, SurfaceLight};
use terrella_imagery::{EarthLayers, LayerImage};

const SIZE: (u32, u32) = (320, 180);

/// An Earth without air under a water map.
fn options(day: [u8; 3], water: LayerImage) -> EarthOptions {
    let mut options = EarthOptions::new(EarthLayers {
        day: map(64, |_, _| day),
        clouds: None,
        normals: None,
        night_lights: None,
        water: Some(water),
    });
    options.atmosphere = Atmosphere::None;
    options.light = SurfaceLight::PLAIN;
    options.tone = terrella::Tone::Neutral;
    options
}

fn ocean() -> LayerImage {
    LayerImage::from_r8(64, 32, vec![255; 64 * 32]).expect("a sound map")
}

/// Linear light of a pixel's green.
fn light(picture: &RgbaImage, x: u32, y: u32) -> f64 {
    let encoded = f64::from(picture.get_pixel(x, y).0[1]) / 255.0;
    match encoded <= 0.04045 {
        true => encoded / 12.92,
        false => ((encoded + 0.055) / 1.055).powf(2.4),
    }
}

/// Where the ellipsoid reflects the Sun into the eye: there the bisector of both directions has no horizontal component. Newton's method on
/// latitude and longitude, starting below the eye.
fn specular_point(eye_m: DVec3, sun: DVec3) -> Geodetic {
    let start = Ellipsoid::WGS84.geodetic_from_itrf(eye_m);
    let mut at = DVec2::new(start.lat_rad, start.lon_rad);
    let along_ground = |at: DVec2| {
        let place = Geodetic {
            lat_rad: at.x,
            lon_rad: at.y,
            height_m: 0.0,
        };
        let up = Ellipsoid::normal(at.x, at.y);
        let east = DVec3::new(-at.y.sin(), at.y.cos(), 0.0);
        let to_eye = (eye_m - Ellipsoid::WGS84.itrf_from_geodetic(place)).normalize();
        let half_way = (to_eye + sun).normalize();
        DVec2::new(half_way.dot(east), half_way.dot(up.cross(east)))
    };
    for _ in 0..30 {
        let step = 1e-6;
        let here = along_ground(at);
        let by_lat = (along_ground(at + DVec2::X * step) - here) / step;
        let by_lon = (along_ground(at + DVec2::Y * step) - here) / step;
        at -= glam::DMat2::from_cols(by_lat, by_lon).inverse() * here;
    }
    assert!(along_ground(at).length() < 1e-9, "no specular point found");
    Geodetic {
        lat_rad: at.x,
        lon_rad: at.y,
        height_m: 0.0,
    }
}

/// The pixel that shows a direction from the eye, counted from the picture's corner.
fn pixel_of(view: &EyeView, direction: DVec3) -> DVec2 {
    let first = ray(view, 0, 0, SIZE);
    let (right, down) = (
        ray(view, SIZE.0 - 1, 0, SIZE),
        ray(view, 0, SIZE.1 - 1, SIZE),
    );
    // Rays end on one plane: find the direction in the corners' own coordinates.
    let forward = ray(view, SIZE.0 / 2, SIZE.1 / 2, SIZE);
    let on_plane = |v: DVec3| v / v.dot(forward);
    let (first, right, down) = (on_plane(first), on_plane(right), on_plane(down));
    let basis = DMat3::from_cols(right - first, down - first, first);
    let at = basis.inverse() * direction;
    DVec2::new(
        0.5 + at.x / at.z * f64::from(SIZE.0 - 1),
        0.5 + at.y / at.z * f64::from(SIZE.1 - 1),
    )
}

/// The top of the paraboloid that fits these values best.
fn summit(values: &[(DVec2, f64)]) -> DVec2 {
    let (mut matrix, mut right) = ([[0.0_f64; 6]; 6], [0.0_f64; 6]);
    let middle = values.iter().map(|(at, _)| *at).sum::<DVec2>() / values.len() as f64;
    for (at, value) in values {
        let p = (*at - middle) / 20.0;
        let terms = [1.0, p.x, p.y, p.x * p.x, p.x * p.y, p.y * p.y];
        for i in 0..6 {
            for j in 0..6 {
                matrix[i][j] += terms[i] * terms[j];
            }
            right[i] += terms[i] * value;
        }
    }
    for i in 0..6 {
        for k in 0..6 {
            if k != i {
                let factor = matrix[k][i] / matrix[i][i];
                let row = matrix[i];
                for (value, pivot) in matrix[k].iter_mut().zip(row) {
                    *value -= factor * pivot;
                }
                right[k] -= factor * right[i];
            }
        }
    }
    let c: Vec<f64> = (0..6).map(|i| right[i] / matrix[i][i]).collect();
    let det = 4.0 * c[3] * c[5] - c[4] * c[4];
    middle
        + 20.0
            * DVec2::new(
                c[4] * c[2] - 2.0 * c[5] * c[1],
                c[4] * c[1] - 2.0 * c[3] * c[2],
            )
            / det
}

#[test]
fn the_glint_lies_where_the_ellipsoid_mirrors_the_sun() {
    let at = Geodetic::from_degrees;
    let views: [(&str, Geodetic, f64, f64, f64); 3] = [
        ("low, equator", at(0.5, 80.0, 4e5), 20.0, 12.0, 70.0),
        ("high latitude", at(48.0, -30.0, 9e5), 30.0, 4.0, 60.0),
        ("whole disc", at(-20.0, 10.0, 3.6e7), -10.0, 25.0, 20.0),
    ];
    for (name, place, sun_north_deg, sun_east_deg, fov_deg) in views {
        let view = down(place, fov_deg, f64::from(SIZE.0) / f64::from(SIZE.1));
        let sun = Ellipsoid::normal(
            place.lat_rad + f64::to_radians(sun_north_deg),
            place.lon_rad + f64::to_radians(sun_east_deg),
        );
        // Two winds: everything except the waves' slopes is the same in both images, and the ratio is greatest where none is needed.
        let mut pictures = [0.0, 4.0].map(|wind_m_s| {
            let mut options = options([0; 3], ocean());
            options.light.wind_m_s = wind_m_s;
            options.exposure = terrella::Exposure::Ev(-1.0);
            // Linear light, so that ratios are those of light.
            options.tone = terrella::Tone::Linear;
            let (picture, _) = Rig::new(&options, SIZE).draw(&view, sun);
            picture
        });
        let [calm, rough] = &mut pictures;
        let mut values = Vec::new();
        for (x, y, pixel) in calm.enumerate_pixels() {
            let other = rough.get_pixel(x, y).0[1];
            if (60..250).contains(&pixel.0[1]) && (60..250).contains(&other) {
                let ratio = (light(calm, x, y) / light(rough, x, y)).ln();
                values.push((DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5), ratio));
            }
        }
        assert!(
            values.len() > 30,
            "{name}: {} pixels of glint",
            values.len()
        );
        let eye_m = Ellipsoid::WGS84.itrf_from_geodetic(place);
        let exact = specular_point(eye_m, sun);
        let want = pixel_of(&view, Ellipsoid::WGS84.itrf_from_geodetic(exact) - eye_m);
        let found = summit(&values);
        println!("{name}: {found} for {want}, of {} pixels", values.len());
        assert!(
            found.distance(want) < 1.0,
            "{name}: {found}, must be {want}"
        );
    }
}

#[test]
fn a_coast_is_a_pixel_wide_however_large_texels_are() {
    // Water west of 10.3° E, between texels 5.6° wide; the land is white.
    let edge_deg = 10.3_f64;
    let share = |x: u32| {
        let west_deg = -180.0 + f64::from(x) * 5.625;
        (255.0 * ((edge_deg - west_deg) / 5.625).clamp(0.0, 1.0)).round() as u8
    };
    let texels = (0..64 * 32).map(|n| share(n % 64)).collect();
    let water = LayerImage::from_r8(64, 32, texels).expect("a sound map");
    let mut rig = Rig::new(&options([255; 3], water), SIZE);
    for height_m in [4e5, 2e6] {
        let view = down(
            Geodetic::from_degrees(3.0, 10.3, height_m),
            50.0,
            rig.aspect(),
        );
        let (picture, _) = rig.draw(&view, Ellipsoid::normal(0.3, 0.9));
        for y in [20, 90, 160] {
            let row: Vec<f64> = (0..SIZE.0).map(|x| light(&picture, x, y)).collect();
            let (low, high) = (row[5], row[SIZE.0 as usize - 5]);
            assert!(low < 0.1 * high, "{height_m} {y}: water {low}, land {high}");
            let between = |value: &&f64| **value > low + 0.05 * high && **value < 0.9 * high;
            let soft = row.iter().filter(between).count();
            assert!(soft <= 4, "{height_m} m, row {y}: a coast of {soft} pixels");
        }
    }
}

#[test]
fn land_keeps_its_light_and_the_sea_is_its_own() {
    let view = tilted(
        Geodetic::from_degrees(0.0, 0.0, 1e6),
        200.0,
        -80.0,
        40.0,
        16.0 / 9.0,
    );
    let sun = Ellipsoid::normal(0.6, -0.7);
    let color = [120, 140, 80];
    let dry = LayerImage::from_r8(64, 32, vec![0; 64 * 32]).expect("a sound map");
    let (land, _) = Rig::new(&options(color, dry), SIZE).draw(&view, sun);
    let mut without = options(color, ocean());
    without.layers.water = None;
    let (day, _) = Rig::new(&without, SIZE).draw(&view, sun);
    assert!(land == day, "no water, no change");
    let (sea, _) = Rig::new(&options(color, ocean()), SIZE).draw(&view, sun);
    let (green, _) = Rig::new(&options([0, 255, 0], ocean()), SIZE).draw(&view, sun);
    assert!(sea == green, "the sea has nothing of the day map's colour");
    let (x, y) = (160, 90);
    assert!(looks_at(&view, x, y, SIZE).is_some());
    let [r, g, b, _] = sea.get_pixel(x, y).0;
    assert!(b > g && g > r && b < 90, "blue and dark: {r} {g} {b}");
}

#[test]
fn shelves_are_turquoise_in_the_tropics_and_green_beyond() {
    // 8 m of water. The Sun is in the zenith of each place, and its glint outside the image.
    let color_at = |lat_deg: f64| {
        let mut options = options([0; 3], ocean());
        let day = LayerImage::from_rgba8(64, 32, [0, 0, 0, 51].repeat(64 * 32));
        options.layers.day = day.expect("a sound map");
        options.tone = terrella::Tone::Linear;
        options.exposure = terrella::Exposure::Ev(2.0);
        let place = Geodetic::from_degrees(lat_deg, 0.0, 5e5);
        let view = tilted(place, 0.0, -40.0, 10.0, 16.0 / 9.0);
        let sun = Ellipsoid::normal(place.lat_rad, 0.0);
        let (picture, _) = Rig::new(&options, SIZE).draw(&view, sun);
        picture.get_pixel(160, 90).0.map(f64::from)
    };
    let [_, green, blue, _] = color_at(5.0);
    assert!((0.6..1.2).contains(&(green / blue)), "{green} {blue}");
    for lat_deg in [48.0, -48.0] {
        let [red, green, blue, _] = color_at(lat_deg);
        assert!(green > 1.4 * blue && red > blue, "{red} {green} {blue}");
    }
}
