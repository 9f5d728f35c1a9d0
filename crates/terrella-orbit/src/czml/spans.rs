//! Times in which samples hold: intervals in any order, later ones over earlier ones, cut by the availability.

use super::super::interpolated::{EphemerisSegment, InterpolatedStates};
use std::collections::BTreeMap;
use std::sync::Arc;
use terrella_frames::Epoch;

/// Most intervals of an object's availability or position.
pub const MAX_INTERVALS: usize = 10_000;

/// First and last instant.
pub type Span = (Epoch, Epoch);

/// Samples and the interval in which they apply.
#[derive(Clone)]
pub struct Known {
    pub samples: Arc<InterpolatedStates>,
    pub span: Span,
}

/// Intervals in order of time, those that touch or overlap joined.
pub fn joined(mut intervals: Vec<Span>) -> Vec<Span> {
    intervals.sort();
    let mut joined: Vec<Span> = Vec::with_capacity(intervals.len());
    for (from, to) in intervals {
        match joined.last_mut() {
            Some(last) if from <= last.1 => last.1 = last.1.max(to),
            _ => joined.push((from, to)),
        }
    }
    joined
}

/// The parts of `span` inside intervals that [`joined`] has sorted.
pub fn within(span: Span, intervals: &[Span]) -> impl Iterator<Item = Span> {
    let first = intervals.partition_point(|(_, to)| *to < span.0);
    let rest = intervals.get(first..).unwrap_or_default();
    let near = rest.iter().take_while(move |(from, _)| *from <= span.1);
    near.map(move |(from, to)| (span.0.max(*from), span.1.min(*to)))
}

/// Times that later intervals have taken from earlier ones.
#[derive(Default)]
pub struct Taken(BTreeMap<Epoch, Epoch>);

impl Taken {
    /// The parts of `span` that were not taken yet; all of it is taken afterwards. Ends are shared with parts taken before.
    pub fn take(&mut self, span: Span) -> Vec<Span> {
        let (mut from, mut all) = (span.0, span);
        // Overlapping intervals: one that begins before, and those that begin inside.
        let before = self.0.range(..span.0).next_back();
        let before = before.map(|(a, b)| (*a, *b)).filter(|(_, b)| *b >= span.0);
        let inside: Vec<Span> = before
            .into_iter()
            .chain(self.0.range(span.0..=span.1).map(|(a, b)| (*a, *b)))
            .collect();
        let mut left = Vec::new();
        for (begin, end) in inside {
            if from < begin {
                left.push((from, begin));
            }
            from = from.max(end);
            all = (all.0.min(begin), all.1.max(end));
            self.0.remove(&begin);
        }
        let is_untouched = from == span.0 && left.is_empty() && all == span;
        if from < span.1 || is_untouched {
            left.push((from, span.1));
        }
        self.0.insert(all.0, all.1);
        left
    }
}

/// Sorts by time, and removes times that a neighbour covers too.
pub fn in_order(mut known: Vec<Known>) -> Vec<Known> {
    known.sort_by_key(|known| known.span);
    let spans: Vec<Span> = known.iter().map(|known| known.span).collect();
    let answers = |at: Option<usize>, instant: Epoch| {
        let span = at.and_then(|at| spans.get(at));
        span.is_some_and(|(from, to)| from < to && *from <= instant && instant <= *to)
    };
    let mut at = 0_usize;
    known.retain(|known| {
        let (from, to) = known.span;
        let is_needless =
            from == to && (answers(at.checked_sub(1), from) || answers(Some(at + 1), from));
        at += 1;
        !is_needless
    });
    known
}

/// The segments of an ephemeris.
pub fn segments(known: Vec<Known>) -> Vec<EphemerisSegment> {
    let segment = |known: Known| EphemerisSegment {
        samples: known.samples,
        usable: known.span,
        sigma_m: Vec::new(),
    };
    known.into_iter().map(segment).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(s: i32) -> Epoch {
        Epoch::from_tai_seconds(3e9 + f64::from(s))
    }

    fn spans(spans: &[(i32, i32)]) -> Vec<Span> {
        spans.iter().map(|&(a, b)| (at(a), at(b))).collect()
    }

    #[test]
    fn intervals_are_joined_and_cut() {
        let all = joined(spans(&[(10, 20), (0, 5), (5, 7), (12, 13), (30, 30)]));
        assert_eq!(all, spans(&[(0, 7), (10, 20), (30, 30)]));
        for (span, left) in [
            ((0, 40), &[(0, 7), (10, 20), (30, 30)][..]),
            ((6, 11), &[(6, 7), (10, 11)]),
            ((8, 9), &[]),
            ((20, 25), &[(20, 20)]),
        ] {
            let within: Vec<_> = within((at(span.0), at(span.1)), &all).collect();
            assert_eq!(within, spans(left), "{span:?}");
        }
    }

    #[test]
    fn later_intervals_take_their_time_from_earlier_ones() {
        let mut taken = Taken::default();
        for (span, left) in [
            ((10, 20), &[(10, 20)][..]),
            ((20, 30), &[(20, 30)]),
            ((0, 10), &[(0, 10)]),
            ((5, 35), &[(30, 35)]),
            ((-5, 50), &[(-5, 0), (35, 50)]),
            ((60, 60), &[(60, 60)]),
            ((0, 1), &[]),
            ((55, 65), &[(55, 60), (60, 65)]),
        ] {
            let span = (at(span.0), at(span.1));
            assert_eq!(taken.take(span), spans(left), "{span:?}");
        }
    }
}
