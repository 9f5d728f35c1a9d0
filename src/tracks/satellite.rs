//! One satellite: its curves over time.

use super::curve::{Curve, CurvePoint, STEP_RAD, TimeWindow};
use super::ink::Ink;
use super::style::{TrackSpan, TrackStyle};
use super::turn::EarthTurn;
use crate::gpu::PassFormat;
use glam::{DMat3, DVec3};
use terrella_frames::{Duration, EARTH_ROTATION_RATE_RAD_S, Ellipsoid, Epoch, Orientation};
use terrella_orbit::constants::EARTH_GM_M3_S2;
use terrella_orbit::{Feed, FieldOfView, Frame, Freshness, OrbitState};

/// Longest revolution for spans in revolutions, seconds; for longer periods, spans are counted in days.
const LONGEST_REVOLUTION_S: f64 = 2.0 * 86_400.0;
/// For a live feed, states later than this time before now are requested again: late packets change them.
const UNSETTLED_S: f64 = 10.0;

/// The current time, and the rotations from inertial axes to the present Earth-fixed axes, each computed on first use.
pub(super) struct Axes {
    pub now: Epoch,
    orientation: Orientation,
    turn: Option<EarthTurn>,
    itrf_from: [Option<DMat3>; Frame::ALL.len()],
}

impl Axes {
    pub fn new(now: Epoch, orientation: Orientation, turn: Option<EarthTurn>) -> Self {
        Self {
            now,
            orientation,
            turn,
            itrf_from: [None; Frame::ALL.len()],
        }
    }

    pub fn itrf_from(&mut self, frame: Frame) -> DMat3 {
        let kept = &mut self.itrf_from[frame as usize];
        *kept.get_or_insert_with(|| {
            let by_date = |frame: Frame| frame.itrf_from(self.now, &self.orientation);
            match self.turn {
                Some(turn) if frame == Frame::Gcrf => turn.itrf_from_gcrf,
                Some(turn) if !frame.is_earth_fixed() => {
                    let gcrf_from_itrf = by_date(Frame::Gcrf).transpose();
                    turn.itrf_from_gcrf * gcrf_from_itrf * by_date(frame)
                }
                _ => by_date(frame),
            }
        })
    }

    /// Rotation rate of the Earth, radians per second.
    fn rate_rad_s(&self) -> f64 {
        self.turn
            .map_or(EARTH_ROTATION_RATE_RAD_S, |turn| turn.rate_rad_s)
    }
}

/// A satellite with its sampled curves.
#[derive(Clone)]
pub(super) struct Satellite {
    pub style: TrackStyle,
    pub ink: Ink,
    // Boxed: most of thousands of satellites have none.
    pub trail: Option<Box<Curve>>,
    pub ground: Option<Box<Curve>>,
    /// Left and right edge of the swath.
    pub swath: Option<Box<Curve<[DVec3; 2]>>>,
    pub reference: Option<CurveReference>,
    /// Its current position, in the reference's axes, if known.
    pub now_m: Option<DVec3>,
    /// Direction of its motion, in these axes.
    pub flight: DVec3,
    pub now_s: f64,
}

/// Origin of the times and axes of the curves.
#[derive(Clone, Copy)]
pub(super) struct CurveReference {
    epoch: Epoch,
    pub frame: Frame,
    revolution_s: f64,
}

impl CurveReference {
    fn at(epoch: Epoch, state: &OrbitState) -> Self {
        Self {
            epoch,
            frame: state.frame,
            revolution_s: revolution_s(state),
        }
    }

    fn seconds(&self, epoch: Epoch) -> f64 {
        (epoch - self.epoch).to_seconds()
    }

    pub fn window(&self, span: TrackSpan, now_s: f64) -> TimeWindow {
        let (before_s, after_s) = match span {
            TrackSpan::Seconds { before_s, after_s } => (before_s, after_s),
            TrackSpan::Revolutions { before, after } => {
                (before * self.revolution_s, after * self.revolution_s)
            }
        };
        TimeWindow {
            from_s: now_s - before_s,
            now_s,
            to_s: now_s + after_s,
        }
    }
}

/// A state in non-rotating axes: its own, or TEME, which is the cheapest to transform to.
fn inertial(state: &OrbitState, orientation: &Orientation) -> OrbitState {
    match state.frame.is_earth_fixed() {
        true => state.in_frame(Frame::Teme, orientation),
        false => *state,
    }
}

