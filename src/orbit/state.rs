//! Position and velocity, and the step from inertial axes to the turning Earth.

use crate::frames::{EARTH_ROTATION_RATE_RAD_S, Epoch, itrf_from_teme};
use glam::DVec3;

/// The axes that a state is given in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frame {
    /// True equator, mean equinox of date: what SGP4 gives.
    Teme,
    /// Earth-fixed.
    Itrf,
}

/// Position and velocity at an epoch, in the axes of `frame`, about the Earth's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrbitState {
    /// When.
    pub epoch: Epoch,
    /// In which axes.
    pub frame: Frame,
    /// Position, metres.
    pub position_m: DVec3,
    /// Velocity as seen in `frame`, metres per second.
    pub velocity_m_s: DVec3,
}

impl OrbitState {
    /// The same state in ITRF: the velocity is the one seen from the turning Earth, v_ITRF = R v − ω × r.
    ///
    /// Errors are those of [`itrf_from_teme`]: UT1 taken as UTC, polar motion left out.
    pub fn in_itrf(&self) -> Self {
        Self {
            frame: Frame::Itrf,
            position_m: self.position_itrf_m(),
            velocity_m_s: match self.frame {
                Frame::Itrf => self.velocity_m_s,
                Frame::Teme => {
                    self.inertial_velocity_itrf_axes_m_s()
                        - rotation_rad_s().cross(self.position_itrf_m())
                }
            },
            ..*self
        }
    }

    /// Position in ITRF, metres.
    pub fn position_itrf_m(&self) -> DVec3 {
        match self.frame {
            Frame::Itrf => self.position_m,
            Frame::Teme => itrf_from_teme(self.epoch) * self.position_m,
        }
    }

    /// Velocity as seen from the stars, its components along the ITRF axes of this instant, metres per second.
    ///
    /// The direction of flight for cameras: it lies in the orbit's plane.
    pub fn inertial_velocity_itrf_axes_m_s(&self) -> DVec3 {
        match self.frame {
            Frame::Itrf => self.velocity_m_s + rotation_rad_s().cross(self.position_m),
            Frame::Teme => itrf_from_teme(self.epoch) * self.velocity_m_s,
        }
    }
}

/// ω, the Earth's rotation, in ITRF axes.
fn rotation_rad_s() -> DVec3 {
    DVec3::new(0.0, 0.0, EARTH_ROTATION_RATE_RAD_S)
}
