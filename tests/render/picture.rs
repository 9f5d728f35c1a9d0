//! The image compared with the exact ray: right place, right way up, no seams, no holes, halo joined to limb.

use crate::common::{Rig, day_only, down, looks_at, map, plain, ray, tilted};
use glam::{DMat4, DVec3, DVec4};
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::{Atmosphere, EarthOptions, EyeView, Shading, ViewError, Visibility};
use terrella_imagery::{EarthLayers, LayerImage};

const SIZE: (u32, u32) = (320, 180);

/// Waves of latitude and longitude, one a block, and one of longitude around the whole Earth to distinguish blocks. One unit of 255 is 0.04° at the
/// steepest, a ninth of a texel. Display values below saturation after the paper's × 1.1.
fn waves(lat_rad: f64, lon_rad: f64) -> [f64; 3] {
    let wave = |angle: f64| 110.0 + 100.0 * angle.sin();
    [wave(16.0 * lat_rad), wave(16.0 * lon_rad), wave(lon_rad)]
}

fn position_layers() -> EarthLayers {
    let day = map(1024, |lat, lon| {
        waves(lat.to_radians(), lon.to_radians()).map(|v| v.round() as u8)
    });
    day_only(day)
}

/// Views that between them hold both poles, the date line, Greenwich and the limb.
fn views(aspect: f64) -> Vec<(&'static str, EyeView)> {
    let at = Geodetic::from_degrees;
    vec![
        ("north pole", down(at(90.0, 0.0, 2e6), 50.0, aspect)),
        (
            "near the north pole",
            down(at(88.0, 30.0, 4e5), 50.0, aspect),
        ),
        ("south pole", down(at(-90.0, 0.0, 2e6), 50.0, aspect)),
        ("date line", down(at(10.0, 180.0, 1e6), 50.0, aspect)),
        (
            "date line, oblique",
            tilted(at(-40.0, 179.0, 6e5), 80.0, -50.0, 40.0, aspect),
        ),
        ("Greenwich", down(at(50.0, 0.0, 3e6), 50.0, aspect)),
        ("whole disc", down(at(20.0, -100.0, 3e7), 26.0, aspect)),
    ]
}

#[test]
fn every_pixel_looks_where_the_exact_ray_does() {
    let mut options = EarthOptions::new(position_layers());
    options.atmosphere = Atmosphere::None;
    options.shading = Shading::Paper;
    options.subdivision = terrella::Subdivision::Cells(6);
    options.anisotropy = 1;
    let mut rig = Rig::new(&options, SIZE);
    for (name, view) in views(rig.aspect()) {
        let sun = view.eye_world.normalize();
        let (picture, _) = rig.draw(&view, sun);
        let (mut worst, mut count) = (0.0_f64, 0);
        for (x, y, pixel) in picture.enumerate_pixels() {
            let Some(place) = looks_at(&view, x, y, SIZE) else {
                continue;
            };
            let up = Ellipsoid::normal(place.lat_rad, place.lon_rad);
            // Keep off the limb's very edge, where a pixel covers degrees.
            let facing = -up.dot(ray(&view, x, y, SIZE));
            // And off the last texels at a pole.
            if facing < 0.2 || place.lat_rad.abs() > 89.7_f64.to_radians() {
                continue;
            }
            let lit = (up.dot(sun) + 0.3).clamp(0.0, 1.0) * 1.1;
            let want = waves(place.lat_rad, place.lon_rad).map(|v| v * lit);
            for (k, want) in want.into_iter().enumerate() {
                // Where a pixel covers much of a block's wave, filtering flattens it: near a pole, and far away.
                let near_pole = k == 1 && place.lat_rad.abs() > 80_f64.to_radians();
                let far = k < 2 && view.eye_world.length() > 2e7 && facing < 0.8;
                if near_pole || far {
                    continue;
                }
                worst = worst.max((f64::from(pixel.0[k]) - want).abs());
            }
            count += 1;
        }
        println!("{name}: worst {worst:.2} of 255 over {count} pixels");
        assert!(count > 5_000, "{name}: only {count} pixels compared");
        // Half a texel aside is 5 units; rounding of map, mip level and target are 2.
        assert!(worst < 4.0, "{name}: off by {worst} of 255");
    }
}

