//! The secular drift of an ellipse by the Earth's flattening.

use super::{Conic, Elements};
use crate::orbit::constants::{EGM96_EQUATORIAL_RADIUS_M, EGM96_J2};

/// Average rates by J2, to first order (Vallado 2013, 9-37…9-41).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SecularRates {
    /// Ω̇, radians per second.
    pub node_rad_s: f64,
    /// ω̇, radians per second.
    pub argument_rad_s: f64,
    /// Ṁ − n over n.
    pub mean_motion_relative: f64,
}

impl SecularRates {
    /// Of an ellipse; `None` of anything else.
    ///
    /// With p = a(1 − e²): Ω̇ = −(3/2) n J2 (R/p)² cos i,  ω̇ = (3/4) n J2 (R/p)² (4 − 5 sin² i),
    /// Ṁ = n + (3/4) n J2 (R/p)² √(1 − e²) (2 − 3 sin² i).
    pub fn of(conic: &Conic) -> Option<Self> {
        let e = conic.eccentricity;
        if e >= 1.0 || conic.reciprocal_axis_1_m <= 0.0 || conic.periapsis_m <= 0.0 {
            return None;
        }
        let i = Elements::of(conic).inclination_rad;
        let n = conic.mean_motion_rad_s();
        let p = conic.periapsis_m * (1.0 + e);
        let factor = 0.75 * EGM96_J2 * (EGM96_EQUATORIAL_RADIUS_M / p).powi(2);
        let sin2_i = i.sin().powi(2);
        Some(Self {
            node_rad_s: -2.0 * n * factor * i.cos(),
            argument_rad_s: n * factor * (4.0 - 5.0 * sin2_i),
            mean_motion_relative: factor * ((1.0 - e) * (1.0 + e)).sqrt() * (2.0 - 3.0 * sin2_i),
        })
    }
}
