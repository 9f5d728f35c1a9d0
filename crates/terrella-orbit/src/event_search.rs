//! Events along any motion: entry into and exit from the Earth's shadow, nodes and apsides.

use super::one_dimension::{bisect, greatest};
use super::{Feed, OrbitError};
use terrella_frames::{
    Duration, Ellipsoid, Epoch, Orientation, shadow_margins_rad, sun_position_itrf_m,
};

/// How exactly times are found, seconds.
const EXACT_S: f64 = 1e-3;
/// A step, as an angle that the satellite moves about the Earth's centre, radians, and its bounds, seconds.
const STEP_RAD: f64 = 0.02;
const STEP_S: std::ops::RangeInclusive<f64> = 0.5..=120.0;
/// Sines nearer to 0 have no sign: an equatorial orbit has no nodes, a circular one no apsides.
const NO_SIGN: f64 = 1e-9;

/// Kinds of events of [`motion_events`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionEventKind {
    /// The Earth begins to cover the Sun.
    PenumbraEntry,
    /// The Earth covers all of the Sun.
    UmbraEntry,
    /// The Sun begins to reappear.
    UmbraExit,
    /// The Earth no longer covers any of the Sun.
    PenumbraExit,
    /// The satellite crosses the equator northwards.
    AscendingNode,
    /// It crosses the equator southwards.
    DescendingNode,
    /// It is nearest to the Earth's centre.
    Periapsis,
    /// It is farthest from the Earth's centre.
    Apoapsis,
}

/// An event of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionEvent {
    /// Its time, to a millisecond.
    pub epoch: Epoch,
    /// Its kind.
    pub kind: MotionEventKind,
}

/// Which events are searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SoughtEvents {
    /// Entry into and exit from the penumbra and the umbra.
    Shadow,
    /// These, nodes and apsides.
    All,
}

/// The events of a motion in order, from `first` to `last` and within its validity.
///
/// The search advances in steps of 0.02 rad of motion, at most two minutes. It finds times by bisection on the angles of [`shadow_margins_rad`], and
/// extremes of these between steps by golden section, so that short eclipses are found too. Gaps of the feed ([`OrbitError::NotCovered`]) have no
/// events. What has begun before `first` has no entry.
///
/// # Errors
/// Errors of the feed within its validity: a satellite that has decayed.
pub fn motion_events(
    feed: &dyn Feed,
    sought: SoughtEvents,
    ellipsoid: &Ellipsoid,
    orientation: &dyn Fn(Epoch) -> Orientation,
    (first, last): (Epoch, Epoch),
) -> Result<Vec<MotionEvent>, OrbitError> {
    let known = feed.validity();
    let (first, last) = (first.max(known.0), last.min(known.1));
    if first > last {
        return Ok(Vec::new());
    }
    let search = EventSearch {
        feed,
        sought,
        ellipsoid,
        orientation,
        first,
        end_s: (last - first).to_seconds(),
    };
    search.run()
}

/// A function of time that changes its sign at events.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Signal {
    Penumbra,
    Umbra,
    Latitude,
    Radial,
}

impl Signal {
    const ALL: [Self; 4] = [Self::Penumbra, Self::Umbra, Self::Latitude, Self::Radial];

    /// The event when the value becomes positive or negative.
    fn kind(self, becomes_positive: bool) -> MotionEventKind {
        match (self, becomes_positive) {
            (Self::Penumbra, false) => MotionEventKind::PenumbraEntry,
            (Self::Penumbra, true) => MotionEventKind::PenumbraExit,
            (Self::Umbra, false) => MotionEventKind::UmbraEntry,
            (Self::Umbra, true) => MotionEventKind::UmbraExit,
            (Self::Latitude, true) => MotionEventKind::AscendingNode,
            (Self::Latitude, false) => MotionEventKind::DescendingNode,
            (Self::Radial, true) => MotionEventKind::Periapsis,
            (Self::Radial, false) => MotionEventKind::Apoapsis,
        }
    }

    /// Whether a value has a sign.
    fn has_sign(self, value: f64) -> bool {
        match self {
            Self::Penumbra | Self::Umbra => true,
            Self::Latitude | Self::Radial => value.abs() > NO_SIGN,
        }
    }
}

/// The values of all signals at a time.
#[derive(Clone, Copy)]
struct Look {
    t: f64,
    values: [f64; 4],
    step_s: f64,
}

impl Look {
    fn is_positive(&self, index: usize) -> bool {
        self.values[index] >= 0.0
    }
}

/// Times are seconds since `first`.
struct EventSearch<'s> {
    feed: &'s dyn Feed,
    sought: SoughtEvents,
    ellipsoid: &'s Ellipsoid,
    orientation: &'s dyn Fn(Epoch) -> Orientation,
    first: Epoch,
    end_s: f64,
}

