//! The last states of a simulator, interpolated between and extrapolated beyond.

use super::super::constants::EARTH_GM_M3_S2;
use super::super::interpolated::{InterpolatedStates, Interpolation, StateSample};
use super::super::kepler::Conic;
use super::super::{Frame, OrbitState};
use std::collections::VecDeque;
use terrella_frames::{Duration, Epoch, Orientation};

/// Default of how far states continue a motion, and of how far they may be apart, seconds.
pub const REACH_S: f64 = 60.0;

/// How the satellite goes on where states are missing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Extrapolation {
    /// On the conic of the last state: free fall.
    #[default]
    TwoBody,
    /// Linear, for objects that do not fall.
    Linear,
}

/// How many states are kept.
pub const MAX_STATES: usize = 256;

/// Result of adding a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Insertion {
    /// It is the latest one.
    Newest,
    /// It arrived after a later one and was inserted in order.
    Late,
    /// There is already a state of this time.
    Duplicate,
    /// It is older than all that are kept.
    TooLate,
    /// It is far from the others in time; the next one decides whether the simulator jumped or this one is wrong.
    Apart,
    /// The second one far from the others: the simulator has jumped, what was before is forgotten.
    Restart,
}

/// The last states, in the order of time.
#[derive(Debug)]
pub struct StateBuffer {
    states: VecDeque<OrbitState>,
    /// Farther apart than this is a jump, seconds.
    gap_s: f64,
    apart: Option<OrbitState>,
}

impl StateBuffer {
    pub fn new(gap_s: f64) -> Self {
        Self {
            states: VecDeque::with_capacity(MAX_STATES),
            gap_s,
            apart: None,
        }
    }

    pub fn oldest(&self) -> Option<&OrbitState> {
        self.states.front()
    }

    pub fn newest(&self) -> Option<&OrbitState> {
        self.states.back()
    }

    /// Adds a state of a simulator that does not wait.
    pub fn take(&mut self, state: OrbitState) -> Insertion {
        let Some(newest) = self.newest() else {
            self.states.push_back(state);
            return Insertion::Newest;
        };
        let ahead_s = seconds(newest.epoch, state.epoch);
        if ahead_s.abs() > self.gap_s {
            let is_confirmed = self.apart.is_some_and(|before| {
                let between_s = seconds(before.epoch, state.epoch);
                between_s != 0.0 && between_s.abs() <= self.gap_s
            });
            if !is_confirmed {
                self.apart = Some(state);
                return Insertion::Apart;
            }
            let before = self.apart.take();
            self.states.clear();
            self.states.extend(before);
            self.place(state);
            return Insertion::Restart;
        }
        let taken = self.place(state);
        if matches!(taken, Insertion::Newest | Insertion::Late) {
            self.apart = None;
        }
        taken
    }

    /// Takes a state that a simulator waits for: it is drawn whatever was before.
    #[cfg(any(feature = "live", test))]
    pub fn take_frame(&mut self, state: OrbitState) {
        self.apart = None;
        let goes_on = self.newest().is_some_and(|newest| {
            let ahead_s = seconds(newest.epoch, state.epoch);
            ahead_s > 0.0 && ahead_s <= self.gap_s
        });
        if !goes_on {
            self.states.clear();
        }
        self.place(state);
    }

    fn place(&mut self, state: OrbitState) -> Insertion {
        let at = self.states.partition_point(|s| s.epoch < state.epoch);
        if self.states.get(at).is_some_and(|s| s.epoch == state.epoch) {
            return Insertion::Duplicate;
        }
        if self.states.len() == MAX_STATES {
            if at == 0 {
                return Insertion::TooLate;
            }
            self.states.pop_front();
            self.states.insert(at - 1, state);
        } else {
            self.states.insert(at, state);
        }
        match self.newest().is_some_and(|s| s.epoch == state.epoch) {
            true => Insertion::Newest,
            false => Insertion::Late,
        }
    }

