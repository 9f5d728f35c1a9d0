//! The reference renderer, compared with closed forms: limb, light, filters, places. No GPU, except for the last test.

use crate::common::{day_only, down, map, plain, tilted};
use glam::{DMat4, DVec2, DVec3, DVec4};
use std::f64::consts::PI;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use terrella::frames::{Ellipsoid, Epoch, Geodetic, sun_direction_itrf, utc_from_rfc3339};
use terrella::{Atmosphere, EyeView, Shading, Sky, SurfaceLight, Tone};
use terrella_ground::globe::Figure;
use terrella_imagery::{EarthLayers, LayerImage};
use terrella_reference::{
    Reference, ReferenceError, ReferenceOptions, ReferencePicture, ground_point, limb_angle_rad,
};

/// No air, a sphere, no brightening.
const BARE: ReferenceOptions = ReferenceOptions {
    figure: Figure::Sphere,
    shading: Shading::Sunlit,
    surface: SurfaceLight {
        relief_exaggeration: 4.0,
        cloud_relief_m: 0.0,
        ..SurfaceLight::PLAIN
    },
    atmosphere: Atmosphere::None,
    aerosol_optical_depth: 0.0,
    exposure: 1.0,
    tone: Tone::Linear,
    samples: 2,
};

const RADIUS_M: f64 = Ellipsoid::PAPER_SPHERE.equatorial_radius_m;

fn reference(layers: &EarthLayers, options: ReferenceOptions) -> Reference {
    Reference::new(layers, options).expect("sound options")
}

fn sky(sun_itrf: DVec3) -> Sky {
    Sky::new(sun_itrf)
}

/// An eye at `eye_m` that looks at the centre, z upwards.
fn centered(eye_m: DVec3, fov_rad: f64, aspect: f64) -> EyeView {
    EyeView::itrf(eye_m, -eye_m, DVec3::Z, fov_rad, aspect)
}

/// Mean over the pixels of one channel of the light.
fn sum(picture: &ReferencePicture, channel: usize) -> f64 {
    let light = picture.linear.iter().map(|light| f64::from(light[channel]));
    light.sum()
}

