//! Events that are looked for along a trajectory: impact, nodes, apsides, eclipses.

use super::force::{EquationsOfMotion, sun_above_limb_rad};
use super::integrate::Step;
use glam::DVec3;
use terrella_frames::Epoch;

/// Kinds of events.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EventKind {
    /// Impact on the ground; the trajectory ends.
    Impact,
    /// It crosses the equator of date northwards.
    AscendingNode,
    /// It crosses the equator of date southwards.
    DescendingNode,
    /// It is nearest to the Earth's centre.
    Periapsis,
    /// It is farthest from the Earth's centre.
    Apoapsis,
    /// An eclipse begins: the Sun's centre goes behind the Earth's limb (a sphere of 6378.137 km).
    ShadowEntry,
    /// The Sun's centre comes back.
    ShadowExit,
}

/// An event on a trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// When: to a microsecond of the trajectory as integrated.
    pub epoch: Epoch,
    /// Kind of event.
    pub kind: EventKind,
}

/// Which events to look for; the impact always is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EventSelection {
    /// Crossings of the equator.
    pub nodes: bool,
    /// Nearest and farthest points.
    pub apsides: bool,
    /// Eclipses: entry into and exit from the Earth's shadow.
    pub shadow: bool,
}

/// A function of the state that changes its sign at an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum EventFunction {
    Height,
    Latitude,
    Radial,
    Shadow,
}

impl EventFunction {
    fn value(self, motion: &mut EquationsOfMotion, ground_m: f64, t: f64, y: &[f64; 6]) -> f64 {
        let (r, v) = (DVec3::new(y[0], y[1], y[2]), DVec3::new(y[3], y[4], y[5]));
        match self {
            // High up only the sign matters.
            Self::Height if r.length() > 6.5e6 + ground_m => r.length(),
            Self::Height => motion.height_m(t, r) - ground_m,
            Self::Latitude => (motion.axes.intermediate_from_gcrf(t) * r).z,
            Self::Radial => r.dot(v),
            Self::Shadow => sun_above_limb_rad(r, motion.axes.sun_m(t)),
        }
    }

    /// The event when the value increases or decreases through zero.
    fn kind(self, rising: bool) -> EventKind {
        match (self, rising) {
            (Self::Height, _) => EventKind::Impact,
            (Self::Latitude, true) => EventKind::AscendingNode,
            (Self::Latitude, false) => EventKind::DescendingNode,
            (Self::Radial, true) => EventKind::Periapsis,
            (Self::Radial, false) => EventKind::Apoapsis,
            (Self::Shadow, true) => EventKind::ShadowExit,
            (Self::Shadow, false) => EventKind::ShadowEntry,
        }
    }
}

/// Looks at the events of one step after the other.
#[derive(Clone, Debug)]
pub(super) struct EventDetector {
    functions: Vec<EventFunction>,
    ground_m: f64,
}

/// Places looked at inside a step: two changes of sign between two of them go unseen.
const LOOKS: u32 = 8;

impl EventDetector {
    pub fn new(selection: EventSelection, ground_m: f64) -> Self {
        let functions = [
            (true, EventFunction::Height),
            (selection.nodes, EventFunction::Latitude),
            (selection.apsides, EventFunction::Radial),
            (selection.shadow, EventFunction::Shadow),
        ];
        Self {
            functions: functions
                .into_iter()
                .filter(|(on, _)| *on)
                .map(|(_, function)| function)
                .collect(),
            ground_m,
        }
    }

    /// Events inside a step with their times, in the order of flight. Nothing follows an impact.
    pub fn events(&self, motion: &mut EquationsOfMotion, step: &Step<6>) -> Vec<(f64, EventKind)> {
        let mut found = Vec::new();
        for &function in &self.functions {
            let mut value = |t: f64, y: &[f64; 6]| function.value(motion, self.ground_m, t, y);
            let (mut t0, mut g0) = (step.t0, value(step.t0, &step.y0));
            for k in 1..=LOOKS {
                let (t1, y1) = match k == LOOKS {
                    true => (step.t1(), step.y1),
                    false => {
                        let t = step.t0 + step.h * f64::from(k) / f64::from(LOOKS);
                        (t, step.at(t))
                    }
                };
                let g1 = value(t1, &y1);
                if (g0 < 0.0) != (g1 < 0.0) {
                    let t = root(|t| value(t, &step.at(t)), (t0, g0), (t1, g1));
                    let rising = (g1 > g0) == (step.h > 0.0);
                    found.push((t, function.kind(rising)));
                }
                (t0, g0) = (t1, g1);
            }
        }
        found.sort_by(|a, b| ((a.0 - b.0) * step.h.signum()).total_cmp(&0.0));
        if let Some(impact) = found
            .iter()
            .position(|(_, kind)| *kind == EventKind::Impact)
        {
            found.truncate(impact + 1);
        }
        found
    }
}

/// A zero between two places of opposite sign, to a tenth of a microsecond: false position that halves the weight of an end
/// that stays (Illinois), and plain halving where that is slow. Ends on the side of the first place.
fn root(mut f: impl FnMut(f64) -> f64, first: (f64, f64), last: (f64, f64)) -> f64 {
    let ((mut a, mut fa), (mut b, mut fb)) = (first, last);
    for round in 0..120 {
        if (b - a).abs() <= 1e-7 {
            break;
        }
        let t = match round % 3 == 2 {
            true => 0.5 * (a + b),
            false => b - fb * (b - a) / (fb - fa),
        };
        let t = if (t - a) * (t - b) < 0.0 {
            t
        } else {
            0.5 * (a + b)
        };
        let ft = f(t);
        if (ft < 0.0) == (first.1 < 0.0) {
            (a, fa, fb) = (t, ft, 0.5 * fb);
        } else {
            (b, fb, fa) = (t, ft, 0.5 * fa);
        }
    }
    a
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_are_found_in_few_rounds_and_from_the_near_side() {
        type Case = (fn(f64) -> f64, f64, f64, f64);
        let cases: [Case; 4] = [
            (|x| x * x * x - 2.0, 0.0, 4.0, 2f64.cbrt()),
            (|x| 1.0 - (x - 3.0).exp(), 0.0, 9.0, 3.0),
            (|x| (x - 0.5).powi(9), 0.0, 3.0, 0.5),
            (|x| x - 1e-6, 5.0, 0.0, 1e-6),
        ];
        for (f, a, b, expected) in cases {
            let mut calls = 0;
            let counted = |x| {
                calls += 1;
                f(x)
            };
            let found = root(counted, (a, f(a)), (b, f(b)));
            assert!((found - expected).abs() <= 1.1e-7, "{found} {expected}");
            assert!(f(found) == 0.0 || (f(found) < 0.0) == (f(a) < 0.0));
            assert!(calls < 90, "{calls}");
        }
    }
}