#[test]
fn the_disc_has_no_holes_and_no_fringe() {
    let mut options = EarthOptions::new(plain([200, 200, 200]));
    options.atmosphere = Atmosphere::None;
    options.shading = Shading::Paper;
    for (subdivision, visibility) in [
        (6, Visibility::Conservative),
        (1, Visibility::Conservative),
        (48, Visibility::Conservative),
    ] {
        options.subdivision = terrella::Subdivision::Cells(subdivision);
        options.visibility = visibility;
        let mut rig = Rig::new(&options, SIZE);
        // A cell's middle is this far below the ellipsoid: only there the limb may be short.
        let sagitta = 6_378_137.0
            * (1.0 - (std::f64::consts::PI / (16.0 * f64::from(subdivision))).cos())
            * 2.1;
        for (name, view) in views(rig.aspect()) {
            let (picture, _) = rig.draw(&view, view.eye_world.normalize());
            for (x, y, pixel) in picture.enumerate_pixels() {
                let direction = ray(&view, x, y, SIZE);
                let scale = Ellipsoid::WGS84.scaled_from_itrf();
                let (e, d) = (view.eye_world * scale, (direction * scale).normalize());
                let lift_m = (e.cross(d).length() - 1.0) * 6_378_137.0;
                let pixel_m = view.eye_world.length() * 3e-3;
                let lit = pixel.0[0] > 20;
                if lift_m < -sagitta - pixel_m && e.dot(d) < 0.0 {
                    assert!(lit, "{name}, n = {subdivision}: a hole at {x}, {y}");
                }
                if lift_m > pixel_m {
                    assert!(
                        !lit,
                        "{name}, n = {subdivision}: drawn outside the limb at {x}, {y}"
                    );
                }
            }
        }
    }
}

/// The paper's three layers: the ground, clouds over it, and the normals that both are lit by.
#[test]
fn the_papers_shading_is_the_printed_formula() {
    let color = [120, 80, 200];
    let cover = 90_u8;
    // Slopes to the east and to the north: none, and two that rotate the normal by 14° and 27°.
    for slopes in [None, Some([0_i8, 32]), Some([-64, 16])] {
        let slope_map = slopes.map(|slopes| {
            let texel = slopes.map(|slope| slope as u8);
            LayerImage::from_slopes(64, 32, texel.repeat(64 * 32)).unwrap()
        });
        let layers = EarthLayers {
            day: map(64, |_, _| color),
            clouds: Some(LayerImage::from_r8(64, 32, vec![cover; 64 * 32]).unwrap()),
            normals: slope_map,
            night_lights: None,
            water: None,
        };
        let [east, north] = slopes
            .unwrap_or_default()
            .map(|slope| f64::from(slope) / 127.0);
        let mut options = EarthOptions::new(layers);
        options.atmosphere = Atmosphere::None;
        options.shading = Shading::Paper;
        options.subdivision = terrella::Subdivision::Cells(48);
        let mut rig = Rig::new(&options, SIZE);
        let view = down(Geodetic::from_degrees(15.0, 25.0, 2e7), 30.0, rig.aspect());
        let sun = Ellipsoid::normal(0.2, 1.7);
        let (picture, _) = rig.draw(&view, sun);
        let mut shades = [0; 3];
        let mut turned = 0;
        for (x, y, pixel) in picture.enumerate_pixels() {
            let Some(place) = looks_at(&view, x, y, SIZE) else {
                continue;
            };
            let up = Ellipsoid::normal(place.lat_rad, place.lon_rad);
            if up.dot(ray(&view, x, y, SIZE)) > -0.2 {
                continue;
            }
            let east_axis = DVec3::Z.cross(up).normalize();
            let n = (up - east * east_axis - north * up.cross(east_axis)).normalize();
            let lit = |n: DVec3| (n.dot(sun) + 0.3).clamp(0.0, 1.0) * 1.1;
            let ninfo = lit(n);
            turned += usize::from((ninfo - lit(up)).abs() > 0.05);
            shades[if ninfo == 0.0 {
                0
            } else if ninfo < 1.1 {
                1
            } else {
                2
            }] += 1;
            for (channel, color) in pixel.0.into_iter().zip(color) {
                let blend =
                    1.0 - (1.0 - f64::from(color) / 255.0) * (1.0 - f64::from(cover) / 255.0);
                let want = (blend * ninfo * 255.0).min(255.0);
                assert!(
                    (f64::from(channel) - want).abs() < 2.5,
                    "{slopes:?}: {x}, {y}: {:?} instead of {want}",
                    pixel.0
                );
            }
        }
        assert!(
            shades.iter().all(|count| *count > 40),
            "night, dusk and full day must all be in the picture: {shades:?}"
        );
        assert_eq!(slopes.is_some(), turned > 1_000, "{slopes:?}: {turned}");
    }
}

