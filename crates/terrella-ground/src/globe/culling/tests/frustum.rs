//! Tests of the view frustum.

use super::*;

#[test]
fn the_frustum_keeps_every_ball_with_a_point_inside() {
    let mut random = Random(4);
    let mut counts = [0; 3];
    for round in 0..4_000 {
        let clip_from_eye = projection(&mut random, round % 4);
        let frustum = Frustum::new(&clip_from_eye);
        let is_inside = |point: DVec3| {
            let clip: DVec4 = clip_from_eye * point.extend(1.0);
            clip.x.abs() <= clip.w && clip.y.abs() <= clip.w && 0.0 <= clip.z && clip.z <= clip.w
        };
        let center = random.direction() * 10_f64.powf(random.between(-1.0, 4.0));
        let radius = center.length() * random.between(0.0, 1.2);
        let points = (0..60).map(|_| center + random.direction() * radius * 0.999);
        let inside = points.filter(|point| is_inside(*point)).count();
        let kind = frustum.classify_ball(center, radius);
        match kind {
            Containment::Inside => assert_eq!(inside, 60, "{round}"),
            Containment::Intersecting => {}
            Containment::Outside => assert_eq!(inside, 0, "{round}"),
        }
        counts[kind as usize] += 1;
        // Without depth planes it contains no less: everything in front of the eye between the four sides.
        let sides = frustum.without_depth();
        assert!(kind == Containment::Outside || !sides.excludes_ball(center, radius));
        let clip: DVec4 = clip_from_eye * center.extend(1.0);
        let is_beside = clip.x.abs() > clip.w || clip.y.abs() > clip.w;
        assert_eq!(sides.excludes_ball(center, 0.0), is_beside, "{round}");
        // A step inwards from a side's foot point, along its normal, is inside it.
        let [left, right, bottom, top] = sides.side_normals().map(|normal| {
            let moved: DVec4 = clip_from_eye * (normal * 1e-3).extend(0.0);
            moved
        });
        assert!(left.w + left.x > 0.0 && right.w - right.x > 0.0, "{round}");
        assert!(bottom.w + bottom.y > 0.0 && top.w - top.y > 0.0, "{round}");
    }
    assert!(counts.iter().all(|count| *count > 100), "{counts:?}");
}

#[test]
fn planes_at_infinity_and_of_no_numbers_cut_nothing_off() {
    let all_round = DMat4::from_cols(DVec4::ZERO, DVec4::ZERO, DVec4::ZERO, DVec4::W);
    for clip_from_eye in [
        all_round,
        DMat4::ZERO,
        DMat4::NAN,
        DMat4::IDENTITY * f64::INFINITY,
    ] {
        let frustum = Frustum::new(&clip_from_eye);
        for center in [DVec3::ZERO, DVec3::splat(-1e12), DVec3::X] {
            for radius in [0.0, 1.0, 1e9] {
                assert_eq!(frustum.classify_ball(center, radius), Containment::Inside);
            }
        }
        let rect = ScaledRect {
            lon: DVec2::X,
            half_width_rad: 0.1,
            north: DVec2::from_angle(0.2),
            south: DVec2::X,
        };
        let scaled = frustum.scaled(&Ellipsoid::WGS84, DVec3::X * 7e6);
        assert!(!scaled.excludes_rect(&rect, &GroundShell::SMOOTH));
    }
}

#[test]
fn a_rectangle_s_largest_product_is_that_of_its_points() {
    let mut random = Random(5);
    for _ in 0..2_000 {
        let lon = DVec2::from_angle(random.between(-PI, PI));
        let half_width_rad = random.between(0.0, 0.5 * PI);
        let (a, b) = (
            random.between(-0.5 * PI, 0.5 * PI),
            random.between(-0.5 * PI, 0.5 * PI),
        );
        let (south, north) = (a.min(b), a.max(b));
        let rect = ScaledRect {
            lon,
            half_width_rad,
            north: DVec2::from_angle(north),
            south: DVec2::from_angle(south),
        };
        let v = random.direction() * random.between(0.1, 60.0);
        let mut most = f64::NEG_INFINITY;
        for i in 0..=40 {
            for j in 0..=40 {
                let at = |k: i32| f64::from(k) / 40.0;
                let lat = DVec2::from_angle(south + (north - south) * at(i));
                let turn = DVec2::from_angle(half_width_rad * (2.0 * at(j) - 1.0)).rotate(lon);
                most = most.max((turn * lat.x).extend(lat.y).dot(v));
            }
        }
        let reported = rect.max_dot(v);
        assert!(most <= reported + 1e-12 * v.length(), "{most} {reported}");
        assert!(reported - most < 0.01 * v.length(), "{most} {reported}");
    }
}

#[test]
fn planes_exclude_a_rectangle_but_not_what_leans_out_of_it() {
    // Normals of a very flat figure are not along the ray from the centre.
    let figure = FIGURES[2];
    let range = HeightRange {
        low_m: 0.0,
        high_m: 1e5,
    };
    let shell = GroundShell::new(&figure, range);
    let at = DVec2::from_angle(PI / 4.0);
    let rect = ScaledRect {
        lon: DVec2::X,
        half_width_rad: 0.0,
        north: at,
        south: at,
    };
    let foot = DVec3::new(at.x, 0.0, at.y);
    let up = (foot * figure.scaled_from_itrf()).normalize();
    let point = foot * figure.itrf_from_scaled() + up * range.high_m;
    let top = point * figure.scaled_from_itrf();
    let across = (top - foot * top.dot(foot)).normalize();
    let normal = (across * figure.scaled_from_itrf()).normalize();
    let row = normal.extend(0.0);
    let frustum = Frustum::new(&DMat4::from_cols(row, DVec4::ZERO, DVec4::ZERO, row).transpose());
    for (beyond_m, is_excluded) in [(-1.0, false), (1e5, true)] {
        let scaled = frustum.scaled(&figure, point + normal * beyond_m);
        assert_eq!(scaled.excludes_rect(&rect, &shell), is_excluded);
    }
}
