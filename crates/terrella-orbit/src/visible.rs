//! Visible passes: when a sunlit satellite is in a dark sky, and its brightness.

use super::one_dimension::bisect;
use super::{Feed, Frame, Observer, OrbitError, Pass};
use glam::DVec3;
use terrella_frames::{Duration, Epoch, illumination, sun_position_itrf_m};

/// How exactly the ends of an interval are found, seconds.
const EXACT_S: f64 = 1e-3;
/// How exactly the brightest instant is found, seconds: brightness hardly changes within it.
const BRIGHTEST_EXACT_S: f64 = 0.1;
/// Step, as an angle that the satellite moves about the Earth's centre, radians, and its bounds, seconds.
const STEP_RAD: f64 = 0.005;
const STEP_S: std::ops::RangeInclusive<f64> = 0.5..=60.0;
/// The constant of [`VisibilityRule::magnitude`]: near 5 lg of 1000 km, with half of the disc lit.
const MAGNITUDE_OFFSET: f64 = -15.75;

/// When a satellite counts as visible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VisibilityRule {
    /// Elevation of the Sun's centre below which the observer's sky is dark, radians; without refraction.
    pub sun_below_rad: f64,
    /// The satellite's magnitude at a range of 1000 km with half of its disc lit, as Molczan and McCants list it. `None` estimates no magnitudes.
    pub standard_magnitude: Option<f64>,
}

impl Default for VisibilityRule {
    /// The end of civil twilight, −6°, and no magnitudes.
    fn default() -> Self {
        Self {
            sun_below_rad: f64::to_radians(-6.0),
            standard_magnitude: None,
        }
    }
}

impl VisibilityRule {
    /// Magnitude of a satellite of this range, metres, and phase angle (between Sun and observer, seen from it), radians, in full sunlight:
    /// m₀ − 15.75 + 2.5 lg(r²/F), r in kilometres and F = (1 + cos φ)/2 the lit share of its disc. `None` without a standard magnitude.
    ///
    /// Source: Molczan's formula for the standard magnitudes of the lists of McCants (`mcnames`, `qs.mag`). No extinction by the air.
    pub fn magnitude(&self, range_m: f64, phase_rad: f64) -> Option<f64> {
        let range_km = range_m / 1e3;
        let lit = 0.5 * (1.0 + phase_rad.cos());
        let dimming = 2.5 * (range_km * range_km / lit).log10();
        Some(self.standard_magnitude? + MAGNITUDE_OFFSET + dimming)
    }
}

/// A time all through which a satellite is visible: outside the Earth's umbra, and the Sun low enough for the observer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VisibleInterval {
    /// Its first instant.
    pub begin: Epoch,
    /// Its last instant.
    pub end: Epoch,
    /// When the satellite is brightest and its magnitude then, which counts the part of the Sun that is covered in the penumbra; `None` without
    /// a standard magnitude.
    pub brightest: Option<(Epoch, f64)>,
}

/// The times of a pass in which a satellite is visible, in order.
///
/// The pass is sampled every 0.005 radians of the satellite's motion, at steps of half a second to a minute: two changes within a step are missed.
/// Ends are found by bisection, to a millisecond. The Earth is its ellipsoid without air: sunlight refracted into the shadow is neglected.
///
/// # Errors
/// Errors of the feed; its gaps count as invisible.
pub fn visible_intervals(
    feed: &dyn Feed,
    observer: &Observer<'_>,
    pass: &Pass,
    rule: &VisibilityRule,
) -> Result<Vec<VisibleInterval>, OrbitError> {
    let search = Search {
        feed,
        observer,
        rule,
        from: pass.begin,
    };
    let end = (pass.end - pass.begin).to_seconds();
    let mut found = Vec::new();
    let mut t = 0.0;
    let mut is_visible = search.look(t)?.is_visible();
    let mut begin = is_visible.then_some(t);
    while t < end {
        let next_t = (t + search.step_s(t)?).min(end);
        let next = search.look(next_t)?.is_visible();
        if next != is_visible {
            let (before, after) = search.change(t, next_t, next)?;
            match begin.take() {
                Some(begin) => found.push(search.interval(begin, before)?),
                None => begin = Some(after),
            }
        }
        (t, is_visible) = (next_t, next);
    }
    if let Some(begin) = begin {
        found.push(search.interval(begin, end)?);
    }
    Ok(found)
}

