//! Positions from a feed over a span of time, sampled once and kept: those of the trail in inertial axes, those of the ground track on the ground.

use glam::DVec3;
use std::collections::VecDeque;

/// Value of a curve: a position, or both edges of a swath.
pub(super) trait Place: Copy {
    /// Interpolates linearly.
    fn toward(self, other: Self, part: f64) -> Self;
}

impl Place for DVec3 {
    fn toward(self, other: Self, part: f64) -> Self {
        self.lerp(other, part)
    }
}

impl Place for [DVec3; 2] {
    fn toward(self, other: Self, part: f64) -> Self {
        let [[a, b], [c, d]] = [self, other];
        [a.lerp(c, part), b.lerp(d, part)]
    }
}

/// A sampled point of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CurvePoint<P = DVec3> {
    /// Seconds since the curve's reference epoch.
    pub t_s: f64,
    /// Metres, in the curve's axes.
    pub point_m: P,
    /// Time in which the satellite moves by one [`STEP_RAD`], seconds.
    pub step_s: f64,
}

/// Angle about the Earth's centre from one sample to the next, radians: half a degree. A chord of the lowest orbit is then 65 m from its arc.
pub(super) const STEP_RAD: f64 = 0.5 * std::f64::consts::PI / 180.0;

/// Shortest step, seconds: nothing outside the Earth moves by half a degree in less.
const SHORTEST_S: f64 = 0.01;

/// The span of time that a curve is drawn over, seconds since its reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TimeWindow {
    pub from_s: f64,
    pub now_s: f64,
    pub to_s: f64,
}

/// A sampled curve. Between calls its samples have no gaps.
#[derive(Clone, Debug)]
pub(super) struct Curve<P = DVec3> {
    samples: VecDeque<CurvePoint<P>>,
    /// Limit of the number of samples.
    max_points: usize,
    /// Factor of all steps: above 1 if the span is too long for `max_points`.
    coarseness: f64,
    /// Times before and after which the feed has returned an error.
    rejected: (f64, f64),
}

impl<P: Place> Curve<P> {
    /// An empty curve of at most `max_points` samples.
    pub fn new(max_points: usize) -> Self {
        Self {
            samples: VecDeque::with_capacity(max_points + 2),
            max_points,
            coarseness: 1.0,
            rejected: (f64::NEG_INFINITY, f64::INFINITY),
        }
    }

    /// Drops all samples: the next call starts again.
    pub fn clear(&mut self) {
        self.samples.clear();
        self.coarseness = 1.0;
        self.rejected = (f64::NEG_INFINITY, f64::INFINITY);
    }

    /// Drops samples later than `t_s`, and the times of errors: a live feed may have states by now.
    pub fn forget_after(&mut self, t_s: f64) {
        while self.samples.back().is_some_and(|last| last.t_s > t_s) {
            self.samples.pop_back();
        }
        self.rejected = (f64::NEG_INFINITY, f64::INFINITY);
    }

    /// Samples the missing parts of `window`, from now outwards, with at most `budget` calls of `at`, which are subtracted from it. `known` is the
    /// feed's validity, first and last. Samples outside the window are dropped, except one at each end.
    ///
    /// Returns whether the curve is complete. Allocates nothing.
    pub fn follow(
        &mut self,
        window: TimeWindow,
        known: (f64, f64),
        budget: &mut usize,
        mut at: impl FnMut(f64) -> Option<CurvePoint<P>>,
    ) -> bool {
        let TimeWindow {
            from_s,
            now_s,
            to_s,
        } = window;
        if self.is_far(window) {
            self.clear();
        }
        let mut taken = |budget: &mut usize, t_s: f64| {
            *budget -= 1;
            at(t_s)
        };
        loop {
            let first_s = from_s.max(known.0).max(self.rejected.0);
            let last_s = to_s.min(known.1).min(self.rejected.1);
            if *budget == 0 || first_s > last_s {
                break;
            }
            let (Some(front), Some(back)) =
                (self.samples.front().copied(), self.samples.back().copied())
            else {
                let t_s = now_s.clamp(first_s, last_s);
                match taken(budget, t_s) {
                    Some(sample) => self.samples.push_back(sample),
                    None => break,
                }
                continue;
            };
            if self.samples.len() >= self.max_points {
                // Longer steps from the start: otherwise no samples would be left for the missing end.
                let coarser = 1.5 * self.coarseness;
                self.clear();
                self.coarseness = coarser;
                continue;
            }
            let step = |sample: &CurvePoint<P>| (self.coarseness * sample.step_s).max(SHORTEST_S);
            // The end nearer to now is extended first.
            let (later, earlier) = (back.t_s < last_s, front.t_s > first_s);
            match (later, earlier) {
                (true, other) if !other || back.t_s - now_s <= now_s - front.t_s => {
                    // Steps may go beyond the span, but not beyond the feed's validity.
                    let t_s = (back.t_s + step(&back)).min(known.1);
                    match taken(budget, t_s) {
                        Some(sample) => self.samples.push_back(sample),
                        None => self.rejected.1 = back.t_s,
                    }
                }
                (_, true) => {
                    let t_s = (front.t_s - step(&front)).max(known.0);
                    match taken(budget, t_s) {
                        Some(sample) => self.samples.push_front(sample),
                        None => self.rejected.0 = front.t_s,
                    }
                }
                _ => break,
            }
        }
        self.drop_outside(from_s, to_s);
        let ends = self.samples.front().zip(self.samples.back());
        ends.is_none_or(|(front, back)| {
            front.t_s <= from_s.max(known.0).max(self.rejected.0)
                && back.t_s >= to_s.min(known.1).min(self.rejected.1)
        })
    }

