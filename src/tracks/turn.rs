//! An Earth with its own rotation.

use glam::DMat3;

/// Orientation and rotation rate of an Earth that does not follow the date.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EarthTurn {
    /// Present rotation from inertial axes, taken as GCRF, to Earth-fixed axes.
    pub itrf_from_gcrf: DMat3,
    /// Rotation rate about its pole, radians per second.
    pub rate_rad_s: f64,
}
