//! Passes: when a satellite is above an observer's horizon, and its azimuth and elevation angle.

use super::constants::EARTH_GM_M3_S2;
use super::one_dimension::{bisect, greatest};
use super::{Feed, Frame, OrbitError, OrbitState};
use glam::DVec3;
use terrella_frames::{
    Duration, EARTH_ROTATION_RATE_RAD_S, Ellipsoid, Epoch, Geodetic, Orientation,
};

/// How exactly the ends of a pass are found, seconds.
const EXACT_S: f64 = 1e-3;
/// From the end of one pass to where the next one is looked for, seconds.
const SEPARATION_S: f64 = 1.0;
/// Step where the feed has no state, seconds.
const GAP_STEP_S: f64 = 30.0;
/// Shortest steps, as an angle that the satellite moves about the Earth's centre, radians: within it the elevation turns
/// at most once.
const STEP_RAD: f64 = 0.01;
/// Bounds of these steps, seconds.
const STEP_S: std::ops::RangeInclusive<f64> = 0.5..=120.0;
/// Gravity at the ground is nowhere greater, m/s².
const MAX_GRAVITY_M_S2: f64 = 9.9;
/// Factor of all acceleration bounds, for other forces.
const MARGIN: f64 = 1.1;

/// An observer on the ground: a position, and the elevation mask, the least elevation angle of a visible satellite. No refraction, no terrain.
#[derive(Clone, Copy)]
pub struct Observer<'o> {
    place_itrf_m: DVec3,
    up: DVec3,
    east: DVec3,
    sin_least: f64,
    ellipsoid: Ellipsoid,
    orientation: &'o dyn Fn(Epoch) -> Orientation,
}

/// Look angles: direction and range of a satellite, seen from a position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LookAngles {
    /// Clockwise from north, radians, 0…2π. At the poles north is along the meridian of the place's longitude.
    pub azimuth_rad: f64,
    /// Above the plane across the ellipsoid's normal, radians.
    pub elevation_rad: f64,
    /// Range, metres.
    pub distance_m: f64,
}

/// A pass, from acquisition to loss of signal: an interval in which a satellite is above the minimum elevation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pass {
    /// Its first instant: acquisition of signal.
    pub begin: Epoch,
    /// Whether it rises at `begin`; otherwise the search or the feed's validity begins there.
    pub rises: bool,
    /// Time of the greatest elevation.
    pub highest: Epoch,
    /// Elevation angle at that time, radians.
    pub elevation_rad: f64,
    /// Its last instant: loss of signal.
    pub end: Epoch,
    /// Whether it sets at `end`.
    pub sets: bool,
}

impl<'o> Observer<'o> {
    /// Of a place above `ellipsoid`; `least_elevation_rad` is brought into 0…π/2, and `orientation` is the Earth's.
    pub fn new(
        place: Geodetic,
        ellipsoid: &Ellipsoid,
        least_elevation_rad: f64,
        orientation: &'o dyn Fn(Epoch) -> Orientation,
    ) -> Self {
        let (sin, cos) = place.lon_rad.sin_cos();
        Self {
            place_itrf_m: ellipsoid.itrf_from_geodetic(place),
            up: Ellipsoid::normal(place.lat_rad, place.lon_rad),
            east: DVec3::new(-sin, cos, 0.0),
            sin_least: least_elevation_rad
                .clamp(0.0, std::f64::consts::FRAC_PI_2)
                .sin(),
            ellipsoid: *ellipsoid,
            orientation,
        }
    }

    /// Where it is, ITRF metres.
    pub(super) fn place_itrf_m(&self) -> DVec3 {
        self.place_itrf_m
    }

    /// Its unit vector away from the ground, ITRF.
    pub(super) fn up(&self) -> DVec3 {
        self.up
    }

    /// The sine of the elevation angle of a position, ITRF metres, minus that of the mask.
    pub(super) fn sine_above_mask(&self, position_itrf_m: DVec3) -> f64 {
        let line = position_itrf_m - self.place_itrf_m;
        line.normalize_or_zero().dot(self.up) - self.sin_least
    }

