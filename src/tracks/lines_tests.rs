//! Polylines, compared with independent formulas.

use super::*;
use crate::earth::infinite_reversed_z;
use glam::DVec2;

const STYLE: LineStyle = LineStyle::thin([255, 255, 255], 1.0);

/// x²/a² + y²/a² + z²/b² − 1, as a height in metres.
fn off_ellipsoid_m(point: DVec3) -> f64 {
    let (a, b) = (6_378_137.0_f64, 6_356_752.314_245_179_f64);
    let sum = (point.x * point.x + point.y * point.y) / (a * a) + point.z * point.z / (b * b);
    0.5 * a * (sum - 1.0)
}

fn finest(lines: &Polylines) -> impl Iterator<Item = &[DVec3]> {
    lines.parts.iter().map(|part| {
        let (first, end) = part.levels[0];
        &lines.points_itrf_m[first as usize..end as usize]
    })
}

/// Every vertex lies on the ellipsoid, on a meridian or a parallel of the grid: tan φ = z / ((1 − e²) ρ) (Torge 2001, 4.27).
#[test]
fn vertices_of_a_graticule_lie_on_the_ellipsoid_and_on_the_grid() {
    let lines = Polylines::graticule(STYLE, &Ellipsoid::WGS84, 10.0).expect("a graticule");
    let flattening = 1.0 / 298.257_223_563;
    let e2 = flattening * (2.0 - flattening);
    let mut count = 0;
    for point in finest(&lines).flatten() {
        assert!(off_ellipsoid_m(*point).abs() < 1e-6, "{point}");
        let across = point.x.hypot(point.y);
        let lat_deg = point.z.atan2((1.0 - e2) * across).to_degrees();
        let lon_deg = point.y.atan2(point.x).to_degrees();
        let off = |value: f64| (value / 10.0 - (value / 10.0).round()).abs() * 10.0;
        let is_on_meridian = off(lon_deg) < 1e-9 || across < 1e-6;
        assert!(is_on_meridian || off(lat_deg) < 1e-9, "{lat_deg} {lon_deg}");
        // Near the poles there are four meridians.
        let is_fourth = (lon_deg / 90.0 - (lon_deg / 90.0).round()).abs() < 1e-9;
        assert!(lat_deg.abs() < 80.0 + 1e-9 || is_fourth || across < 1e-6);
        count += 1;
    }
    // 17 parallels of 720 half degrees at the equator, 36 meridians of 320.
    assert!((17_000..30_000).contains(&count), "{count}");
    // With the coarsest step: the equator and four meridians.
    let coarse = Polylines::graticule(STYLE, &Ellipsoid::WGS84, 90.0).expect("a graticule");
    let north = finest(&coarse).flatten().map(|point| point.z);
    assert!(north.fold(0.0, f64::max) > 6_356_752.0);
}

/// The 49th parallel is one segment in latitude and longitude: as a great circle it would be up to 1.5° farther north.
#[test]
fn segments_are_straight_in_latitude_and_longitude_and_follow_the_ellipsoid() {
    let ends = [(49.0, -123.0), (49.0, -95.0)];
    let line = ends.map(|(lat, lon)| Geodetic::from_degrees(lat, lon, 0.0));
    let lines = Polylines::on_ground(STYLE, &Ellipsoid::WGS84, [line]).expect("a line");
    for points in finest(&lines) {
        for pair in points.windows(2) {
            let middle = 0.5 * (pair[0] + pair[1]);
            let lat_deg = Ellipsoid::WGS84
                .geodetic_from_itrf(middle)
                .lat_rad
                .to_degrees();
            assert!((lat_deg - 49.0).abs() < 1e-3, "{lat_deg}");
            assert!((-61.0..=1e-6).contains(&off_ellipsoid_m(middle)));
        }
    }
    // The shorter way across the date line: 2° and not 358°.
    let date_line = [(0.0, 179.0), (0.0, -179.0)];
    let line = date_line.map(|(lat, lon)| Geodetic::from_degrees(lat, lon, 0.0));
    let lines = Polylines::on_ground(STYLE, &Ellipsoid::WGS84, [line]).expect("a line");
    assert_eq!(lines.point_count(), 5);
    assert!(finest(&lines).flatten().all(|point| point.x < -6.3e6));
}

/// A jagged line at every level: no dropped point is farther from the simplified line than the level's error.
#[test]
fn levels_of_detail_keep_their_error() {
    let jagged = (0..400_i32).map(|k| {
        let wave = 0.4 * (f64::from(k) * 0.7).sin() + 0.03 * f64::from(k % 7);
        Geodetic::from_degrees(wave, 0.1 * f64::from(k), 0.0)
    });
    let lines = Polylines::on_ground(STYLE, &Ellipsoid::WGS84, [jagged]).expect("a line");
    let mut counts = [0; LEVEL_ERRORS_M.len()];
    for part in lines.parts.iter() {
        let of = |(first, end): (u32, u32)| &lines.points_itrf_m[first as usize..end as usize];
        let all = of(part.levels[0]);
        for (k, error_m) in LEVEL_ERRORS_M.into_iter().enumerate() {
            let level = of(part.levels[k]);
            counts[k] += level.len();
            assert_eq!(level.first(), all.first());
            assert_eq!(level.last(), all.last());
            for point in all {
                // By the area of the triangle, or the distance to the nearer end.
                let nearest = level.windows(2).map(|pair| {
                    let along = pair[1] - pair[0];
                    let to = *point - pair[0];
                    let t = to.dot(along) / along.dot(along);
                    match (0.0..=1.0).contains(&t) {
                        true => along.cross(to).length() / along.length(),
                        false => point.distance(pair[0]).min(point.distance(pair[1])),
                    }
                });
                let nearest = nearest.fold(f64::INFINITY, f64::min);
                assert!(nearest <= error_m + 1e-6, "{nearest} m at level {k}");
            }
        }
    }
    assert!(counts[10] * 4 < counts[2], "{counts:?}");
}

