//! Keplerian (classical) elements: semi-major axis or periapsis, eccentricity, inclination, RAAN, argument of periapsis, anomaly.

use super::{Conic, KeplerError};
use crate::StartError;
use glam::DVec3;
use std::f64::consts::TAU;
use terrella_frames::Epoch;

/// Size of a conic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OrbitSize {
    /// Semi-major axis a, metres; negative for hyperbolas, undefined for a parabola.
    SemiMajorAxis(f64),
    /// Distance of the periapsis from the Earth's centre q, metres, above 0.
    Periapsis(f64),
}

/// Position on the conic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Anomaly {
    /// True anomaly ν, radians.
    True(f64),
    /// Mean anomaly M, radians. On a hyperbola M = √(μ/|a|³) t; undefined for a parabola.
    Mean(f64),
    /// The epoch of a passage of the periapsis.
    PeriapsisAt(Epoch),
}

/// Classical elements of an ellipse, parabola or hyperbola. They are undefined for a rectilinear fall: use a state vector instead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeplerElements {
    /// How large it is.
    pub size: OrbitSize,
    /// Eccentricity e, 0 or more.
    pub eccentricity: f64,
    /// Inclination i, radians, 0…π.
    pub inclination_rad: f64,
    /// Right ascension of the ascending node (RAAN) Ω, radians.
    pub raan_rad: f64,
    /// Argument of periapsis ω, radians.
    pub argument_of_periapsis_rad: f64,
    /// Where on it, at the epoch.
    pub anomaly: Anomaly,
}

/// Sizes in metres that anything about the Earth can have; also what keeps products finite.
const SIZES_M: std::ops::RangeInclusive<f64> = 1.0..=1e15;

impl KeplerElements {
    /// The conic at `epoch` about a centre of the given μ, m³/s².
    ///
    /// # Errors
    /// Numbers that are not finite or out of range, a size and an eccentricity that do not go together, an anomaly that
    /// the conic does not have.
    pub fn conic(&self, gm_m3_s2: f64, epoch: Epoch) -> Result<Conic, KeplerError> {
        self.check_finite()?;
        let range = |field, value, expected| {
            Err(KeplerError::from(StartError::Range {
                field,
                value,
                expected,
            }))
        };
        let e = self.eccentricity;
        if !(0.0..=1e6).contains(&e) {
            return range("eccentricity", e, "0…1e6");
        }
        let i = self.inclination_rad;
        if !(0.0..=std::f64::consts::PI).contains(&i) {
            return range("inclination, rad,", i, "0…π");
        }
        let (q, alpha) = match self.size {
            OrbitSize::SemiMajorAxis(a) => {
                if e == 1.0 || (a > 0.0) != (e < 1.0) {
                    return Err(KeplerError::Contradiction {
                        axis_m: a,
                        eccentricity: e,
                    });
                }
                if !SIZES_M.contains(&a.abs()) {
                    return range("semi-major axis, m,", a, "1…1e15 in size");
                }
                (a * (1.0 - e), 1.0 / a)
            }
            OrbitSize::Periapsis(q) => {
                if !SIZES_M.contains(&q) {
                    return range("periapsis radius, m,", q, "1…1e15");
                }
                (q, (1.0 - e) / q)
            }
        };
        let [to_periapsis, across] = plane(
            self.inclination_rad,
            self.raan_rad,
            self.argument_of_periapsis_rad,
        );
        let mut conic = Conic {
            gm_m3_s2,
            periapsis_m: q,
            eccentricity: e,
            reciprocal_axis_1_m: alpha,
            to_periapsis,
            across,
            since_periapsis_s: 0.0,
        };
        conic.since_periapsis_s = match self.anomaly {
            Anomaly::PeriapsisAt(at) => (epoch - at).to_seconds(),
            Anomaly::Mean(_) if e == 1.0 => return Err(KeplerError::NoMeanAnomaly),
            Anomaly::Mean(m) => {
                // An ellipse's is taken to −π…π, where it has most digits.
                let m = if e < 1.0 {
                    m - TAU * (m / TAU).round()
                } else {
                    m
                };
                m / conic.mean_motion_rad_s()
            }
            Anomaly::True(nu) => conic.time_at(chi_of_true_anomaly(&conic, nu)?),
        };
        Ok(conic)
    }

