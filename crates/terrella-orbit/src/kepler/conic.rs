//! Motion on a conic of any kind, from a circle over the parabola and the straight line to the hyperbola.

use super::stumpff::Universal;
use crate::StartError;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// A conic about the Earth's centre, its axes, and when its periapsis is passed.
///
/// Everything is counted from the periapsis by the universal variable χ (Battin 1999, 4.5), with the functions U_k(χ)
/// of α = 1/a. In this form nothing depends on the kind of conic, and nothing cancels at e = 0 or e = 1:
///
/// √μ t = q χ + e U3,  r = q + e U2,  x = q − U2,  y = √p U1,  ẋ = −√μ U1/r,  ẏ = √(μp) U0/r.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conic {
    /// Gravitational parameter μ, m³/s².
    pub gm_m3_s2: f64,
    /// Distance of the periapsis from the centre, q, metres; 0 for a fall along a straight line.
    pub periapsis_m: f64,
    /// Eccentricity e.
    pub eccentricity: f64,
    /// α = 1/a = (1 − e)/q, 1/m: above 0 for ellipses, below for hyperbolas. Held apart because 1 − e has no digits left
    /// where e is close to 1.
    pub reciprocal_axis_1_m: f64,
    /// Towards the periapsis, unit.
    pub to_periapsis: DVec3,
    /// 90° on in the direction of motion, unit.
    pub across: DVec3,
    /// Time from the periapsis to the epoch, seconds.
    pub since_periapsis_s: f64,
}

/// Position, metres, and velocity, metres per second.
pub(super) type PositionVelocity = (DVec3, DVec3);

/// Bound on the solver's rounds; each halves the bracket at least, and no bracket has more than 2 000 binary digits.
const MAX_ROUNDS: u32 = 2_200;

impl Conic {
    /// The conic through a position (m) with a velocity (m/s), both finite, the position not zero.
    ///
    /// # Errors
    /// A number that is not finite, a position at the centre, a speed that overflows.
    pub fn from_state(
        gm_m3_s2: f64,
        position_m: DVec3,
        velocity_m_s: DVec3,
    ) -> Result<Self, StartError> {
        let finite = |field, v: DVec3| match v.is_finite() {
            true => Ok(()),
            false => Err(StartError::NotFinite { field }),
        };
        finite("position", position_m)?;
        finite("velocity", velocity_m_s)?;
        let range = |field, value, expected| StartError::Range {
            field,
            value,
            expected,
        };
        let r = position_m.length();
        if !(1e-3..=1e15).contains(&r) {
            return Err(range(
                "distance from the Earth's centre, m,",
                r,
                "0.001…1e15",
            ));
        }
        let speed = velocity_m_s.length();
        if speed > 3e8 {
            return Err(range("speed, m/s,", speed, "at most 3e8"));
        }
        let mu = gm_m3_s2;
        // α = 2/r − v²/μ, p = h²/μ, e⃗ = v × h/μ − r/|r|.
        let alpha = 2.0 / r - velocity_m_s.length_squared() / mu;
        let h = position_m.cross(velocity_m_s);
        let p = h.length_squared() / mu;
        let e_vector = velocity_m_s.cross(h) / mu - position_m / r;
        // 1 − e² = αp keeps its digits near e = 1, the vector near 0.
        let by_vector = e_vector.length();
        let e = match by_vector {
            0.0..0.5 => by_vector,
            _ => (1.0 - alpha * p).max(0.0).sqrt(),
        };
        let q = p / (1.0 + e);
        let to_periapsis = e_vector.try_normalize().unwrap_or(position_m / r);
        let normal = h
            .try_normalize()
            .unwrap_or_else(|| to_periapsis.any_orthonormal_vector());
        // Made square again: near e = 0 the periapsis is known to few digits only.
        let across = normal
            .cross(to_periapsis)
            .normalize_or(to_periapsis.any_orthonormal_vector());
        let to_periapsis = across.cross(normal).normalize_or(to_periapsis);
        let mut conic = Self {
            gm_m3_s2,
            periapsis_m: q,
            eccentricity: e,
            reciprocal_axis_1_m: alpha,
            to_periapsis,
            across,
            since_periapsis_s: 0.0,
        };
        // r·v/√μ = e U1; for small e from y = √p U1.
        let u1 = match e {
            0.0..0.5 => position_m.dot(across) / p.sqrt(),
            _ => position_m.dot(velocity_m_s) / mu.sqrt() / e,
        };
        let u2 = match e {
            0.0..0.5 => q - position_m.dot(to_periapsis),
            _ => (r - q) / e,
        };
        conic.since_periapsis_s = conic.time_at(conic.chi_from(u1, u2));
        Ok(conic)
    }

    /// Position and velocity `whole_s + rest_s` seconds after the epoch.
    ///
    /// In two parts, so that whole turns are taken off without rounding: `whole_s` should be a whole number.
    pub(super) fn at(&self, whole_s: f64, rest_s: f64) -> PositionVelocity {
        let chi = self.chi_at(whole_s, rest_s);
        let (plane_m, plane_m_s) = self.in_plane(chi);
        (
            self.to_periapsis * plane_m.0 + self.across * plane_m.1,
            self.to_periapsis * plane_m_s.0 + self.across * plane_m_s.1,
        )
    }

    /// Position (m) and velocity (m/s) `seconds` after the epoch.
    pub fn state_after(&self, seconds: f64) -> PositionVelocity {
        self.at(seconds.trunc(), seconds.fract())
    }