#[test]
fn the_sunlit_side_is_lit_and_the_night_is_dark() {
    let mut options = EarthOptions::new(plain([128, 128, 128]));
    options.subdivision = terrella::Subdivision::Cells(24);
    // Single pixels are compared.
    options.light.detail = false;
    for atmosphere in [Atmosphere::None, Atmosphere::Billboard] {
        options.atmosphere = atmosphere;
        let mut rig = Rig::new(&options, SIZE);
        let view = down(Geodetic::from_degrees(0.0, 0.0, 2e7), 30.0, rig.aspect());
        // The Sun is above 90° E: right half of the image.
        let (picture, _) = rig.draw(&view, DVec3::Y);
        let level = |x: u32| f64::from(picture.get_pixel(x, SIZE.1 / 2).0[1]);
        assert!(level(205) > 90.0, "day {}", level(205));
        assert!(level(115) < 2.0, "night {}", level(115));
        // Soft: the terminator is a slope, not a step, and it rises from night to day.
        let middle: Vec<_> = (150..175).map(level).collect();
        assert!(
            middle
                .windows(2)
                .all(|w| w[1] >= w[0] - 1.0 && w[1] - w[0] < 30.0),
            "{middle:?}"
        );
    }
}

#[test]
fn halo_and_limb_meet_at_every_distance() {
    let mut options = EarthOptions::new(plain([60, 60, 60]));
    options.subdivision = terrella::Subdivision::Cells(48);
    let mut rig = Rig::new(&options, (160, 160));
    for height_m in [1.0e5, 1.0001e5, 2e5, 4e5, 2e6, 7e6, 3.6e7, 3.84e8] {
        for lat in [0.0, 45.0, 90.0] {
            // Look at the limb with a field of view of eight air thicknesses.
            let place = Geodetic::from_degrees(lat, 10.0, height_m);
            let eye = Ellipsoid::WGS84.itrf_from_geodetic(place);
            let scale = Ellipsoid::WGS84.itrf_from_scaled();
            let e = eye / scale;
            let l = e.length();
            let across = e.normalize().any_orthonormal_vector();
            // The tangent point of the limb in scaled space, and back.
            let foot = e / (l * l) + across * ((l - 1.0) * (l + 1.0)).sqrt() / l;
            let limb = foot * scale - eye;
            let up = Ellipsoid::WGS84
                .surface_point((foot / scale).normalize())
                .normalize();
            let fov = 2.0 * (4e5 / limb.length()).atan().min(0.6);
            let view = EyeView::itrf(eye, limb, up, fov, 1.0);
            let sun = (up - limb.normalize() * 0.2).normalize();
            let (picture, _) = rig.draw(&view, sun);
            // Up the middle column: ground, then air that fades outwards, and never a dark gap between.
            let column: Vec<f64> = (0..160)
                .rev()
                .map(|y| {
                    let p = picture.get_pixel(80, y).0;
                    f64::from(p[2]).max(f64::from(p[1]))
                })
                .collect();
            let last_lit = column.iter().rposition(|v| *v > 12.0).expect("some light");
            assert!(
                column[..last_lit].iter().all(|v| *v > 12.0),
                "{height_m} m, {lat}°: a gap in {column:?}"
            );
            // The halo reaches above the limb, which is the middle of the picture, by tens of kilometres.
            let px_m = 2.0 * limb.length() * (0.5 * fov).tan() / 160.0;
            let reach_km = (last_lit as f64 - 79.5) * px_m / 1e3;
            assert!(
                (15.0..110.0).contains(&reach_km),
                "{height_m} m, {lat}°: the halo reaches {reach_km} km"
            );
        }
    }
}

#[test]
fn the_air_is_continuous_where_the_eye_enters_it() {
    let mut options = EarthOptions::new(plain([60, 60, 60]));
    options.subdivision = terrella::Subdivision::Cells(48);
    let mut rig = Rig::new(&options, SIZE);
    let mut at = |height_m: f64| {
        let view = tilted(
            Geodetic::from_degrees(10.0, 10.0, height_m),
            90.0,
            -12.0,
            50.0,
            16.0 / 9.0,
        );
        rig.draw(&view, Ellipsoid::normal(0.3, 0.9)).0
    };
    // In scaled space the boundary is at 100 km / a above every latitude.
    let (inside, outside) = (at(99_600.0), at(100_400.0));
    let worst = inside
        .iter()
        .zip(outside.iter())
        .map(|(a, b)| a.abs_diff(*b))
        .max()
        .unwrap();
    let mean = inside
        .iter()
        .zip(outside.iter())
        .map(|(a, b)| f64::from(a.abs_diff(*b)))
        .sum::<f64>()
        / inside.len() as f64;
    println!("across the boundary: worst {worst}, mean {mean:.2} of 255");
    assert!(worst <= 24 && mean < 3.0, "worst {worst}, mean {mean}");
}

