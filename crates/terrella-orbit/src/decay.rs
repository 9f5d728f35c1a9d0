//! Validity of SGP4: from the epoch to the first time, forwards or backwards, at which it returns no orbit.
//!
//! SGP4 models drag as a polynomial in time. After a decay the polynomial rises again, and the orbit with it: weeks later a satellite that has
//! burnt up would be millions of kilometres away. Results after a failure are therefore never used, however plausible. The limit does not depend on
//! the requested time: the search starts at the epoch and proceeds outwards.

use super::OrbitState;

/// The gravitational parameter of SGP4's constants (WGS72), m³/s².
const MU_M3_S2: f64 = 3.986_008e14;
/// Perigees of the osculating ellipse swing about the lowest place by less, metres: the short-period terms of J2.
const MARGIN_M: f64 = 40_000.0;
/// Longest leap, milliseconds: a quarter of the Moon's shorter period, by which perigees of long ellipses swing.
const LONGEST_LEAP_MS: i64 = 4 * 86_400_000;
/// Steps of a revolution whose perigee is close to the ground.
const STEPS_A_REVOLUTION: f64 = 32.0;
/// Drag moves no orbit so far within the time for which elements hold; SGP4's series does, where it has left its range.
const MOST_GROWTH: f64 = 2.0;

/// The ellipse that touches the motion at an instant.
#[derive(Clone, Copy, Debug)]
pub(super) struct Osculating {
    radius_m: f64,
    /// Rate of the radius, metres per second.
    rate_m_s: f64,
    perigee_m: f64,
    /// Half the long axis, metres; infinite where the motion is not bound.
    axis_m: f64,
}

impl Osculating {
    pub fn of(state: &OrbitState) -> Self {
        let (r, v) = (state.position_m, state.velocity_m_s);
        let radius_m = r.length();
        // v²/2 − μ/r = −μ/2a, and p = h²/μ = q (1 + e).
        let energy = v.length_squared() / 2.0 - MU_M3_S2 / radius_m;
        let parameter_m = r.cross(v).length_squared() / MU_M3_S2;
        let eccentricity = (1.0 + 2.0 * energy * parameter_m / MU_M3_S2).max(0.0);
        Self {
            radius_m,
            rate_m_s: r.dot(v) / radius_m,
            perigee_m: parameter_m / (1.0 + eccentricity.sqrt()),
            axis_m: match energy < 0.0 {
                true => -MU_M3_S2 / (2.0 * energy),
                false => f64::INFINITY,
            },
        }
    }

    /// Whether drag can have changed the orbit at the epoch into this one.
    pub fn is_like(&self, at_epoch: &Self) -> bool {
        self.axis_m <= MOST_GROWTH * at_epoch.axis_m
    }

    fn period_ms(&self) -> f64 {
        std::f64::consts::TAU * (self.axis_m.powi(3) / MU_M3_S2).sqrt() * 1e3
    }
}

/// The search from the epoch to one side.
pub(super) struct DecaySearch<'s> {
    /// The orbit at this many milliseconds from the epoch; `None` if there is none.
    pub orbit_at: &'s dyn Fn(i64) -> Option<Osculating>,
    /// Radius of the ground, metres.
    pub ground_m: f64,
    /// Where the search ends: milliseconds from the epoch, below 0 to search backwards.
    pub until_ms: i64,
}

impl DecaySearch<'_> {
    /// The last time before the first failure, milliseconds from the epoch; `None` if there is no failure until the end of the search, or no orbit
    /// at the epoch.
    ///
    /// While the perigee is well above the ground, the step doubles each time, but is limited so that the perigee does not lose half of its height.
    /// Otherwise the search proceeds in small steps and looks for the minimum height between two of them.
    pub fn last_good_ms(&self) -> Option<i64> {
        let first = (self.orbit_at)(0)?;
        let step_ms = (first.period_ms() / STEPS_A_REVOLUTION).clamp(1.0, 1e9) as i64;
        let (mut at, mut here, mut leap_ms) = (0, first, 2 * step_ms);
        while at != self.until_ms {
            let room_m = here.perigee_m - self.ground_m - MARGIN_M;
            let is_leap = room_m > 0.0 && leap_ms > step_ms;
            let to = self.towards_end(at, if is_leap { leap_ms } else { step_ms });
            match (self.orbit_at)(to) {
                Some(next) if is_leap && here.perigee_m - next.perigee_m <= room_m / 2.0 => {
                    (at, here) = (to, next);
                    leap_ms = (2 * leap_ms).min(LONGEST_LEAP_MS);
                }
                _ if is_leap => leap_ms /= 2,
                Some(next) => {
                    if let Some(bad) = self.below_ground(at, &here, to, &next) {
                        return Some(self.boundary(at, bad));
                    }
                    (at, here, leap_ms) = (to, next, 2 * step_ms);
                }
                None => return Some(self.boundary(at, to)),
            }
        }
        None
    }

    fn towards_end(&self, at: i64, by_ms: i64) -> i64 {
        match self.until_ms < 0 {
            true => (at - by_ms).max(self.until_ms),
            false => (at + by_ms).min(self.until_ms),
        }
    }

    /// An instant without an orbit about the lowest place between two instants of a step, if there is one.
    fn below_ground(&self, a: i64, here: &Osculating, b: i64, next: &Osculating) -> Option<i64> {
        let sign = if self.until_ms < 0 { -1.0 } else { 1.0 };
        let (falls, rises) = (sign * here.rate_m_s < 0.0, sign * next.rate_m_s > 0.0);
        let fastest_m_s = here.rate_m_s.abs().max(next.rate_m_s.abs());
        let fall_m = fastest_m_s * (b - a).abs() as f64 * 1e-3;
        if !(falls && rises && here.radius_m.min(next.radius_m) - fall_m < self.ground_m) {
            return None;
        }
        let (mut a, mut b) = (a, b);
        while (b - a).abs() > 1 {
            let middle = a + (b - a) / 2;
            match (self.orbit_at)(middle) {
                None => return Some(middle),
                Some(orbit) if sign * orbit.rate_m_s < 0.0 => a = middle,
                Some(_) => b = middle,
            }
        }
        None
    }

    /// Between an instant with an orbit and one without: the last one with.
    fn boundary(&self, mut good: i64, mut bad: i64) -> i64 {
        while (bad - good).abs() > 1 {
            let middle = good + (bad - good) / 2;
            match (self.orbit_at)(middle) {
                Some(_) => good = middle,
                None => bad = middle,
            }
        }
        good
    }
}
