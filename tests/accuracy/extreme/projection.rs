//! From metres to clip space and depth, near plane at 0.1 m and ground up to 1e12 m away.

use glam::{DVec2, DVec3, Vec2};
use terrella::EyeView;
use terrella_measure::numeric::{log_spaced, reversed_depth, standard_depth};

#[test]
fn depth_is_monotone_and_tells_near_from_far() {
    // Distances one rounding of f32 apart never swap; two that differ by a millionth are distinguished from 0.1 m to 1e12 m.
    for distance_m in log_spaced(0.1, 1e12, 40) {
        let near = distance_m as f32;
        let mut farther = near;
        for _ in 0..8 {
            let next = farther.next_up();
            let (a, b) = (
                reversed_depth(f64::from(farther)),
                reversed_depth(f64::from(next)),
            );
            assert!(a >= b, "{farther} m at {a}, {next} m at {b}");
            farther = next;
        }
        let (a, b) = (
            reversed_depth(distance_m),
            reversed_depth(distance_m * (1.0 + 1e-6)),
        );
        assert!(
            a > b && b > 0.0 && a <= 1.000_001,
            "{distance_m} m: {a} {b}"
        );
    }
    // Standard depth does not resolve distances beyond 3355 km = 0.1 m × 2²⁵.
    assert_eq!(standard_depth(4e6), standard_depth(1e12));
    assert!(standard_depth(1e3) == standard_depth(1e3 * (1.0 + 1e-6)));
    assert!(reversed_depth(4e6) > reversed_depth(4.000_01e6));
}

/// Worst distance on screen, pixels of a target of 1000 lines, between points projected in f32 as the GPU does and in f64.
fn worst_px(height_m: f64, fov_rad: f64) -> f64 {
    let eye = DVec3::new(0.3, -0.5, 0.812).normalize() * (6_378_137.0 + height_m);
    let view = EyeView::itrf(eye, -eye, DVec3::Z, fov_rad, 1.6);
    let (_, clip_from_eye) = view.to_itrf();
    let on_gpu = clip_from_eye.as_mat4();
    let from_clip = clip_from_eye.inverse();
    let mut worst = 0.0_f64;
    for k in 0..200 {
        let at = |turn: f64| (f64::from(k) * turn).fract() * 2.0 - 1.0;
        let ray = from_clip * glam::DVec4::new(at(0.618_034), at(0.754_878), 0.5, 1.0);
        let point = ray.truncate().normalize() * height_m * (1.0 + 0.2 * at(0.569_84));
        let gpu = on_gpu * point.as_vec3().extend(1.0);
        let cpu = clip_from_eye * point.extend(1.0);
        let gpu = Vec2::new(gpu.x / gpu.w, gpu.y / gpu.w).as_dvec2();
        let cpu = DVec2::new(cpu.x / cpu.w, cpu.y / cpu.w);
        worst = worst.max(((gpu - cpu) * DVec2::new(800.0, 500.0)).length());
    }
    worst
}

#[test]
fn a_tenth_of_a_pixel_holds_from_a_metre_to_1e12_m_down_to_a_view_of_a_tenth_of_a_degree() {
    for fov_deg in [170.0_f64, 60.0, 10.0, 1.0, 0.1, 0.01, 0.001] {
        let worst = [1.0, 1e3, 4e5, 3.6e7, 1e9, 1e12]
            .map(|height_m| worst_px(height_m, fov_deg.to_radians()))
            .into_iter()
            .fold(0.0, f64::max);
        println!("{fov_deg}°: {worst:.5} px");
        // f32 resolves a direction to 6e-8 rad: a tenth of a pixel where a pixel is 6e-7 rad, 0.035° over 1000 lines.
        if fov_deg >= 0.1 {
            assert!(worst < 0.1, "{fov_deg}°: {worst} px");
        } else {
            assert!(worst < 0.01 / fov_deg, "{fov_deg}°: {worst} px");
        }
    }
}
