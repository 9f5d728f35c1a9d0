//! Tests of the horizon, and of the radii that bound the ground.

use super::*;

#[test]
fn no_ground_in_sight_is_behind_the_horizon() {
    let mut random = Random(1);
    let (mut in_sight, mut hidden, mut culled) = (0, 0, [0; 4]);
    World::all(&mut random, |random, world| {
        for _ in 0..40 {
            let (foot, normal, point) = world.ground(random);
            let clearance_m = world.clearance_m(point);
            let radius_m = 10_f64.powf(random.between(-1.0, 6.0));
            // The point is on the rim of a ball.
            let center = point + random.direction() * radius_m * 0.999;
            let high_m = match random.part() < 0.5 {
                true => world.range.high_m,
                false => world.figure.geodetic_from_itrf(point).height_m,
            };
            let half = random.between(0.0, 0.1);
            let lon = foot.truncate().normalize_or(DVec2::X);
            let rect = ScaledRect {
                lon: DVec2::from_angle(random.between(-half, half)).rotate(lon),
                half_width_rad: half,
                north: DVec2::from_angle(half).rotate(DVec2::new(foot.truncate().length(), foot.z)),
                south: DVec2::from_angle(-half)
                    .rotate(DVec2::new(foot.truncate().length(), foot.z)),
            };
            let axis = (foot + random.direction() * half * 0.5).normalize();
            let hides = [
                world.horizon.hides_point(point),
                world.horizon.hides_ball(center, radius_m, high_m),
                world.horizon.hides_rect(&rect),
                world
                    .horizon
                    .hides_cap(axis, axis.angle_between(foot) + 1e-9),
            ];
            if clearance_m >= 0.0 {
                in_sight += 1;
                assert_eq!(
                    hides, [false; 4],
                    "{clearance_m} m over the ground: {point} with normal {normal} from {} over {:?} of {:?}",
                    world.eye, world.range, world.figure
                );
            } else {
                hidden += 1;
                for (culled, hides) in culled.iter_mut().zip(hides) {
                    *culled += u32::from(hides);
                }
            }
        }
    });
    println!(
        "{in_sight} in sight, {hidden} not; culled as point, ball, rectangle, cap: {culled:?}"
    );
    assert!(in_sight > 5_000 && hidden > 10_000);
    let most = culled.iter().min().is_some_and(|least| 5 * least > hidden);
    assert!(most, "{culled:?} of {hidden}");
}

#[test]
fn without_relief_the_horizon_is_exact() {
    let mut random = Random(2);
    let mut near = 0;
    for figure in FIGURES {
        for height_m in [1e-3, 1.0, 1e3, 4e5, 3.8e8] {
            for _ in 0..200 {
                let up = random.direction();
                let eye = figure.surface_point(up) + up * height_m;
                let horizon = Horizon::new(&figure, eye, GroundShell::SMOOTH);
                let e = eye * figure.scaled_from_itrf();
                let level = e.normalize().any_orthonormal_vector();
                let theta = horizon.limb_rad() * random.between(0.9, 1.1);
                let foot = e.normalize() * theta.cos() + level * theta.sin();
                let point = foot * figure.itrf_from_scaled();
                let is_hidden = foot.dot(e) < 1.0;
                // Distance of the foot from the limb, in rounding errors of its position.
                if (foot.dot(e) - 1.0).abs() < 1e-13 {
                    continue;
                }
                near += 1;
                let rect = ScaledRect {
                    lon: foot.truncate().normalize(),
                    half_width_rad: 0.0,
                    north: DVec2::new(foot.truncate().length(), foot.z),
                    south: DVec2::new(foot.truncate().length(), foot.z),
                };
                assert_eq!(horizon.hides_rect(&rect), is_hidden, "{height_m} {theta}");
                // A ray that grazes the ground misses its middle by less than a rounding error.
                if (theta / horizon.limb_rad() - 1.0).abs() > 0.05 {
                    let hides = horizon.hides_point(point);
                    assert_eq!(hides, is_hidden, "{height_m} {theta}");
                    // The ball needs millimetres of slack.
                    let hides = horizon.hides_ball(point, 1e-3, 0.0);
                    assert!(hides == is_hidden || height_m < 1e3, "{height_m} {theta}");
                }
            }
        }
    }
    assert!(near > 3_000, "{near}");
}