/// Whether a position can be drawn: a radius of 0 and non-finite values are rejected here.
fn is_sound(position_m: DVec3) -> bool {
    position_m.is_finite() && position_m != DVec3::ZERO
}

/// Whether a time is between two others, or equal to one. Epochs of one time scale are compared directly: the general comparison of hifitime
/// converts both.
fn is_within(now: Epoch, first: Epoch, last: Epoch) -> bool {
    match [first, last]
        .iter()
        .all(|end| end.time_scale == now.time_scale)
    {
        true => first.duration <= now.duration && now.duration <= last.duration,
        false => first <= now && now <= last,
    }
}

/// Period from the energy, T = 2π√(a³/μ) with 1/a = 2/r − v²/μ; a day if there is none or it is too long.
fn revolution_s(state: &OrbitState) -> f64 {
    const DAY_S: f64 = 86_400.0;
    let inverse =
        2.0 / state.position_m.length() - state.velocity_m_s.length_squared() / EARTH_GM_M3_S2;
    if inverse <= 0.0 {
        return DAY_S;
    }
    let time_s = std::f64::consts::TAU / (EARTH_GM_M3_S2 * inverse.powi(3)).sqrt();
    match time_s <= LONGEST_REVOLUTION_S {
        true => time_s,
        false => DAY_S,
    }
}

impl Satellite {
    pub fn new(style: &TrackStyle, format: &PassFormat, max_points: usize) -> Self {
        Self {
            style: *style,
            ink: style.ink(format),
            trail: style.trail.map(|_| Box::new(Curve::new(max_points))),
            ground: style.ground_track.map(|_| Box::new(Curve::new(max_points))),
            swath: style.swath().map(|_| Box::new(Curve::new(max_points))),
            reference: None,
            now_m: None,
            flight: DVec3::ZERO,
            now_s: 0.0,
        }
    }

    /// Updates the curves to the current time; if nothing is drawn, only if `is_looked_for` by stations. Returns whether the curves are complete.
    pub fn follow(
        &mut self,
        feed: &dyn Feed,
        axes: &mut Axes,
        ellipsoid: &Ellipsoid,
        budget: &mut usize,
        is_looked_for: bool,
    ) -> bool {
        self.now_m = None;
        if self.style.is_nothing() && !is_looked_for {
            return true;
        }
        if self.trail.is_none() && self.ground.is_none() && self.swath.is_none() {
            self.follow_place(feed, axes);
            return true;
        }
        let (first, last) = feed.validity();
        let orientation = axes.orientation;
        let state_at = |epoch: Epoch| {
            let state = feed.state_at(epoch).ok()?;
            let state = inertial(&state, &orientation);
            is_sound(state.position_m).then_some(state)
        };
        let is_known = is_within(axes.now, first, last);
        let state = match is_known {
            true => state_at(axes.now),
            // If there is no state for now, another time may serve as reference.
            false if self.reference.is_none() && first <= last => {
                state_at(axes.now.clamp(first, last))
            }
            false => None,
        };
        if let Some(state) = state
            && self
                .reference
                .is_none_or(|reference| reference.frame != state.frame)
        {
            self.curves().for_each(Curve::clear);
            if let Some(swath) = &mut self.swath {
                swath.clear();
            }
            self.reference = Some(CurveReference::at(axes.now, &state));
        }
        let Some(reference) = self.reference else {
            return true;
        };
        self.now_m = state.filter(|_| is_known).map(|state| state.position_m);
        self.flight = state.map_or(DVec3::ZERO, |state| state.velocity_m_s);
        self.now_s = reference.seconds(axes.now);
        let now_s = self.now_s;
        if feed.freshness() != Freshness::Settled {
            self.curves()
                .for_each(|curve| curve.forget_after(now_s - UNSETTLED_S));
            if let Some(swath) = &mut self.swath {
                swath.forget_after(now_s - UNSETTLED_S);
            }
        }
        let known = (reference.seconds(first), reference.seconds(last));
        let itrf_from_inertial = axes.itrf_from(reference.frame);
        let rate_rad_s = axes.rate_rad_s();
        let moving = |t_s: f64| {
            // Seconds are rounded; clamped so that the ends of the validity are not missed.
            let epoch = (reference.epoch + Duration::from_seconds(t_s)).clamp(first, last);
            Some(state_at(epoch)?.in_frame(reference.frame, &orientation))
        };
        let step_s = |state: &OrbitState| {
            let speed = state.velocity_m_s.length();
            STEP_RAD * state.position_m.length() / speed.max(1.0)
        };
        // For a slow satellite the rotation of the ground sets the step.
        let ground_step_s =
            |state: &OrbitState| 1.0 / (1.0 / step_s(state) + EARTH_ROTATION_RATE_RAD_S / STEP_RAD);
        // The Earth rotates from its present orientation.
        let itrf_at =
            |t_s: f64| DMat3::from_rotation_z(-rate_rad_s * (t_s - now_s)) * itrf_from_inertial;
        let sample = |t_s: f64| {
            let state = moving(t_s)?;
            Some(CurvePoint {
                t_s,
                point_m: state.position_m,
                step_s: step_s(&state),
            })
        };
        let mut is_whole = true;
        if let (Some(curve), Some(span)) = (&mut self.trail, self.style.trail) {
            is_whole &= curve.follow(reference.window(span, now_s), known, budget, sample);
        }
        if let (Some(curve), Some(span)) = (&mut self.ground, self.style.ground_track) {
            let on_ground = |t_s: f64| {
                let state = moving(t_s)?;
                Some(CurvePoint {
                    t_s,
                    point_m: subpoint(itrf_at(t_s) * state.position_m, ellipsoid),
                    step_s: ground_step_s(&state),
                })
            };
            is_whole &= curve.follow(reference.window(span, now_s), known, budget, on_ground);
        }
        if let (Some(curve), Some(span)) = (&mut self.swath, self.style.swath()) {
            let field = self.style.field();
            let edges = |t_s: f64| {
                let state = moving(t_s)?;
                let itrf = itrf_at(t_s);
                let flight = itrf * state.velocity_m_s;
                Some(CurvePoint {
                    t_s,
                    point_m: swath_edges(&field, itrf * state.position_m, flight, ellipsoid)?,
                    step_s: ground_step_s(&state),
                })
            };
            is_whole &= curve.follow(reference.window(span, now_s), known, budget, edges);
        }
        is_whole
    }