    /// The state at an instant between two states: Hermite's cubic through both; at a state it is the state, bit for bit.
    /// `None` before the first and after the last.
    ///
    /// Two states and not more, because a simulator may thrust between any two. In low orbit the cubic is off by
    /// 0.03 µm at one second from state to state, 0.3 m at one minute.
    pub fn between(&self, epoch: Epoch) -> Option<OrbitState> {
        let behind = self.states.partition_point(|s| s.epoch <= epoch);
        let before = self.states.get(behind.checked_sub(1)?)?;
        if before.epoch == epoch {
            return Some(*before);
        }
        let after = self.states.get(behind)?;
        let before = before.in_frame(after.frame, &Orientation::default());
        let sample = |s: &OrbitState| StateSample {
            epoch: s.epoch,
            position_m: s.position_m,
            velocity_m_s: Some(s.velocity_m_s),
        };
        let samples = [sample(&before), sample(after)];
        let cubic = Interpolation::Hermite { degree: 3 };
        let sampled = InterpolatedStates::new(after.frame, &samples, cubic).ok()?;
        sampled.state_at(epoch)
    }

    /// The state after the last one, as it goes on by itself; `None` where f64 cannot hold it or there is no state.
    pub fn beyond(&self, epoch: Epoch, how: Extrapolation) -> Option<OrbitState> {
        let last = *self.newest()?;
        let state = match how {
            Extrapolation::Linear => straight_on(last, epoch),
            Extrapolation::TwoBody => on_a_conic(last, epoch).unwrap_or(straight_on(last, epoch)),
        };
        (state.position_m.is_finite() && state.velocity_m_s.is_finite()).then_some(state)
    }
}

fn straight_on(last: OrbitState, epoch: Epoch) -> OrbitState {
    OrbitState {
        epoch,
        position_m: last.position_m + last.velocity_m_s * seconds(last.epoch, epoch),
        ..last
    }
}

fn on_a_conic(last: OrbitState, epoch: Epoch) -> Option<OrbitState> {
    let orientation = Orientation::default();
    // A conic is fixed relative to the stars.
    let still = match last.frame.is_earth_fixed() {
        true => last.in_frame(Frame::Gcrf, &orientation),
        false => last,
    };
    let conic = Conic::from_state(EARTH_GM_M3_S2, still.position_m, still.velocity_m_s).ok()?;
    let (position_m, velocity_m_s) = conic.state_after(seconds(last.epoch, epoch));
    let state = OrbitState {
        epoch,
        position_m,
        velocity_m_s,
        ..still
    };
    let is_finite = position_m.is_finite() && velocity_m_s.is_finite();
    is_finite.then(|| state.in_frame(last.frame, &orientation))
}

/// Elapsed time, seconds.
pub fn seconds(from: Epoch, to: Epoch) -> f64 {
    nanoseconds(from, to) as f64 * 1e-9
}

/// Elapsed time, nanoseconds.
pub fn nanoseconds(from: Epoch, to: Epoch) -> i128 {
    to.to_tai_duration().total_nanoseconds() - from.to_tai_duration().total_nanoseconds()
}

