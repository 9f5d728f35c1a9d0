//! Fields of view against plane trigonometry, quadratic equations in metres, and places tried one by one.

use super::*;
use glam::{DQuat, DVec2};
use terrella_frames::Geodetic;

const WGS84: Ellipsoid = Ellipsoid::WGS84;
const SPHERE: Ellipsoid = Ellipsoid {
    equatorial_radius_m: 6_371_000.0,
    polar_radius_m: 6_371_000.0,
};

/// A satellite at a place that flies in an azimuth, and the axes there: up, ahead, right.
fn satellite(ellipsoid: &Ellipsoid, place: [f64; 3], azimuth_deg: f64) -> (DVec3, [DVec3; 3]) {
    let [lat, lon, height] = place;
    let place = Geodetic::from_degrees(lat, lon, height);
    let up = Ellipsoid::normal(place.lat_rad, place.lon_rad);
    let east = DVec3::Z.cross(up).normalize();
    // Positive about up is anticlockwise.
    let turn = DQuat::from_axis_angle(up, -azimuth_deg.to_radians());
    let (ahead, right) = (turn * up.cross(east), turn * east);
    (ellipsoid.itrf_from_geodetic(place), [up, ahead, right])
}

fn field(shape: FieldShape, off_nadir_deg: f64, azimuth_deg: f64) -> FieldOfView {
    FieldOfView {
        shape,
        off_nadir_rad: off_nadir_deg.to_radians(),
        azimuth_rad: azimuth_deg.to_radians(),
    }
}

fn cone(half_deg: f64) -> FieldShape {
    let half_angle_rad = half_deg.to_radians();
    FieldShape::Cone { half_angle_rad }
}

fn rectangle(along_deg: f64, across_deg: f64) -> FieldShape {
    FieldShape::Rectangle {
        along_rad: along_deg.to_radians(),
        across_rad: across_deg.to_radians(),
    }
}

/// Where a ray meets (x² + y²)/a² + z²/b² = 1, by the quadratic equation in metres.
fn met(from: DVec3, direction: DVec3, ellipsoid: &Ellipsoid) -> Option<DVec3> {
    let (a2, b2) = (
        ellipsoid.equatorial_radius_m.powi(2),
        ellipsoid.polar_radius_m.powi(2),
    );
    let form = |p: DVec3, q: DVec3| (p.x * q.x + p.y * q.y) / a2 + p.z * q.z / b2;
    let (square, half, constant) = (
        form(direction, direction),
        form(from, direction),
        form(from, from) - 1.0,
    );
    let discriminant = half * half - square * constant;
    (discriminant >= 0.0 && half < 0.0)
        .then(|| from + direction * ((-half - discriminant.sqrt()) / square))
}

/// On a sphere the ground at η off nadir is R (asin(r/R sin η) − η) away (Wertz 2001, 9.1); a pyramid's edge is farthest out at a corner or in its
/// middle, where the rays meet it.
#[test]
fn swath_edges_are_those_of_the_plane_triangle() {
    let radius = SPHERE.equatorial_radius_m;
    let height = 700e3;
    let (at, [up, ahead, right]) = satellite(&SPHERE, [20.0, 50.0, height], 340.0);
    for (shape, off_nadir_deg, half_deg) in [
        (cone(5.0), 30.0_f64, 5.0_f64),
        (rectangle(1.0, 12.0), 20.0, 12.0),
        (cone(20.0), 0.0, 20.0),
    ] {
        let aimed = field(shape, off_nadir_deg, 90.0)
            .aimed(at, ahead, &SPHERE)
            .expect("above the ground");
        for side in [1.0, -1.0] {
            let edge = aimed.swath_edge(ahead, side).expect("on the Earth");
            let eta = off_nadir_deg.to_radians() + side * half_deg.to_radians();
            let away = ((radius + height) / radius * eta.sin()).asin() - eta;
            let expected = match shape {
                FieldShape::Cone { .. } => radius * (up * away.cos() + right * away.sin()),
                FieldShape::Rectangle {
                    along_rad,
                    across_rad,
                } => {
                    let (sin, cos) = off_nadir_deg.to_radians().sin_cos();
                    let across = side * across_rad.tan() * (right * cos + up * sin);
                    let middle = right * sin - up * cos + across;
                    let corner = middle + along_rad.tan() * ahead;
                    let points = [middle, corner].map(|ray| met(at, ray, &SPHERE));
                    let points = points.map(|point| point.expect("the ground"));
                    let out = points.map(|point| side * point.dot(right));
                    points[usize::from(out[1] > out[0])]
                }
            };
            let aside = edge.dot(right) - expected.dot(right);
            assert!(aside.abs() < 1.0, "{shape:?} {side}: {aside} m");
        }
    }
    // Past the limb the swath ends at the horizon, R acos(R/r) away.
    let wide = field(cone(30.0), 60.0, 90.0);
    let aimed = wide.aimed(at, ahead, &SPHERE).expect("above");
    let edge = aimed.swath_edge(ahead, 1.0).expect("the horizon");
    let away = (radius / (radius + height)).acos();
    assert!((edge.dot(right) - radius * away.sin()).abs() < 1.0);
    let upwards = field(cone(5.0), 90.0, 90.0);
    let aimed = upwards.aimed(at, ahead, &SPHERE).expect("above");
    assert_eq!(aimed.swath_edge(ahead, 1.0), None);
}