#[test]
fn heights_stay_between_their_radii_and_near_their_feet() {
    let mut random = Random(3);
    for figure in FIGURES {
        for (low_m, high_m) in RANGES {
            let shell = GroundShell::new(&figure, HeightRange { low_m, high_m });
            let (mut least, mut most, mut lean) = (f64::INFINITY, 0.0_f64, 0.0_f64);
            for _ in 0..4_000 {
                let normal = random.direction();
                let height_m = random.between(low_m, high_m);
                let foot = figure.surface_point(normal) * figure.scaled_from_itrf();
                let point =
                    (figure.surface_point(normal) + normal * height_m) * figure.scaled_from_itrf();
                (least, most) = (least.min(point.length()), most.max(point.length()));
                lean = lean.max(point.normalize().distance(foot.normalize()));
                assert!(point.length() >= lowest_radius(&figure, height_m));
                assert!(point.length() <= highest_radius(&figure, height_m));
            }
            assert!(shell.lowest <= least && most <= shell.highest && lean <= shell.lean + 1e-15);
            // The bounds are tight.
            let slack = 0.35 * (high_m - low_m).max(high_m.abs()).max(low_m.abs()) / 4.8e6 + 1e-9;
            assert!(least - shell.lowest < slack && shell.highest - most < slack);
            assert!(shell.lean <= 1.6 * lean + 1e-15, "{} {lean}", shell.lean);
        }
    }
}

#[test]
fn a_ball_is_hidden_by_shadow_or_by_horizon() {
    let figure = Ellipsoid::WGS84;
    let range = HeightRange {
        low_m: 0.0,
        high_m: 9e3,
    };
    let horizon = Horizon::new(&figure, DVec3::X * 7e6, GroundShell::new(&figure, range));
    let at = |theta: f64, height_m: f64| {
        DVec3::new(theta.cos(), theta.sin(), 0.0) * (figure.equatorial_radius_m + height_m)
    };
    // Two degrees beyond the limb: deep in the shadow, but not beyond the horizon for ground of any height.
    let theta = horizon.limb_rad() + 0.035;
    assert!(horizon.hides_ball(at(theta, 0.0), 10.0, 1e6));
    assert!(!horizon.hides_ball(at(theta, 0.0), 1e5, 1e6));
    // A ball that bulges out of the shadow, but has only low ground and is farther than low ground is visible.
    let theta = horizon.limb_rad() + 0.3;
    assert!(horizon.hides_ball(at(theta, 0.0), 1.2e6, 0.0));
    assert!(!horizon.hides_ball(at(theta, 0.0), 1.2e6, 1e6));
    // Ground declared lower than the lowest is treated as the lowest.
    assert!(!horizon.hides_ball(at(horizon.limb_rad() - 1e-3, 0.0), 10.0, -1e5));
}

#[test]
fn the_lowest_height_that_shows_is_where_sight_grazes() {
    let mut random = Random(8);
    for figure in FIGURES {
        for (low_m, high_m) in RANGES {
            let shell = GroundShell::new(&figure, HeightRange { low_m, high_m });
            let eye = figure.surface_point(random.direction()) * 1.1;
            let horizon = Horizon::new(&figure, eye, shell);
            let up = horizon.eye_scaled().normalize();
            let aside = up.any_orthonormal_vector();
            let limb = horizon.limb_rad();
            assert_eq!(horizon.lowest_visible_m(0.9 * limb), f64::NEG_INFINITY);
            assert_eq!(horizon.lowest_visible_m(limb + 1.6), f64::INFINITY);
            for beyond in [1e-4, 0.01, 0.1, 0.5] {
                let reported_m = horizon.lowest_visible_m(limb + beyond);
                let foot = up * (limb + beyond).cos() + aside * (limb + beyond).sin();
                // In scaled space a height is between its fractions of the two radii.
                let grazing = shell.lowest / beyond.cos() - 1.0;
                let (a, b) = (figure.equatorial_radius_m, figure.polar_radius_m);
                let least_m = (grazing * a).min(grazing * b);
                assert!(
                    (reported_m - least_m).abs() < 2e-3,
                    "{reported_m} {least_m}"
                );
                // A point a little below the grazing line of sight is hidden, and a point above it is not.
                for (part, is_hidden) in [(1.0 - 1e-7, true), (1.0 + 1e-7, false)] {
                    let point = foot * (1.0 + grazing) * part * figure.itrf_from_scaled();
                    assert_eq!(horizon.hides_point(point), is_hidden, "{beyond} {part}");
                }
            }
        }
    }
}