/// The drawn line stays within a pixel of the original, and parts out of sight are not drawn.
#[test]
fn a_frame_gets_what_is_in_sight_to_within_a_pixel() {
    let ellipsoid = Ellipsoid::WGS84;
    let lines = Polylines::graticule(STYLE, &ellipsoid, 10.0).expect("a graticule");
    let mut counts = Vec::new();
    for height_m in [400e3, 20_000e3, 400_000e3] {
        let eye_itrf_m = DVec3::new(ellipsoid.equatorial_radius_m + height_m, 0.0, 0.0);
        let look = glam::dcamera::rh::view::look_to_mat4(DVec3::ZERO, -DVec3::X, DVec3::Z);
        let clip_from_eye = infinite_reversed_z(0.7, 16.0 / 9.0, 1.0) * look;
        let eye = EyeProjection::new(eye_itrf_m, clip_from_eye, (1280, 720), &ellipsoid);
        let mut points = Vec::new();
        lines.write([[0; 4]; 2], &eye, &mut points);
        counts.push(points.len());
        let pixel = |from_eye_m: DVec3| {
            let clip = eye.clip_from_eye * from_eye_m.extend(1.0);
            DVec2::new(
                640.0 * (1.0 + clip.x / clip.w),
                360.0 * (1.0 - clip.y / clip.w),
            )
        };
        let mut segments = Vec::new();
        for pair in points.windows(2) {
            if pair[1].flags & TRACK_FROM_PREVIOUS != 0 {
                let ends = [pair[0], pair[1]];
                segments.push(ends.map(|end| pixel(DVec3::from(end.from_eye_m.map(f64::from)))));
            }
        }
        // The equator and the Greenwich meridian as the eye sees them, with independent steps.
        let a = ellipsoid.equatorial_radius_m;
        let horizon = (a / (a + height_m)).acos();
        for k in -20..=20 {
            let angle = 0.95 * horizon * f64::from(k) / 20.0;
            let place = a * DVec3::new(angle.cos(), angle.sin(), 0.0);
            let at = pixel(place - eye_itrf_m);
            if !(0.0..=1280.0).contains(&at.x) {
                continue;
            }
            let near = segments.iter().map(|[from, to]| {
                let along = *to - *from;
                let part = (at - *from).dot(along) / along.length_squared().max(1e-12);
                at.distance(*from + part.clamp(0.0, 1.0) * along)
            });
            let near = near.fold(f64::INFINITY, f64::min);
            assert!(near < 1.0, "{near} px at {angle} from {height_m} m");
        }
        // No point is more than a part's length behind the horizon.
        for point in &points {
            let place = eye_itrf_m + DVec3::from(point.from_eye_m.map(f64::from));
            assert!(place.angle_between(DVec3::X) < horizon + 2.0 * PART_RAD);
        }
    }
    let all = lines.point_count();
    assert!(counts[0] > 0 && counts[0] < all / 20, "{counts:?} of {all}");
    // Of segments of at most 2.5° in place of half a degree, on half of the globe.
    assert!(
        counts[1] < all / 7 && counts[2] < all / 7,
        "{counts:?} of {all}"
    );
}

#[test]
fn lines_without_meaning_are_rejected() {
    let line = || [Geodetic::default(), Geodetic::from_degrees(1.0, 1.0, 0.0)];
    let make = |style| Polylines::on_ground(style, &Ellipsoid::WGS84, [line()]).err();
    assert!(make(STYLE).is_none());
    for opacity in [0.0, 1.5, f64::NAN] {
        let error = make(LineStyle { opacity, ..STYLE }).map(|error| error.to_string());
        assert!(error.is_some_and(|text| text.contains("opacity")));
    }
    assert!(
        make(LineStyle {
            width_px: 65.0,
            ..STYLE
        })
        .is_some()
    );
    let nowhere = [Geodetic {
        lat_rad: f64::NAN,
        ..Geodetic::default()
    }];
    assert!(Polylines::on_ground(STYLE, &Ellipsoid::WGS84, [nowhere]).is_err());
    assert!(Polylines::in_space(STYLE, [[DVec3::NAN, DVec3::X]]).is_err());
    for step_deg in [0.5, 91.0, f64::NAN] {
        assert!(Polylines::graticule(STYLE, &Ellipsoid::WGS84, step_deg).is_err());
    }
}
