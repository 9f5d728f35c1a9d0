//! The motion from a message's state under the forces that act, from manoeuvre to manoeuvre.

use super::{Maneuver, ParameterMessage};
use crate::entry::RecordFault;
use crate::numerical::{
    AtmosphereModel, Event, ForceModel, Gravity, NumericalError, NumericalFeed, NumericalOptions,
    Shadow, Spacecraft, Thrust,
};
use crate::{Feed, Frame, OrbitError, OrbitState};
use glam::DVec3;
use std::sync::Arc;
use terrella_frames::{Epoch, Orientation, rfc3339};

/// Degree and order of the Earth's gravity.
const GRAVITY_DEGREE: usize = 20;
/// Least mass that manoeuvres leave, kilograms.
const LEAST_MASS_KG: f64 = 1e-6;

/// The motion of a satellite from the state of a message on, and before it.
///
/// It is integrated as [`NumericalFeed`] does it: EGM96 to degree and order 20, the Sun and the Moon; drag in the US Standard
/// Atmosphere 1976 and the pressure of sunlight where the message gives mass, area and coefficient. Impulses change the velocity at
/// once, burns are accelerations that are constant over their time; the mass changes when a manoeuvre is over. At the instant of
/// an impulse the state is that behind it.
#[derive(Clone, Debug)]
pub struct OpmFeed {
    message: Arc<ParameterMessage>,
    /// In order of time, each beginning where the one before it ends.
    stretches: Vec<NumericalFeed>,
    span: (Epoch, Epoch),
}

/// Boundary between two arcs.
#[derive(Clone, Copy)]
struct Break<'m> {
    at: Epoch,
    maneuver: &'m Maneuver,
}

impl ParameterMessage {
    /// Propagates the state over a span, which is extended to contain the state's epoch.
    ///
    /// # Errors
    /// A state that cannot be propagated, or an integration that fails: names the message's position in the file.
    pub fn propagated(
        self: &Arc<Self>,
        first: Epoch,
        last: Epoch,
        orientation: &Orientation,
    ) -> Result<OpmFeed, OrbitError> {
        let epoch = self.state.epoch;
        let span = (first.min(epoch), last.max(epoch));
        let stretches = Propagation::new(self, orientation).all(span);
        let stretches = stretches.map_err(|error| {
            let fault = RecordFault::Motion(error);
            self.place.error(&self.origin, fault)
        })?;
        Ok(OpmFeed {
            message: Arc::clone(self),
            stretches,
            span,
        })
    }
}

/// Parameters common to all arcs.
struct Propagation<'m> {
    message: &'m ParameterMessage,
    model: ForceModel,
    /// Whether the mass matters.
    has_surface_forces: bool,
}

impl<'m> Propagation<'m> {
    fn new(message: &'m ParameterMessage, orientation: &Orientation) -> Self {
        let craft = &message.craft;
        let has_drag = craft.drag_area_m2 * craft.drag_coefficient > 0.0;
        let is_pressed = craft.sunlit_area_m2 * craft.reflectivity > 0.0;
        let burns = message.maneuvers.iter().filter(|one| !one.is_impulse());
        let thrusts = burns.map(|burn| Thrust {
            first: burn.ignition,
            last: burn.end(),
            acceleration_m_s2: burn.delta_v_m_s / burn.duration.to_seconds(),
            axes: burn.axes,
        });
        Self {
            message,
            model: ForceModel {
                gravity: Gravity::Field {
                    degree: GRAVITY_DEGREE,
                    order: GRAVITY_DEGREE,
                },
                drag: has_drag.then_some(AtmosphereModel::Standard1976),
                sun: true,
                moon: true,
                sunlight: is_pressed.then_some(Shadow::Cone),
                thrusts: thrusts.collect(),
                orientation: *orientation,
            },
            has_surface_forces: has_drag || is_pressed,
        }
    }

