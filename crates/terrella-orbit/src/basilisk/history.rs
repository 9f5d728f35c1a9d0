//! Recorded positions of spacecraft, for trails and ground tracks.

use super::world::{CraftState, between};
use std::collections::VecDeque;

/// Limit of states that are kept, for all spacecraft together.
const MAX_STATES: usize = 262_144;
/// Most and least of one craft.
const MAX_STATES_OF_ONE: usize = 8192;
const LEAST_STATES_OF_ONE: usize = 64;
/// Minimum angle between two kept states, seen from the Earth's centre (0.2°) …
const LEAST_ANGLE_RAD: f64 = 0.0035;
/// … unless they are so many simulated seconds apart.
const LONGEST_STEP_S: f64 = 60.0;

/// The states of one craft, in the order of simulated time.
#[derive(Debug, Default)]
pub struct History {
    states: VecDeque<(f64, CraftState)>,
}

impl History {
    /// How many states of each craft are kept where there are so many craft.
    pub fn most(craft: usize) -> usize {
        (MAX_STATES / craft.max(1)).clamp(LEAST_STATES_OF_ONE, MAX_STATES_OF_ONE)
    }

    /// Adds the state at `elapsed_s`. If time steps back, later states are dropped. A state of the same time replaces the last one. Of many states
    /// close together only some are kept.
    pub fn add(&mut self, elapsed_s: f64, state: &CraftState, most: usize) {
        if self.last_s().is_some_and(|last_s| elapsed_s < last_s) {
            self.states.clear();
        }
        let count = self.states.len();
        let replaces_last = match (self.states.get(count.wrapping_sub(2)), self.states.back()) {
            (_, Some((last_s, _))) if *last_s == elapsed_s => true,
            // The newest is always there; it stays where it is far from the one before it.
            (Some((before_s, before)), Some((last_s, last))) => {
                let angle_rad = before.position_m.angle_between(last.position_m);
                last_s - before_s < LONGEST_STEP_S && angle_rad < LEAST_ANGLE_RAD
            }
            _ => false,
        };
        if replaces_last {
            self.states.pop_back();
        }
        while self.states.len() >= most {
            self.states.pop_front();
        }
        self.states.push_back((elapsed_s, state.clone()));
    }

    /// The first and the last simulated time, seconds.
    pub fn span_s(&self) -> Option<(f64, f64)> {
        Some((self.states.front()?.0, self.last_s()?))
    }

    fn last_s(&self) -> Option<f64> {
        self.states.back().map(|(elapsed_s, _)| *elapsed_s)
    }

    /// The state at a simulated time within the span, Hermite's cubic between two; `None` outside.
    pub fn at(&self, elapsed_s: f64) -> Option<CraftState> {
        let behind = self.states.partition_point(|(s, _)| *s <= elapsed_s);
        let (before_s, before) = self.states.get(behind.checked_sub(1)?)?;
        if *before_s == elapsed_s {
            return Some(before.clone());
        }
        let (after_s, after) = self.states.get(behind)?;
        let span_s = after_s - before_s;
        let part = (elapsed_s - before_s) / span_s;
        let (position_m, velocity_m_s) = between(before, after, span_s, part);
        let attitude = before.inertial_from_body;
        Some(CraftState {
            name: before.name.clone(),
            position_m,
            velocity_m_s,
            inertial_from_body: attitude.slerp(after.inertial_from_body, part),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DQuat, DVec3};

    fn on_circle(elapsed_s: f64) -> CraftState {
        let (radius_m, rate) = (7e6, 0.001);
        let (sin, cos) = (rate * elapsed_s).sin_cos();
        CraftState {
            name: "sat".into(),
            position_m: radius_m * DVec3::new(cos, sin, 0.0),
            velocity_m_s: radius_m * rate * DVec3::new(-sin, cos, 0.0),
            inertial_from_body: DQuat::IDENTITY,
        }
    }

    #[test]
    fn a_revolution_is_kept_in_few_states_and_comes_back() {
        let mut history = History::default();
        for k in 0..63_000 {
            let elapsed_s = f64::from(k) * 0.1;
            history.add(elapsed_s, &on_circle(elapsed_s), 8192);
        }
        assert!(history.states.len() < 2000, "{}", history.states.len());
        let (first_s, last_s) = history.span_s().expect("a span");
        assert!(first_s == 0.0 && (last_s - 6299.9).abs() < 1e-6);
        for k in 0..629 {
            let elapsed_s = f64::from(k) * 10.0 + 0.05;
            let state = history.at(elapsed_s).expect("within");
            let off_m = (state.position_m - on_circle(elapsed_s).position_m).length();
            assert!(off_m < 1e-4, "{off_m} m at {elapsed_s} s");
        }
        assert_eq!(history.at(-1.0), None);
        assert_eq!(history.at(6300.0), None);
        // The simulation begins again.
        history.add(5.0, &on_circle(5.0), 8192);
        assert_eq!(history.span_s(), Some((5.0, 5.0)));
    }

    #[test]
    fn memory_is_bounded() {
        let mut history = History::default();
        for k in 0..1000 {
            let elapsed_s = f64::from(k) * 100.0;
            history.add(elapsed_s, &on_circle(elapsed_s), 64);
        }
        assert_eq!(history.states.len(), 64);
        assert_eq!(history.span_s(), Some((93_600.0, 99_900.0)));
        // A pause repeats its time.
        for _ in 0..1000 {
            history.add(99_900.0, &on_circle(99_900.0), 64);
        }
        assert_eq!(history.states.len(), 64);
        assert!(History::most(1000) * 1000 <= MAX_STATES);
    }
}