fn worst(a: &[[f32; 3]], b: &[[f32; 3]]) -> f32 {
    assert_eq!(a.len(), b.len());
    let pairs = a.iter().zip(b).flat_map(|(a, b)| a.iter().zip(b));
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[test]
fn a_white_sphere_reflects_by_lamberts_phase_law() {
    let options = ReferenceOptions { samples: 4, ..BARE };
    let reference = reference(&plain([255; 3]), options);
    // So far away that all rays are parallel.
    let distance_m = 1e10;
    let fov = 2.2 * RADIUS_M / distance_m;
    let view = centered(DVec3::X * distance_m, fov, 1.0);
    let side = 128;
    let radius_px = f64::from(side) * 0.5 * (RADIUS_M / distance_m) / (0.5 * fov).tan();
    for phase_deg in [0.0_f64, 30.0, 60.0, 90.0, 120.0, 150.0] {
        let phase = phase_deg.to_radians();
        let sun = DVec3::new(phase.cos(), phase.sin(), 0.0);
        let picture = reference.render(&view, &sky(sun), (side, side));
        // ∫ cos over the lit, seen disc: 2/3 of it at full phase, falling with (sin α + (π − α) cos α)/π.
        let law = (phase.sin() + (PI - phase) * phase.cos()) / PI;
        let exact = 2.0 / 3.0 * PI * radius_px * radius_px * law;
        let found = sum(&picture, 1);
        println!("phase {phase_deg}°: {found:.3} of {exact:.3}");
        // The thin crescent is a few pixels wide.
        let full = 2.0 / 3.0 * PI * radius_px * radius_px;
        assert!(
            (found - exact).abs() < 1e-3 * exact + 1e-4 * full,
            "{phase_deg}°: {found} {exact}"
        );
    }
}

#[test]
fn the_silhouette_is_the_analytic_limb() {
    let side = 64;
    for (figure, distance_m) in [
        (Figure::Sphere, 7.0e6),
        (Figure::Sphere, 3.0e7),
        (Figure::Wgs84, 7.0e6),
        (Figure::Wgs84, 2.6e7),
        (Figure::Wgs84, 1e12),
    ] {
        let options = ReferenceOptions {
            figure,
            samples: 8,
            ..BARE
        };
        let reference = reference(&plain([90; 3]), options);
        let ellipsoid = figure.ellipsoid();
        let (a, b) = (ellipsoid.equatorial_radius_m, ellipsoid.polar_radius_m);
        // Seen from the equator: tangents of the meridian ellipse and of the equator.
        let slant = 1.0 / ((distance_m - a) * (distance_m + a)).sqrt();
        let (half_width, half_height) = (a * slant, b * slant);
        let fov = 2.0 * (1.05 * half_width).atan();
        let view = centered(DVec3::X * distance_m, fov, 1.0);
        let picture = reference.render(&view, &sky(DVec3::X), (side, side));
        let covered: f64 = picture.ground.iter().map(|part| f64::from(*part)).sum();
        let px = f64::from(side) * 0.5 / (0.5 * fov).tan();
        let exact = PI * half_width * half_height * px * px;
        println!("{figure:?} {distance_m:e}: {covered:.2} px of {exact:.2}");
        assert!(
            (covered / exact - 1.0).abs() < 1e-3,
            "{figure:?} {distance_m}: {covered} {exact}"
        );
        for (across, tangent) in [(DVec3::Y, half_width), (DVec3::Z, half_height)] {
            let angle = limb_angle_rad(ellipsoid, DVec3::X * distance_m, DVec3::NEG_X, across);
            let angle = angle.expect("a limb");
            assert!(
                (angle.tan() / tangent - 1.0).abs() < 1e-12,
                "{figure:?} {distance_m}"
            );
        }
        // No axis of symmetry: the limb by bisection of exact rays.
        let eye = DVec3::new(0.6, 0.3, 0.5).normalize() * distance_m;
        let across = (-eye).normalize().any_orthonormal_vector();
        let angle = limb_angle_rad(ellipsoid, eye, -eye, across).expect("a limb");
        let meets = |angle: f64| {
            let forward = (-eye).normalize() * angle.cos() + across * angle.sin();
            let view = EyeView::itrf(eye, forward, DVec3::Z, 1e-3, 1.0);
            ground_point(&view, ellipsoid, (2, 2), DVec2::ONE).is_some()
        };
        assert!(
            meets(angle * (1.0 - 1e-9)) && !meets(angle * (1.0 + 1e-9)),
            "{figure:?}"
        );
    }
    let none = limb_angle_rad(Ellipsoid::WGS84, DVec3::X * 6e6, DVec3::X, DVec3::Y);
    assert_eq!(none, None, "inside");
}

#[test]
fn places_are_found_to_rounding() {
    let size = (200, 120);
    for (name, view) in [
        (
            "near",
            tilted(
                Geodetic::from_degrees(46.0, 8.0, 3e5),
                70.0,
                -35.0,
                50.0,
                200.0 / 120.0,
            ),
        ),
        (
            "far",
            down(
                Geodetic::from_degrees(-60.0, 179.9, 4e7),
                15.0,
                200.0 / 120.0,
            ),
        ),
        (
            "on the ground",
            tilted(
                Geodetic::from_degrees(10.0, 8.0, 1.7),
                0.0,
                -10.0,
                50.0,
                1.0,
            ),
        ),
    ] {
        let mut met = 0;
        for x in 0..20 {
            for y in 0..12 {
                let at = DVec2::new(10.0 * f64::from(x) + 0.25, 10.0 * f64::from(y) + 3.0);
                let Some(point) = ground_point(&view, Ellipsoid::WGS84, size, at) else {
                    continue;
                };
                met += 1;
                let height = Ellipsoid::WGS84.geodetic_from_itrf(point).height_m;
                let far_m = view.eye_world.length();
                assert!(
                    height.abs() < 1e-15 * far_m * 10.0 + 2e-9,
                    "{name}: {height} m"
                );
                // And it projects back to where it was looked for.
                let (eye, clip_from_eye) = view.to_itrf();
                let clip = clip_from_eye * (point - eye).extend(1.0);
                let back = DVec2::new(
                    (clip.x / clip.w + 1.0) * 0.5 * f64::from(size.0),
                    (1.0 - clip.y / clip.w) * 0.5 * f64::from(size.1),
                );
                assert!(back.distance(at) < 1e-6, "{name}: {at} {back}");
            }
        }
        assert!(met > 60, "{name}: {met}");
    }
}

#[test]
fn every_projection_and_every_world_sees_the_same() {
    let size = (90, 60);
    let view = tilted(
        Geodetic::from_degrees(30.0, 20.0, 1e6),
        45.0,
        -40.0,
        50.0,
        1.5,
    );
    let reference = reference(&plain([120; 3]), BARE);
    let sun = sky(DVec3::new(0.7, 0.5, 0.5).normalize());
    let whole = reference.render(&view, &sun, size);
    // The right half by an off-centre projection: X' = 2X − 1.
    let shift = DMat4::from_cols(
        DVec4::new(2.0, 0.0, 0.0, 0.0),
        DVec4::Y,
        DVec4::Z,
        DVec4::new(-1.0, 0.0, 0.0, 1.0),
    );
    let half = EyeView {
        clip_from_view: shift * view.clip_from_view,
        ..view
    };
    let right = reference.render(&half, &sun, (45, 60));
    let expected: Vec<_> = whole
        .linear
        .chunks_exact(90)
        .flat_map(|row| &row[45..])
        .copied()
        .collect();
    assert!(worst(&right.linear, &expected) < 1e-6);
    // A world in kilometres, turned and shifted.
    let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -1.2, 2.0);
    let itrf_from_world = glam::DAffine3::from_scale_rotation_translation(
        DVec3::splat(1000.0),
        turn,
        DVec3::new(5e6, -3e7, 1e6),
    );
    let world = EyeView {
        eye_world: itrf_from_world.inverse().transform_point3(view.eye_world),
        view_from_world: view.view_from_world * turn,
        itrf_from_world,
        ..view
    };
    let picture = reference.render(&world, &sun, size);
    assert!(worst(&picture.linear, &whole.linear) < 1e-5);
}

