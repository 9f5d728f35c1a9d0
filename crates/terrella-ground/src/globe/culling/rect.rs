//! A rectangle of longitude and latitude on the unit sphere of scaled space.

use glam::{DVec2, DVec3};

/// Ground between two meridians and two parallels, given by the feet of its points; in scaled space the ellipsoid is the unit sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScaledRect {
    /// (cos, sin) of the middle longitude.
    pub lon: DVec2,
    /// Angle from there to the western and to the eastern edge, radians, at most π/2.
    pub half_width_rad: f64,
    /// (cos, sin) of the northern edge's parametric latitude.
    pub north: DVec2,
    /// (cos, sin) of the southern edge's parametric latitude.
    pub south: DVec2,
}

impl ScaledRect {
    /// Largest P·v over the rectangle's points P, in closed form.
    pub fn max_dot(&self, v: DVec3) -> f64 {
        let k = max_toward(self.lon, v, self.half_width_rad);
        // Maximise k cos β + v_z sin β between the southern and the northern edge.
        let (north, south) = (self.north, self.south);
        let along = DVec2::new(k, v.z);
        if south.perp_dot(along) >= 0.0 && along.perp_dot(north) >= 0.0 {
            along.length()
        } else {
            along.dot(north).max(along.dot(south))
        }
    }

    /// Distance from a point of scaled space, on or above the unit sphere, to the rectangle's nearest point.
    pub fn distance(&self, eye: DVec3) -> f64 {
        let length = eye.length();
        // |e|² + 1 − 2m = (|e| − 1)² + 2(|e| − m). Nothing cancels for an eye above the rectangle, where m = |e|.
        let beside = (length - self.max_dot(eye)).max(0.0);
        ((length - 1.0).powi(2) + 2.0 * beside).sqrt()
    }
}

/// Largest horizontal component of `v` towards any meridian within `half_width_rad` (at most π/2) of the meridian `lon` (cos,
/// sin).
pub fn max_toward(lon: DVec2, v: DVec3, half_width_rad: f64) -> f64 {
    let x = lon.x * v.x + lon.y * v.y;
    let y = (lon.x * v.y - lon.y * v.x).abs();
    let (sin, cos) = half_width_rad.sin_cos();
    if x > 0.0 && y * cos <= x * sin {
        x.hypot(y)
    } else {
        x * cos + y * sin
    }
}
