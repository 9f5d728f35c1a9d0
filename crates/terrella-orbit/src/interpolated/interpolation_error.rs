//! The error of interpolated ephemerides against a Kepler orbit, by degree and step.

use super::{InterpolatedStates, Interpolation, InterpolationError, StateSample};
use crate::Frame;
use glam::DVec3;
use terrella_frames::{Duration, Epoch};

/// An unperturbed orbit in its own plane, x to perigee.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeplerOrbit {
    /// Half the long axis, metres.
    pub semi_major_axis_m: f64,
    /// Eccentricity, 0…0.9.
    pub eccentricity: f64,
}

/// The Earth's gravitational parameter, m³/s² (EGM96).
const MU_M3_S2: f64 = 3.986_004_418e14;

impl KeplerOrbit {
    /// 400 km high, 92.6 min.
    pub const LOW: Self = Self {
        semi_major_axis_m: 6_778_000.0,
        eccentricity: 0.001,
    };
    /// Twelve hours, perigee 660 km high.
    pub const MOLNIYA: Self = Self {
        semi_major_axis_m: 26_560_000.0,
        eccentricity: 0.735,
    };
    /// One sidereal day.
    pub const GEOSTATIONARY: Self = Self {
        semi_major_axis_m: 42_164_170.0,
        eccentricity: 0.0,
    };

    /// Mean motion n = √(μ/a³), radians per second.
    pub fn mean_motion_rad_s(&self) -> f64 {
        (MU_M3_S2 / self.semi_major_axis_m.powi(3)).sqrt()
    }

    /// Position and velocity `t_s` seconds after perigee, metres and metres per second.
    pub fn state(&self, t_s: f64) -> (DVec3, DVec3) {
        let (a, e, n) = (
            self.semi_major_axis_m,
            self.eccentricity,
            self.mean_motion_rad_s(),
        );
        let turn = std::f64::consts::TAU;
        let mean = (n * t_s + turn / 2.0).rem_euclid(turn) - turn / 2.0;
        // E − e sin E = M by Newton's method; from π·sign it converges for every e below 1.
        let mut anomaly = match e < 0.5 {
            true => mean,
            false => mean.signum() * turn / 2.0,
        };
        for _ in 0..50 {
            let step = (anomaly - e * anomaly.sin() - mean) / (1.0 - e * anomaly.cos());
            anomaly -= step;
            if step.abs() < 1e-15 {
                break;
            }
        }
        let (sin, cos) = anomaly.sin_cos();
        let b = a * (1.0 - e * e).sqrt();
        let rate = n / (1.0 - e * cos);
        (
            DVec3::new(a * (cos - e), b * sin, 0.0),
            DVec3::new(-a * sin * rate, b * cos * rate, 0.0),
        )
    }
}

/// The largest errors found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WorstDifference {
    /// Of the position, metres.
    pub position_m: f64,
    /// Of the velocity, metres per second.
    pub velocity_m_s: f64,
}

/// The largest difference between `orbit` and the interpolation of its states at intervals of `step_s` seconds, over one revolution, perigee
/// included, in the inner part of an ephemeris (at its ends it is larger).
///
/// Largest error in metres, in low orbit ([`KeplerOrbit::LOW`]) and, after the slash, at a Molniya's perigee:
///
/// | degree | 30 s | 60 s | 120 s | 300 s | 600 s |
/// |---|---|---|---|---|---|
/// | linear | 980 / 900 | 3.9e3 / 3.6e3 | 1.6e4 / 1.4e4 | 9.8e4 / 8.8e4 | 3.9e5 / 3.3e5 |
/// | Lagrange 5 | 5e-5 / 2e-3 | 3e-3 / 0.1 | 0.2 / 6 | 51 / 1.0e3 | 3.1e3 / 2.6e4 |
/// | Lagrange 7 | 1e-8 / 1e-5 | 4e-6 / 3e-3 | 9e-4 / 0.6 | 1.4 / 380 | 320 / 1.8e4 |
/// | Lagrange 9 | 1e-8 / 1e-7 | 9e-9 / 1e-4 | 5e-6 / 0.1 | 0.05 / 200 | 39 / 1.4e4 |
/// | Lagrange 11 | 1e-8 / 3e-8 | 8e-9 / 9e-6 | 5e-8 / 0.02 | 2e-3 / 130 | 6.5 / 1.2e4 |
/// | Hermite 3 | 0.02 / 0.06 | 0.4 / 1.0 | 6 / 16 | 240 / 580 | 3.7e3 / 7.8e3 |
/// | Hermite 5 | 2e-6 / 6e-5 | 1e-4 / 4e-3 | 9e-3 / 0.3 | 2.1 / 57 | 130 / 2.7e3 |
/// | Hermite 7 | 1e-8 / 9e-8 | 3e-8 / 2e-5 | 7e-6 / 5e-3 | 0.01 / 5.6 | 2.6 / 650 |
/// | Hermite 9 | 1e-8 / 5e-8 | 7e-9 / 3e-7 | 1e-8 / 3e-4 | 1e-4 / 1.7 | 0.1 / 490 |
///
/// Values of about 1e-8 and 5e-8 are the rounding of the orbit itself.
///
/// Ten times in each step are compared. Steps are clamped to at most half a revolution and at least 1 s.
///
/// # Errors
/// If the degree is not supported.
pub fn interpolation_error(
    interpolation: Interpolation,
    step_s: f64,
    orbit: &KeplerOrbit,
) -> Result<WorstDifference, InterpolationError> {
    const WITHIN_STEP: i64 = 10;
    let period_s = std::f64::consts::TAU / orbit.mean_motion_rad_s();
    // In whole tenths of a step, in nanoseconds, so that instants are exact.
    let tenth_ns = (step_s.clamp(1.0, period_s / 2.0) * 1e8).round() as i64;
    let half_revolution = (period_s * 0.5e9 / (tenth_ns * WITHIN_STEP) as f64).ceil() as i64;
    let margin = interpolation.samples() as i64;
    let start = Epoch::from_tai_seconds(3e9);
    // From perigee, in tenths of a step.
    let instant = |tenths: i64| {
        let ns = tenths * tenth_ns;
        (
            start + Duration::from_total_nanoseconds(i128::from(ns)),
            orbit.state(ns as f64 * 1e-9),
        )
    };
    let samples: Vec<_> = (-half_revolution - margin..=half_revolution + margin)
        .map(|k| {
            let (epoch, (position_m, velocity)) = instant(k * WITHIN_STEP);
            StateSample {
                epoch,
                position_m,
                velocity_m_s: Some(velocity),
            }
        })
        .collect();
    let sampled = InterpolatedStates::new(Frame::Gcrf, &samples, interpolation)?;
    let mut worst = WorstDifference::default();
    for tenths in -half_revolution * WITHIN_STEP..=half_revolution * WITHIN_STEP {
        let (epoch, (position, velocity)) = instant(tenths);
        if let Some(state) = sampled.state_at(epoch) {
            let (dr, dv) = (
                state.position_m.distance(position),
                state.velocity_m_s.distance(velocity),
            );
            worst.position_m = worst.position_m.max(dr);
            worst.velocity_m_s = worst.velocity_m_s.max(dv);
        }
    }
    Ok(worst)
}
