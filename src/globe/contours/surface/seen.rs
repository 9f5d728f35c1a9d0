//! What a view sees of a cell.

use super::ContourSurface;
use super::choose::Measure;
use crate::frames::Ellipsoid;
use crate::globe::GroundView;
use glam::{DVec3, DVec4};

/// Below any ground: what the horizon is reckoned with.
const DEPTH_M: f64 = 12_000.0;

/// What a view sees.
pub(super) struct Seen {
    eye_m: DVec3,
    /// The eye above the ellipsoid.
    height_m: f64,
    sides: [DVec4; 4],
    /// Angle of a pixel, radians.
    pub(super) pixel_rad: f64,
    /// Most error that may show.
    pub(super) tolerance_px: f64,
    ellipsoid: Ellipsoid,
}

impl Seen {
    pub(super) fn new(view: &GroundView, ellipsoid: Ellipsoid) -> Self {
        let rows = view.clip_from_eye.transpose();
        Self {
            eye_m: view.eye_itrf_m,
            height_m: ellipsoid.geodetic_from_itrf(view.eye_itrf_m).height_m,
            sides: [
                rows.w_axis + rows.x_axis,
                rows.w_axis - rows.x_axis,
                rows.w_axis + rows.y_axis,
                rows.w_axis - rows.y_axis,
            ],
            pixel_rad: view.pixel_rad.max(1e-9),
            tolerance_px: view.tolerance_px.max(0.0),
            ellipsoid,
        }
    }

    /// Distance to the nearest of a cell, at least 1 m; none if it is certainly not seen.
    pub(super) fn distance_m(&self, surface: &ContourSurface, measure: &Measure) -> Option<f64> {
        let (center, radius) = (measure.center_m, measure.radius_m);
        let high = f64::from(measure.high_m);
        let from_eye = center - self.eye_m;
        // Not nearer than its ball, nor than its top is below the eye.
        let distance = (from_eye.length() - radius)
            .max(self.height_m - high)
            .max(1.0);
        #[cfg(test)]
        if !surface.cull {
            return Some(distance);
        }
        #[cfg(not(test))]
        let _ = surface;
        let beside = self.sides.iter().any(|side| {
            let n = side.truncate();
            n.dot(from_eye) + side.w < -radius * n.length()
        });
        // Below the horizon of a sphere that lies inside all ground: both tangents add up.
        let inside = self.ellipsoid.polar_radius_m - DEPTH_M;
        let eye = self.eye_m.length();
        let far = center.length();
        let hidden = eye > inside && far > radius && {
            let top = (self.ellipsoid.equatorial_radius_m + high).max(inside);
            let reach = (inside / eye).acos() + (inside / top).acos();
            let apart = self.eye_m.angle_between(center);
            apart - (radius / far).min(1.0).asin() > reach
        };
        (!beside && !hidden).then_some(distance)
    }
}