    /// Updates the position only, without curves: the usual case for thousands of satellites.
    fn follow_place(&mut self, feed: &dyn Feed, axes: &Axes) {
        let (first, last) = feed.validity();
        if !is_within(axes.now, first, last) {
            return;
        }
        let Ok(mut state) = feed.state_at(axes.now) else {
            return;
        };
        if state.frame.is_earth_fixed() {
            state = inertial(&state, &axes.orientation);
        }
        if !is_sound(state.position_m) {
            return;
        }
        self.now_m = Some(state.position_m);
        self.flight = state.velocity_m_s;
        if self
            .reference
            .as_ref()
            .is_none_or(|reference| reference.frame != state.frame)
        {
            self.reference = Some(CurveReference::at(axes.now, &state));
        }
    }

    /// Its current position, ITRF metres, if known.
    pub fn place_itrf_m(&self, axes: &mut Axes) -> Option<DVec3> {
        let (reference, now_m) = (self.reference?, self.now_m?);
        Some(axes.itrf_from(reference.frame) * now_m)
    }

    fn curves(&mut self) -> impl Iterator<Item = &mut Curve> {
        let curves = [&mut self.trail, &mut self.ground].into_iter();
        curves.filter_map(Option::as_deref_mut)
    }
}

/// Left and right edge of the swath of a satellite at a position; `None` if the field of view misses the ground.
pub(super) fn swath_edges(
    field: &FieldOfView,
    place_itrf_m: DVec3,
    flight_itrf: DVec3,
    ellipsoid: &Ellipsoid,
) -> Option<[DVec3; 2]> {
    let aimed = field.aimed(place_itrf_m, flight_itrf, ellipsoid)?;
    let edge = |side: f64| aimed.swath_edge(flight_itrf, side);
    Some([edge(-1.0)?, edge(1.0)?])
}

/// The sub-satellite point: the foot of the ellipsoid's normal through a position.
pub(super) fn subpoint(place_itrf_m: DVec3, ellipsoid: &Ellipsoid) -> DVec3 {
    let place = ellipsoid.geodetic_from_itrf(place_itrf_m);
    ellipsoid.surface_point(Ellipsoid::normal(place.lat_rad, place.lon_rad))
}

#[cfg(test)]
#[path = "satellite_tests.rs"]
mod tests;
