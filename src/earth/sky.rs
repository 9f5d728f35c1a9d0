//! Sun, Moon and stars.

use crate::gpu::LAMPS_OUT_SIN;
use glam::{DMat3, DVec3};
use terrella_frames::{ASTRONOMICAL_UNIT_M, Epoch, MoonShadow, Observer, Orientation};

/// Where the Sun's elevation has nowhere a lower sine on a block, none of its lamps is lit; with a margin for the ellipsoid.
pub(super) const LIGHTS_OUT: f64 = LAMPS_OUT_SIN + ROOM_SIN;
/// Where the Sun's elevation has nowhere a higher sine on a block, 23.6° below the horizon, the Sun gives it no light. The clouds before a place are
/// at most 280 km from it, where the Sun is then 21° down: a billionth of daylight is left.
pub(super) const DEEP_NIGHT: f64 = -0.4;
/// Margin for the ellipsoid's flattening, in sines of the Sun's elevation.
pub(super) const ROOM_SIN: f64 = 0.01;

/// Sun, Moon and the axes of the stars. Hosts with an ephemeris fill in the fields; others derive them from a date.
///
/// Sun and Moon are at their places as seen from the Earth's centre. Light time and aberration must be applied to both or to neither: half a minute
/// of arc between them moves the Moon's shadow by 50 km.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// Direction to the Sun in ITRF axes. Any other finite length is normalised to 1.
    pub sun_itrf: DVec3,
    /// Distance of the Sun, metres. It only sets the size of the disc in eclipses.
    pub sun_distance_m: f64,
    /// The Moon's centre from the Earth's in ITRF axes, metres; `None` for a night without a Moon.
    pub moon_itrf_m: Option<DVec3>,
    /// Rotation from the inertial frame of the stars, GCRF, to ITRF; `None` without a date. It does not affect the Earth.
    pub itrf_from_gcrf: Option<DMat3>,
    /// The time, which animates the aurora. The aurora is static without it.
    pub epoch: Option<Epoch>,
}

impl Sky {
    /// A Sun in this direction at its mean distance, and no Moon.
    pub const fn new(sun_itrf: DVec3) -> Self {
        Self {
            sun_itrf,
            sun_distance_m: ASTRONOMICAL_UNIT_M,
            moon_itrf_m: None,
            itrf_from_gcrf: None,
            epoch: None,
        }
    }

    /// The sky at a time, with UT1 = UTC and without polar motion: the error of the Sun is up to 13.5″.
    pub fn at(epoch: Epoch) -> Self {
        Self::with_orientation(epoch, &Orientation::default())
    }

    /// The sky at a time, for this orientation of the Earth.
    pub fn with_orientation(epoch: Epoch, orientation: &Orientation) -> Self {
        let center = Observer::moving(epoch, orientation, DVec3::ZERO, DVec3::ZERO);
        let sun_m = center.sun_m();
        Self {
            sun_itrf: sun_m.normalize(),
            sun_distance_m: sun_m.length(),
            moon_itrf_m: Some(center.moon_m()),
            itrf_from_gcrf: Some(center.itrf_from_gcrf()),
            epoch: Some(epoch),
        }
    }

    /// The Moon's shadow; `None` without a Moon, or if either position is not finite.
    pub fn moon_shadow(&self) -> Option<MoonShadow> {
        let sun_m = self.with_unit_sun()?.sun_itrf * self.sun_distance_m;
        let moon_m = self.moon_itrf_m?;
        let is_somewhere = sun_m.is_finite() && moon_m.is_finite();
        (is_somewhere && sun_m != moon_m).then(|| MoonShadow::new(sun_m, moon_m))
    }

    /// Direction to the Moon, and its light as a fraction of the Sun's; zero without a Moon or if its position is not finite.
    pub fn moonlight(&self) -> (DVec3, f64) {
        let moon = self.moon_itrf_m.unwrap_or(DVec3::ZERO);
        let (direction, distance_m) = (moon.normalize_or_zero(), moon.length());
        if direction == DVec3::ZERO || !distance_m.is_finite() {
            return (DVec3::ZERO, 0.0);
        }
        // The Sun is far away: its direction from the Moon is that from the Earth.
        let phase_rad = (-direction.dot(self.sun_itrf)).clamp(-1.0, 1.0).acos();
        (direction, moonlight(phase_rad, distance_m))
    }

