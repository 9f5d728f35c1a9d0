//! Each camera, tested through the matrices that the renderer gets.

use super::*;
use glam::{DVec2, DVec4};
use terrella::EyeView;

const WGS84: Ellipsoid = Ellipsoid::WGS84;
const ASPECT: f64 = 16.0 / 9.0;

/// Screen position of an ITRF point: x right and y up, ±1 at the edges; `None` behind the eye.
fn screen(view: &EyeView, point_itrf_m: DVec3) -> Option<DVec2> {
    let p = view.view_from_world * (point_itrf_m - view.eye_world);
    let clip = view.clip_from_view * DVec4::new(p.x, p.y, p.z, 1.0);
    (clip.w > 0.0).then(|| DVec2::new(clip.x / clip.w, clip.y / clip.w))
}

/// A satellite above a place that flies level on a bearing (degrees clockwise from north).
fn over(lat_deg: f64, lon_deg: f64, height_m: f64, bearing_deg: f64) -> OrbitalMotion {
    let place = Geodetic::from_degrees(lat_deg, lon_deg, height_m);
    let north = north_of(place);
    let east = north.cross(Ellipsoid::normal(place.lat_rad, place.lon_rad));
    let (sin, cos) = bearing_deg.to_radians().sin_cos();
    OrbitalMotion {
        position_itrf_m: WGS84.itrf_from_geodetic(place),
        velocity_m_s: 7_700.0 * (cos * north + sin * east),
    }
}

/// The ground below, a few kilometres on in a direction.
fn ground_towards(motion: &OrbitalMotion, direction: DVec3) -> DVec3 {
    let foot = Geodetic {
        height_m: 0.0,
        ..motion.place(&WGS84)
    };
    let point = WGS84.itrf_from_geodetic(foot) + 5_000.0 * direction.normalize();
    WGS84.itrf_from_geodetic(Geodetic {
        height_m: 0.0,
        ..WGS84.geodetic_from_itrf(point)
    })
}

fn assert_sound(pose: &Pose, what: &str) {
    assert!(pose.eye_itrf_m.is_finite(), "{what}: {pose:?}");
    assert!(
        (pose.forward.length() - 1.0).abs() < 1e-12,
        "{what}: {pose:?}"
    );
    assert!((pose.up.length() - 1.0).abs() < 1e-12, "{what}: {pose:?}");
    assert!(pose.forward.dot(pose.up).abs() < 1e-12, "{what}: {pose:?}");
    let view = pose.view(1e-5, ASPECT);
    assert!(view.clip_from_view.is_finite(), "{what}: {view:?}");
    assert!(view.view_from_world.is_finite(), "{what}: {view:?}");
}

#[test]
fn nadir_has_the_sub_satellite_point_in_the_middle_and_flight_upwards() {
    for (lat, lon, bearing) in [(0.0, 0.0, 40.0), (51.6, -75.0, 90.0), (-80.0, 179.9, 200.0)] {
        let motion = over(lat, lon, 420_000.0, bearing);
        let view = Pose::nadir(&motion, CameraUp::Flight, &WGS84).view(45f64.to_radians(), ASPECT);
        let foot = WGS84.itrf_from_geodetic(Geodetic::from_degrees(lat, lon, 0.0));
        let at = screen(&view, foot).expect("the ground is ahead");
        assert!(at.length() < 1e-9, "{lat} {lon}: {at}");
        let ahead = screen(&view, ground_towards(&motion, motion.velocity_m_s)).expect("ahead");
        assert!(
            ahead.y > 1e-3 && ahead.x.abs() < 1e-4,
            "{lat} {lon}: {ahead}"
        );
        // Objects to the right of the flight direction are on the right of the image.
        let right = motion.velocity_m_s.cross(motion.position_itrf_m);
        let right = screen(&view, ground_towards(&motion, right)).expect("right");
        assert!(right.x > 1e-3, "{lat} {lon}: {right}");
    }
}

#[test]
fn nadir_can_have_north_upwards() {
    let motion = over(20.0, -75.2, 35_786_000.0, 90.0);
    let view = Pose::nadir(&motion, CameraUp::North, &WGS84).view(0.3, ASPECT);
    let place = |lat, lon| WGS84.itrf_from_geodetic(Geodetic::from_degrees(lat, lon, 0.0));
    let north = screen(&view, place(30.0, -75.2)).expect("the north is ahead");
    let east = screen(&view, place(20.0, -65.0)).expect("the east is ahead");
    assert!(north.y > 1e-3 && north.x.abs() < 1e-9, "{north}");
    assert!(east.x > 1e-3, "{east}");
}

