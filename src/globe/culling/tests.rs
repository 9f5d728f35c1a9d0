//! Nothing that can be seen is culled, and little that cannot be is kept: against points of ground and lines of sight that are
//! looked at one by one.

use super::horizon::{highest_radius, lowest_radius};
use super::*;
use crate::frames::{Ellipsoid, Geodetic, HeightRange};
use crate::globe::surface::GroundView;
use glam::dcamera::rh::{self, proj::directx};
use glam::{DMat4, DVec2, DVec3, DVec4};
use std::f64::consts::{PI, TAU};

/// The Earth, the paper's sphere, and figures far flatter and longer than any planet's.
const FIGURES: [Ellipsoid; 4] = [
    Ellipsoid::WGS84,
    Ellipsoid::PAPER_SPHERE,
    Ellipsoid {
        equatorial_radius_m: 6.4e6,
        polar_radius_m: 4.8e6,
    },
    Ellipsoid {
        equatorial_radius_m: 6.0e6,
        polar_radius_m: 6.9e6,
    },
];

/// Lowest and highest ground: none, the Earth's, ground that is all below and all above the ellipsoid, and far more.
const RANGES: [(f64, f64); 5] = [
    (0.0, 0.0),
    (-11e3, 9e3),
    (-9e3, -2e3),
    (1e3, 6e3),
    (-1e5, 1e5),
];

/// Above the highest ground, from a metre to the Moon; the negative ones are parts of the way down to the lowest.
const EYES_M: [f64; 9] = [1.0, 100.0, 3e3, 4e4, 4e5, 4e6, 3.8e8, -0.5, -0.95];

/// Numbers that look random, the same in each run.
struct Random(u64);

impl Random {
    fn part(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.part()
    }

    fn direction(&mut self) -> DVec3 {
        let z = self.between(-1.0, 1.0);
        let (sin, cos) = self.between(0.0, TAU).sin_cos();
        (DVec2::new(cos, sin) * (1.0 - z * z).sqrt()).extend(z)
    }
}

struct World {
    figure: Ellipsoid,
    range: HeightRange,
    eye: DVec3,
    horizon: Horizon,
}

impl World {
    /// Of every figure, range and eye, in several directions.
    fn all(random: &mut Random, mut check: impl FnMut(&mut Random, &Self)) {
        for figure in FIGURES {
            for (low_m, high_m) in RANGES {
                let range = HeightRange { low_m, high_m };
                for eye_m in EYES_M {
                    let height_m = match eye_m < 0.0 {
                        true => high_m + eye_m * (low_m - high_m).abs(),
                        false => high_m + eye_m,
                    };
                    for _ in 0..4 {
                        let up = random.direction();
                        let eye = figure.surface_point(up) + up * height_m;
                        let shell = GroundShell::new(&figure, range);
                        let horizon = Horizon::new(&figure, eye, shell);
                        check(
                            random,
                            &Self {
                                figure,
                                range,
                                eye,
                                horizon,
                            },
                        );
                    }
                }
            }
        }
    }

    /// A foot, mostly where the horizon is, its normal, and a point of ground over it.
    fn ground(&self, random: &mut Random) -> (DVec3, DVec3, DVec3) {
        let up = (self.eye * self.figure.scaled_from_itrf()).normalize();
        let aside = up.cross(random.direction()).normalize();
        let far = self.horizon.far_rad().max(1e-3);
        let theta = match random.part() < 0.7 {
            true => far * random.between(0.6, 1.4),
            false => random.between(0.0, PI),
        };
        let foot = up * theta.cos() + aside * theta.sin();
        let normal = (foot * self.figure.scaled_from_itrf()).normalize();
        // Highest ground tells most.
        let part = random.part().sqrt();
        let height_m = self.range.low_m + (self.range.high_m - self.range.low_m) * part;
        let point = self.figure.surface_point(normal) + normal * height_m;
        (foot, normal, point)
    }

    /// How far the line of sight to a point stays above the lowest ground, metres; less than 0 where that hides it.
    ///
    /// Height is the distance from a convex body and so convex along the line: its least is found by thirds.
    fn clearance_m(&self, point: DVec3) -> f64 {
        let along = point - self.eye;
        let above = |t: f64| {
            let place = self.figure.geodetic_from_itrf(self.eye + along * t);
            place.height_m - self.range.low_m
        };
        let (mut from, mut to) = (0.0, 1.0);
        let mut least = above(0.0).min(above(1.0));
        for _ in 0..70 {
            if least < 0.0 {
                break;
            }
            let (one, other) = ((2.0 * from + to) / 3.0, (from + 2.0 * to) / 3.0);
            let (one_m, other_m) = (above(one), above(other));
            least = least.min(one_m).min(other_m);
            match one_m < other_m {
                true => to = other,
                false => from = one,
            }
        }
        least
    }
}

