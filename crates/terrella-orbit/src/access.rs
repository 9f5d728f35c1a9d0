//! Access: when one satellite can see another, or a ground station a satellite, within range and in sunlight.

use super::one_dimension::{bisect, greatest};
use super::passes::Observer;
use super::{Feed, OrbitError};
use glam::DVec3;
use terrella_frames::{
    Duration, Ellipsoid, Epoch, Illumination, Orientation, illumination, sun_position_itrf_m,
};

/// How exactly the ends of an access are found, seconds.
const EXACT_S: f64 = 1e-3;
/// A step, as an angle that the faster of two satellites moves about the Earth's centre, radians: within it the margin turns once at most.
const STEP_RAD: f64 = 0.02;
/// Bounds of a step, seconds.
const STEP_S: std::ops::RangeInclusive<f64> = 1.0..=120.0;
/// Most accesses of one search.
pub const MAX_ACCESSES: usize = 100_000;

/// Conditions of an access besides a line of sight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AccessRule {
    /// Longest range, metres.
    pub max_range_m: f64,
    /// Least height above the ellipsoid that the line between two satellites passes the Earth at, metres: the depth of the air that blocks
    /// it.
    pub min_height_m: f64,
    /// Whether the satellite must be outside the Earth's umbra. Between two satellites, the second must be.
    pub needs_sunlight: bool,
}

impl Default for AccessRule {
    /// Any range, past the bare ellipsoid, by day and night.
    fn default() -> Self {
        Self {
            max_range_m: f64::INFINITY,
            min_height_m: 0.0,
            needs_sunlight: false,
        }
    }
}

/// A time all through which there is access.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Access {
    /// Its first instant.
    pub begin: Epoch,
    /// Whether the access begins here; otherwise the search or the feed's validity does.
    pub starts: bool,
    /// Its last instant.
    pub end: Epoch,
    /// Whether the access ends here.
    pub stops: bool,
    /// Least and greatest range at steps within it and at its ends, metres.
    pub range_m: (f64, f64),
}

/// One end of a line of sight.
#[derive(Clone, Copy)]
pub enum AccessFrom<'a> {
    /// A satellite.
    Satellite(&'a dyn Feed),
    /// A ground station with its elevation mask.
    Station(&'a Observer<'a>),
}

/// The times in which `from` has access to a satellite, in order, from `first` to `last` and within the feeds' validity.
///
/// The margin of each condition is a number that is negative if it fails. The search advances in steps of 0.02 rad of motion. It finds ends by
/// bisection, and the extremes of the margin between steps by golden section, so that short accesses and interruptions are found too. A feed's gaps
/// ([`OrbitError::NotCovered`]) interrupt accesses. At most [`MAX_ACCESSES`].
///
/// # Errors
/// Errors of a feed within its validity: a satellite that has decayed.
pub fn accesses(
    from: AccessFrom<'_>,
    to: &dyn Feed,
    rule: &AccessRule,
    ellipsoid: &Ellipsoid,
    orientation: &dyn Fn(Epoch) -> Orientation,
    (first, last): (Epoch, Epoch),
) -> Result<Vec<Access>, OrbitError> {
    let own = match from {
        AccessFrom::Satellite(feed) => feed.validity(),
        AccessFrom::Station(_) => to.validity(),
    };
    let known = to.validity();
    let (first, last) = (first.max(known.0).max(own.0), last.min(known.1).min(own.1));
    if first > last {
        return Ok(Vec::new());
    }
    let search = AccessSearch {
        from,
        to,
        rule,
        ellipsoid,
        orientation,
        first,
        end_s: (last - first).to_seconds(),
    };
    search.run()
}

/// The geometry at one time.
#[derive(Clone, Copy)]
struct Sight {
    /// Minimum of the margins of all conditions: not negative during an access.
    margin: f64,
    range_m: f64,
    step_s: f64,
}

