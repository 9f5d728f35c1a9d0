//! An Earth that turns by its own law.

use glam::DMat3;

/// How an Earth stands and turns that does so by its own law and not by the date.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EarthTurn {
    /// Rotation from inertial axes, taken as GCRF, to Earth-fixed ones, now.
    pub itrf_from_gcrf: DMat3,
    /// How fast it turns about its pole, radians per second.
    pub rate_rad_s: f64,
}