#[test]
fn strange_eyes_give_a_defined_picture() {
    let mut rig = Rig::new(&EarthOptions::new(plain([60, 60, 60])), (64, 64));
    let eyes = [
        DVec3::ZERO,
        DVec3::new(0.0, 0.0, 6_356_752.0),
        DVec3::new(6_378_136.0, 0.0, 0.0),
        DVec3::new(3e6, 1e6, 0.0),
        DVec3::new(1e12, 0.0, 0.0),
        DVec3::new(0.0, 0.0, 6_356_753.4),
    ];
    for eye in eyes {
        for forward in [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::ZERO] {
            for fov in [1e-5, 1.0, 3.12] {
                let view = EyeView::itrf(eye, forward, DVec3::Z, fov, 1.0);
                let (first, _) = rig.draw(&view, DVec3::X);
                let (again, _) = rig.draw(&view, DVec3::X);
                assert_eq!(
                    first, again,
                    "not repeatable: eye {eye}, forward {forward}, fov {fov}"
                );
            }
        }
    }
    // Non-finite input draws nothing, and the Earth recovers from it.
    let good = down(Geodetic::from_degrees(0.0, 0.0, 2e7), 30.0, 1.0);
    let (expected, _) = rig.draw(&good, DVec3::X);
    let bad = EyeView {
        eye_world: DVec3::new(f64::NAN, 0.0, 0.0),
        ..good
    };
    let cases = [(bad, DVec3::X), (good, DVec3::NAN)];
    for (view, sun) in cases {
        let (picture, stats) = rig.draw(&view, sun);
        assert!(picture.pixels().all(|p| p.0[..3] == [0, 0, 0]));
        assert_eq!((stats.blocks_drawn, stats.draw_calls), (0, 0));
        assert!(stats.texture_bytes > 0);
    }
    assert_eq!(rig.draw(&good, DVec3::X).0, expected);
    // The day side from 2 m above the ground is neither black nor overexposed.
    let view = tilted(Geodetic::from_degrees(0.0, 0.0, 2.0), 90.0, 5.0, 60.0, 1.0);
    let (sky, _) = rig.draw(&view, DVec3::X);
    let p = sky.get_pixel(32, 10).0;
    assert!(p[2] > 60 && p[2] > p[0], "a daytime sky is blue: {p:?}");
}

#[test]
fn views_that_cannot_be_drawn_are_named_and_not_drawn() {
    let mut rig = Rig::new(&EarthOptions::new(plain([120; 3])), (32, 32));
    let good = down(Geodetic::from_degrees(0.0, 0.0, 2e7), 30.0, 1.0);
    let project = |change: DMat4| EyeView {
        clip_from_view: change * good.clip_from_view,
        ..good
    };
    let world = |scale: DVec3| EyeView {
        itrf_from_world: glam::DAffine3::from_scale(scale),
        ..good
    };
    let orthographic = EyeView {
        clip_from_view: DMat4::from_diagonal(DVec4::new(1e-7, 1e-7, 1e-8, 1.0)),
        ..good
    };
    let nowhere = EyeView {
        eye_world: DVec3::NAN,
        ..good
    };
    for (view, wrong) in [
        (orthographic, ViewError::Projection),
        (project(DMat4::ZERO), ViewError::Projection),
        (
            project(DMat4::from_scale(DVec3::new(1.0, -1.0, 1.0))),
            ViewError::Mirrored,
        ),
        (world(DVec3::new(1.0, 1.0, -1.0)), ViewError::World),
        (world(DVec3::new(1.0, 1.1, 1.0)), ViewError::World),
        (nowhere, ViewError::NotFinite),
    ] {
        assert_eq!(view.check(), Err(wrong));
        let (picture, stats) = rig.draw(&view, DVec3::X);
        assert!(picture.pixels().all(|p| p.0[..3] == [0; 3]), "{wrong}");
        assert_eq!((stats.blocks_drawn, stats.draw_calls), (0, 0), "{wrong}");
    }
    // An off-centre image, and a world in kilometres whose rotation is that of single precision.
    let mut off_centre = good;
    off_centre.clip_from_view.z_axis.x = 0.3;
    let turn = glam::Quat::from_rotation_z(0.3).as_dquat();
    let turned = EyeView {
        eye_world: turn.inverse() * good.eye_world / 1000.0,
        view_from_world: good.view_from_world * turn,
        itrf_from_world: glam::DAffine3::from_scale_rotation_translation(
            DVec3::splat(1000.0),
            turn,
            DVec3::ZERO,
        ),
        ..good
    };
    for view in [good, off_centre, turned] {
        assert_eq!(view.check(), Ok(()));
        assert!(rig.draw(&view, DVec3::X).1.blocks_drawn > 0);
    }
}
