//! What lights the Earth.

use crate::frames::{Epoch, Orientation, sun_and_moon_itrf};
use crate::gpu::LAMPS_OUT_SIN;
use glam::DVec3;

/// A block on which the sine of the Sun's elevation is nowhere less has no lamp lit, with room for the ellipsoid.
pub(super) const LIGHTS_OUT: f64 = LAMPS_OUT_SIN + ROOM_SIN;
/// Room for the ellipsoid in sines of the Sun's elevation.
pub(super) const ROOM_SIN: f64 = 0.01;

/// What lights the Earth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// Vector to the Sun in ITRF axes, of length 1; of any other finite length it is made a unit vector.
    pub sun_itrf: DVec3,
    /// The Moon's centre from the Earth's in ITRF axes, metres; `None` for a night without a Moon.
    pub moon_itrf_m: Option<DVec3>,
}

impl Sky {
    /// A Sun in this direction, and no Moon.
    pub const fn new(sun_itrf: DVec3) -> Self {
        Self {
            sun_itrf,
            moon_itrf_m: None,
        }
    }

    /// The sky of a date, UT1 taken as UTC and polar motion left out: the Sun is up to 13.5″ off.
    pub fn at(epoch: Epoch) -> Self {
        Self::with_orientation(epoch, &Orientation::default())
    }

    /// The sky of a date over an Earth of that orientation.
    pub fn with_orientation(epoch: Epoch, orientation: &Orientation) -> Self {
        let (sun_itrf, moon_itrf_m) = sun_and_moon_itrf(epoch, orientation);
        Self {
            sun_itrf,
            moon_itrf_m: Some(moon_itrf_m),
        }
    }

    /// Direction to the Moon and its light, as a part of the Sun's; none where it is not said or not finite.
    pub(super) fn moonlight(&self) -> (DVec3, f64) {
        let moon = self.moon_itrf_m.unwrap_or(DVec3::ZERO);
        let (direction, distance_m) = (moon.normalize_or_zero(), moon.length());
        if direction == DVec3::ZERO || !distance_m.is_finite() {
            return (DVec3::ZERO, 0.0);
        }
        // From the Sun, which is far away, as from the Earth.
        let phase_rad = (-direction.dot(self.sun_itrf)).clamp(-1.0, 1.0).acos();
        let nearness = MOON_DISTANCE_M / distance_m.max(MOON_DISTANCE_M / 10.0);
        let light = moonlight_of_phase(phase_rad) * nearness * nearness;
        (direction, light)
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
            ..self
        })
    }
}

/// Mean distance of the Moon, metres.
const MOON_DISTANCE_M: f64 = 3.844e8;

/// Light of the Moon at its mean distance as a part of the Sun's, for the angle at the Moon between Sun and Earth, 0 being full:
/// the Sun has −26.74 magnitudes, the Moon −12.73 + 0.026 α + 4e-9 α⁴, α in degrees (Allen's Astrophysical Quantities).
pub(crate) fn moonlight_of_phase(phase_rad: f64) -> f64 {
    let degrees = phase_rad.to_degrees();
    let magnitude = -12.73 + 0.026 * degrees + 4e-9 * degrees.powi(4);
    10_f64.powf(-0.4 * (magnitude + 26.74))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_full_moon_gives_a_third_of_a_lux_and_the_half_moon_a_tenth_of_it() {
        // Above the air the Sun gives 133 100 lx.
        let full = moonlight_of_phase(0.0);
        assert!((full * 133_100.0 - 0.33).abs() < 0.02, "{full}");
        let half = moonlight_of_phase(90_f64.to_radians()) / full;
        assert!((0.08..0.12).contains(&half), "{half}");
        assert!(moonlight_of_phase(180_f64.to_radians()) < 1e-3 * full);
    }

    #[test]
    fn the_moon_was_full_at_the_eclipse_of_july_2018_and_new_two_weeks_before() {
        let light = |text: &str| {
            let epoch = text.parse().expect("a date");
            Sky::at(epoch).moonlight().1
        };
        // Totality: 27 July 2018, 20:22 UTC, the Moon at its farthest.
        let full = light("2018-07-27T20:22:00Z");
        assert!((2.0e-6..2.5e-6).contains(&full), "{full}");
        assert!(light("2018-07-13T03:00:00Z") < 1e-3 * full);
        let nowhere = Sky::new(DVec3::X);
        assert_eq!(nowhere.moonlight().1, 0.0);
        let lost = Sky {
            moon_itrf_m: Some(DVec3::NAN),
            ..nowhere
        };
        assert_eq!(lost.moonlight().1, 0.0);
    }
}