    /// The Earth's figure.
    pub(super) fn ellipsoid(&self) -> &Ellipsoid {
        &self.ellipsoid
    }

    /// The Earth's orientation.
    pub(super) fn orientation(&self, epoch: Epoch) -> Orientation {
        (self.orientation)(epoch)
    }

    /// Look angles of a satellite.
    pub fn look_angles(&self, state: &OrbitState) -> LookAngles {
        let itrf = state.in_frame(Frame::Itrf, &(self.orientation)(state.epoch));
        let line = itrf.position_m - self.place_itrf_m;
        let (east, up) = (line.dot(self.east), line.dot(self.up));
        let north = line.dot(self.up.cross(self.east));
        LookAngles {
            azimuth_rad: east.atan2(north).rem_euclid(std::f64::consts::TAU),
            elevation_rad: up.atan2(east.hypot(north)),
            distance_m: line.length(),
        }
    }
}

/// The first pass at or after `from` and before `until`, within the feed's validity. A satellite that is already above the mask at `from` is in its
/// first pass; one that always is has a pass that neither rises nor sets. A pass that ends at `from` is not found again.
///
/// With h = ρ·u − |ρ| sin e (ρ from the position to the satellite, u upwards) and |a| the satellite's acceleration, a satellite below the mask
/// cannot rise within Δ while h + h′Δ + ½|a|(1 + sin e)Δ² < 0, as |ρ|″ ≥ −|a|: the search skips this time. Where it is short, the search advances
/// by 0.01 radians of motion and looks for a maximum between two steps where h′ changes sign. Ends of passes are found by bisection and maxima by
/// golden section, to a millisecond. This assumes that velocities match positions, and an acceleration of at most gravity's, a tenth more, and that
/// of the Earth's rotation: two burns within minutes may hide a pass between them.
///
/// The work is bounded: at most one state per half second of the span, typically one per some minutes. A feed's gaps ([`OrbitError::NotCovered`])
/// are skipped and end passes.
///
/// # Errors
/// Errors of the feed within its validity before the end of a pass: a satellite that has decayed.
pub fn next_pass(
    feed: &dyn Feed,
    observer: &Observer<'_>,
    from: Epoch,
    until: Epoch,
) -> Result<Option<Pass>, OrbitError> {
    let (first, last) = feed.validity();
    let (mut from, until) = (from.max(first), until.min(last));
    while from < until {
        let search = Search {
            feed,
            observer,
            from,
            end_s: (until - from).to_seconds(),
        };
        let Some((begin_s, rises)) = search.rise()? else {
            break;
        };
        let pass = search.follow(begin_s, rises)?;
        let length_s = (pass.end - pass.begin).to_seconds();
        // Ends of passes are found to `EXACT_S`.
        let is_remainder = begin_s == 0.0 && length_s <= 2.0 * EXACT_S;
        if !is_remainder {
            return Ok(Some(pass));
        }
        from += Duration::from_seconds(SEPARATION_S);
    }
    Ok(None)
}

/// All passes of a span in order of time, as [`next_pass`] finds them; an error is the last item.
pub fn passes<'a>(
    feed: &'a dyn Feed,
    observer: &'a Observer<'a>,
    from: Epoch,
    until: Epoch,
) -> impl Iterator<Item = Result<Pass, OrbitError>> + 'a {
    let mut from = Some(from);
    std::iter::from_fn(move || {
        let found = next_pass(feed, observer, from.take()?, until).transpose()?;
        if let Ok(pass) = &found {
            from = Some(pass.end + Duration::from_seconds(SEPARATION_S)).filter(|at| *at < until);
        }
        Some(found)
    })
}

/// Elevation and its rate at one state.
#[derive(Clone, Copy)]
struct ElevationState {
    /// h = ρ·u − |ρ| sin e, metres: not negative above the mask.
    above_m: f64,
    /// h′, metres per second.
    rate_m_s: f64,
    sin_elevation: f64,
    /// How long it cannot rise, seconds.
    leap_s: f64,
    /// How long the elevation turns at most once, seconds.
    step_s: f64,
}