/// Visibility at a time.
#[derive(Clone, Copy)]
enum Look {
    /// The sky is bright, the satellite in the umbra, or the feed has a gap.
    Invisible,
    /// With its magnitude, where one is estimated.
    Visible(Option<f64>),
}

impl Look {
    fn is_visible(self) -> bool {
        matches!(self, Self::Visible(_))
    }
}

/// A pass to look through; times are seconds since `from`.
struct Search<'s> {
    feed: &'s dyn Feed,
    observer: &'s Observer<'s>,
    rule: &'s VisibilityRule,
    from: Epoch,
}

impl Search<'_> {
    fn epoch(&self, t: f64) -> Epoch {
        self.from + Duration::from_seconds(t)
    }

    /// Position and velocity, ITRF metres and metres per second; `None` in a gap of the feed.
    fn state(&self, t: f64) -> Result<Option<(DVec3, DVec3)>, OrbitError> {
        match self.feed.state_at(self.epoch(t)) {
            Ok(state) => {
                let orientation = self.observer.orientation(state.epoch);
                let itrf = state.in_frame(Frame::Itrf, &orientation);
                Ok(Some((itrf.position_m, itrf.velocity_m_s)))
            }
            Err(OrbitError::NotCovered { .. }) => Ok(None),
            Err(error) => Err(error),
        }
    }

    fn step_s(&self, t: f64) -> Result<f64, OrbitError> {
        let step = self
            .state(t)?
            .map_or(*STEP_S.start(), |(r, v)| STEP_RAD * r.length() / v.length());
        Ok(step.clamp(*STEP_S.start(), *STEP_S.end()))
    }

    fn look(&self, t: f64) -> Result<Look, OrbitError> {
        let epoch = self.epoch(t);
        let sun = sun_position_itrf_m(epoch, &self.observer.orientation(epoch));
        let place = self.observer.place_itrf_m();
        let to_sun = (sun - place).normalize_or_zero();
        if to_sun.dot(self.observer.up()) > self.rule.sun_below_rad.sin() {
            return Ok(Look::Invisible);
        }
        let Some((position, _)) = self.state(t)? else {
            return Ok(Look::Invisible);
        };
        let (_, share) = illumination(position, sun, self.observer.ellipsoid());
        if share <= 0.0 {
            return Ok(Look::Invisible);
        }
        let line = place - position;
        let phase_rad = line.angle_between(sun - position);
        let magnitude = self.rule.magnitude(line.length(), phase_rad);
        Ok(Look::Visible(magnitude.map(|m| m - 2.5 * share.log10())))
    }

    /// Two times at most [`EXACT_S`] apart, between which it becomes visible, or no longer is.
    fn change(&self, low: f64, high: f64, becomes: bool) -> Result<(f64, f64), OrbitError> {
        bisect(low, high, EXACT_S, |t| {
            Ok(self.look(t)?.is_visible() == becomes)
        })
    }

    fn interval(&self, begin: f64, end: f64) -> Result<VisibleInterval, OrbitError> {
        Ok(VisibleInterval {
            begin: self.epoch(begin),
            end: self.epoch(end),
            brightest: match self.rule.standard_magnitude {
                Some(_) => self.brightest(begin, end)?,
                None => None,
            },
        })
    }

    /// The least magnitude of an interval: the best of its steps, then of ever smaller ones about it.
    fn brightest(&self, begin: f64, end: f64) -> Result<Option<(Epoch, f64)>, OrbitError> {
        let mut best = self.brighter(None, end)?;
        let mut t = begin;
        while t < end {
            best = self.brighter(best, t)?;
            t += self.step_s(t)?;
        }
        let mut step = *STEP_S.end();
        while step > BRIGHTEST_EXACT_S {
            step *= 0.5;
            for side in [-step, step] {
                let at = best.map_or(begin, |(t, _)| t) + side;
                best = self.brighter(best, at.clamp(begin, end))?;
            }
        }
        Ok(best.map(|(t, magnitude)| (self.epoch(t), magnitude)))
    }

    /// The better of the best so far and another time, with its magnitude.
    fn brighter(&self, best: Option<(f64, f64)>, t: f64) -> Result<Option<(f64, f64)>, OrbitError> {
        Ok(match (self.look(t)?, best) {
            (Look::Visible(Some(magnitude)), None) => Some((t, magnitude)),
            (Look::Visible(Some(magnitude)), Some((_, least))) if magnitude < least => {
                Some((t, magnitude))
            }
            _ => best,
        })
    }
}

#[cfg(test)]
#[path = "visible_tests.rs"]
mod tests;