#[test]
fn no_ground_in_sight_is_behind_the_horizon() {
    let mut random = Random(1);
    let (mut in_sight, mut hidden, mut culled) = (0, 0, [0; 4]);
    World::all(&mut random, |random, world| {
        for _ in 0..40 {
            let (foot, normal, point) = world.ground(random);
            let clearance_m = world.clearance_m(point);
            let radius_m = 10_f64.powf(random.between(-1.0, 6.0));
            // The point on the rim of a ball.
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
                // How far the foot is from the limb, in roundings of its place.
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
                // A ray that grazes the ground misses its middle by less than a rounding.
                if (theta / horizon.limb_rad() - 1.0).abs() > 0.05 {
                    let hides = horizon.hides_point(point);
                    assert_eq!(hides, is_hidden, "{height_m} {theta}");
                    // Millimetres of slack for the ball.
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
            // And not by far.
            let slack = 0.35 * (high_m - low_m).max(high_m.abs()).max(low_m.abs()) / 4.8e6 + 1e-9;
            assert!(least - shell.lowest < slack && shell.highest - most < slack);
            assert!(shell.lean <= 1.6 * lean + 1e-15, "{} {lean}", shell.lean);
        }
    }
}

/// A view of some kind in any direction.
fn projection(random: &mut Random, kind: u32) -> DMat4 {
    let view_from_eye = rh::view::look_to_mat4(DVec3::ZERO, random.direction(), random.direction());
    let (fov, aspect) = (random.between(0.05, 2.5), random.between(0.3, 3.0));
    let near = 10_f64.powf(random.between(-1.0, 3.0));
    let clip_from_view = match kind {
        0 => directx::perspective_infinite_reverse(fov, aspect, near),
        1 => directx::perspective(fov, aspect, near, near * 1e3),
        2 => directx::perspective_infinite(fov, aspect, near),
        _ => directx::orthographic(-near, near * aspect, -near, near, -near, 10.0 * near),
    };
    clip_from_view * view_from_eye
}

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
        // Without depth it holds no less, and all that is before the eye between the four sides.
        let sides = frustum.without_depth();
        assert!(kind == Containment::Outside || !sides.excludes_ball(center, radius));
        let clip: DVec4 = clip_from_eye * center.extend(1.0);
        let is_beside = clip.x.abs() > clip.w || clip.y.abs() > clip.w;
        assert_eq!(sides.excludes_ball(center, 0.0), is_beside, "{round}");
        // A step inwards from a side's foot point, along its normal, is inside of it.
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
        let told = rect.max_dot(v);
        assert!(most <= told + 1e-12 * v.length(), "{most} {told}");
        assert!(told - most < 0.01 * v.length(), "{most} {told}");
    }
}

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
    // The far plane cuts the ground off.
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
    // Beyond the limb by two degrees, deep in the shadow, but no horizon for ground of any height.
    let theta = horizon.limb_rad() + 0.035;
    assert!(horizon.hides_ball(at(theta, 0.0), 10.0, 1e6));
    assert!(!horizon.hides_ball(at(theta, 0.0), 1e5, 1e6));
    // A ball that bulges out of the shadow, but has low ground alone, and is farther than this shows.
    let theta = horizon.limb_rad() + 0.3;
    assert!(horizon.hides_ball(at(theta, 0.0), 1.2e6, 0.0));
    assert!(!horizon.hides_ball(at(theta, 0.0), 1.2e6, 1e6));
    // Ground that is told to be lower than all is as the lowest.
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
                let told_m = horizon.lowest_visible_m(limb + beyond);
                let foot = up * (limb + beyond).cos() + aside * (limb + beyond).sin();
                // In scaled space a height is between its parts of the two radii.
                let grazing = shell.lowest / beyond.cos() - 1.0;
                let (a, b) = (figure.equatorial_radius_m, figure.polar_radius_m);
                let least_m = (grazing * a).min(grazing * b);
                assert!((told_m - least_m).abs() < 2e-3, "{told_m} {least_m}");
                // What stands a little lower than sight grazes is hidden, and what is higher is not.
                for (part, is_hidden) in [(1.0 - 1e-7, true), (1.0 + 1e-7, false)] {
                    let point = foot * (1.0 + grazing) * part * figure.itrf_from_scaled();
                    assert_eq!(horizon.hides_point(point), is_hidden, "{beyond} {part}");
                }
            }
        }
    }
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
    // Brute force: the line from the eye to the top of a mountain cuts the occluder or does not.
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
            let told = far_rad(length, lowest, highest);
            assert!(
                (told - seen).abs() < 1e-7,
                "{length} {lowest} {highest}: {told}, found {seen}"
            );
            let at = |theta: f64| DVec3::new(theta.cos(), theta.sin(), 0.0);
            assert!(
                is_within_angle(at(told - 1e-6), DVec3::X, told)
                    && !is_within_angle(at(told + 1e-6), DVec3::X, told)
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

#[test]
fn planes_exclude_a_rectangle_but_not_what_leans_out_of_it() {
    // Upright ground of a very flat figure does not stand along the ray from the centre.
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
