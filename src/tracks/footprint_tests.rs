//! Footprints and occlusion, compared with rays that are traced by bisection.

use super::*;
use terrella_frames::Geodetic;

const WGS84: Ellipsoid = Ellipsoid::WGS84;
/// An ellipsoid so flat that treating it as a sphere anywhere would fail a test.
const FLAT: Ellipsoid = Ellipsoid {
    equatorial_radius_m: 6_378_137.0,
    polar_radius_m: 4_500_000.0,
};

fn outline(satellite: DVec3, half_angle_rad: f64, ellipsoid: &Ellipsoid) -> Vec<DVec3> {
    let mut points = Vec::new();
    footprint_outline(satellite, half_angle_rad, ellipsoid, |point| {
        points.push(point)
    });
    points
}

fn height_m(point: DVec3, ellipsoid: &Ellipsoid) -> f64 {
    ellipsoid.geodetic_from_itrf(point).height_m
}

/// Minimum of |p/(a, a, b)|² on a ray, and where the ray first meets the ellipsoid, by brute force: a thousand steps along it, then bisection.
fn walk(from: DVec3, direction: DVec3, ellipsoid: &Ellipsoid) -> Option<DVec3> {
    let is_inside = |t: f64| {
        let p = ellipsoid.scaled_from_itrf() * (from + t * direction);
        p.length_squared() <= 1.0
    };
    let far = 2.0 * from.length();
    let steps = 4000;
    let hit = (1..=steps).find(|k| is_inside(far * f64::from(*k) / f64::from(steps)))?;
    let (mut out, mut inside) = (
        far * f64::from(hit - 1) / f64::from(steps),
        far * f64::from(hit) / f64::from(steps),
    );
    for _ in 0..80 {
        let middle = 0.5 * (out + inside);
        match is_inside(middle) {
            true => inside = middle,
            false => out = middle,
        }
    }
    Some(from + inside * direction)
}

#[test]
fn outlines_lie_on_the_cone_or_on_the_horizon() {
    for ellipsoid in [WGS84, FLAT] {
        for (lat, lon, height) in [
            (0.0, 0.0, 400e3),
            (51.6, 170.0, 420e3),
            (89.99, 20.0, 800e3),
            (-90.0, 0.0, 39e6),
            (0.01, -75.0, 35.8e6),
            (62.0, 90.0, 1e3),
        ] {
            let place = Geodetic::from_degrees(lat, lon, height);
            let satellite = ellipsoid.itrf_from_geodetic(place);
            let down = -Ellipsoid::normal(place.lat_rad, place.lon_rad);
            for half_deg in [0.1, 8.0, 45.0, 65.0, 90.0] {
                let half_rad = f64::to_radians(half_deg);
                let points = outline(satellite, half_rad, &ellipsoid);
                assert_eq!(points.len(), OUTLINE_POINTS);
                for point in points {
                    assert!(height_m(point, &ellipsoid).abs() < 1e-6);
                    let ray = point - satellite;
                    let angle = ray.cross(down).length().atan2(ray.dot(down));
                    assert!(angle < half_rad + 1e-9, "{lat} {half_deg}: {angle}");
                    // No ground in front of it on its ray.
                    let d = ray.normalize();
                    let met = walk(satellite, d, &ellipsoid).unwrap_or(point);
                    let normal = (ellipsoid.scaled_from_itrf().powf(2.0) * point).normalize();
                    let grazing = normal.dot(d).abs();
                    if angle > half_rad - 1e-9 {
                        // On the cone; a bisected point is accurate to rounding over the sine of incidence.
                        let off = met.distance(point) * grazing;
                        assert!(off < 1e-3, "{lat} {half_deg}: {off} m off");
                    } else {
                        // On the horizon: the ray lies in the tangent plane.
                        assert!(grazing < 1e-6, "{lat} {half_deg}: {grazing}");
                    }
                }
            }
        }
    }
}