impl EventSearch<'_> {
    fn run(&self) -> Result<Vec<MotionEvent>, OrbitError> {
        let mut found = Vec::new();
        let signals: &[Signal] = match self.sought {
            SoughtEvents::Shadow => &Signal::ALL[..2],
            SoughtEvents::All => &Signal::ALL,
        };
        // The last two looks at which each signal has a sign.
        let mut seen: [[Option<Look>; 2]; 4] = [[None; 2]; 4];
        let mut t = 0.0;
        loop {
            let look = self.look(t)?;
            for (index, (&signal, seen)) in signals.iter().zip(&mut seen).enumerate() {
                let Some(next) = look else {
                    // In a gap.
                    *seen = [None; 2];
                    continue;
                };
                if !signal.has_sign(next.values[index]) {
                    continue;
                }
                let [earlier, before] = *seen;
                if let Some(before) = before {
                    if before.is_positive(index) != next.is_positive(index) {
                        self.cross(index, signal, (before.t, next.t), &mut found)?;
                    } else if let Some(earlier) = earlier {
                        self.dip(index, signal, [earlier, before, next], &mut found)?;
                    }
                }
                *seen = [before, Some(next)];
            }
            if t >= self.end_s {
                break;
            }
            let step_s = look.map_or(*STEP_S.start(), |look| look.step_s);
            t = (t + step_s).min(self.end_s);
        }
        found.sort_by_key(|event: &MotionEvent| event.epoch);
        Ok(found)
    }

    /// Adds the event between two times if the sign differs at them.
    fn cross(
        &self,
        index: usize,
        signal: Signal,
        (low, high): (f64, f64),
        found: &mut Vec<MotionEvent>,
    ) -> Result<(), OrbitError> {
        let is_positive = |t: f64| -> Result<Option<bool>, OrbitError> {
            Ok(self.look(t)?.map(|look| look.is_positive(index)))
        };
        let (Some(from), Some(to)) = (is_positive(low)?, is_positive(high)?) else {
            return Ok(());
        };
        if from == to {
            return Ok(());
        }
        let (_, after) = bisect(low, high, EXACT_S, |t| {
            Ok::<_, OrbitError>(is_positive(t)? == Some(to))
        })?;
        found.push(MotionEvent {
            epoch: self.epoch(after),
            kind: signal.kind(to),
        });
        Ok(())
    }

    /// Adds both events if the value has one sign at three times, is nearest to 0 at the middle one, and has the other sign beside it.
    fn dip(
        &self,
        index: usize,
        signal: Signal,
        [a, b, c]: [Look; 3],
        found: &mut Vec<MotionEvent>,
    ) -> Result<(), OrbitError> {
        let [at_a, at_b, at_c] = [a, b, c].map(|look| look.values[index]);
        let has_extremes = matches!(signal, Signal::Penumbra | Signal::Umbra);
        let sign = if at_b >= 0.0 { -1.0 } else { 1.0 };
        let is_extreme = sign * at_b >= sign * at_a && sign * at_b > sign * at_c;
        if !has_extremes || a.is_positive(index) != b.is_positive(index) || !is_extreme {
            return Ok(());
        }
        let value = |t: f64| -> Result<f64, OrbitError> {
            let look = self.look(t)?;
            Ok(look.map_or(f64::NEG_INFINITY, |look| sign * look.values[index]))
        };
        let (extreme, most) = greatest(a.t, c.t, EXACT_S, value, |most| most > 0.0)?;
        if most > 0.0 {
            let (low, high) = if extreme < b.t {
                (a.t, b.t)
            } else {
                (b.t, c.t)
            };
            self.cross(index, signal, (low, extreme), found)?;
            self.cross(index, signal, (extreme, high), found)?;
        }
        Ok(())
    }

    fn epoch(&self, t: f64) -> Epoch {
        self.first + Duration::from_seconds(t)
    }

    /// `None` in a gap of the feed.
    fn look(&self, t: f64) -> Result<Option<Look>, OrbitError> {
        let epoch = self.epoch(t);
        let state = match self.feed.state_at(epoch) {
            Ok(state) => state,
            Err(OrbitError::NotCovered { .. }) => return Ok(None),
            Err(error) => return Err(error),
        };
        let orientation = (self.orientation)(epoch);
        let (position_m, velocity_m_s) = state.inertial_in_itrf_axes(&orientation);
        let sun_m = sun_position_itrf_m(epoch, &orientation);
        let [penumbra, umbra] = shadow_margins_rad(position_m, sun_m, self.ellipsoid);
        let (radius, speed) = (
            position_m.length().max(1.0),
            velocity_m_s.length().max(1e-9),
        );
        Ok(Some(Look {
            t,
            values: [
                penumbra,
                umbra,
                position_m.z / radius,
                position_m.dot(velocity_m_s) / (radius * speed),
            ],
            step_s: (STEP_RAD * radius / speed).clamp(*STEP_S.start(), *STEP_S.end()),
        }))
    }
}

#[cfg(test)]
#[path = "event_search_tests.rs"]
mod tests;
