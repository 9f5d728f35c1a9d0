//! Numerical orbit propagation: motion under forces, integrated.
//!
//! | folder or file | content |
//! |---|---|
//! | `force/` | gravity, air, Sun, Moon, sunlight, thrust |
//! | `integrate/` | solvers of differential equations |
//! | `event.rs` | impact, nodes, apsides, eclipses |
//! | `trajectory.rs` | the steps with their dense output |
//! | `integration.rs` | from a state to a trajectory |

mod error;
mod event;
mod force;
mod integrate;
mod integration;
#[cfg(test)]
mod tests;
mod trajectory;

pub use error::NumericalError;
pub use event::{Event, EventKind, EventSelection};
pub use force::{AtmosphereModel, ForceModel, Gravity, Shadow, Spacecraft, Thrust, ThrustAxes};
pub use integrate::{Counts, Solver};

use super::validity::{Impacts, Validity};
use super::{Feed, Frame, OrbitError, OrbitState};
use integration::{Integration, StopReason};
use terrella_frames::{Duration, Epoch};
use trajectory::Trajectory;

/// Settings of an integration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NumericalOptions {
    /// First epoch of validity: the state's epoch or earlier.
    pub first: Epoch,
    /// Last epoch of validity: the state's epoch or later.
    pub last: Epoch,
    /// Error allowed in a step, relative to distance and speed: 1e-14…1e-3. Errors of steps add up: docs/orbits.md.
    pub relative_tolerance: f64,
    /// The method of integration.
    pub solver: Solver,
    /// Most steps kept, about 0.4 kB each.
    pub step_limit: usize,
    /// Events to look for.
    pub watch: EventSelection,
    /// Height over WGS84 at which the ground is met, metres.
    pub ground_height_m: f64,
}

impl NumericalOptions {
    /// From one epoch to another with a tolerance of 1e-10, either method, a million steps.
    pub fn between(first: Epoch, last: Epoch) -> Self {
        Self {
            first,
            last,
            relative_tolerance: 1e-10,
            solver: Solver::Automatic,
            step_limit: 1_000_000,
            watch: EventSelection::default(),
            ground_height_m: 0.0,
        }
    }
}

/// A satellite whose motion has been integrated.
///
/// The whole span is integrated at creation; after that the feed is immutable and evaluates the dense output, in GCRF. [`Feed::error_m`] returns
/// nothing: the error of the force models, above all of the air's, is not known here. The integration error is in [`Self::integration_error_m`].
#[derive(Clone, Debug)]
pub struct NumericalFeed {
    name: String,
    epoch: Epoch,
    /// Without a step: a span of no length.
    start: OrbitState,
    trajectory: Trajectory,
    validity: Validity,
    events: Vec<Event>,
    counts: Counts,
    stiff: Vec<(Epoch, Epoch)>,
    /// When thrusts begin and end.
    breaks: Vec<Epoch>,
}

impl NumericalFeed {
    /// Integrates from a state, in any frame, over a span that contains its epoch.
    ///
    /// A trajectory that reaches the ground ends there. That is not an error, see [`Self::impact`].
    ///
    /// # Errors
    /// Invalid parameters, a span without the epoch, or a start below the ground; if the integration fails, the epoch and the cause.
    pub fn new(
        name: impl Into<String>,
        state: &OrbitState,
        model: &ForceModel,
        craft: &Spacecraft,
        options: &NumericalOptions,
    ) -> Result<Self, NumericalError> {
        let name = name.into();
        let start = state.in_frame(Frame::Gcrf, &model.orientation);
        let mut integration = Integration::new(&name, &start, model, craft, options)?;
        let epoch = start.epoch;
        let before = integration.propagate((options.first - epoch).to_seconds())?;
        let after = integration.propagate((options.last - epoch).to_seconds())?;
        let impact = |ending: StopReason| match ending {
            StopReason::Limit => None,
            // Whole nanoseconds, and on this side of the ground.
            StopReason::Impact(t) => Some(epoch + Duration::from_seconds(t)),
        };
        let validity = Validity {
            first: options.first,
            last: options.last,
            impacts: Impacts {
                before: impact(before),
                after: impact(after),
            },
        };
        let Integration {
            trajectory,
            mut events,
            counts,
            mut stiff,
            ..
        } = integration;
        stiff.sort_by(|a, b| a.0.total_cmp(&b.0));
        let at = |t| epoch + Duration::from_seconds(t);
        let stiff = stiff.into_iter().map(|(a, b)| (at(a), at(b))).collect();
        events.sort_by_key(|event| event.epoch);
        let (first, last) = validity.interval();
        let ends = model.thrusts.iter().flat_map(|one| [one.first, one.last]);
        let mut breaks: Vec<_> = ends.filter(|at| (first..=last).contains(at)).collect();
        breaks.sort();
        breaks.dedup();
        Ok(Self {
            name,
            epoch,
            start,
            trajectory,
            validity,
            events,
            counts,
            stiff,
            breaks,
        })
    }

    /// Time of impact on the ground, if it is after the epoch of the state.
    pub fn impact(&self) -> Option<Epoch> {
        self.validity.impacts.after
    }

    /// Events in the order of time.
    pub fn events(&self) -> &[Event] {
        &self.events
    }

    /// Work of the integration.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Stretches that the implicit method flew, in the order of time: with [`Solver::Automatic`], where the motion was found
    /// stiff.
    pub fn stiff_spans(&self) -> &[(Epoch, Epoch)] {
        &self.stiff
    }

    /// Number of steps kept.
    pub fn steps(&self) -> usize {
        self.trajectory.len()
    }

    /// How far the integration itself is off at most, metres: the largest distance from a second one with a hundredth of the
    /// tolerance (1e-14 at least), at a thousand places. Takes somewhat longer than the first.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn integration_error_m(
        &self,
        model: &ForceModel,
        craft: &Spacecraft,
        options: &NumericalOptions,
    ) -> Result<f64, NumericalError> {
        let finer = NumericalOptions {
            relative_tolerance: (0.01 * options.relative_tolerance).max(1e-14),
            ..*options
        };
        let finer = Self::new(self.name.clone(), &self.start, model, craft, &finer)?;
        let ((a0, a1), (b0, b1)) = (self.validity(), finer.validity());
        let (first, last) = (a0.max(b0), a1.min(b1));
        let mut worst = 0.0_f64;
        for k in 0..=1000 {
            let at = first + (last - first) * (f64::from(k) / 1000.0);
            let apart = self.inside(at).position_m - finer.inside(at).position_m;
            worst = worst.max(apart.length());
        }
        Ok(worst)
    }

    /// The state at an epoch that is known to be answered for.
    fn inside(&self, epoch: Epoch) -> OrbitState {
        let t = (epoch - self.epoch).to_seconds();
        let (position_m, velocity_m_s) = self
            .trajectory
            .at(t)
            .unwrap_or((self.start.position_m, self.start.velocity_m_s));
        OrbitState {
            epoch,
            frame: Frame::Gcrf,
            position_m,
            velocity_m_s,
        }
    }
}

impl Feed for NumericalFeed {
    fn name(&self) -> &str {
        &self.name
    }

    fn validity(&self) -> (Epoch, Epoch) {
        self.validity.interval()
    }

    fn impact(&self) -> Option<Epoch> {
        self.validity.impacts.after
    }

    fn breaks(&self) -> Vec<Epoch> {
        self.breaks.clone()
    }

    fn state_at(&self, epoch: Epoch) -> Result<OrbitState, OrbitError> {
        self.validity
            .state_at(&self.name, epoch, |epoch| self.inside(epoch))
    }
}