#[test]
fn geodetic_has_north_up_and_east_right() {
    for (lat, lon) in [
        (0.0, 0.0),
        (47.0, 8.0),
        (-33.0, 151.0),
        (89.0, -120.0),
        (10.0, 180.0),
    ] {
        let place = Geodetic::from_degrees(lat, lon, 2_000_000.0);
        let view = Pose::geodetic(place, &WGS84).view(60f64.to_radians(), ASPECT);
        let ground = |dlat: f64, dlon: f64| {
            let g = Geodetic::from_degrees(lat + dlat, lon + dlon, 0.0);
            screen(&view, WGS84.itrf_from_geodetic(g)).expect("ahead")
        };
        assert!(ground(0.0, 0.0).length() < 1e-9, "{lat} {lon}");
        assert!(
            ground(0.5, 0.0).y > 1e-3 && ground(0.5, 0.0).x.abs() < 1e-9,
            "{lat} {lon}"
        );
        assert!(ground(0.0, 0.5).x > 1e-5, "{lat} {lon}");
    }
}

#[test]
fn a_place_can_be_looked_from_to_any_side() {
    for (lat, lon) in [(0.0, 0.0), (37.5, -105.2), (-80.0, 179.9), (90.0, 30.0)] {
        let place = Geodetic::from_degrees(lat, lon, 5_000.0);
        let down = Pose::geodetic(place, &WGS84);
        let same = down.facing(0.0, -std::f64::consts::FRAC_PI_2);
        assert!(same.forward.distance(down.forward) < 1e-15 && same.up.distance(down.up) < 1e-15);
        let vertical = Ellipsoid::normal(place.lat_rad, place.lon_rad);
        let north = north_of(place);
        let east = north.cross(vertical);
        for (heading, pitch, to) in [
            (0.0, 0.0, north),
            (90.0, 0.0, east),
            (270.0, 0.0, -east),
            (180.0, -30.0, -north * 0.75_f64.sqrt() - 0.5 * vertical),
            (45.0, 90.0, vertical),
        ] {
            let pose = down.facing(f64::to_radians(heading), f64::to_radians(pitch));
            assert_sound(&pose, "turned");
            assert!(
                pose.forward.distance(to) < 1e-14,
                "{heading} {pitch}: {pose:?}"
            );
            // The horizon is level: nothing to the right is up or down.
            let right = pose.forward.cross(pose.up);
            assert!(
                right.dot(vertical).abs() < 1e-14,
                "{heading} {pitch}: {pose:?}"
            );
        }
    }
}

#[test]
fn geodetic_at_the_poles_is_the_limit_of_its_meridian() {
    for sign in [1.0, -1.0] {
        for lon in [0.0, 90.0, -135.0, 180.0] {
            let pole = Pose::geodetic(Geodetic::from_degrees(sign * 90.0, lon, 1e6), &WGS84);
            let near = Pose::geodetic(Geodetic::from_degrees(sign * 89.999, lon, 1e6), &WGS84);
            assert_sound(&pole, "pole");
            assert!(pole.up.distance(near.up) < 1e-4, "{lon}: {pole:?} {near:?}");
            assert!(pole.eye_itrf_m.distance(near.eye_itrf_m) < 200.0, "{lon}");
        }
    }
}

/// The limb ahead, found by brute force: the lowest direction in the vertical plane of flight that misses the
/// ellipsoid, by bisection.
fn limb_direction(motion: &OrbitalMotion) -> DVec3 {
    let place = motion.place(&WGS84);
    let vertical = Ellipsoid::normal(place.lat_rad, place.lon_rad);
    let ahead = motion.ahead(place);
    let scale = WGS84.scaled_from_itrf();
    let e = scale * motion.position_itrf_m;
    let misses = |dip: f64| {
        let d = (scale * (dip.cos() * ahead - dip.sin() * vertical)).normalize();
        let nearest = e - d * e.dot(d);
        e.dot(d) >= 0.0 || nearest.length() > 1.0
    };
    let (mut high, mut low) = (0.0, std::f64::consts::FRAC_PI_2);
    for _ in 0..60 {
        let middle = 0.5 * (high + low);
        if misses(middle) {
            high = middle
        } else {
            low = middle
        }
    }
    high.cos() * ahead - high.sin() * vertical
}

