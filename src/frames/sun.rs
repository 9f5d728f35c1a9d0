//! The Sun.
use super::Epoch;
use glam::DVec3;

/// Unit vector from the Earth's centre to the Sun in ITRF axes.
pub fn sun_direction_itrf(_epoch: Epoch) -> DVec3 {
    DVec3::X
}