/// Every point of an outline is where its direction meets the ground, to a metre, at the field's edge; or on the horizon inside the field.
#[test]
fn outlines_are_at_the_edge_or_on_the_horizon() {
    let mut horizon = 0;
    for (place, flight_deg) in [
        ([0.0, 0.0, 400e3], 51.0),
        ([70.0, 170.0, 800e3], 250.0),
        ([-89.0, 30.0, 35.8e6], 10.0),
    ] {
        let (at, [up, ahead, _]) = satellite(&WGS84, place, flight_deg);
        for (shape, half_rad) in [
            (cone(3.0), 3_f64.to_radians()),
            (cone(40.0), 40_f64.to_radians()),
            (rectangle(2.0, 30.0), 0.0),
        ] {
            for (off_nadir, azimuth) in [(0.0, 90.0), (25.0, 90.0), (50.0, 200.0), (5.0, 0.0)] {
                let aimed = field(shape, off_nadir, azimuth)
                    .aimed(at, ahead, &WGS84)
                    .expect("above the ground");
                // The boresight by a rotation of straight down about the level axis across the azimuth.
                let toward = DQuat::from_axis_angle(up, -f64::to_radians(azimuth)) * ahead;
                let axis = (-up).cross(toward);
                let boresight = DQuat::from_axis_angle(axis, f64::to_radians(off_nadir)) * -up;
                assert!(aimed.boresight.distance(boresight) < 1e-12);
                aimed.outline(|point| {
                    let ray = point - at;
                    let margin = aimed.margin_rad(ray);
                    assert!(WGS84.geodetic_from_itrf(point).height_m.abs() < 1e-3);
                    assert!(margin > -1e-6, "{margin}");
                    if margin < 1e-7 {
                        if half_rad > 0.0 {
                            let angle = ray.normalize().angle_between(boresight);
                            assert!((angle - half_rad).abs() < 1e-6, "{angle}");
                        }
                        let direct = met(at, ray.normalize(), &WGS84);
                        // A grazing ray magnifies what is rounded.
                        let sine = WGS84.scaled_from_itrf().powf(2.0) * point;
                        let sine = sine.normalize().dot(ray.normalize()).abs();
                        if let Some(direct) = direct.filter(|_| sine > 1e-3) {
                            assert!(direct.distance(point) < 1.0, "{place:?} {shape:?}");
                        }
                    } else {
                        let normal = (WGS84.scaled_from_itrf().powf(2.0) * point).normalize();
                        assert!(normal.dot(ray.normalize()).abs() < 1e-6);
                        horizon += 1;
                    }
                });
            }
        }
    }
    assert!(horizon > 200, "{horizon}");
}

/// Places of the ground one by one: within the outline, as the satellite sees it, exactly if in the field and in sight.
#[test]
fn outlines_enclose_what_is_seen() {
    let (at, [up, ahead, right]) = satellite(&WGS84, [48.0, 175.0, 700e3], 30.0);
    // Seen from the satellite, everything is in front of a plane below it.
    let seen = |point: DVec3| {
        let ray = point - at;
        DVec2::new(ray.dot(ahead), ray.dot(right)) / -ray.dot(up)
    };
    for (shape, off_nadir, azimuth, is_any) in [
        (cone(10.0), 40.0, 90.0, true),
        (cone(25.0), 60.0, 300.0, true),
        (rectangle(35.0, 70.0), 10.0, 180.0, true),
        (rectangle(3.0, 20.0), 55.0, 90.0, true),
        (cone(85.0), 0.0, 90.0, true),
        (cone(5.0), 80.0, 90.0, false),
    ] {
        let aimed = field(shape, off_nadir, azimuth)
            .aimed(at, ahead, &WGS84)
            .expect("above the ground");
        let mut outline = Vec::new();
        aimed.outline(|point| outline.push(seen(point)));
        assert_eq!(outline.len() > EDGE_POINTS / 2, is_any, "{}", outline.len());
        let mut inside = 0;
        for step in 0..6000_u32 {
            let k = f64::from(step);
            // Spread evenly over the ground below.
            let (z, turn) = (1.0 - 0.1 * k / 6000.0, k * 2.399_963_229_728_653);
            let r = (1.0 - z * z).sqrt();
            let normal = up * z + ahead * (r * turn.cos()) + right * (r * turn.sin());
            let point = WGS84.surface_point(normal);
            let ray = point - at;
            let elevation = -ray.normalize().dot(normal);
            let margin = aimed.margin_rad(ray);
            // Too near an edge for a polygon of chords.
            if margin.abs() < 4e-3 || elevation.abs() < 0.03 {
                continue;
            }
            let p = seen(point);
            let crossings = (0..outline.len()).filter(|k| {
                let (a, b) = (outline[*k], outline[(k + 1) % outline.len()]);
                (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
            });
            let is_within = elevation > 0.0 && crossings.count() % 2 == 1;
            let is_seen = elevation > 0.0 && margin > 0.0;
            assert_eq!(is_within, is_seen, "{shape:?} {off_nadir}: {p}");
            inside += u32::from(is_seen);
        }
        assert_eq!(inside > 20, is_any, "{shape:?}: {inside}");
    }
}

#[test]
fn angles_and_places_without_meaning_are_rejected() {
    for bad in [
        field(cone(0.0), 0.0, 90.0),
        field(cone(91.0), 0.0, 90.0),
        field(rectangle(5.0, f64::NAN), 0.0, 90.0),
        field(cone(5.0), -1.0, 90.0),
        field(cone(5.0), 1.0, f64::INFINITY),
    ] {
        assert!(bad.fault().is_some(), "{bad:?}");
    }
    let good = FieldOfView::nadir(0.1);
    assert_eq!(good.fault(), None);
    for (place, flight) in [
        (DVec3::X * 6e6, DVec3::Y),
        (DVec3::splat(f64::NAN), DVec3::Y),
        (DVec3::X * 7e6, DVec3::X),
    ] {
        assert!(good.aimed(place, flight, &WGS84).is_none(), "{place}");
    }
}