#[test]
fn an_eye_under_all_ground_hides_nothing_and_strange_ranges_are_defined() {
    let figure = Ellipsoid::WGS84;
    let rect = ScaledRect {
        lon: DVec2::NEG_X,
        half_width_rad: 0.1,
        north: DVec2::from_angle(0.1),
        south: DVec2::from_angle(-0.1),
    };
    let deep = figure.itrf_from_geodetic(Geodetic::from_degrees(0.0, 0.0, -2e4));
    let below = HeightRange {
        low_m: -11e3,
        high_m: 9e3,
    };
    let nothing = HeightRange {
        low_m: f64::NEG_INFINITY,
        high_m: f64::INFINITY,
    };
    let unknown = HeightRange {
        low_m: f64::NAN,
        high_m: f64::NAN,
    };
    for (eye, range) in [
        (deep, below),
        (DVec3::ZERO, below),
        (DVec3::NAN, below),
        (DVec3::X * 7e6, nothing),
        (DVec3::X * 7e6, unknown),
    ] {
        let horizon = Horizon::new(&figure, eye, GroundShell::new(&figure, range));
        let far = -DVec3::X * 6.3e6;
        assert!(!horizon.hides_ball(far, 1.0, 0.0), "{eye} {range:?}");
        assert!(!horizon.hides_rect(&rect), "{eye} {range:?}");
        assert!(!horizon.hides_cap(DVec3::NEG_X, 0.1), "{eye} {range:?}");
    }
}

#[test]
fn ground_shows_as_far_as_the_law_says() {
    // Brute force: the line from the eye to the top of a mountain intersects the occluder or does not.
    let unit = Ellipsoid {
        equatorial_radius_m: 1.0,
        polar_radius_m: 1.0,
    };
    let far_rad = |length: f64, lowest, highest| {
        let shell = GroundShell {
            lowest,
            highest,
            lean: 0.0,
        };
        Horizon::new(&unit, DVec3::X * length, shell).far_rad()
    };
    for length in [1.0003, 1.002, 1.06, 7.0, 1e4] {
        for (lowest, highest) in [(1.0, 1.0014), (0.9983, 1.0014), (0.999, 0.9995), (1.0, 1.0)] {
            let shows = |theta: f64| {
                let eye = DVec3::X * length;
                let top = DVec3::new(theta.cos(), theta.sin(), 0.0) * highest;
                let along = (top - eye).normalize();
                let nearest = -eye.dot(along);
                let clear = eye.cross(along).length() >= lowest;
                clear || nearest > top.distance(eye)
            };
            let (mut seen, mut hidden) = (0.0, PI);
            for _ in 0..60 {
                let middle = 0.5 * (seen + hidden);
                if shows(middle) {
                    seen = middle;
                } else {
                    hidden = middle;
                }
            }
            let reported = far_rad(length, lowest, highest);
            assert!(
                (reported - seen).abs() < 1e-7,
                "{length} {lowest} {highest}: {reported}, found {seen}"
            );
            let at = |theta: f64| DVec3::new(theta.cos(), theta.sin(), 0.0);
            assert!(
                is_within_angle(at(reported - 1e-6), DVec3::X, reported)
                    && !is_within_angle(at(reported + 1e-6), DVec3::X, reported)
            );
        }
    }
    // Flat ground: the paper's P̂·û ≥ R/L.
    assert!((far_rad(1.06, 1.0, 1.0).cos() - 1.0 / 1.06).abs() < 1e-15);
}

#[test]
fn no_height_leaves_its_shell() {
    let e = Ellipsoid::WGS84;
    for height_m in [-11e3, -1.0, 0.0, 1.0, 9e3] {
        for lat in 0..=900 {
            let at =
                e.itrf_from_geodetic(Geodetic::from_degrees(0.1 * f64::from(lat), 7.0, height_m));
            let radius = (at * e.scaled_from_itrf()).length();
            assert!(
                lowest_radius(&e, height_m) <= radius && radius <= highest_radius(&e, height_m)
            );
        }
    }
}