/// An instant so many seconds later, counted in TAI; held at 1e10 s.
pub fn later(epoch: Epoch, seconds: f64) -> Epoch {
    let ns = (seconds.clamp(-1e10, 1e10) * 1e9).round() as i128;
    let epoch = Epoch::from_tai_duration(epoch.to_tai_duration());
    epoch + Duration::from_total_nanoseconds(ns)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use terrella_frames::utc_from_rfc3339;

    fn orbit(t_s: f64) -> OrbitState {
        let start = utc_from_rfc3339("2018-01-15T12:00:00Z").unwrap();
        let (sin, cos) = (t_s * 0.001_131).sin_cos();
        let radius_m = (EARTH_GM_M3_S2 / 0.001_131_f64.powi(2)).cbrt();
        OrbitState {
            epoch: later(start, t_s),
            frame: Frame::Gcrf,
            position_m: DVec3::new(cos, sin, 0.0) * radius_m,
            velocity_m_s: DVec3::new(-sin, cos, 0.0) * radius_m * 0.001_131,
        }
    }

    fn off_m(state: Option<OrbitState>, t_s: f64) -> f64 {
        (state.unwrap().position_m - orbit(t_s).position_m).length()
    }

    #[test]
    fn the_cubic_is_as_good_as_it_says() {
        for (step_s, most_m) in [(1.0, 4e-8), (60.0, 0.4)] {
            let mut buffer = StateBuffer::new(200.0);
            for k in [0.0, 3.0, 1.0, 2.0] {
                buffer.take(orbit(k * step_s));
            }
            let mut worst_m = 0.0_f64;
            for k in 0..=300 {
                let t_s = f64::from(k) * 0.01 * step_s;
                worst_m = worst_m.max(off_m(buffer.between(orbit(t_s).epoch), t_s));
            }
            assert!(worst_m < most_m, "{worst_m} at {step_s} s");
            assert!(worst_m > most_m * 0.01, "{worst_m} at {step_s} s");
            assert_eq!(buffer.between(orbit(-0.1).epoch), None);
            assert_eq!(buffer.between(orbit(3.1 * step_s).epoch), None);
            assert_eq!(buffer.between(orbit(step_s).epoch), Some(orbit(step_s)));
        }
    }

    #[test]
    fn beyond_the_last_state_it_falls_on_or_flies_straight() {
        let mut buffer = StateBuffer::new(60.0);
        assert_eq!(
            buffer.beyond(orbit(0.0).epoch, Extrapolation::TwoBody),
            None
        );
        buffer.take(orbit(0.0));
        let two_body = buffer.beyond(orbit(600.0).epoch, Extrapolation::TwoBody);
        assert!(off_m(two_body, 600.0) < 1e-5);
        // Half of 8.6 m/s² times 10 s squared.
        let straight_m = off_m(
            buffer.beyond(orbit(10.0).epoch, Extrapolation::Linear),
            10.0,
        );
        assert!((straight_m - 430.0).abs() < 20.0, "{straight_m}");
        // Seen from the turning Earth it is the same orbit.
        let fixed = orbit(0.0).in_frame(Frame::Itrf, &Orientation::default());
        let mut buffer = StateBuffer::new(60.0);
        buffer.take(fixed);
        let beyond = buffer
            .beyond(orbit(600.0).epoch, Extrapolation::TwoBody)
            .unwrap();
        assert_eq!(beyond.frame, Frame::Itrf);
        let back = beyond.in_frame(Frame::Gcrf, &Orientation::default());
        // ω × r does not follow the slow turn of the equator: 5e-5 m/s.
        assert!(
            off_m(Some(back), 600.0) < 0.1,
            "{}",
            off_m(Some(back), 600.0)
        );
    }

    #[test]
    fn one_state_apart_is_an_error_and_two_are_a_restart() {
        let mut buffer = StateBuffer::new(60.0);
        assert_eq!(buffer.take(orbit(0.0)), Insertion::Newest);
        assert_eq!(buffer.take(orbit(1e6)), Insertion::Apart);
        assert_eq!(buffer.take(orbit(1.0)), Insertion::Newest);
        assert_eq!(buffer.take(orbit(1e6)), Insertion::Apart);
        assert_eq!(
            buffer.take(orbit(1e6)),
            Insertion::Apart,
            "the same again says nothing"
        );
        assert_eq!(buffer.take(orbit(-5000.0)), Insertion::Apart);
        assert_eq!(buffer.take(orbit(-4999.0)), Insertion::Restart);
        assert_eq!(buffer.oldest(), Some(&orbit(-5000.0)));
        assert_eq!(buffer.newest(), Some(&orbit(-4999.0)));
    }

    #[test]
    fn memory_is_bounded_and_the_oldest_go() {
        let mut buffer = StateBuffer::new(60.0);
        for k in 0..10_000 {
            assert_eq!(buffer.take(orbit(f64::from(k) * 0.1)), Insertion::Newest);
        }
        assert_eq!(buffer.states.len(), MAX_STATES);
        assert!(buffer.states.capacity() < 2 * MAX_STATES);
        assert_eq!(buffer.take(orbit(999.9)), Insertion::Duplicate);
        assert_eq!(buffer.take(orbit(999.85)), Insertion::Late);
        assert_eq!(buffer.take(orbit(960.0)), Insertion::TooLate);
        assert_eq!(buffer.states.len(), MAX_STATES);
        let epochs: Vec<_> = buffer.states.iter().map(|s| s.epoch).collect();
        assert!(epochs.is_sorted());
    }

    #[test]
    fn a_frame_that_is_waited_for_is_there_whatever_was_before() {
        let mut buffer = StateBuffer::new(60.0);
        for t_s in [0.0, 1.0, 1e6, 5.0, 5.0, 4.0] {
            buffer.take_frame(orbit(t_s));
            assert_eq!(buffer.between(orbit(t_s).epoch), Some(orbit(t_s)));
        }
    }
}
