//! The ground that a sensor sees, and whether the globe hides a point: on the exact ellipsoid, in scaled space.

use glam::DVec3;
use terrella_frames::Ellipsoid;
use terrella_ground::globe::culling::{GroundShell, Horizon};

/// Number of points of a footprint's outline; the first is not repeated.
pub const OUTLINE_POINTS: usize = 256;

/// Widest half angle of a cone about nadir, radians: a larger value selects all visible ground.
pub const WIDEST_HALF_ANGLE_RAD: f64 = 89.999 * std::f64::consts::PI / 180.0;

/// The outline of the visible ground within `half_angle_rad` of nadir (the ellipsoid's normal): [`OUTLINE_POINTS`] points on the ellipsoid, ITRF
/// metres, anticlockwise from above, starting in the east.
///
/// In each direction about nadir, the point is where a ray at the cone's half angle meets the ground. If that ray misses the Earth, it is the point
/// of the horizon in that direction. A wide cone is thus bounded by the horizon circle, entirely for [`WIDEST_HALF_ANGLE_RAD`]. Empty for a
/// satellite on or below the ground.
///
/// In scaled space (x/a, y/a, z/b) the ellipsoid is the unit sphere. With D = tH − N (N and H are the normal and a level
/// direction scaled, t the tangent of the angle from nadir) the line e + sD touches it where (e·D)² = c|D|², c = |e|² − 1:
/// t²(c|H|² − (e·H)²) − 2t(cN·H − (e·N)(e·H)) − ((e·N)² − c|N|²) = 0.
pub fn footprint_outline(
    satellite_itrf_m: DVec3,
    half_angle_rad: f64,
    ellipsoid: &Ellipsoid,
    mut give: impl FnMut(DVec3),
) {
    let scale = ellipsoid.scaled_from_itrf();
    let e = scale * satellite_itrf_m;
    let above = (e.length() - 1.0) * (e.length() + 1.0);
    // Also false for NaN.
    if !(above > 0.0 && e.is_finite() && half_angle_rad > 0.0) {
        return;
    }
    let place = ellipsoid.geodetic_from_itrf(satellite_itrf_m);
    let normal = Ellipsoid::normal(place.lat_rad, place.lon_rad);
    let (sin, cos) = place.lon_rad.sin_cos();
    let east = DVec3::new(-sin, cos, 0.0);
    let north = normal.cross(east);
    let wanted = half_angle_rad.min(WIDEST_HALF_ANGLE_RAD).tan();
    let n = scale * normal;
    let itrf_from_scaled = ellipsoid.itrf_from_scaled();
    for k in 0..OUTLINE_POINTS {
        let turn = std::f64::consts::TAU * k as f64 / OUTLINE_POINTS as f64;
        let h = scale * (turn.cos() * east + turn.sin() * north);
        let square = above * h.length_squared() - e.dot(h).powi(2);
        let half_linear = above * n.dot(h) - e.dot(n) * e.dot(h);
        let constant = e.dot(n).powi(2) - above * n.length_squared();
        let root = (half_linear * half_linear + square * constant)
            .max(0.0)
            .sqrt();
        // The positive solution, in the form without cancellation.
        let limb = match half_linear >= 0.0 {
            true => (half_linear + root) / square,
            false => constant / (root - half_linear),
        };
        let direction = (h * limb.min(wanted) - n).normalize();
        let nearest = -e.dot(direction);
        // 1 − |e × d|² is the square of half the chord; 0 if the ray is tangent.
        let half_chord = match limb <= wanted {
            true => 0.0,
            false => (1.0 - e.cross(direction).length_squared()).max(0.0).sqrt(),
        };
        let along = match limb <= wanted {
            true => nearest,
            false => above / (nearest + half_chord),
        };
        // Normalised, to lie on the ellipsoid to the last digit.
        give(itrf_from_scaled * (e + along * direction).normalize());
    }
}

/// Whether the globe hides `point` from `eye`, both in ITRF metres and neither below the ground: the CPU version of `in_sight` in
/// `shaders/tracks.wgsl`.
pub fn is_hidden(eye_itrf_m: DVec3, point_itrf_m: DVec3, ellipsoid: &Ellipsoid) -> bool {
    Horizon::new(ellipsoid, eye_itrf_m, GroundShell::SMOOTH).hides_point(point_itrf_m)
}

/// Whether a point is beyond the near boundary of the air as seen from `eye`, so that the air is drawn over it: the CPU version of `is_on_side` in
/// the shaders of tracks. `air_top` is the boundary's radius in scaled space.
pub fn is_beyond_air(
    eye_itrf_m: DVec3,
    point_itrf_m: DVec3,
    air_top: f64,
    ellipsoid: &Ellipsoid,
) -> bool {
    let scale = ellipsoid.scaled_from_itrf();
    let (e, p) = (scale * eye_itrf_m, scale * point_itrf_m);
    let Some(d) = (p - e).try_normalize() else {
        return false;
    };
    let q = e.cross(d).length();
    let half_chord = ((air_top - q) * (air_top + q)).max(0.0).sqrt();
    q < air_top && p.dot(d) > -half_chord
}

#[cfg(test)]
#[path = "footprint_tests.rs"]
mod tests;