#[test]
fn the_picture_is_as_symmetric_as_the_scene() {
    for (atmosphere, figure) in [
        (Atmosphere::Billboard, Figure::Wgs84),
        (Atmosphere::None, Figure::Sphere),
    ] {
        let options = ReferenceOptions {
            atmosphere,
            figure,
            ..BARE
        };
        let reference = reference(&plain([140, 120, 90]), options);
        let eye = DVec3::new(1.1e7, 2e6, 3e6);
        let forward = DVec3::new(-1.0, 0.1, -0.2);
        let draw = |turn_rad: f64, mirror: f64| {
            let turn = |v: DVec3| {
                let (sin, cos) = turn_rad.sin_cos();
                let v = DVec3::new(v.x, v.y * mirror, v.z);
                DVec3::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z)
            };
            let view = EyeView::itrf(turn(eye), turn(forward), DVec3::Z, 1.0, 1.0);
            let sun = turn(DVec3::new(0.3, 0.8, 0.4).normalize());
            reference.render(&view, &sky(sun), (40, 40)).linear
        };
        let straight = draw(0.0, 1.0);
        assert!(straight.iter().any(|light| light[1] > 0.05));
        // Turned about the axis, across the date line.
        assert!(worst(&straight, &draw(2.9, 1.0)) < 1e-5, "{figure:?}");
        // Mirrored in the plane y = 0.
        let mirrored: Vec<_> = draw(0.0, -1.0)
            .chunks_exact(40)
            .flat_map(|row| row.iter().rev().copied().collect::<Vec<_>>())
            .collect();
        assert!(worst(&straight, &mirrored) < 1e-5, "{figure:?}");
    }
}

fn place_of(view: &EyeView, size: (u32, u32), x: f64, y: f64) -> Option<DVec3> {
    let point = ground_point(view, Ellipsoid::WGS84, size, DVec2::new(x, y))?;
    let place = Ellipsoid::WGS84.geodetic_from_itrf(point);
    Some(Ellipsoid::normal(place.lat_rad, place.lon_rad))
}