    /// Whether the window is so far from the kept samples that extending them would cost more than starting again.
    fn is_far(&self, window: TimeWindow) -> bool {
        let (Some(front), Some(back)) = (self.samples.front(), self.samples.back()) else {
            return false;
        };
        let span_s = window.to_s - window.from_s;
        window.from_s > back.t_s + span_s || window.to_s < front.t_s - span_s
    }

    fn drop_outside(&mut self, from_s: f64, to_s: f64) {
        while self
            .samples
            .get(1)
            .is_some_and(|second| second.t_s < from_s)
        {
            self.samples.pop_front();
        }
        while self.samples.len() > 1 && self.samples[self.samples.len() - 2].t_s > to_s {
            self.samples.pop_back();
        }
    }

    /// Passes the positions in the window to `give`, in order of time. Its ends are interpolated between samples, and `now`, the exact position, is
    /// included. Passes nothing if nothing is known.
    pub fn walk(&self, window: TimeWindow, now: Option<P>, mut give: impl FnMut(f64, P)) {
        let TimeWindow {
            from_s,
            now_s,
            to_s,
        } = window;
        let mut now = now.filter(|_| from_s <= now_s && now_s <= to_s);
        let mut before: Option<&CurvePoint<P>> = None;
        for sample in &self.samples {
            if sample.t_s > from_s
                && let Some(before) = before.filter(|before| before.t_s < from_s)
            {
                let cut_s = from_s.min(sample.t_s);
                if cut_s <= to_s {
                    give(cut_s, between(before, sample, cut_s));
                }
            }
            if sample.t_s >= now_s
                && let Some(place) = now.take()
                && (before.is_some() || sample.t_s == now_s)
            {
                give(now_s, place);
            }
            if sample.t_s > to_s {
                if let Some(before) = before.filter(|before| before.t_s < to_s && to_s > from_s) {
                    give(to_s, between(before, sample, to_s));
                }
                return;
            }
            if sample.t_s >= from_s && sample.t_s != now_s {
                give(sample.t_s, sample.point_m);
            }
            before = Some(sample);
        }
        // A feed may have a state for now and none later.
        if let Some(place) = now.filter(|_| before.is_some_and(|last| last.t_s < now_s)) {
            give(now_s, place);
        }
    }

    /// Samples that are kept.
    #[cfg(test)]
    pub fn len(&self) -> usize {
        self.samples.len()
    }
}