    /// Period, seconds; `None` for an open orbit.
    pub fn period_s(&self) -> Option<f64> {
        let alpha = self.reciprocal_axis_1_m;
        let period = TAU / (self.gm_m3_s2.sqrt() * alpha * alpha.sqrt());
        (alpha > 0.0 && period.is_finite()).then_some(period)
    }

    /// Coordinates in the plane of motion, metres and metres per second.
    pub(super) fn in_plane(&self, chi: f64) -> ((f64, f64), (f64, f64)) {
        let (q, e, mu) = (self.periapsis_m, self.eccentricity, self.gm_m3_s2);
        let u = Universal::at(chi, self.reciprocal_axis_1_m);
        let p = q * (1.0 + e);
        let r = q + e * u.u2;
        (
            (q - u.u2, p.sqrt() * u.u1),
            (-mu.sqrt() * u.u1 / r, (mu * p).sqrt() * u.u0 / r),
        )
    }

    /// Distance from the centre, metres, and the time after the epoch, seconds, at χ.
    pub(super) fn radius_and_time(&self, chi: f64) -> (f64, f64) {
        let u = Universal::at(chi, self.reciprocal_axis_1_m);
        (
            self.periapsis_m + self.eccentricity * u.u2,
            self.time_at(chi) - self.since_periapsis_s,
        )
    }

    /// χ from U1 and U2.
    pub(super) fn chi_from(&self, u1: f64, u2: f64) -> f64 {
        let alpha = self.reciprocal_axis_1_m;
        let root = alpha.abs().sqrt();
        if alpha > 0.0 {
            (root * u1).atan2(1.0 - alpha * u2) / root
        } else if alpha < 0.0 {
            (root * u1).asinh() / root
        } else {
            u1
        }
    }

    /// Time from the periapsis, seconds.
    pub(super) fn time_at(&self, chi: f64) -> f64 {
        let u = Universal::at(chi, self.reciprocal_axis_1_m);
        (self.periapsis_m * chi + self.eccentricity * u.u3) / self.gm_m3_s2.sqrt()
    }

    /// χ at a time after the epoch. On an ellipse the nearest turn's, −π…π.
    pub(super) fn chi_at(&self, whole_s: f64, rest_s: f64) -> f64 {
        let rest_s = rest_s + self.since_periapsis_s;
        let t = match self.period_s() {
            Some(period) => {
                let turns = ((whole_s + rest_s) / period).round();
                (-turns).mul_add(period, whole_s) + rest_s
            }
            None => whole_s + rest_s,
        };
        let (chi, _) = self.solve(self.gm_m3_s2.sqrt() * t.abs());
        chi.copysign(t)
    }

    /// The χ ≥ 0 at which q χ + e U3 = τ, for τ ≥ 0, and the rounds that it took.
    ///
    /// The left side rises and (up to half a turn) is convex, so Newton's method comes down on the root from the right;
    /// the bracket holds it where rounding has the last word.
    pub(super) fn solve(&self, tau: f64) -> (f64, u32) {
        let (q, e, alpha) = (
            self.periapsis_m,
            self.eccentricity,
            self.reciprocal_axis_1_m,
        );
        if tau == 0.0 {
            return (0.0, 0);
        }
        let value = |chi: f64| {
            let u = Universal::at(chi, alpha);
            (q * chi + e * u.u3 - tau, q + e * u.u2)
        };
        let (mut low, mut high) = (0.0, f64::INFINITY);
        if alpha > 0.0 {
            // Half a turn, and a little more: τ may be rounded beyond it.
            high = PI / alpha.sqrt() * (1.0 + 1e-14);
        }
        // Where only one of the terms counts: q χ = τ, or χ³ e/6 = τ.
        let mut chi = (tau / q).min((6.0 * tau / e).cbrt()).min(high);
        if alpha < 0.0 {
            // Far out on a hyperbola e sinh H = M nearly, H = √−α χ, and Newton's method would come down by one in H a round.
            let root = (-alpha).sqrt();
            chi = chi.min((2.0 * tau * root * root * root / e + 1.8).ln() / root);
        }
        let mut before = f64::INFINITY;
        for round in 1..=MAX_ROUNDS {
            let (f, slope) = value(chi);
            if f == 0.0 {
                return (chi, round);
            }
            // Overflow counts as too far.
            if f < 0.0 {
                low = chi;
            } else {
                high = chi;
            }
            let newton = chi - f / slope;
            // All that is left is rounding.
            if f.abs() <= 2.0 * f64::EPSILON * tau || (newton - chi).abs() <= f64::EPSILON * chi {
                return (newton.clamp(low, high), round);
            }
            let slow = f.abs() > 0.5 * before;
            before = f.abs();
            let next = if newton > low && newton < high && !slow {
                newton
            } else if high.is_finite() {
                before = f64::INFINITY;
                match low > 0.0 && high > 4.0 * low {
                    true => low.sqrt() * high.sqrt(),
                    false => low + 0.5 * (high - low),
                }
            } else {
                2.0 * chi
            };
            if (next - chi).abs() <= 2.0 * f64::EPSILON * chi.abs() || next <= low || next >= high {
                return (next.clamp(low, high.min(f64::MAX)), round);
            }
            chi = next;
        }
        (chi, MAX_ROUNDS)
    }
}
