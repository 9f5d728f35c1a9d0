//! How spacecraft are turned: by rules, or by files.

use super::camera::OrbitalMotion;
use crate::scene::{AttitudeName, AttitudeSource, Spin};
use glam::{DMat3, DVec3};
use std::sync::Arc;
use terrella::Sky;
use terrella::frames::{Ellipsoid, Epoch, Orientation};
use terrella_orbit::{AttitudeError, AttitudeHistory, Frame};

/// Source of a spacecraft's attitude, opened.
#[derive(Clone)]
pub enum Attitude {
    Rule(AttitudeName),
    /// A rule, and on top of it a spin from an epoch on.
    Spinning(AttitudeName, Spin, Epoch),
    File(Arc<AttitudeHistory>),
}

/// Inputs of an attitude.
pub struct AttitudeMoment<'m> {
    pub epoch: Epoch,
    pub motion: &'m OrbitalMotion,
    pub ellipsoid: &'m Ellipsoid,
    pub sky: &'m Sky,
    pub orientation: &'m Orientation,
}

impl Attitude {
    /// Reads the file, where there is one.
    pub fn open(source: &AttitudeSource) -> Result<Self, AttitudeError> {
        Ok(match source {
            AttitudeSource::Rule(rule) => Self::Rule(*rule),
            AttitudeSource::File(path) => Self::File(Arc::new(AttitudeHistory::open(path)?)),
        })
    }

    /// Checks that the attitude is known from one epoch to another.
    ///
    /// # Errors
    /// The first epoch at which it is unknown, and the time span of the file.
    pub fn check_span(&self, first: Epoch, last: Epoch) -> Result<(), AttitudeError> {
        match self {
            Self::Rule(_) | Self::Spinning(..) => Ok(()),
            Self::File(history) => history.check_span(first, last),
        }
    }

    /// Rotation from the spacecraft's axes to ITRF.
    ///
    /// # Errors
    /// An epoch at which a file has no attitude.
    pub fn itrf_from_craft(&self, moment: &AttitudeMoment<'_>) -> Result<DMat3, AttitudeError> {
        let level = || moment.motion.itrf_from_level(moment.ellipsoid);
        match self {
            Self::Rule(AttitudeName::Nadir) => Ok(level()),
            Self::Rule(AttitudeName::Sun) => Ok(facing(moment.sky.sun_itrf, &level())),
            Self::Rule(AttitudeName::Inertial) => {
                let of_date = || Frame::Gcrf.itrf_from(moment.epoch, moment.orientation);
                // A simulation has its own Earth orientation.
                Ok(moment.sky.itrf_from_gcrf.unwrap_or_else(of_date))
            }
            Self::Spinning(rule, spin, start) => {
                let axes = Self::Rule(*rule).itrf_from_craft(moment)?;
                let turned_deg = spin.rate_deg_s * (moment.epoch - *start).to_seconds();
                let axis = spin.axis.normalize_or(DVec3::Z);
                // Of many turns the whole ones do not count.
                let turned_rad = (turned_deg % 360.0).to_radians();
                Ok(axes * DMat3::from_axis_angle(axis, turned_rad))
            }
            Self::File(history) => history.itrf_from_body(moment.epoch, moment.orientation),
        }
    }
}

/// Axes with −z to the Sun and x as close as possible to that of level flight, or to its y if the Sun is straight ahead.
fn facing(sun_itrf: DVec3, level: &DMat3) -> DMat3 {
    let down = -sun_itrf.normalize_or(-level.z_axis);
    let ahead = level.x_axis.reject_from_normalized(down);
    let ahead = match ahead.length() > 1e-6 {
        true => ahead.normalize(),
        false => level.y_axis.reject_from_normalized(down).normalize(),
    };
    DMat3::from_cols(ahead, down.cross(ahead), down)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moment<'m>(motion: &'m OrbitalMotion, sky: &'m Sky) -> AttitudeMoment<'m> {
        AttitudeMoment {
            epoch: Epoch::default(),
            motion,
            ellipsoid: &Ellipsoid::WGS84,
            sky,
            orientation: &Orientation {
                ut1_minus_utc_s: 0.0,
                x_pole_rad: 0.0,
                y_pole_rad: 0.0,
            },
        }
    }

    #[test]
    fn rules_turn_as_their_words_say() {
        // Over the equator at 0° E, flying east.
        let motion = OrbitalMotion {
            position_itrf_m: DVec3::X * 7e6,
            velocity_m_s: DVec3::Y * 7_500.0,
        };
        let sun = DVec3::new(0.6, 0.48, 0.64);
        let mut sky = Sky::new(sun);
        sky.itrf_from_gcrf = Some(DMat3::from_rotation_z(1.0));
        let of = |rule, sky: &Sky| {
            let attitude = Attitude::Rule(rule);
            attitude.itrf_from_craft(&moment(&motion, sky)).unwrap()
        };
        let level = of(AttitudeName::Nadir, &sky);
        assert!(
            level.x_axis.distance(DVec3::Y) < 1e-12 && level.z_axis.distance(DVec3::NEG_X) < 1e-12
        );
        let sunward = of(AttitudeName::Sun, &sky);
        assert!(sunward.z_axis.distance(-sun) < 1e-12);
        // The part of the flight direction across the Sun: √(1 − 0.48²).
        assert!((sunward.x_axis.y - (1.0_f64 - 0.48 * 0.48).sqrt()).abs() < 1e-12);
        assert!((sunward.determinant() - 1.0).abs() < 1e-12);
        assert_eq!(
            of(AttitudeName::Inertial, &sky),
            DMat3::from_rotation_z(1.0)
        );
        // A quarter turn after 15 s about z of the craft: its x is where its y was.
        let spin = Spin {
            axis: DVec3::Z * 2.0,
            rate_deg_s: 6.0 + 360.0,
        };
        let start = Epoch::default() - 15.0 * hifitime::Unit::Second;
        let attitude = Attitude::Spinning(AttitudeName::Nadir, spin, start);
        let spun = attitude.itrf_from_craft(&moment(&motion, &sky)).unwrap();
        assert!(spun.x_axis.distance(level.y_axis) < 1e-12, "{spun}");
        assert!(spun.z_axis.distance(level.z_axis) < 1e-12);
        for ahead in [DVec3::Y, DVec3::NEG_Y] {
            let turned = of(AttitudeName::Sun, &Sky::new(ahead));
            assert!((turned.determinant() - 1.0).abs() < 1e-12, "{turned}");
        }
    }
}