/// A span to look through; times are seconds since `from`.
struct Search<'s> {
    feed: &'s dyn Feed,
    observer: &'s Observer<'s>,
    from: Epoch,
    end_s: f64,
}

impl Search<'_> {
    fn epoch(&self, t: f64) -> Epoch {
        self.from + Duration::from_seconds(t)
    }

    /// `None` in a gap of the feed.
    fn elevation_state(&self, t: f64) -> Result<Option<ElevationState>, OrbitError> {
        match self.feed.state_at(self.epoch(t)) {
            Ok(state) => Ok(Some(self.observer.elevation_state(&state))),
            Err(OrbitError::NotCovered { .. }) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// When it first is high enough, and whether it rises there.
    fn rise(&self) -> Result<Option<(f64, bool)>, OrbitError> {
        let mut t = 0.0;
        let mut before = self.elevation_state(t)?;
        if before.is_some_and(|sight| sight.above_m >= 0.0) {
            return Ok(Some((t, false)));
        }
        while t < self.end_s {
            let step = before.map_or(GAP_STEP_S, |sight| sight.leap_s.max(sight.step_s));
            let next_t = (t + step).min(self.end_s);
            let next = self.elevation_state(next_t)?;
            let is_above = next.is_some_and(|sight| sight.above_m >= 0.0);
            let summit = match (before, next) {
                _ if is_above => Some(next_t),
                // Within a skipped interval the satellite cannot rise.
                (Some(a), Some(b)) if a.leap_s < step && a.rate_m_s > 0.0 && b.rate_m_s <= 0.0 => {
                    Some(self.turn(t, next_t, |sight| sight.rate_m_s <= 0.0)?.1)
                }
                _ => None,
            };
            if let Some(summit) = summit {
                let (below, above) = self.turn(t, summit, |sight| sight.above_m >= 0.0)?;
                if self
                    .elevation_state(above)?
                    .is_some_and(|s| s.above_m >= 0.0)
                {
                    return Ok(Some((above, self.elevation_state(below)?.is_some())));
                }
            }
            (t, before) = (next_t, next);
        }
        Ok(None)
    }

    /// The pass that begins at `begin`.
    fn follow(&self, begin: f64, rises: bool) -> Result<Pass, OrbitError> {
        let mut highest = (begin, f64::NEG_INFINITY);
        let (mut before_t, mut before_sine) = (begin, f64::NEG_INFINITY);
        let mut t = begin;
        let mut before = self.elevation_state(t)?;
        let (end, sets) = loop {
            let Some(a) = before else { break (t, false) };
            if a.sin_elevation > highest.1 {
                highest = (t, a.sin_elevation);
            }
            if t >= self.end_s {
                break (self.end_s, false);
            }
            let next_t = (t + a.step_s).min(self.end_s);
            let next = self.elevation_state(next_t)?;
            let is_summit = a.sin_elevation >= before_sine
                && next.is_none_or(|b| b.sin_elevation <= a.sin_elevation);
            if is_summit {
                let (summit, sine) = self.summit(before_t, next_t)?;
                if sine > highest.1 {
                    highest = (summit, sine);
                }
            }
            let low = match next {
                None => Some(next_t),
                Some(b) if b.above_m < 0.0 => Some(next_t),
                // It may dip below between two steps.
                Some(b) if a.rate_m_s < 0.0 && b.rate_m_s >= 0.0 => {
                    Some(self.turn(t, next_t, |sight| sight.rate_m_s >= 0.0)?.0)
                }
                Some(_) => None,
            };
            if let Some(low) = low {
                let is_low = |sight: Option<ElevationState>| sight.is_none_or(|s| s.above_m < 0.0);
                if is_low(self.elevation_state(low)?) {
                    let (above, below) = self.bisect(t, low, is_low)?;
                    break (above, self.elevation_state(below)?.is_some());
                }
            }
            (before_t, before_sine) = (t, a.sin_elevation);
            (t, before) = (next_t, next);
        };
        // A satellite that enters a gap immediately still has a state at `begin`.
        Ok(Pass {
            begin: self.epoch(begin),
            rises,
            highest: self.epoch(highest.0),
            elevation_rad: highest.1.clamp(-1.0, 1.0).asin(),
            end: self.epoch(end),
            sets,
        })
    }

    /// The highest elevation between two times, and its sine, by golden section: velocities of SGP4 are no
    /// derivatives to the last digits and would miss it by seconds in high orbits.
    fn summit(&self, low: f64, high: f64) -> Result<(f64, f64), OrbitError> {
        let sine = |t: f64| -> Result<f64, OrbitError> {
            let sight = self.elevation_state(t)?;
            Ok(sight.map_or(f64::NEG_INFINITY, |sight| sight.sin_elevation))
        };
        greatest(low, high, EXACT_S, sine, |_| false)
    }

    /// As [`Self::bisect`], of known states.
    fn turn(
        &self,
        low: f64,
        high: f64,
        has_turned: impl Fn(&ElevationState) -> bool,
    ) -> Result<(f64, f64), OrbitError> {
        self.bisect(low, high, |sight| sight.as_ref().is_some_and(&has_turned))
    }

    /// Two times at most [`EXACT_S`] apart, between which something turns that has not at `low` and has at `high`.
    fn bisect(
        &self,
        low: f64,
        high: f64,
        has_turned: impl Fn(Option<ElevationState>) -> bool,
    ) -> Result<(f64, f64), OrbitError> {
        bisect(low, high, EXACT_S, |t| {
            Ok(has_turned(self.elevation_state(t)?))
        })
    }
}

impl Observer<'_> {
    fn elevation_state(&self, state: &OrbitState) -> ElevationState {
        let itrf = state.in_frame(Frame::Itrf, &(self.orientation)(state.epoch));
        let (r, v) = (itrf.position_m, itrf.velocity_m_s);
        let line = r - self.place_itrf_m;
        // A satellite at the place itself is nowhere; next to it everything is defined.
        let distance = line.length().max(1e-3);
        let along = line / distance;
        let sin_elevation = along.dot(self.up);
        let range_rate = along.dot(v);
        let above_m = line.dot(self.up) - self.sin_least * distance;
        let rate_m_s = v.dot(self.up) - self.sin_least * range_rate;
        let (radius, speed) = (r.length().max(1.0), v.length());
        let omega = EARTH_ROTATION_RATE_RAD_S;
        let least = (STEP_RAD / (speed / radius + omega)).clamp(*STEP_S.start(), *STEP_S.end());
        let leap = |gravity: f64| {
            // The turning Earth's axes add Coriolis' and the centrifugal acceleration.
            let most = MARGIN * (gravity + 2.0 * omega * speed + omega * omega * radius);
            leap_s(above_m, rate_m_s, 0.5 * most * (1.0 + self.sin_least))
        };
        // Within this time it loses at most a third of its geocentric distance: gravity at most about doubles.
        let soon = 0.25 * radius / (speed + omega * radius);
        let near = leap(2.3 * EARTH_GM_M3_S2 / (radius * radius)).min(soon);
        ElevationState {
            above_m,
            rate_m_s,
            sin_elevation,
            leap_s: leap(MAX_GRAVITY_M_S2).max(near),
            step_s: least,
        }
    }
}

/// The time until h + h′t + ½a t² is 0; 0 for an h that is not negative. `half_most` is ½a.
fn leap_s(above_m: f64, rate_m_s: f64, half_most: f64) -> f64 {
    if above_m >= 0.0 {
        return 0.0;
    }
    let root = (rate_m_s * rate_m_s - 4.0 * half_most * above_m).sqrt();
    // Either form of the quadratic's positive root, whichever adds.
    match rate_m_s > 0.0 {
        true => -2.0 * above_m / (rate_m_s + root),
        false => (root - rate_m_s) / (2.0 * half_most),
    }
}

#[cfg(test)]
#[path = "passes_tests.rs"]
mod tests;
