//! Position and view of the eye: pure f64 functions from a satellite's motion, or a position, to a [`Pose`].
//!
//! "Down" is the ellipsoid normal. The centre of a nadir image is thus the point with the satellite's geodetic latitude and longitude, and the
//! horizon has the depression of the actual figure.

pub use super::pose::Pose;
use super::pose::north_of;
use crate::scene::CameraUp;
use glam::{DMat3, DQuat, DVec3};
use terrella::frames::{Ellipsoid, Geodetic};

/// Distance of the eye from the satellite in chase mode, metres.
pub const CHASE_DISTANCE_M: f64 = 40.0;
/// Elevation of the chase camera above the satellite's level, seen from the satellite, radians (25°).
pub const CHASE_ELEVATION_RAD: f64 = 25.0 * std::f64::consts::PI / 180.0;
/// Position of the limb in horizon mode: this fraction of the image height below its top edge.
pub const LIMB_FROM_TOP: f64 = 1.0 / 3.0;
/// Narrowest view that zooming reaches, radians (a thousandth of a degree), unless the scene itself is narrower.
pub const NARROWEST_RAD: f64 = 0.001 * std::f64::consts::PI / 180.0;
/// Widest view that zooming reaches, radians (150°), unless the scene itself is wider.
pub const WIDEST_RAD: f64 = 150.0 * std::f64::consts::PI / 180.0;

/// Position and velocity of a satellite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrbitalMotion {
    /// Position, ITRF, metres.
    pub position_itrf_m: DVec3,
    /// Velocity seen from the stars, components along ITRF axes, metres per second. Only its direction counts.
    pub velocity_m_s: DVec3,
}

/// Changes of a view by the user.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadTurn {
    /// Magnification, 1 is the scene's own; the picture's half height on a plane ahead is divided by it.
    pub zoom: f64,
    /// Turn of the head to the right, radians.
    pub yaw_rad: f64,
    /// Turn of the head upwards, radians.
    pub pitch_rad: f64,
}

impl Default for HeadTurn {
    fn default() -> Self {
        Self {
            zoom: 1.0,
            yaw_rad: 0.0,
            pitch_rad: 0.0,
        }
    }
}

impl HeadTurn {
    /// Vertical field of view after zooming, within the limits of this module.
    pub fn fov_rad(&self, scene_fov_rad: f64) -> f64 {
        let zoom = if self.zoom.is_finite() && self.zoom > 0.0 {
            self.zoom
        } else {
            1.0
        };
        let fov = 2.0 * ((0.5 * scene_fov_rad).tan() / zoom).atan();
        fov.clamp(
            NARROWEST_RAD.min(scene_fov_rad),
            WIDEST_RAD.max(scene_fov_rad),
        )
    }
}

impl OrbitalMotion {
    fn place(&self, ellipsoid: &Ellipsoid) -> Geodetic {
        ellipsoid.geodetic_from_itrf(self.position_itrf_m)
    }

    /// Horizontal direction of flight; north if the satellite is at rest or moves vertically.
    fn ahead(&self, place: Geodetic) -> DVec3 {
        let vertical = Ellipsoid::normal(place.lat_rad, place.lon_rad);
        let level = self.velocity_m_s.reject_from_normalized(vertical);
        // The rounding error of a vertical velocity is not a direction.
        if level.length() > 1e-9 * self.velocity_m_s.length() {
            level.normalize_or(north_of(place))
        } else {
            north_of(place)
        }
    }

    /// Axes of a craft that flies level, in ITRF: x ahead, y to the right, z straight down.
    pub fn itrf_from_level(&self, ellipsoid: &Ellipsoid) -> DMat3 {
        let place = self.place(ellipsoid);
        let down = -Ellipsoid::normal(place.lat_rad, place.lon_rad);
        let ahead = self.ahead(place);
        DMat3::from_cols(ahead, down.cross(ahead), down)
    }
}

impl Pose {
    /// At the satellite, straight down, the direction of flight or north upwards on screen.
    pub fn nadir(motion: &OrbitalMotion, up: CameraUp, ellipsoid: &Ellipsoid) -> Self {
        let place = motion.place(ellipsoid);
        Self {
            eye_itrf_m: motion.position_itrf_m,
            forward: -Ellipsoid::normal(place.lat_rad, place.lon_rad),
            up: match up {
                CameraUp::Flight => motion.ahead(place),
                CameraUp::North => north_of(place),
            },
        }
    }