    /// The instants at which velocity or mass changes, in order of time.
    fn breaks(&self) -> Vec<Break<'m>> {
        let maneuvers = self.message.maneuvers.iter();
        let changes = maneuvers.filter(|maneuver| {
            let changes_mass = self.has_surface_forces && maneuver.delta_mass_kg != 0.0;
            maneuver.is_impulse() || changes_mass
        });
        let mut breaks: Vec<_> = changes
            .map(|maneuver| Break {
                at: maneuver.end(),
                maneuver,
            })
            .collect();
        breaks.sort_by_key(|one| one.at);
        breaks
    }

    /// All stretches of a span that holds the state's epoch, in order of time.
    fn all(&self, span: (Epoch, Epoch)) -> Result<Vec<NumericalFeed>, NumericalError> {
        let start = self
            .message
            .state
            .in_frame(Frame::Gcrf, &self.model.orientation);
        let breaks = self.breaks();
        let behind = breaks.partition_point(|one| one.at < start.epoch);
        let (before, after) = breaks.split_at(behind);
        let mut steps_left = NumericalOptions::between(span.0, span.1).step_limit;
        let earlier = before.iter().rev().filter(|one| one.at >= span.0);
        let mut stretches = self.flown(start, earlier, span.0, false, &mut steps_left)?;
        stretches.reverse();
        let later = after.iter().filter(|one| one.at <= span.1);
        stretches.extend(self.flown(start, later, span.1, true, &mut steps_left)?);
        Ok(stretches)
    }

    /// Propagates from the state across the breaks to the end of the span, forwards or backwards; empty if that is the state's epoch.
    fn flown<'b>(
        &self,
        start: OrbitState,
        breaks: impl Iterator<Item = &'b Break<'m>>,
        end: Epoch,
        forwards: bool,
        steps_left: &mut usize,
    ) -> Result<Vec<NumericalFeed>, NumericalError>
    where
        'm: 'b,
    {
        let (mut state, mut craft) = (start, self.message.craft);
        let mut stretches = Vec::new();
        let stops = breaks.map(|one| (one.at, Some(one.maneuver)));
        for (at, maneuver) in stops.chain([(end, None)]) {
            // The forward feed must have a state at the state's epoch in any case.
            let is_needed = at != state.epoch || maneuver.is_none() && forwards;
            if is_needed {
                let stretch = self.stretch(&state, &craft, at, steps_left)?;
                let (first, last) = stretch.validity();
                let has_arrived = if forwards { last >= at } else { first <= at };
                if let Some(there) = stretch.state_at(at).ok().filter(|_| has_arrived) {
                    state = there;
                }
                stretches.push(stretch);
                if !has_arrived {
                    break;
                }
            }
            if let Some(maneuver) = maneuver {
                let sign = if forwards { 1.0 } else { -1.0 };
                let mass_kg = craft.mass_kg + sign * maneuver.delta_mass_kg;
                craft.mass_kg = mass_kg.max(LEAST_MASS_KG);
                if maneuver.is_impulse() {
                    state.velocity_m_s = match forwards {
                        true => pushed(&state, maneuver),
                        false => unpushed(&state, maneuver),
                    };
                }
            }
        }
        Ok(stretches)
    }

    fn stretch(
        &self,
        state: &OrbitState,
        craft: &Spacecraft,
        to: Epoch,
        steps_left: &mut usize,
    ) -> Result<NumericalFeed, NumericalError> {
        let options = NumericalOptions {
            step_limit: *steps_left,
            ..NumericalOptions::between(state.epoch.min(to), state.epoch.max(to))
        };
        let name = self.message.name.as_str();
        let stretch = NumericalFeed::new(name, state, &self.model, craft, &options)?;
        *steps_left = steps_left.saturating_sub(stretch.steps());
        Ok(stretch)
    }
}

/// The velocity behind an impulse.
fn pushed(state: &OrbitState, impulse: &Maneuver) -> DVec3 {
    let axes = impulse.axes.gcrf_from(state.position_m, state.velocity_m_s);
    state.velocity_m_s + axes * impulse.delta_v_m_s
}

/// The velocity before an impulse, from that after it. The axes of the impulse are those of the unknown velocity: each iteration reduces the error
/// by the ratio of impulse to speed.
fn unpushed(state: &OrbitState, impulse: &Maneuver) -> DVec3 {
    const ROUNDS: usize = 60;
    let mut before = state.velocity_m_s;
    for _ in 0..ROUNDS {
        let axes = impulse.axes.gcrf_from(state.position_m, before);
        before = state.velocity_m_s - axes * impulse.delta_v_m_s;
    }
    before
}

impl OpmFeed {
    /// The message that it is propagated from.
    pub fn message(&self) -> &ParameterMessage {
        &self.message
    }

    /// Impact on the ground, if any.
    pub fn events(&self) -> Vec<Event> {
        let events = self.stretches.iter().flat_map(NumericalFeed::events);
        events.copied().collect()
    }

    /// The last stretch that begins by then, or the first.
    fn stretch(&self, epoch: Epoch) -> Option<&NumericalFeed> {
        let behind = self
            .stretches
            .partition_point(|stretch| stretch.validity().0 <= epoch);
        self.stretches.get(behind.saturating_sub(1))
    }
}

impl Feed for OpmFeed {
    fn name(&self) -> &str {
        &self.message.name
    }

    fn validity(&self) -> (Epoch, Epoch) {
        let first = self.stretches.first().map(|one| one.validity().0);
        let last = self.stretches.last().map(|one| one.validity().1);
        (first.unwrap_or(self.span.0), last.unwrap_or(self.span.1))
    }

    fn impact(&self) -> Option<Epoch> {
        self.stretches.last().and_then(NumericalFeed::impact)
    }

    fn breaks(&self) -> Vec<Epoch> {
        let maneuvers = self.message.maneuvers.iter();
        let ends = maneuvers.flat_map(|maneuver| [maneuver.ignition, maneuver.end()]);
        let (first, last) = self.validity();
        let mut breaks: Vec<_> = ends.filter(|at| (first..=last).contains(at)).collect();
        breaks.sort();
        breaks.dedup();
        breaks
    }

    fn object_id(&self) -> Option<&str> {
        self.message.object_id.as_deref()
    }

    fn state_at(&self, epoch: Epoch) -> Result<OrbitState, OrbitError> {
        let is_inside = (self.span.0..=self.span.1).contains(&epoch);
        match self.stretch(epoch).filter(|_| is_inside) {
            Some(stretch) => stretch.state_at(epoch),
            None => Err(OrbitError::OutsideValidity {
                satellite: self.message.name.clone(),
                epoch: rfc3339(epoch),
                first: rfc3339(self.span.0),
                last: rfc3339(self.span.1),
            }),
        }
    }
}