fn between<P: Place>(a: &CurvePoint<P>, b: &CurvePoint<P>, t_s: f64) -> P {
    let at = ((t_s - a.t_s) / (b.t_s - a.t_s)).clamp(0.0, 1.0);
    a.point_m.toward(b.point_m, at)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A point that moves along x at a metre a second.
    fn along(t_s: f64) -> Option<CurvePoint> {
        Some(CurvePoint {
            t_s,
            point_m: DVec3::X * t_s,
            step_s: 10.0,
        })
    }

    fn window(from_s: f64, now_s: f64, to_s: f64) -> TimeWindow {
        TimeWindow {
            from_s,
            now_s,
            to_s,
        }
    }

    const ALWAYS: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

    fn walked(curve: &Curve, window: TimeWindow) -> Vec<f64> {
        let mut times = Vec::new();
        curve.walk(window, Some(DVec3::X * window.now_s), |t_s, point| {
            assert!((point.x - t_s).abs() < 1e-9, "{t_s}: {point:?}");
            times.push(t_s);
        });
        assert!(
            times.windows(2).all(|pair| pair[0] < pair[1]),
            "not in order: {times:?}"
        );
        times
    }

    #[test]
    fn the_window_is_filled_to_its_ends_and_follows_time_with_few_samples() {
        let mut curve = Curve::new(1000);
        let calls = std::cell::Cell::new(0);
        let mut budget = 10_000;
        let mut counted = |t_s| {
            calls.set(calls.get() + 1);
            along(t_s)
        };
        assert!(curve.follow(window(-95.0, 3.0, 205.0), ALWAYS, &mut budget, &mut counted));
        assert_eq!(10_000 - budget, 32);
        let times = walked(&curve, window(-95.0, 3.0, 205.0));
        assert_eq!(
            (times[0], times[times.len() - 1]),
            (-95.0, 205.0),
            "{times:?}"
        );
        assert!(times.contains(&3.0));
        // A hundred seconds later, in a hundred frames: ten new samples, and as many dropped.
        for k in 1..=100 {
            let on = f64::from(k);
            let moved = window(-95.0 + on, 3.0 + on, 205.0 + on);
            assert!(curve.follow(moved, ALWAYS, &mut budget, &mut counted));
            let times = walked(&curve, moved);
            assert_eq!(
                (times[0], times[times.len() - 1]),
                (moved.from_s, moved.to_s)
            );
        }
        assert_eq!(calls.get(), 42);
        assert!(curve.len() <= 33, "{}", curve.len());
        // Back in time, and far away.
        let back = window(-195.0, -97.0, 105.0);
        assert!(curve.follow(back, ALWAYS, &mut budget, &mut counted));
        assert_eq!(walked(&curve, back)[0], -195.0);
        let far = window(1e6, 1e6 + 98.0, 1e6 + 300.0);
        assert!(curve.follow(far, ALWAYS, &mut budget, &mut counted));
        assert!(curve.len() <= 33 && calls.get() < 130, "{calls:?}");
    }

    #[test]
    fn it_grows_from_now_within_its_budget() {
        let mut curve = Curve::new(1000);
        let whole = window(-1000.0, 0.0, 1000.0);
        let mut budget = 11;
        assert!(!curve.follow(whole, ALWAYS, &mut budget, along));
        assert_eq!((budget, curve.len()), (0, 11));
        let times = walked(&curve, whole);
        assert_eq!((times[0], times[times.len() - 1]), (-50.0, 50.0));
        let mut budget = 1000;
        assert!(curve.follow(whole, ALWAYS, &mut budget, along));
        assert_eq!(walked(&curve, whole)[0], -1000.0);
    }

    #[test]
    fn it_ends_where_the_feed_does() {
        let mut curve = Curve::new(1000);
        let whole = window(-1000.0, 0.0, 1000.0);
        // Known in advance, to the second.
        assert!(curve.follow(whole, (-33.0, 44.0), &mut 1000, along));
        let times = walked(&curve, whole);
        assert_eq!((times[0], times[times.len() - 1]), (-33.0, 44.0));
        // Discovered by errors: the last time with a state, requested once.
        let mut curve = Curve::new(1000);
        let mut rejected = 0;
        let mut at = |t_s: f64| {
            let is_known = (-45.0..=25.0).contains(&t_s);
            rejected += u32::from(!is_known);
            along(t_s).filter(|_| is_known)
        };
        assert!(curve.follow(whole, ALWAYS, &mut 1000, &mut at));
        assert!(curve.follow(whole, ALWAYS, &mut 1000, &mut at));
        let times = walked(&curve, whole);
        assert_eq!((times[0], times[times.len() - 1]), (-40.0, 20.0));
        assert_eq!(rejected, 2);
        // Nothing known, or not yet started: no points.
        let mut none = Curve::new(10);
        assert!(none.follow(whole, ALWAYS, &mut 10, |_| None));
        assert_eq!(walked(&none, whole), [0.0; 0]);
        let mut ended = Curve::new(1000);
        assert!(ended.follow(whole, (-700.0, -500.0), &mut 1000, along));
        let mut times = Vec::new();
        ended.walk(whole, None, |t_s, _| times.push(t_s));
        assert_eq!((times[0], times[times.len() - 1]), (-700.0, -500.0));
    }

    #[test]
    fn a_span_too_long_gets_longer_steps() {
        let mut curve = Curve::new(64);
        let mut budget = 100_000;
        let long = window(-50_000.0, 0.0, 50_000.0);
        assert!(curve.follow(long, ALWAYS, &mut budget, along));
        assert!(curve.len() <= 64, "{}", curve.len());
        let times = walked(&curve, long);
        assert_eq!((times[0], times[times.len() - 1]), (-50_000.0, 50_000.0));
        assert!(budget > 99_000, "{budget} left");
    }

    #[test]
    fn what_was_predicted_is_forgotten() {
        let mut curve = Curve::new(1000);
        let whole = window(-100.0, 0.0, 100.0);
        curve.follow(whole, ALWAYS, &mut 1000, along);
        curve.forget_after(-20.0);
        let mut times = Vec::new();
        curve.walk(whole, None, |t_s, _| times.push(t_s));
        assert_eq!((times[0], times[times.len() - 1]), (-100.0, -20.0));
    }
}