    /// At the satellite, looking forwards along its track, with the limb ahead at [`LIMB_FROM_TOP`] from the top.
    pub fn horizon(motion: &OrbitalMotion, ellipsoid: &Ellipsoid, fov_rad: f64) -> Self {
        let place = motion.place(ellipsoid);
        let vertical = Ellipsoid::normal(place.lat_rad, place.lon_rad);
        let ahead = motion.ahead(place);
        let dip = dip_rad(ellipsoid, motion.position_itrf_m, ahead, vertical);
        // The limb's height on screen: 1 is the top edge, 0 the middle.
        let height = 1.0 - 2.0 * LIMB_FROM_TOP;
        let above_middle = (height * (0.5 * fov_rad).tan()).atan();
        let (sin, cos) = (dip + above_middle).sin_cos();
        Self {
            eye_itrf_m: motion.position_itrf_m,
            forward: cos * ahead - sin * vertical,
            up: sin * ahead + cos * vertical,
        }
    }

    /// [`CHASE_DISTANCE_M`] behind the satellite, [`CHASE_ELEVATION_RAD`] above it, looking at it, the Earth below.
    pub fn chase(motion: &OrbitalMotion, ellipsoid: &Ellipsoid) -> Self {
        let place = motion.place(ellipsoid);
        let vertical = Ellipsoid::normal(place.lat_rad, place.lon_rad);
        let ahead = motion.ahead(place);
        let (sin, cos) = CHASE_ELEVATION_RAD.sin_cos();
        let forward = cos * ahead - sin * vertical;
        Self {
            eye_itrf_m: motion.position_itrf_m - CHASE_DISTANCE_M * forward,
            forward,
            up: sin * ahead + cos * vertical,
        }
    }

    /// The same eye with its head turned as the user turned it.
    pub fn turned(&self, look: &HeadTurn) -> Self {
        let right = self.forward.cross(self.up);
        let turn = DQuat::from_axis_angle(self.up, -look.yaw_rad)
            * DQuat::from_axis_angle(right, look.pitch_rad);
        Self {
            eye_itrf_m: self.eye_itrf_m,
            forward: turn * self.forward,
            up: turn * self.up,
        }
    }
}

/// Angle of the limb below level in the direction `ahead`, radians; 0 for an eye on or below the surface.
///
/// In scaled space (x/a, y/a, z/b) the ellipsoid is the unit sphere, and a line E + sD touches it where
/// (E·D)² = (|E|² − 1)|D|². With D = A − tN (A and N are `ahead` and `vertical` scaled, t the tangent of the dip):
/// t²((E·N)² − cN²) − 2t((E·A)(E·N) − cA·N) + (E·A)² − cA² = 0, c = |E|² − 1. On a sphere t = √c.
pub fn dip_rad(ellipsoid: &Ellipsoid, eye_itrf_m: DVec3, ahead: DVec3, vertical: DVec3) -> f64 {
    let scale = ellipsoid.scaled_from_itrf();
    let (e, a, n) = (scale * eye_itrf_m, scale * ahead, scale * vertical);
    let c = (e.length() - 1.0) * (e.length() + 1.0);
    if c <= 0.0 {
        return 0.0;
    }
    let square = e.dot(n).powi(2) - c * n.length_squared();
    let half_linear = e.dot(a) * e.dot(n) - c * a.dot(n);
    let constant = e.dot(a).powi(2) - c * a.length_squared();
    // constant < 0 < square for any eye outside, so the root is of a sum and the two solutions differ in sign. The
    // positive one in the form that adds.
    let root = (half_linear * half_linear - square * constant)
        .max(0.0)
        .sqrt();
    let (rise, run) = if half_linear >= 0.0 {
        (half_linear + root, square)
    } else {
        (-constant, root - half_linear)
    };
    rise.atan2(run)
}

#[cfg(test)]
#[path = "camera_tests.rs"]
mod tests;