#[test]
fn the_brightest_place_and_the_terminator_are_where_the_sun_puts_them() {
    let options = ReferenceOptions {
        figure: Figure::Wgs84,
        samples: 1,
        ..BARE
    };
    let reference = reference(&plain([255; 3]), options);
    for date in [
        "2018-03-20T06:00:00Z",
        "2018-06-21T14:00:00Z",
        "2018-12-01T22:00:00Z",
    ] {
        let epoch: Epoch = utc_from_rfc3339(date).expect("a date");
        let sun = sun_direction_itrf(epoch);
        // 60° beside the Sun: the sub-solar point and the terminator are both in sight.
        let beside = sun.any_orthonormal_vector();
        let eye = (sun * 0.5 + beside * 0.866).normalize() * 4e7;
        let size = (160, 160);
        let view = centered(eye, 20_f64.to_radians(), 1.0);
        let picture = reference.render(&view, &sky(sun), size);
        let brightest = picture
            .linear
            .iter()
            .enumerate()
            .max_by(|a, b| a.1[1].total_cmp(&b.1[1]));
        let (at, _) = brightest.expect("pixels");
        let (x, y) = ((at % 160) as f64 + 0.5, (at / 160) as f64 + 0.5);
        let up = place_of(&view, size, x, y).expect("ground");
        let off_deg = up.dot(sun).clamp(-1.0, 1.0).acos().to_degrees();
        println!("{date}: brightest {off_deg:.2}° from the sub-solar point");
        // A pixel is 100 km there, 0.9°, and more at 60° to it.
        assert!(off_deg < 1.8, "{off_deg}");
        let mut pixels = 0;
        for (at, light) in picture.linear.iter().enumerate() {
            let (x, y) = ((at % 160) as f64 + 0.5, (at / 160) as f64 + 0.5);
            let Some(up) = place_of(&view, size, x, y) else {
                continue;
            };
            // A tap's mean of max(cos, 0) near the terminator differs from its middle's.
            let exact = up.dot(sun).max(0.0);
            let seen = up.dot((view.eye_world).normalize());
            if seen > 0.3 {
                assert!(
                    (f64::from(light[1]) - exact).abs() < 0.012,
                    "{light:?} {exact}"
                );
                assert!(up.dot(sun) > -0.03 || light[1] == 0.0);
                pixels += 1;
            }
        }
        assert!(pixels > 5_000, "{pixels}");
    }
}

/// A map of squares of one texel, black and white.
fn checkered(width: u32) -> LayerImage {
    let texels = (0..width * width / 2).flat_map(|i| {
        let is_white = (i % width + i / width).is_multiple_of(2);
        [if is_white { 255 } else { 0 }; 4]
    });
    LayerImage::from_rgba8(width, width / 2, texels.collect()).expect("a map")
}

#[test]
fn far_away_a_map_is_its_mean_in_linear_light() {
    let options = ReferenceOptions { samples: 1, ..BARE };
    let checkered = reference(&day_only(checkered(1024)), options);
    let white = reference(&plain([255; 3]), options);
    for (distance_m, side) in [(5e8, 4_u32), (3e8, 16), (3e7, 48)] {
        let view = centered(
            DVec3::new(0.8, -0.5, 0.33).normalize() * distance_m,
            2.4 * RADIUS_M / distance_m,
            1.0,
        );
        let sun = sky(DVec3::new(1.0, -0.2, 0.1).normalize());
        let [grey, full] = [&checkered, &white].map(|r| r.render(&view, &sun, (side, side)));
        let mean = sum(&grey, 0) / sum(&full, 0);
        println!("{distance_m:e} m in {side} px: {mean:.5} of white");
        assert!((mean - 0.5).abs() < 2e-3, "{mean}");
        let all = grey.linear.iter().zip(&full.linear).zip(&full.ground);
        for ((grey, full), ground) in all {
            // Well inside the disc each pixel is it too.
            if *ground == 1.0 && full[0] > 0.3 {
                assert!((grey[0] / full[0] - 0.5).abs() < 0.02, "{grey:?} {full:?}");
            }
        }
    }
    // Halves of the Earth: each counts by the area that is seen of it.
    let halves = reference(
        &day_only(map(512, |lat, _| if lat > 0.0 { [255; 3] } else { [0; 3] })),
        options,
    );
    let view = centered(DVec3::X * 5e8, 2.4 * RADIUS_M / 5e8, 1.0);
    let [part, full] = [&halves, &white].map(|r| r.render(&view, &sky(DVec3::X), (5, 5)));
    assert!((sum(&part, 2) / sum(&full, 2) - 0.5).abs() < 2e-3);
}