struct AccessSearch<'s> {
    from: AccessFrom<'s>,
    to: &'s dyn Feed,
    rule: &'s AccessRule,
    ellipsoid: &'s Ellipsoid,
    orientation: &'s dyn Fn(Epoch) -> Orientation,
    first: Epoch,
    end_s: f64,
}

impl AccessSearch<'_> {
    fn epoch(&self, t: f64) -> Epoch {
        self.first + Duration::from_seconds(t)
    }

    fn run(&self) -> Result<Vec<Access>, OrbitError> {
        let mut found: Vec<Access> = Vec::new();
        let mut open: Option<Access> = None;
        let mut t = 0.0;
        let mut earlier: Option<(f64, Sight)> = None;
        let mut before = self.sight(t)?;
        if let Some(sight) = before.filter(|sight| sight.margin >= 0.0) {
            open = Some(self.opened(t, false, sight));
        }
        while t < self.end_s && found.len() < MAX_ACCESSES {
            let step = before.map_or(*STEP_S.start(), |sight| sight.step_s);
            let next_t = (t + step).min(self.end_s);
            let next = self.sight(next_t)?;
            // The sign may change twice between three steps of which the middle one has the extreme margin.
            let mut times = [Some(next_t), None];
            if let (Some((from_t, a)), Some(b), Some(c)) = (earlier, before, next) {
                let sign = if b.margin < 0.0 { 1.0 } else { -1.0 };
                let is_extreme =
                    sign * b.margin >= sign * a.margin && sign * b.margin >= sign * c.margin;
                let is_same =
                    (a.margin < 0.0) == (b.margin < 0.0) && (c.margin < 0.0) == (b.margin < 0.0);
                if is_extreme && is_same {
                    let extreme = self.extreme(from_t, next_t, sign)?;
                    if self
                        .sight(extreme)?
                        .is_some_and(|sight| (sight.margin < 0.0) != (b.margin < 0.0))
                    {
                        // Before or after the middle of the step: both ends of the change are crossed one after the other.
                        if extreme < t {
                            self.cross(from_t, extreme, &mut open, &mut found)?;
                            self.cross(extreme, t, &mut open, &mut found)?;
                        } else {
                            times = [Some(extreme), Some(next_t)];
                        }
                    }
                }
            }
            let mut at = t;
            for time in times.into_iter().flatten() {
                self.cross(at, time, &mut open, &mut found)?;
                at = time;
            }
            if let (Some(access), Some(sight)) =
                (&mut open, next.filter(|sight| sight.margin >= 0.0))
            {
                access.range_m.0 = access.range_m.0.min(sight.range_m);
                access.range_m.1 = access.range_m.1.max(sight.range_m);
            }
            earlier = before.map(|sight| (t, sight));
            (t, before) = (next_t, next);
        }
        if let Some(access) = open {
            found.push(Access {
                end: self.epoch(t),
                stops: false,
                ..access
            });
        }
        Ok(found)
    }

    fn opened(&self, t: f64, starts: bool, sight: Sight) -> Access {
        Access {
            begin: self.epoch(t),
            starts,
            end: self.epoch(t),
            stops: false,
            range_m: (sight.range_m, sight.range_m),
        }
    }

    /// Begins or ends an access where the sign of the margin changes between two times.
    fn cross(
        &self,
        low: f64,
        high: f64,
        open: &mut Option<Access>,
        found: &mut Vec<Access>,
    ) -> Result<(), OrbitError> {
        let has = |sight: Option<Sight>| sight.is_some_and(|sight| sight.margin >= 0.0);
        if has(self.sight(high)?) == open.is_some() {
            return Ok(());
        }
        let was_open = open.is_some();
        let (low, high) = bisect(low, high, EXACT_S, |t| {
            Ok::<_, OrbitError>(has(self.sight(t)?) != was_open)
        })?;
        match open.take() {
            None => {
                let starts = self.sight(low)?.is_some();
                let sight = self.sight(high)?;
                *open = sight.map(|sight| self.opened(high, starts, sight));
            }
            Some(access) => {
                let range_m = self.sight(low)?.map_or(access.range_m, |sight| {
                    (
                        access.range_m.0.min(sight.range_m),
                        access.range_m.1.max(sight.range_m),
                    )
                });
                found.push(Access {
                    end: self.epoch(low),
                    stops: self.sight(high)?.is_some(),
                    range_m,
                    ..access
                });
            }
        }
        Ok(())
    }

    /// Where the margin is greatest (`sign` 1) or least (−1) between two times, by golden section.
    fn extreme(&self, low: f64, high: f64, sign: f64) -> Result<f64, OrbitError> {
        let value = |t: f64| -> Result<f64, OrbitError> {
            let sight = self.sight(t)?;
            Ok(sight.map_or(f64::NEG_INFINITY, |sight| sign * sight.margin))
        };
        // One instant of access is enough.
        let is_enough = |margin: f64| margin >= 0.0 && sign > 0.0;
        let (time, _) = greatest(low, high, EXACT_S, value, is_enough)?;
        Ok(time)
    }

    /// `None` in a gap of a feed.
    fn sight(&self, t: f64) -> Result<Option<Sight>, OrbitError> {
        let epoch = self.epoch(t);
        let orientation = (self.orientation)(epoch);
        let state = |feed: &dyn Feed| match feed.state_at(epoch) {
            Ok(state) => Ok(Some(state.inertial_in_itrf_axes(&orientation))),
            Err(OrbitError::NotCovered { .. }) => Ok(None),
            Err(error) => Err(error),
        };
        let Some((to_m, to_m_s)) = state(self.to)? else {
            return Ok(None);
        };
        let rate = |r: DVec3, v: DVec3| v.length() / r.length().max(1.0);
        let mut fastest = rate(to_m, to_m_s);
        let (from_m, mut margin) = match self.from {
            AccessFrom::Station(observer) => {
                let place = observer.place_itrf_m();
                (place, observer.sine_above_mask(to_m))
            }
            AccessFrom::Satellite(feed) => {
                let Some((from_m, from_m_s)) = state(feed)? else {
                    return Ok(None);
                };
                fastest = fastest.max(rate(from_m, from_m_s));
                (
                    from_m,
                    clearance(from_m, to_m, self.rule.min_height_m, self.ellipsoid),
                )
            }
        };
        let range_m = from_m.distance(to_m);
        if self.rule.max_range_m.is_finite() {
            margin =
                margin.min((self.rule.max_range_m - range_m) / self.ellipsoid.equatorial_radius_m);
        }
        if self.rule.needs_sunlight && margin >= 0.0 {
            let sun_m = sun_position_itrf_m(epoch, &orientation);
            let (light, part) = illumination(to_m, sun_m, self.ellipsoid);
            // The penumbra counts as sunlit.
            margin = margin.min(if light == Illumination::Umbra {
                -1.0
            } else {
                part
            });
        }
        let step_s = (STEP_RAD / fastest).clamp(*STEP_S.start(), *STEP_S.end());
        Ok(Some(Sight {
            margin,
            range_m,
            step_s,
        }))
    }
}

/// How far the line between two places passes the ellipsoid that is `height_m` higher, Earth radii; not positive where it is blocked.
fn clearance(a_m: DVec3, b_m: DVec3, height_m: f64, ellipsoid: &Ellipsoid) -> f64 {
    let (equatorial, polar) = (
        ellipsoid.equatorial_radius_m + height_m,
        ellipsoid.polar_radius_m + height_m,
    );
    let scale = DVec3::new(equatorial, equatorial, polar).recip();
    let (a, b) = (a_m * scale, b_m * scale);
    let line = b - a;
    let along = (-a.dot(line) / line.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    (a + along * line).length() - 1.0
}

#[cfg(test)]
#[path = "access_tests.rs"]
mod tests;
