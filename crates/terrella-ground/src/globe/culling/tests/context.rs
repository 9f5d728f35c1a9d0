//! Frustum, horizon and faces combined, as surfaces use them for culling.

use super::*;

#[test]
fn a_context_keeps_all_that_is_in_the_picture_and_in_sight() {
    let mut random = Random(6);
    let (mut seen, mut kept, mut outside, mut behind) = (0, 0, 0, 0);
    World::all(&mut random, |random, world| {
        let view = GroundView {
            eye_itrf_m: world.eye,
            clip_from_eye: projection(random, 0),
            pixel_rad: 1e-3,
            tolerance_px: 1.0,
        };
        let context = CullingContext::new(&view, &world.figure, world.range);
        let scaled = Frustum::new(&view.clip_from_eye).scaled(&world.figure, world.eye);
        for _ in 0..20 {
            let (foot, _, point) = world.ground(random);
            let clip: DVec4 = view.clip_from_eye * (point - world.eye).extend(1.0);
            let is_inside = clip.x.abs() <= clip.w && clip.y.abs() <= clip.w && clip.z <= clip.w;
            let radius_m = 10_f64.powf(random.between(-1.0, 5.0));
            let bound = GroundBound {
                center_itrf_m: point + random.direction() * radius_m * 0.999,
                radius_m,
                high_m: world.figure.geodetic_from_itrf(point).height_m,
            };
            assert!(context.distance_m(&bound) <= point.distance(world.eye) * (1.0 + 1e-12) + 1e-6);
            let rect = ScaledRect {
                lon: foot.truncate().normalize_or(DVec2::X),
                half_width_rad: 0.0,
                north: DVec2::new(foot.truncate().length(), foot.z),
                south: DVec2::new(foot.truncate().length(), foot.z),
            };
            let shell = GroundShell::new(&world.figure, world.range);
            let visibility = context.visibility(&bound);
            if is_inside && clip.z >= 0.0 {
                assert_ne!(visibility, BoundVisibility::OutsideFrustum);
                assert!(!scaled.excludes_rect(&rect, &shell));
                if world.clearance_m(point) >= 0.0 {
                    seen += 1;
                    assert!(visibility.is_visible());
                }
            }
            match visibility {
                BoundVisibility::OutsideFrustum => outside += 1,
                BoundVisibility::BehindHorizon => behind += 1,
                _ => kept += 1,
            }
        }
    });
    println!("{seen} points seen; {kept} bounds kept, {outside} outside, {behind} behind");
    assert!(seen > 300 && kept > 300 && outside > 2_000 && behind > 3_000);
}

#[test]
fn a_context_tells_all_that_is_inside_and_forgets_depth_alone() {
    let figure = Ellipsoid::WGS84;
    let eye = DVec3::X * 7e6;
    let view_from_eye = rh::view::look_to_mat4(DVec3::ZERO, DVec3::NEG_X, DVec3::Z);
    // The far plane clips the ground.
    let view = GroundView {
        eye_itrf_m: eye,
        clip_from_eye: directx::perspective(1.0, 1.5, 1e3, 1e5) * view_from_eye,
        pixel_rad: 1e-3,
        tolerance_px: 1.0,
    };
    let range = HeightRange {
        low_m: 0.0,
        high_m: 9e3,
    };
    let context = CullingContext::new(&view, &figure, range);
    let bound = |x: f64, y: f64, radius_m: f64| GroundBound {
        center_itrf_m: DVec3::new(x, y, 0.0),
        radius_m,
        high_m: 9e3,
    };
    let (ground, near) = (bound(6.378e6, 0.0, 1e3), bound(6.95e6, 0.0, 1e3));
    let (aside, huge) = (bound(6.378e6, 1.5e6, 1e3), bound(6.378e6, 0.0, 1e6));
    assert_eq!(context.visibility(&near), BoundVisibility::Inside);
    assert_eq!(context.visibility(&ground), BoundVisibility::OutsideFrustum);
    assert_eq!(context.visibility(&huge), BoundVisibility::Intersecting);
    let deep = context.without_depth();
    assert_eq!(deep.visibility(&ground), BoundVisibility::Inside);
    assert_eq!(deep.visibility(&aside), BoundVisibility::OutsideFrustum);
    let behind = bound(-6.378e6, 0.0, 1e3);
    assert_eq!(deep.visibility(&behind), BoundVisibility::BehindHorizon);
    // The eye is in the ball, and far above its ground.
    let above_m = 7e6 - figure.equatorial_radius_m - 9e3;
    assert!((context.distance_m(&huge) - above_m).abs() < 1e-3);
    assert_eq!((deep.eye_itrf_m, deep.pixel_rad), (eye, 1e-3));
    assert_eq!(deep.distance_m(&huge), context.distance_m(&huge));
}

#[test]
fn faces_that_turn_to_the_eye_are_kept() {
    let mut random = Random(7);
    let (mut away, mut facing) = (0, 0);
    let view = GroundView {
        eye_itrf_m: DVec3::new(7e6, 1e5, -2e5),
        clip_from_eye: DMat4::ZERO,
        pixel_rad: 1e-3,
        tolerance_px: 1.0,
    };
    let ground = HeightRange {
        low_m: 0.0,
        high_m: 0.0,
    };
    let context = CullingContext::new(&view, &Ellipsoid::WGS84, ground);
    for _ in 0..4_000 {
        let bound = GroundBound {
            center_itrf_m: view.eye_itrf_m + random.direction() * 1e6,
            radius_m: random.between(0.0, 1.1e6),
            high_m: 0.0,
        };
        let normals = NormalCone {
            axis: random.direction(),
            half_angle_rad: random.between(0.0, 1.0),
        };
        let is_backfacing = context.is_backfacing(&bound, &normals);
        for _ in 0..40 {
            let point = bound.center_itrf_m + random.direction() * bound.radius_m;
            let tilt = normals.axis.cross(random.direction()).normalize();
            let (sin, cos) = normals.half_angle_rad.sin_cos();
            let normal = normals.axis * cos + tilt * sin;
            let is_facing = normal.dot(view.eye_itrf_m - point) > 0.0;
            assert!(!(is_backfacing && is_facing));
            facing += u32::from(is_facing);
        }
        away += u32::from(is_backfacing);
    }
    assert!(away > 300 && facing > 10_000, "{away} {facing}");
}