#[test]
fn a_near_map_is_bilinear_and_has_no_seam() {
    // Random texels, paper's shading with the Sun above the eye: out = earth · 1.1 in display values.
    let (width, height) = (64_i64, 32_i64);
    let texel = |x: i64, y: i64, channel: i64| {
        let mixed = (x * 7919 + y * 104_729 + channel * 31).wrapping_mul(2_654_435_761);
        (mixed >> 7) % 200
    };
    let texels = (0..width * height)
        .flat_map(|i| [0, 1, 2, 3].map(|c| texel(i % width, i / width, c) as u8))
        .collect();
    let day = LayerImage::from_rgba8(64, 32, texels).expect("a map");
    let options = ReferenceOptions {
        figure: Figure::Wgs84,
        shading: Shading::Paper,
        samples: 1,
        ..BARE
    };
    let reference = reference(&day_only(day), options);
    let size = (48, 40);
    for (name, lat, lon) in [
        ("Africa", 10.0, 20.0),
        ("date line", -35.0, 180.0),
        ("date line, west", 12.0, -179.95),
        ("north pole", 89.0, 30.0),
        ("south pole", -87.5, -130.0),
    ] {
        let place = Geodetic::from_degrees(lat, lon, 3e5);
        let view = down(place, 40.0, 1.2);
        let sun = Ellipsoid::normal(place.lat_rad, place.lon_rad);
        let picture = reference.render(&view, &sky(sun), size);
        let mut count = 0;
        for (at, light) in picture.linear.iter().enumerate() {
            let at = DVec2::new((at % 48) as f64 + 0.5, (at / 48) as f64 + 0.5);
            let point = ground_point(&view, Ellipsoid::WGS84, size, at).expect("ground");
            let found = Ellipsoid::WGS84.geodetic_from_itrf(point);
            if found.lat_rad.abs() > 88_f64.to_radians() {
                // There a pixel covers several texels in longitude.
                continue;
            }
            let x = (found.lon_rad / (2.0 * PI) + 0.5) * width as f64 - 0.5;
            let y = (0.5 - found.lat_rad / PI) * height as f64 - 0.5;
            let (i, j) = (x.floor() as i64, y.floor() as i64);
            let (fx, fy) = (x - i as f64, y - j as f64);
            for (channel, light) in (0..).zip(light) {
                let stored = |i: i64, j: i64| {
                    texel(i.rem_euclid(width), j.clamp(0, height - 1), channel) as f64 / 255.0
                };
                let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
                let value = mix(
                    mix(stored(i, j), stored(i + 1, j), fx),
                    mix(stored(i, j + 1), stored(i + 1, j + 1), fx),
                    fy,
                ) * 1.1;
                let linear = if value <= 0.04045 {
                    value / 12.92
                } else {
                    ((value + 0.055) / 1.055).powf(2.4)
                };
                assert!(
                    (f64::from(*light) - linear).abs() < 1e-6,
                    "{name}: {light} {linear}"
                );
            }
            count += 1;
        }
        assert!(count > 100, "{name}: {count}");
    }
}

#[test]
fn a_pixel_is_the_mean_of_its_parts() {
    let layers = day_only(checkered(256));
    let options = |samples| ReferenceOptions {
        atmosphere: Atmosphere::Billboard,
        samples,
        ..BARE
    };
    let view = tilted(
        Geodetic::from_degrees(40.0, -70.0, 8e5),
        200.0,
        -25.0,
        50.0,
        1.5,
    );
    let sun = sky(DVec3::new(0.2, -0.9, 0.5).normalize());
    let small = reference(&layers, options(4)).render(&view, &sun, (24, 16));
    let large = reference(&layers, options(1)).render(&view, &sun, (96, 64));
    for (at, light) in small.linear.iter().enumerate() {
        let (x, y) = (at % 24, at / 24);
        let parts = (0..16).map(|k| large.linear[(4 * y + k / 4) * 96 + 4 * x + k % 4]);
        let mean = parts.fold([0.0; 3], |sum: [f32; 3], part| {
            std::array::from_fn(|c| sum[c] + part[c] / 16.0)
        });
        assert!(
            worst(&[*light], &[mean]) < 1e-5,
            "{x} {y}: {light:?} {mean:?}"
        );
    }
    assert!(
        small.ground.iter().any(|part| (0.1..0.9).contains(part)),
        "no limb in it"
    );
}

