//! An observer: the apparent directions of the Sun, the Moon and the stars.

use super::earth_motion::earth_motion;
use super::rotation::EARTH_ROTATION_RATE_RAD_S;
use super::sun::aberrated;
use super::time::JulianDate;
use super::{
    ASTRONOMICAL_UNIT_M, Duration, Epoch, Orientation, itrf_from_gcrf_oriented, moon,
    sun_position_gcrf_m,
};
use glam::{DMat3, DVec3};

const LIGHT_M_S: f64 = 299_792_458.0;
/// An eye farther away than this does not turn with the Earth, unless its velocity is given, metres.
const TURNS_WITH_THE_EARTH_M: f64 = 1e8;

/// An observer at a time, and the rotation between Earth-fixed axes and those of the stars.
///
/// Apparent directions include light time and the aberration by the Earth's and the observer's motion. They neglect the deflection of light by the
/// Sun (0.03″ at 15° from it, 1.75″ at its limb) and refraction by the air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observer {
    epoch: Epoch,
    itrf_from_gcrf: DMat3,
    /// From the Earth's centre, GCRF axes, metres.
    eye_gcrf_m: DVec3,
    /// From the barycentre, GCRF axes, parts of the speed of light.
    beta: DVec3,
    sun_gcrf_m: DVec3,
    /// From where the Earth is now to where the Moon was when its light left it, GCRF axes, metres.
    moon_gcrf_m: DVec3,
    /// When that was.
    moon_epoch: Epoch,
}

impl Observer {
    /// An observer at an ITRF position, metres, at rest on the rotating Earth; beyond 100 000 km at rest relative to the Earth's centre.
    pub fn at_rest(epoch: Epoch, orientation: &Orientation, eye_itrf_m: DVec3) -> Self {
        let turn = DVec3::Z * EARTH_ROTATION_RATE_RAD_S;
        let velocity = match eye_itrf_m.length() < TURNS_WITH_THE_EARTH_M {
            true => turn.cross(eye_itrf_m),
            false => DVec3::ZERO,
        };
        Self::moving(epoch, orientation, eye_itrf_m, velocity)
    }

    /// An observer at an ITRF position, metres, with a velocity relative to the Earth's centre, metres a second, in non-rotating axes that are
    /// aligned with ITRF at this time.
    pub fn moving(
        epoch: Epoch,
        orientation: &Orientation,
        eye_itrf_m: DVec3,
        velocity_m_s: DVec3,
    ) -> Self {
        let itrf_from_gcrf = itrf_from_gcrf_oriented(epoch, orientation);
        let gcrf_from_itrf = itrf_from_gcrf.transpose();
        let eye_gcrf_m = gcrf_from_itrf * eye_itrf_m;
        let (sun_gcrf_m, earth_m_s) = sun_and_velocity(epoch);
        let velocity = earth_m_s + gcrf_from_itrf * velocity_m_s;
        let (moon_gcrf_m, seconds) = moon::retarded(epoch, eye_gcrf_m);
        Self {
            epoch,
            itrf_from_gcrf,
            eye_gcrf_m,
            beta: velocity / LIGHT_M_S,
            sun_gcrf_m,
            // At that earlier time the Earth was at another place.
            moon_gcrf_m: moon_gcrf_m - earth_m_s * seconds,
            moon_epoch: epoch - Duration::from_seconds(seconds),
        }
    }

    /// The instant.
    pub fn epoch(&self) -> Epoch {
        self.epoch
    }

    /// Rotation from GCRF to ITRF axes.
    pub fn itrf_from_gcrf(&self) -> DMat3 {
        self.itrf_from_gcrf
    }

    /// Apparent direction of an object whose light arrives along a unit direction of GCRF axes: a unit vector in the same axes.
    pub fn seen(&self, natural: DVec3) -> DVec3 {
        let sun_au = (self.sun_gcrf_m - self.eye_gcrf_m).length() / ASTRONOMICAL_UNIT_M;
        // Nearer than a hundredth of its distance the Sun's potential would be all of it.
        aberrated(natural, self.beta, sun_au.max(0.01))
    }

    /// The Sun's centre as the eye sees it: from the eye, ITRF axes, metres.
    pub fn sun_m(&self) -> DVec3 {
        // The Sun moves 7 km while its light is on the way: 0.01″, left out.
        self.apparent_m(self.sun_gcrf_m - self.eye_gcrf_m)
    }

    /// The Moon's centre as the eye sees it: from the eye, ITRF axes, metres.
    pub fn moon_m(&self) -> DVec3 {
        self.apparent_m(self.moon_gcrf_m - self.eye_gcrf_m)
    }

    /// Rotation from ITRF axes to those of the Moon at the time when its light was emitted.
    pub fn moon_from_itrf(&self) -> DMat3 {
        moon::moon_from_gcrf(self.moon_epoch) * self.itrf_from_gcrf.transpose()
    }

    fn apparent_m(&self, from_eye_gcrf_m: DVec3) -> DVec3 {
        let distance = from_eye_gcrf_m.length();
        match from_eye_gcrf_m.try_normalize() {
            Some(natural) => self.itrf_from_gcrf * self.seen(natural) * distance,
            None => DVec3::ZERO,
        }
    }
}

/// The Sun from the Earth, metres, and how the Earth's centre moves about the barycentre, metres a second; GCRF axes.
fn sun_and_velocity(epoch: Epoch) -> (DVec3, DVec3) {
    const DAY_S: f64 = 86_400.0;
    match earth_motion(JulianDate::tt(epoch)) {
        Some(earth) => (
            -earth.from_sun_au * ASTRONOMICAL_UNIT_M,
            earth.velocity_au_day * (ASTRONOMICAL_UNIT_M / DAY_S),
        ),
        // About the Sun instead, 13 m/s from it.
        None => {
            let half_day = Duration::from_seconds(0.5 * DAY_S);
            let before = sun_position_gcrf_m(epoch - half_day);
            let after = sun_position_gcrf_m(epoch + half_day);
            (sun_position_gcrf_m(epoch), (before - after) / DAY_S)
        }
    }
}
