//! The secular drift of an ellipse by the Earth's flattening.

use super::Conic;
use super::elements::angles;
use crate::constants::{EGM96_EQUATORIAL_RADIUS_M, EGM96_J2};
use glam::DVec3;

/// Average rates by J2, to first order (Vallado 2013, 9-37…9-41).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SecularRates {
    /// Of the RAAN, Ω̇, radians per second.
    pub raan_rad_s: f64,
    /// Of the argument of periapsis, ω̇, radians per second.
    pub argument_of_periapsis_rad_s: f64,
    /// Ṁ − n over n.
    pub mean_motion_relative: f64,
}

impl SecularRates {
    /// For an ellipse; `None` for other conics.
    ///
    /// With p = a(1 − e²): Ω̇ = −(3/2) n J2 (R/p)² cos i,  ω̇ = (3/4) n J2 (R/p)² (4 − 5 sin² i),
    /// Ṁ = n + (3/4) n J2 (R/p)² √(1 − e²) (2 − 3 sin² i).
    pub fn of(conic: &Conic) -> Option<Self> {
        let e = conic.eccentricity;
        if e >= 1.0 || conic.reciprocal_axis_1_m <= 0.0 || conic.periapsis_m <= 0.0 {
            return None;
        }
        let [i, ..] = angles(conic);
        let n = conic.mean_motion_rad_s();
        let p = conic.periapsis_m * (1.0 + e);
        let factor = 0.75 * EGM96_J2 * (EGM96_EQUATORIAL_RADIUS_M / p).powi(2);
        let sin2_i = i.sin().powi(2);
        Some(Self {
            raan_rad_s: -2.0 * n * factor * i.cos(),
            argument_of_periapsis_rad_s: n * factor * (4.0 - 5.0 * sin2_i),
            mean_motion_relative: factor * ((1.0 - e) * (1.0 + e)).sqrt() * (2.0 - 3.0 * sin2_i),
        })
    }

    /// The same with the mean motion that a state belongs to, of which the conic has the osculating axis only.
    ///
    /// Energy is kept under J2: −μ/2a − U2 at the state is −μ/2ā − ⟨U2⟩ of the mean axis ā, to first order, with
    /// U2 = −(μ J2 R²/2r³)(3 z²/r² − 1) and ⟨U2⟩ = (μ J2 R²/2a³)(1 − e²)^(−3/2)(1 − (3/2) sin² i).
    pub(super) fn with_mean_axis(self, conic: &Conic, position_m: DVec3) -> Self {
        let r = position_m.length();
        let (e, alpha) = (conic.eccentricity, conic.reciprocal_axis_1_m);
        let normal = conic.to_periapsis.cross(conic.across);
        let sin2_i = 1.0 - normal.z * normal.z;
        let half = 0.5 * EGM96_J2 * EGM96_EQUATORIAL_RADIUS_M.powi(2);
        let here = -half / r.powi(3) * (3.0 * (position_m.z / r).powi(2) - 1.0);
        let average =
            half * (alpha / ((1.0 - e) * (1.0 + e)).sqrt()).powi(3) * (1.0 - 1.5 * sin2_i);
        let mean = (alpha + 2.0 * (here - average)) / alpha;
        match mean > 0.0 {
            true => Self {
                mean_motion_relative: (1.0 + self.mean_motion_relative) * mean * mean.sqrt() - 1.0,
                ..self
            },
            false => self,
        }
    }
}