#[test]
fn strange_eyes_give_a_defined_picture() {
    let layers = plain([200; 3]);
    for atmosphere in [Atmosphere::None, Atmosphere::Billboard] {
        let options = ReferenceOptions {
            figure: Figure::Wgs84,
            atmosphere,
            ..BARE
        };
        let reference = reference(&layers, options);
        for eye in [
            DVec3::ZERO,
            DVec3::new(3e6, 1e6, 0.0),
            DVec3::new(6_378_136.0, 0.0, 0.0),
            DVec3::new(0.0, 0.0, 6_356_753.4),
            DVec3::new(6.4e6, 0.0, 0.0),
            DVec3::new(0.0, 1e12, 0.0),
            DVec3::new(1e300, 0.0, 0.0),
        ] {
            for forward in [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::ZERO] {
                for fov in [1e-5, 1.0, 3.12] {
                    let view = EyeView::itrf(eye, forward, DVec3::Z, fov, 1.0);
                    let picture = reference.render(&view, &sky(DVec3::X), (6, 6));
                    let is_good = |v: &f32| (0.0..=1.0).contains(v);
                    assert!(
                        picture.linear.iter().flatten().all(is_good),
                        "{eye} {forward} {fov}"
                    );
                    let inside = (eye / Ellipsoid::WGS84.itrf_from_scaled()).length() < 1.0;
                    if inside {
                        assert!(picture.ground.iter().all(|part| *part == 0.0), "{eye}");
                    }
                }
            }
        }
        // Two metres above the ground by day: ground below, and a sky where there is air.
        let view = tilted(Geodetic::from_degrees(0.0, 0.0, 2.0), 90.0, 0.0, 60.0, 1.0);
        let picture = reference.render(&view, &sky(DVec3::X), (8, 8));
        assert_eq!((picture.ground[4], picture.ground[60]), (0.0, 1.0));
        let [red, _, blue] = picture.linear[4];
        assert_eq!(
            blue > 0.05 && blue > red,
            atmosphere == Atmosphere::Billboard
        );
        let good = down(Geodetic::from_degrees(0.0, 0.0, 1e7), 50.0, 1.0);
        let bad_eye = EyeView {
            eye_world: DVec3::new(f64::NAN, 0.0, 0.0),
            ..good
        };
        let bad_projection = EyeView {
            clip_from_view: DMat4::ZERO,
            ..good
        };
        for (view, sun) in [
            (bad_eye, DVec3::X),
            (bad_projection, DVec3::X),
            (good, DVec3::NAN),
        ] {
            let picture = reference.render(&view, &sky(sun), (6, 4));
            assert_eq!(picture.linear, [[0.0; 3]; 24]);
            assert_eq!(picture.ground, [0.0; 24]);
        }
        assert!(
            reference
                .render(&good, &sky(DVec3::X), (0, 7))
                .linear
                .is_empty()
        );
    }
}

#[test]
fn work_can_be_counted_and_stopped() {
    let reference = reference(&plain([200; 3]), BARE);
    let view = down(Geodetic::from_degrees(0.0, 0.0, 1e7), 50.0, 1.0);
    let (rows, stop) = (AtomicU32::new(0), AtomicBool::new(false));
    let count = || {
        rows.fetch_add(1, Ordering::Relaxed);
    };
    let picture = reference.render_with(&view, &sky(DVec3::X), (16, 9), &count, &stop);
    assert!(picture.is_some());
    assert_eq!(rows.load(Ordering::Relaxed), 9);
    let halt = || stop.store(true, Ordering::Relaxed);
    assert_eq!(
        reference.render_with(&view, &sky(DVec3::X), (16, 900), &halt, &stop),
        None
    );
}

#[test]
fn unsound_maps_and_options_are_rejected() {
    let layers = plain([200; 3]);
    for samples in [0, 17] {
        let rejected = Reference::new(&layers, ReferenceOptions { samples, ..BARE });
        assert!(matches!(rejected, Err(ReferenceError::Samples(_))));
    }
    for exposure in [-1.0, f64::NAN, f64::INFINITY] {
        let rejected = Reference::new(&layers, ReferenceOptions { exposure, ..BARE });
        assert!(matches!(rejected, Err(ReferenceError::Exposure(_))));
    }
    let mut short = layers.clone();
    std::sync::Arc::make_mut(&mut short.day.levels)[0].pop();
    assert!(matches!(
        Reference::new(&short, BARE),
        Err(ReferenceError::Layer(_))
    ));
    let mut wrong = layers.clone();
    wrong.clouds = Some(layers.day);
    let rejected = Reference::new(&wrong, BARE).expect_err("a colour map of clouds");
    assert!(rejected.to_string().contains("clouds"), "{rejected}");
}