#[test]
fn horizon_has_the_limb_a_third_from_the_top() {
    for height_m in [1_000.0, 420_000.0, 20_000_000.0, 384_000_000.0] {
        for (lat, bearing) in [(0.0, 0.0), (45.0, 0.0), (45.0, 90.0), (-70.0, 30.0)] {
            for fov in [1.0, 60.0, 120.0] {
                let motion = over(lat, 17.0, height_m, bearing);
                let fov = f64::to_radians(fov);
                let pose = Pose::horizon(&motion, &WGS84, fov);
                assert_sound(&pose, "horizon");
                let point = motion.position_itrf_m + 1e6 * limb_direction(&motion);
                let at = screen(&pose.view(fov, ASPECT), point).expect("ahead");
                assert!(
                    (at.y - 1.0 / 3.0).abs() < 1e-6,
                    "{height_m} {lat} {bearing} {fov}: {at}"
                );
                assert!(at.x.abs() < 1e-9, "{height_m} {lat}: {at}");
            }
        }
    }
}

#[test]
fn chase_has_the_satellite_in_the_middle_and_the_earth_below() {
    let motion = over(30.0, 10.0, 420_000.0, 60.0);
    let pose = Pose::chase(&motion, &WGS84);
    assert_sound(&pose, "chase");
    let view = pose.view(45f64.to_radians(), ASPECT);
    let at = screen(&view, motion.position_itrf_m).expect("ahead");
    assert!(at.length() < 1e-6, "{at}");
    let distance = pose.eye_itrf_m.distance(motion.position_itrf_m);
    assert!((distance - CHASE_DISTANCE_M).abs() < 1e-6);
    // Behind and above.
    let offset = pose.eye_itrf_m - motion.position_itrf_m;
    assert!(offset.dot(motion.velocity_m_s) < 0.0 && offset.dot(motion.position_itrf_m) > 0.0);
    // A point of the Earth far ahead is seen below the satellite.
    let ground = ground_towards(&motion, motion.velocity_m_s);
    let to_ground = ground - pose.eye_itrf_m;
    assert!(to_ground.dot(pose.up) < 0.0);
}

#[test]
fn a_motion_without_direction_looks_north() {
    let still = OrbitalMotion {
        velocity_m_s: DVec3::ZERO,
        ..over(20.0, 30.0, 400_000.0, 0.0)
    };
    let place = still.place(&WGS84);
    let radial = OrbitalMotion {
        velocity_m_s: 7_000.0 * Ellipsoid::normal(place.lat_rad, place.lon_rad),
        ..still
    };
    let centre = OrbitalMotion {
        position_itrf_m: DVec3::ZERO,
        velocity_m_s: DVec3::ZERO,
    };
    for motion in [still, radial] {
        assert!(
            Pose::nadir(&motion, CameraUp::Flight, &WGS84)
                .up
                .distance(north_of(place))
                < 1e-12
        );
    }
    for motion in [
        still,
        radial,
        centre,
        over(90.0, 0.0, 4e5, 0.0),
        over(0.0, 0.0, -1e3, 0.0),
    ] {
        for fov in [1e-5, 1.0, 3.1] {
            assert_sound(&Pose::nadir(&motion, CameraUp::Flight, &WGS84), "nadir");
            assert_sound(&Pose::horizon(&motion, &WGS84, fov), "horizon");
            assert_sound(&Pose::chase(&motion, &WGS84), "chase");
        }
    }
}

#[test]
fn the_head_turns_right_and_up_and_the_view_narrows() {
    let pose = Pose::nadir(&over(0.0, 0.0, 4e5, 0.0), CameraUp::Flight, &WGS84);
    let right = pose.forward.cross(pose.up);
    let turned = pose.turned(&HeadTurn {
        yaw_rad: 0.3,
        ..HeadTurn::default()
    });
    assert!(turned.forward.dot(right) > 0.29);
    let raised = pose.turned(&HeadTurn {
        pitch_rad: 0.3,
        ..HeadTurn::default()
    });
    assert!(raised.forward.dot(pose.up) > 0.29);
    assert_sound(&raised, "raised");

    let zoomed = |zoom: f64| {
        HeadTurn {
            zoom,
            ..HeadTurn::default()
        }
        .fov_rad(1.0)
    };
    assert!(zoomed(2.0) < 0.6 && zoomed(2.0) > 0.4);
    assert!((zoomed(1.0) - 1.0).abs() < 1e-12);
    assert_eq!(zoomed(1e12), NARROWEST_RAD);
    assert_eq!(zoomed(1e-12), WIDEST_RAD);
    assert!((zoomed(f64::NAN) - 1.0).abs() < 1e-12);
    assert!((zoomed(-1.0) - 1.0).abs() < 1e-12);
}
