//! A camera that rides on a satellite, as those of scenes do.

use crate::camera::OrbitalMotion;
use crate::pose::Pose;
use crate::scene::CameraUp;
use terrella::Epoch;
use terrella::frames::{Ellipsoid, Orientation};
use terrella::orbit::Feed;

/// How it rides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ride {
    /// At the satellite, straight down, the direction of flight upwards.
    Nadir,
    /// At the satellite, forwards, with the limb a third below the upper edge.
    Horizon,
    /// Some metres behind the satellite and above it.
    Chase,
}

impl Ride {
    /// By its name in scenes.
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "nadir" => Some(Self::Nadir),
            "horizon" => Some(Self::Horizon),
            "chase" => Some(Self::Chase),
            _ => None,
        }
    }

    /// Where the camera is at an instant; `None` while the satellite's place is unknown.
    pub fn pose(self, feed: &dyn Feed, epoch: Epoch, fov_rad: f64) -> Option<Pose> {
        let state = feed.state_at(epoch).ok()?;
        let (position_itrf_m, velocity_m_s) = state.inertial_in_itrf_axes(&Orientation::default());
        let motion = OrbitalMotion {
            position_itrf_m,
            velocity_m_s,
        };
        let ellipsoid = &Ellipsoid::WGS84;
        Some(match self {
            Self::Nadir => Pose::nadir(&motion, CameraUp::Flight, ellipsoid),
            Self::Horizon => Pose::horizon(&motion, ellipsoid, fov_rad),
            Self::Chase => Pose::chase(&motion, ellipsoid),
        })
    }
}
