//! Clouds above the edge of the ground, for an eye outside the air: they continue those in front of the ground.

use crate::common::{Rig, down, gpu, map, ray, tilted};
use glam::DVec3;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::{Atmosphere, EarthOptions, EyeView, FrameRequest, Sky, SurfaceLight};
use terrella_imagery::{EarthLayers, LayerImage};

const SIZE: (u32, u32) = (48, 96);

/// Dark ground under clouds of one cover, or without a map of clouds.
fn rig(cover: Option<u8>, atmosphere: Atmosphere) -> Rig {
    let mut options = EarthOptions::new(EarthLayers {
        day: map(64, |_, _| [40; 3]),
        clouds: cover
            .map(|cover| LayerImage::from_r8(64, 32, vec![cover; 64 * 32]).expect("a sound map")),
        normals: None,
        night_lights: None,
        water: None,
    });
    options.atmosphere = atmosphere;
    options.light = SurfaceLight::PLAIN;
    Rig::of_light(&options, SIZE)
}

/// The limb from this height, with pixels of some 700 m there.
fn view(height_m: f64) -> EyeView {
    let radius_m = 6_378_137.0;
    let dip = (radius_m / (radius_m + height_m)).acos();
    let to_limb_m = (height_m * (2.0 * radius_m + height_m)).sqrt();
    let fov = 700.0 * f64::from(SIZE.1) / to_limb_m;
    let place = Geodetic::from_degrees(10.0, 20.0, height_m);
    tilted(place, 90.0, -dip.to_degrees(), fov.to_degrees(), 0.5)
}

/// Sunlight from high behind the eye.
fn sun() -> DVec3 {
    Ellipsoid::normal(10_f64.to_radians(), -10_f64.to_radians())
}

/// Height of the ray's nearest point above the ground, metres, below 0 where it meets the ground; and red light, along the middle of the image from
/// the ground upwards.
fn across_limb(rig: &mut Rig, view: &EyeView) -> Vec<(f64, f32)> {
    let light = rig.draw_light(view, sun());
    let scale = Ellipsoid::WGS84.itrf_from_scaled();
    let eye = view.eye_world / scale;
    let x = SIZE.0 / 2;
    let rows = (0..SIZE.1).rev().map(|y| {
        let ray = (ray(view, x, y, SIZE) / scale).normalize();
        let nearest = eye.cross(ray).length() - 1.0;
        (6_378_137.0 * nearest, light[(y * SIZE.0 + x) as usize][0])
    });
    rows.collect()
}

/// Light of the last pixel of ground and of the first one of sky.
fn at_edge(rows: &[(f64, f32)]) -> (f32, f32) {
    let sky = rows.iter().position(|(height_m, _)| *height_m > 0.0);
    let sky = sky.expect("there is sky");
    (rows[sky - 1].1, rows[sky].1)
}

#[test]
fn the_edge_of_the_ground_does_not_show_through_clouds() {
    // Without air, clouds let a fifth of the black sky through.
    for (atmosphere, most_step) in [(Atmosphere::Billboard, 0.05), (Atmosphere::None, 0.25)] {
        let mut thick = rig(Some(255), atmosphere);
        for height_m in [200e3, 420e3, 5000e3] {
            let clouded = across_limb(&mut thick, &view(height_m));
            let (ground, sky) = at_edge(&clouded);
            let step = (sky / ground - 1.0).abs();
            println!("{atmosphere:?}, {height_m} m: {ground} to {sky}");
            assert!(
                step < most_step,
                "{atmosphere:?}, {height_m} m: {ground} to {sky}"
            );
            // Above it the light fades without a step, and without air to nothing.
            let fading = clouded.windows(2).filter(|pair| pair[0].0 > 0.0);
            let most = fading.map(|pair| (pair[1].1 - pair[0].1).abs());
            let most = most.fold(0.0, f32::max);
            assert!(
                most < 0.3 * ground,
                "{atmosphere:?}, {height_m} m: {most} {ground}"
            );
            let above = clouded.iter().filter(|(above_m, _)| *above_m > 6500.0);
            let left = above.map(|(_, light)| *light).fold(0.0, f32::max);
            assert_eq!(left > 0.0, atmosphere == Atmosphere::Billboard, "{left}");
        }
    }
}

#[test]
fn a_clear_sky_has_none_and_neither_has_the_air() {
    let atmosphere = Atmosphere::Billboard;
    let (mut bare, mut clear) = (rig(None, atmosphere), rig(Some(0), atmosphere));
    let view_420 = view(420e3);
    assert_eq!(
        across_limb(&mut bare, &view_420),
        across_limb(&mut clear, &view_420)
    );
    // From the edge of the air on they fade in, and the step at the edge of the ground vanishes.
    let mut thick = rig(Some(255), atmosphere);
    let steps = [101e3, 115e3, 130e3, 150e3].map(|height_m| {
        let (ground, sky) = at_edge(&across_limb(&mut thick, &view(height_m)));
        1.0 - sky / ground
    });
    println!("{steps:?}");
    assert!(
        steps.is_sorted_by(|before, after| before > after),
        "{steps:?}"
    );
    assert!(steps[0] > 0.2 && steps[3] < 0.05, "{steps:?}");
}

#[test]
fn they_are_left_out_where_none_can_be_seen() {
    let atmosphere = Atmosphere::Billboard;
    let (mut bare, mut thick) = (rig(None, atmosphere), rig(Some(255), atmosphere));
    let mut more_draws = |view: &EyeView| {
        let sky = Sky::new(sun());
        let [without, with] = [&mut bare, &mut thick].map(|rig| {
            let request = FrameRequest::new(view, &sky, SIZE);
            rig.earth.prepare(&gpu().queue, request).draw_calls
        });
        with - without
    };
    let below =
        |height_m, fov_deg| down(Geodetic::from_degrees(10.0, 20.0, height_m), fov_deg, 0.5);
    assert_eq!(more_draws(&view(420e3)), 1);
    assert_eq!(more_draws(&below(420e3, 40.0)), 0, "no sky");
    assert_eq!(
        more_draws(&below(4e8, 3.0)),
        0,
        "less than a tenth of a pixel"
    );
    assert_eq!(more_draws(&view(90e3)), 0, "in the air");
}
