//! One set of mean elements, propagated by SGP4.

use super::decay::{DecaySearch, Osculating};
use super::mean_elements::MeanElements;
use super::{Frame, OrbitError, OrbitState};
use glam::DVec3;
use std::path::Path;
use std::sync::{Arc, OnceLock};
use terrella_frames::{Duration, Epoch, rfc3339};

/// Validity of a set before and after the epoch of its elements: 30 days.
pub(super) const VALIDITY: Duration = Duration::from_parts(0, 30 * 86_400 * 1_000_000_000);

/// Radius below which the reference code reports a decay: one equatorial radius of WGS72, kilometres.
const DECAYED_BELOW_KM: f64 = 6378.135;

/// A set of a satellite that SGP4 flies.
#[derive(Clone, Debug)]
pub(super) struct Sgp4Set {
    pub elements: MeanElements,
    pub line: usize,
    origin: Arc<Path>,
    constants: sgp4::Constants,
    reach: OnceLock<Reach>,
}

/// Last instants with an orbit before and after the epoch of the elements, where SGP4 ends it within the time that they hold.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    pub before: Option<Epoch>,
    pub after: Option<Epoch>,
    /// Validity of the set, first and last, elapsed time from its epoch.
    span: (Duration, Duration),
}

impl Sgp4Set {
    /// # Errors
    /// If SGP4 cannot start from them, or the satellite has decayed at their own epoch.
    pub fn new(elements: MeanElements, origin: Arc<Path>, line: usize) -> Result<Self, OrbitError> {
        let constants =
            sgp4::Constants::from_elements_afspc_compatibility_mode(&elements.for_sgp4());
        let constants = constants.map_err(|e| OrbitError::Sgp4 {
            path: origin.to_path_buf(),
            line,
            satellite: elements.name.clone(),
            epoch: rfc3339(elements.epoch),
            cause: e.to_string(),
        })?;
        let set = Self {
            elements,
            origin,
            line,
            constants,
            reach: OnceLock::new(),
        };
        // A set that does not even hold at its own epoch is rejected here, not in the middle of a flight.
        set.propagated(set.elements.epoch)?;
        Ok(set)
    }

    fn sgp4_error(&self, epoch: Epoch, cause: String) -> OrbitError {
        OrbitError::Sgp4 {
            path: self.origin.to_path_buf(),
            line: self.line,
            satellite: self.elements.name.clone(),
            epoch: rfc3339(epoch),
            cause,
        }
    }

    /// Result of SGP4 at any time, however far away.
    fn propagated(&self, epoch: Epoch) -> Result<OrbitState, OrbitError> {
        // Both in TAI: elapsed time, leap seconds included.
        let elapsed = epoch.to_tai_duration() - self.elements.epoch.to_tai_duration();
        let minutes = sgp4::MinutesSinceEpoch(elapsed.to_seconds() / 60.0);
        let prediction = self
            .constants
            .propagate_afspc_compatibility_mode(minutes)
            .map_err(|e| self.sgp4_error(epoch, e.to_string()))?;
        let position_km = DVec3::from(prediction.position);
        let velocity_km_s = DVec3::from(prediction.velocity);
        // Wild elements can make SGP4's series overflow without its noticing.
        if !position_km.is_finite() || !velocity_km_s.is_finite() {
            return Err(self.sgp4_error(epoch, "the result is not a number".to_owned()));
        }
        // The sixth error of the reference code, which the crate leaves to its caller.
        if position_km.length() < DECAYED_BELOW_KM {
            return Err(OrbitError::Decayed {
                path: self.origin.to_path_buf(),
                line: self.line,
                satellite: self.elements.name.clone(),
                epoch: rfc3339(epoch),
                depth_km: DECAYED_BELOW_KM - position_km.length(),
            });
        }
        Ok(OrbitState {
            epoch,
            frame: Frame::Teme,
            position_m: position_km * 1000.0,
            velocity_m_s: velocity_km_s * 1000.0,
        })
    }

    /// So many milliseconds of elapsed time from the epoch of the elements.
    fn after_epoch(&self, ms: i64) -> Epoch {
        self.elements.epoch + Duration::from_total_nanoseconds(i128::from(ms) * 1_000_000)
    }

    pub fn reach(&self) -> Reach {
        *self.reach.get_or_init(|| {
            let orbit = |ms| {
                let state = self.propagated(self.after_epoch(ms)).ok()?;
                Some(Osculating::of(&state))
            };
            let at_epoch = orbit(0);
            let orbit_at = |ms| {
                let is_like = |orbit: &Osculating| at_epoch.is_some_and(|at| orbit.is_like(&at));
                orbit(ms).filter(is_like)
            };
            let days_ms = VALIDITY.to_seconds() as i64 * 1000;
            let last_good = |until_ms| {
                let search = DecaySearch {
                    orbit_at: &orbit_at,
                    ground_m: DECAYED_BELOW_KM * 1e3,
                    until_ms,
                };
                search.last_good_ms().map(|ms| self.after_epoch(ms))
            };
            let (before, after) = (last_good(-days_ms), last_good(days_ms));
            let epoch = self.elements.epoch;
            let elapsed = |at: Epoch| at.to_tai_duration() - epoch.to_tai_duration();
            Reach {
                before,
                after,
                span: (
                    elapsed(before.unwrap_or(epoch - VALIDITY)),
                    elapsed(after.unwrap_or(epoch + VALIDITY)),
                ),
            }
        })
    }

    /// Rejects an epoch outside the validity.
    fn check(&self, epoch: Epoch) -> Result<(), OrbitError> {
        // Thousands of sets are evaluated in a frame: comparing elapsed times is cheapest.
        let elapsed = epoch.to_tai_duration() - self.elements.epoch.to_tai_duration();
        let span = self.reach().span;
        if span.0 <= elapsed && elapsed <= span.1 {
            return Ok(());
        }
        let (first, last) = self.validity();
        if (first..=last).contains(&epoch) {
            return Ok(());
        }
        let (reach, satellite) = (self.reach(), self.elements.name.clone());
        let is_after = epoch > last;
        let lost = if is_after { reach.after } else { reach.before };
        let hold = VALIDITY;
        let is_near = (self.elements.epoch - hold..=self.elements.epoch + hold).contains(&epoch);
        match lost.filter(|_| is_near) {
            Some(lost) => Err(OrbitError::Lost {
                path: self.origin.to_path_buf(),
                line: self.line,
                satellite,
                epoch: rfc3339(epoch),
                lost: rfc3339(lost),
                side: if is_after { "after" } else { "before" },
            }),
            None => Err(OrbitError::OutsideValidity {
                satellite,
                epoch: rfc3339(epoch),
                first: rfc3339(first),
                last: rfc3339(last),
            }),
        }
    }

    /// First and last epoch of validity.
    pub fn validity(&self) -> (Epoch, Epoch) {
        let (epoch, reach) = (self.elements.epoch, self.reach());
        (
            reach.before.unwrap_or(epoch - VALIDITY),
            reach.after.unwrap_or(epoch + VALIDITY),
        )
    }

    /// The state at an epoch of the validity.
    pub fn state_at(&self, epoch: Epoch) -> Result<OrbitState, OrbitError> {
        match self.check(epoch) {
            Ok(()) => self.propagated(epoch),
            // If SGP4 itself fails, its reason is more informative.
            Err(lost @ OrbitError::Lost { .. }) => {
                Err(self.propagated(epoch).err().unwrap_or(lost))
            }
            Err(outside) => Err(outside),
        }
    }
}
