//! What a view sees of a ball of ground.

use crate::elevation::HeightRange;
use crate::frames::Ellipsoid;
use crate::globe::GroundView;
use glam::{DVec3, DVec4};

/// A view, as pages are chosen by it.
pub(super) struct Seen {
    pub eye_m: DVec3,
    /// The eye above the ellipsoid.
    eye_height_m: f64,
    /// The sides of the picture.
    sides: [DVec4; 4],
    /// Angle of a pixel, radians.
    pub pixel_rad: f64,
    /// Radii of spheres inside and outside of all ground.
    inside_m: f64,
    outside_m: f64,
}

impl Seen {
    pub fn new(view: &GroundView, ellipsoid: &Ellipsoid, range: HeightRange) -> Self {
        let rows = view.clip_from_eye.transpose();
        Self {
            eye_m: view.eye_itrf_m,
            eye_height_m: ellipsoid.geodetic_from_itrf(view.eye_itrf_m).height_m,
            sides: [
                rows.w_axis + rows.x_axis,
                rows.w_axis - rows.x_axis,
                rows.w_axis + rows.y_axis,
                rows.w_axis - rows.y_axis,
            ],
            pixel_rad: view.pixel_rad.max(1e-9),
            inside_m: ellipsoid.polar_radius_m + range.low_m.min(0.0) - 1_000.0,
            outside_m: ellipsoid.equatorial_radius_m + range.high_m.max(0.0),
        }
    }

    /// Distance to the nearest of a ball of ground that is nowhere higher than that, at least 1 m; none if it is certainly
    /// not seen.
    pub fn distance_m(&self, center_m: DVec3, radius_m: f64, high_m: f64) -> Option<f64> {
        let from_eye = center_m - self.eye_m;
        let away = from_eye.length();
        let is_beside = self.sides.iter().any(|side| {
            let n = side.truncate();
            n.dot(from_eye) + side.w < -radius_m * n.length()
        });
        // Beyond the horizon of a sphere inside all ground, and beyond that of its own top: both tangents add up.
        let (eye, far) = (self.eye_m.length(), center_m.length());
        let is_hidden = eye > self.inside_m && far > radius_m && {
            let reach = (self.inside_m / eye).acos() + (self.inside_m / self.outside_m).acos();
            self.eye_m.angle_between(center_m) - (radius_m / far).min(1.0).asin() > reach
        };
        // Not nearer than its ball, nor than its top is below the eye.
        let distance_m = (away - radius_m).max(self.eye_height_m - high_m).max(1.0);
        (!is_beside && !is_hidden).then_some(distance_m)
    }
}