    /// The same sky with a Sun vector of length 1; `None` if the vector is zero or not finite.
    pub(super) fn with_unit_sun(self) -> Option<Self> {
        let sun = self.sun_itrf;
        if (sun.length_squared() - 1.0).abs() < 1e-6 {
            return Some(self);
        }
        // Scaled by the largest component first: squares of very long vectors overflow, those of very short ones underflow.
        let largest = sun.abs().max_element();
        (sun.is_finite() && largest > 0.0).then(|| Self {
            sun_itrf: (sun / largest).normalize(),
            ..self
        })
    }
}

/// Mean distance of the Moon, metres.
pub(super) const MOON_DISTANCE_M: f64 = 3.844e8;

/// Moonlight as a fraction of sunlight, for a phase and distance. A distance below a tenth of the mean is treated as that.
pub(crate) fn moonlight(phase_rad: f64, distance_m: f64) -> f64 {
    let nearness = MOON_DISTANCE_M / distance_m.max(MOON_DISTANCE_M / 10.0);
    moonlight_of_phase(phase_rad) * nearness * nearness
}

/// Light of the Moon at its mean distance as a fraction of the Sun's, for the angle at the Moon between Sun and Earth, 0 at full Moon. The Sun has
/// magnitude −26.74, the Moon −12.73 + 0.026 α + 4e-9 α⁴, α in degrees (Allen's Astrophysical Quantities).
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
        // Above the air the Sun's illuminance is 133 100 lx.
        let full = moonlight_of_phase(0.0);
        assert!((full * 133_100.0 - 0.33).abs() < 0.02, "{full}");
        let half = moonlight_of_phase(90_f64.to_radians()) / full;
        assert!((0.08..0.12).contains(&half), "{half}");
        assert!(moonlight_of_phase(180_f64.to_radians()) < 1e-3 * full);
    }

    #[test]
    fn a_date_beyond_all_ephemerides_has_a_sky_or_none_and_never_panics() {
        use terrella_frames::Duration;
        let origin = Epoch::from_gregorian_utc(2000, 1, 1, 0, 0, 0, 0);
        for years in [
            -32_000.0, -20_000.0, -3000.0, 3000.0, 20_000.0, 32_000.0, 1e6,
        ] {
            let sky = Sky::at(origin + Duration::from_seconds(years * 3.156e7));
            let is_sky = sky.with_unit_sun().is_some();
            assert!(
                is_sky || !sky.sun_itrf.is_finite() || !sky.sun_distance_m.is_finite(),
                "{years}"
            );
            let _whatever = (sky.moon_shadow(), sky.moonlight());
        }
    }

    #[test]
    fn the_moons_shadow_is_there_where_sun_and_moon_are() {
        let noon: Epoch = "2017-08-21T18:25:32Z".parse().expect("a date");
        let sky = Sky::at(noon);
        assert!(sky.itrf_from_gcrf.is_some());
        let shadow = sky.moon_shadow().expect("a Moon");
        assert!(shadow.reaches(DVec3::ZERO, 6.4e6));
        assert_eq!(Sky::new(DVec3::X).moon_shadow(), None);
        for lost in [DVec3::NAN, DVec3::INFINITY] {
            let moon_itrf_m = Some(lost);
            assert_eq!(Sky { moon_itrf_m, ..sky }.moon_shadow(), None);
            let sun_itrf = lost;
            assert_eq!(Sky { sun_itrf, ..sky }.moon_shadow(), None);
        }
    }

    #[test]
    fn the_moon_was_full_at_the_eclipse_of_july_2018_and_new_two_weeks_before() {
        let light = |text: &str| {
            let epoch = text.parse().expect("a date");
            Sky::at(epoch).moonlight().1
        };
        // Totality: 27 July 2018, 20:22 UTC, the Moon near apogee.
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