/// A point of the ground is inside the outline if and only if a ray to it is inside the cone and meets no ground before.
#[test]
fn brute_force_finds_the_same_ground() {
    let place = Geodetic::from_degrees(48.0, 175.0, 700e3);
    for (ellipsoid, half_deg) in [(WGS84, 30.0), (WGS84, 64.2), (WGS84, 80.0), (FLAT, 50.0)] {
        let satellite = ellipsoid.itrf_from_geodetic(place);
        let down = -Ellipsoid::normal(place.lat_rad, place.lon_rad);
        let half_rad = f64::to_radians(half_deg);
        let points = outline(satellite, half_rad, &ellipsoid);
        // Point-in-polygon test along the satellite's axis, where the cap is star-shaped: by the angle from nadir.
        let (east, north) = {
            let east = DVec3::new(-place.lon_rad.sin(), place.lon_rad.cos(), 0.0);
            (east, (-down).cross(east))
        };
        let mut compared = 0;
        for step in 0..4000_u32 {
            // Points evenly distributed over the hemisphere below.
            let k = f64::from(step);
            let (z, turn) = (1.0 - k / 4000.0, k * 2.399_963_229_728_653);
            let r = (1.0 - z * z).sqrt();
            let ground = ellipsoid
                .surface_point(-down * z + east * (r * turn.cos()) + north * (r * turn.sin()));
            let ray = ground - satellite;
            let angle = ray.cross(down).length().atan2(ray.dot(down));
            let met = walk(satellite, ray.normalize(), &ellipsoid);
            let is_seen = met.is_some_and(|met| met.distance(ground) < 1e3) && angle < half_rad;
            let azimuth = ray
                .dot(north)
                .atan2(ray.dot(east))
                .rem_euclid(std::f64::consts::TAU);
            let near = (azimuth / std::f64::consts::TAU * OUTLINE_POINTS as f64).round() as usize;
            let edge = points[near % OUTLINE_POINTS];
            let edge_ray = edge - satellite;
            let edge_angle = edge_ray.cross(down).length().atan2(edge_ray.dot(down));
            // Too close to the edge for a test with a polygon.
            if (angle - edge_angle).abs() < 2e-3
                || is_hidden(satellite, ground, &ellipsoid) && is_seen
            {
                continue;
            }
            let is_within = angle < edge_angle && !is_hidden(satellite, ground, &ellipsoid);
            assert_eq!(is_within, is_seen, "{half_deg}: {angle} of {edge_angle}");
            compared += 1;
        }
        assert!(compared > 3500, "{compared}");
    }
}

#[test]
fn there_is_no_footprint_of_what_is_not_above_the_ground() {
    for place in [
        DVec3::ZERO,
        DVec3::X * 6e6,
        DVec3::splat(f64::NAN),
        DVec3::X * 6_378_136.9,
    ] {
        assert!(outline(place, 0.5, &WGS84).is_empty(), "{place}");
    }
    assert!(outline(DVec3::X * 7e6, 0.0, &WGS84).is_empty());
    assert!(outline(DVec3::X * 7e6, -1.0, &WGS84).is_empty());
}

#[test]
fn hiding_agrees_with_rays_that_are_walked() {
    let mut hidden = 0;
    for ellipsoid in [WGS84, FLAT] {
        for step in 0..600_u32 {
            let k = f64::from(step);
            let eye = ellipsoid.itrf_from_geodetic(Geodetic::from_degrees(
                90.0 * (0.7 * k).sin(),
                180.0 * (1.3 * k).cos(),
                10_f64.powf(4.0 + 4.0 * (0.37 * k).sin().abs()),
            ));
            let point = ellipsoid.itrf_from_geodetic(Geodetic::from_degrees(
                90.0 * (1.9 * k).cos(),
                180.0 * (0.53 * k).sin(),
                10_f64.powf(4.5 + 3.0 * (0.11 * k).cos().abs()),
            ));
            let ray = point - eye;
            let is_before = walk(eye, ray.normalize(), &ellipsoid)
                .is_some_and(|met| met.distance(eye) < ray.length());
            // Steps of a four-thousandth may miss a grazed limb.
            let d = (ellipsoid.scaled_from_itrf() * ray).normalize();
            let q = (ellipsoid.scaled_from_itrf() * eye).cross(d).length();
            if (q - 1.0).abs() < 1e-3 {
                continue;
            }
            assert_eq!(is_hidden(eye, point, &ellipsoid), is_before, "{step}");
            hidden += u32::from(is_before);
        }
    }
    assert!((200..1000).contains(&hidden), "{hidden} of 1200");
}

#[test]
fn the_air_lies_over_what_is_behind_its_near_side() {
    let top = 1.0 + 100e3 / WGS84.equatorial_radius_m;
    let eye = DVec3::X * 4e7;
    let beyond = |point: DVec3| is_beyond_air(eye, point, top, &WGS84);
    let a = WGS84.equatorial_radius_m;
    // In front of the disc: above the air, inside it, on the ground.
    assert!(!beyond(DVec3::X * (a + 101e3)) && beyond(DVec3::X * (a + 99e3)));
    assert!(beyond(DVec3::X * a));
    // Beyond the limb: in front of and behind the plane of the limb.
    let limb = DVec3::Y * (a + 50e3);
    assert!(beyond(limb + DVec3::NEG_X * 3e6) && !beyond(limb + DVec3::X * 3e6));
    assert!(!beyond(DVec3::new(-3e6, a + 5e6, 0.0)));
    // From inside the air, every other point is inside or beyond it.
    let low = DVec3::X * (a + 10e3);
    assert!(is_beyond_air(low, DVec3::X * (a + 9e3), top, &WGS84));
}
