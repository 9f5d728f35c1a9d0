//! What lights the Earth.

use crate::frames::{Epoch, Orientation, sun_direction_itrf_oriented};
use glam::DVec3;

/// What lights the Earth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// Vector to the Sun in ITRF axes, of length 1; of any other finite length it is made a unit vector.
    pub sun_itrf: DVec3,
}

impl Sky {
    /// The sky of a date, UT1 taken as UTC and polar motion left out: the Sun is up to 13.5″ off.
    pub fn at(epoch: Epoch) -> Self {
        Self::with_orientation(epoch, &Orientation::default())
    }

    /// The sky of a date over an Earth of that orientation.
    pub fn with_orientation(epoch: Epoch, orientation: &Orientation) -> Self {
        Self {
            sun_itrf: sun_direction_itrf_oriented(epoch, orientation),
        }
    }

    /// The same with a Sun of length 1; `None` where that has no direction or is not finite.
    pub(super) fn with_unit_sun(self) -> Option<Self> {
        let sun = self.sun_itrf;
        if (sun.length_squared() - 1.0).abs() < 1e-6 {
            return Some(self);
        }
        // By the largest component first: squares of very long vectors are infinite, of very short ones 0.
        let largest = sun.abs().max_element();
        (sun.is_finite() && largest > 0.0).then(|| Self {
            sun_itrf: (sun / largest).normalize(),
        })
    }
}