    /// Elements of a conic; angles from 0 to 2π, where a circle's periapsis is put into its node and an equatorial
    /// orbit's node to 0. The anomaly is the true one at the epoch.
    pub fn of(conic: &Conic) -> Self {
        let [inclination_rad, raan_rad, argument] = angles(conic);
        let ((x, y), _) = conic.in_plane(conic.chi_at(0.0, 0.0));
        let circle = conic.eccentricity < 1e-14;
        let argument_of_periapsis_rad = if circle { 0.0 } else { argument };
        // From the node to the place, less what the periapsis has of it.
        let nu = y.atan2(x) + argument - argument_of_periapsis_rad;
        Self {
            size: match conic.eccentricity {
                0.0..0.9 => OrbitSize::SemiMajorAxis(1.0 / conic.reciprocal_axis_1_m),
                _ => OrbitSize::Periapsis(conic.periapsis_m),
            },
            eccentricity: conic.eccentricity,
            inclination_rad,
            raan_rad: raan_rad.rem_euclid(TAU),
            argument_of_periapsis_rad: argument_of_periapsis_rad.rem_euclid(TAU),
            anomaly: Anomaly::True(nu - TAU * (nu / TAU).round()),
        }
    }

    fn check_finite(&self) -> Result<(), StartError> {
        let (size_name, size) = match self.size {
            OrbitSize::SemiMajorAxis(a) => ("semi-major axis", a),
            OrbitSize::Periapsis(q) => ("periapsis radius", q),
        };
        let (anomaly_name, anomaly) = match self.anomaly {
            Anomaly::True(nu) => ("true anomaly", nu),
            Anomaly::Mean(m) => ("mean anomaly", m),
            Anomaly::PeriapsisAt(_) => ("time of periapsis", 0.0),
        };
        let numbers = [
            (size_name, size),
            ("eccentricity", self.eccentricity),
            ("inclination", self.inclination_rad),
            ("right ascension of the ascending node", self.raan_rad),
            ("argument of the periapsis", self.argument_of_periapsis_rad),
            (anomaly_name, anomaly),
        ];
        match numbers.iter().find(|(_, value)| !value.is_finite()) {
            Some(&(field, _)) => Err(StartError::NotFinite { field }),
            None => Ok(()),
        }
    }
}

impl Conic {
    /// n = √(μ/|a|³), radians per second; 0 for a parabola.
    pub fn mean_motion_rad_s(&self) -> f64 {
        let alpha = self.reciprocal_axis_1_m.abs();
        self.gm_m3_s2.sqrt() * alpha * alpha.sqrt()
    }
}

/// Inclination, node and argument of the periapsis of a conic, radians, −π…π; a circle's axes count as any other's.
pub(super) fn angles(conic: &Conic) -> [f64; 3] {
    let normal = conic.to_periapsis.cross(conic.across);
    let horizontal = normal.x.hypot(normal.y);
    let (node, raan_rad) = match horizontal > 1e-12 {
        true => (
            DVec3::new(-normal.y, normal.x, 0.0) / horizontal,
            normal.x.atan2(-normal.y),
        ),
        false => (DVec3::X, 0.0),
    };
    let ahead = normal.cross(node);
    let argument_of_periapsis_rad = conic
        .to_periapsis
        .dot(ahead)
        .atan2(conic.to_periapsis.dot(node));
    [
        horizontal.atan2(normal.z),
        raan_rad,
        argument_of_periapsis_rad,
    ]
}

/// Unit vectors to the periapsis and 90° on: R3(−Ω) R1(−i) R3(−ω) applied to x and y.
pub(super) fn plane(
    inclination_rad: f64,
    raan_rad: f64,
    argument_of_periapsis_rad: f64,
) -> [DVec3; 2] {
    let (sin_i, cos_i) = inclination_rad.sin_cos();
    let (sin_o, cos_o) = raan_rad.sin_cos();
    let node = DVec3::new(cos_o, sin_o, 0.0);
    let ahead = DVec3::new(-sin_o * cos_i, cos_o * cos_i, sin_i);
    let (sin_w, cos_w) = argument_of_periapsis_rad.sin_cos();
    [node * cos_w + ahead * sin_w, ahead * cos_w - node * sin_w]
}

fn chi_of_true_anomaly(conic: &Conic, nu: f64) -> Result<f64, KeplerError> {
    let (q, e) = (conic.periapsis_m, conic.eccentricity);
    let nu = nu - TAU * (nu / TAU).round();
    let (sin_nu, cos_nu) = nu.sin_cos();
    let p = q * (1.0 + e);
    // r = p/(1 + e cos ν), U1 = r sin ν/√p, U2 = q − r cos ν = r (1 − cos ν)/(1 + e).
    let denominator = 1.0 + e * cos_nu;
    let r = p / denominator;
    if denominator <= 0.0 || (e >= 1.0 && r > 1e18) {
        return Err(KeplerError::BeyondAsymptote {
            anomaly_deg: nu.to_degrees(),
            eccentricity: e,
            most_deg: (-1.0 / e).acos().to_degrees(),
        });
    }
    let half = (0.5 * nu).sin();
    Ok(conic.chi_from(r * sin_nu / p.sqrt(), 2.0 * r * half * half / (1.0 + e)))
}
