//! A point on the ground must not move on screen by more than 0.1 px against a projection in f64.

use crate::common::{Rig, down, plain, tilted};
use glam::{DVec2, Vec2};
use terrella::frames::Geodetic;
use terrella::{Atmosphere, EarthOptions, EyeView};

const SIZE: (u32, u32) = (1280, 720);

/// Largest distance in pixels between the GPU's vertices, projected in f32 as the GPU does, and the exact ones; and
/// how many of them are on screen.
fn worst_px(rig: &mut Rig, view: &EyeView) -> (f64, u32) {
    rig.draw(view, glam::DVec3::X);
    let (eye, clip_from_eye) = view.to_itrf();
    let on_gpu = clip_from_eye.as_mat4();
    let (mut worst, mut count) = (0.0_f64, 0);
    for (from_eye, exact) in rig.earth.diagnostics().vertices() {
        let gpu = on_gpu * from_eye.extend(1.0);
        let cpu = clip_from_eye * (exact - eye).extend(1.0);
        if cpu.w <= 0.0 || cpu.x.abs() > cpu.w || cpu.y.abs() > cpu.w {
            continue;
        }
        let half = DVec2::new(f64::from(SIZE.0), f64::from(SIZE.1)) * 0.5;
        let gpu = Vec2::new(gpu.x / gpu.w, gpu.y / gpu.w).as_dvec2();
        let cpu = DVec2::new(cpu.x / cpu.w, cpu.y / cpu.w);
        worst = worst.max(((gpu - cpu) * half).length());
        count += 1;
    }
    (worst, count)
}

#[test]
fn ground_points_stay_within_a_tenth_of_a_pixel() {
    let mut options = EarthOptions::new(plain([90, 90, 90]));
    options.atmosphere = Atmosphere::None;
    for subdivision in [6, 48] {
        options.subdivision = terrella::Subdivision::Cells(subdivision);
        let mut rig = Rig::new(&options, SIZE);
        let aspect = rig.aspect();
        for height_m in [100.0, 1e4, 4e5, 3.6e7, 3.84e8] {
            let (mut worst, mut count) = (0.0_f64, 0);
            // Vertices are every 22.5°/n: choose places on, beside and between them, poles and date line included.
            for (lat, lon) in [
                (0.0, 0.0),
                (45.0, 90.0),
                (67.5, -180.0),
                (89.9999, 12.0),
                (-22.5, 179.9999),
                (22.5004, 45.0003),
            ] {
                let place = Geodetic::from_degrees(lat, lon, height_m);
                let views = [
                    down(place, 45.0, aspect),
                    tilted(place, 200.0, -3.0, 45.0, aspect),
                    tilted(place, 77.0, -40.0, 10.0, aspect),
                ];
                for view in views {
                    let (px, seen) = worst_px(&mut rig, &view);
                    worst = worst.max(px);
                    count += seen;
                }
            }
            println!("n = {subdivision}, {height_m} m: worst {worst:.4} px over {count} vertices");
            assert!(
                count >= 5,
                "only {count} vertices were on screen at {height_m} m"
            );
            assert!(worst < 0.1, "{worst} px at {height_m} m");
        }
    }
}

#[test]
fn earth_centred_f32_would_fail_the_same_measure() {
    // The same ground points as f32 metres from the Earth's centre: the measure must go red.
    let view = tilted(
        Geodetic::from_degrees(22.5004, 45.0003, 100.0),
        200.0,
        -3.0,
        45.0,
        1280.0 / 720.0,
    );
    let (eye, clip_from_eye) = view.to_itrf();
    let point = eye
        + terrella::frames::Ellipsoid::normal(0.39, 0.78)
            .cross(glam::DVec3::Z)
            .normalize()
            * 200.0
        - eye.normalize() * 100.0;
    let shaken = point.as_vec3().as_dvec3() - eye.as_vec3().as_dvec3();
    let (good, bad) = (
        clip_from_eye * (point - eye).extend(1.0),
        clip_from_eye * shaken.extend(1.0),
    );
    let error =
        (good.truncate() / good.w - bad.truncate() / bad.w).truncate() * DVec2::new(640.0, 360.0);
    assert!(error.length() > 0.1, "{}", error.length());
}
