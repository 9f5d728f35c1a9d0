//! The part of the span that the time line shows.

use terrella::frames::Epoch;

/// Shortest part, seconds.
const SHORTEST_S: f64 = 10.0;

/// A part of a span, which is shown as long as the span is the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zoom {
    span: (Epoch, Epoch),
    part: (f64, f64),
}

impl Zoom {
    /// All of a span.
    fn whole(span: (Epoch, Epoch)) -> Self {
        let part = (0.0, 1.0);
        Self { span, part }
    }

    /// The part of this span, 0…1: all of another than the zoom's.
    pub fn part(zoom: Option<Self>, span: (Epoch, Epoch)) -> (f64, f64) {
        zoom.filter(|zoom| zoom.span == span)
            .unwrap_or(Self::whole(span))
            .part
    }

    /// Zooms by `factor` about `at`, a fraction of the span, whose position on the line is kept; then shifts by the fraction `by` of the visible
    /// part.
    #[must_use]
    pub fn changed(
        zoom: Option<Self>,
        span: (Epoch, Epoch),
        at: f64,
        factor: f64,
        by: f64,
    ) -> Option<Self> {
        let (from, to) = Self::part(zoom, span);
        let whole_s = (span.1 - span.0).to_seconds();
        if !(at.is_finite() && by.is_finite() && factor.is_finite() && factor > 0.0) {
            return zoom;
        }
        let length = ((to - from) / factor).clamp((SHORTEST_S / whole_s).min(1.0), 1.0);
        let before = ((at - from) / (to - from)).clamp(0.0, 1.0);
        let from = (at.clamp(from, to) - before * length + by * length).clamp(0.0, 1.0 - length);
        let part = (from, from + length);
        (length < 1.0).then_some(Self { span, part })
    }

    /// Scrolled as far as needed to show `at`, a fraction of the span.
    #[must_use]
    pub fn showing(zoom: Option<Self>, span: (Epoch, Epoch), at: f64) -> Option<Self> {
        let (from, to) = Self::part(zoom, span);
        let by = match at {
            early if early < from => early - from,
            late if late > to => (late - from).min(1.0 - to),
            _ => return zoom,
        };
        Self::changed(zoom, span, from, 1.0, by / (to - from))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrella::frames::{Duration, utc_from_rfc3339};

    fn span(hours: f64) -> (Epoch, Epoch) {
        let first = utc_from_rfc3339("2018-01-15T12:00:00Z").expect("a date");
        (first, first + Duration::from_hours(hours))
    }

    #[test]
    fn what_is_under_the_pointer_stays_there() {
        let day = span(24.0);
        let mut zoom = None;
        for _ in 0..5 {
            zoom = Zoom::changed(zoom, day, 0.3, 1.5, 0.0);
            let (from, to) = Zoom::part(zoom, day);
            assert!(((0.3 - from) / (to - from) - 0.3).abs() < 1e-9);
        }
        let (from, to) = Zoom::part(zoom, day);
        assert!((to - from - 1.5_f64.powi(-5)).abs() < 1e-9);
        // No shorter than ten seconds, and back to all of it.
        zoom = Zoom::changed(zoom, day, 0.3, 1e9, 0.0);
        let (from, to) = Zoom::part(zoom, day);
        assert!(((to - from) * 86_400.0 - 10.0).abs() < 1e-6);
        assert_eq!(Zoom::changed(zoom, day, 0.9, 1e-9, 0.0), None);
        // Another span is shown whole.
        assert_eq!(Zoom::part(zoom, span(1.0)), (0.0, 1.0));
        assert_eq!(Zoom::changed(zoom, day, f64::NAN, 1.0, 0.0), zoom);
    }

    #[test]
    fn it_moves_within_the_span_and_after_the_clock() {
        let day = span(24.0);
        let zoom = Zoom::changed(None, day, 0.5, 4.0, 0.0);
        assert_eq!(Zoom::part(zoom, day), (0.375, 0.625));
        let moved = Zoom::changed(zoom, day, 0.5, 1.0, -0.5);
        assert_eq!(Zoom::part(moved, day), (0.25, 0.5));
        let end = Zoom::changed(zoom, day, 0.5, 1.0, 9.0);
        assert_eq!(Zoom::part(end, day), (0.75, 1.0));
        assert_eq!(Zoom::showing(zoom, day, 0.5), zoom);
        // On it pages, so that what comes is seen; back it goes no further than it must.
        let on = Zoom::part(Zoom::showing(zoom, day, 0.63), day);
        assert!((on.0 - 0.63).abs() < 1e-9, "{on:?}");
        let back = Zoom::part(Zoom::showing(zoom, day, 0.2), day);
        assert!((back.0 - 0.2).abs() < 1e-9, "{back:?}");
        assert_eq!(Zoom::showing(None, day, 0.2), None);
    }
}
