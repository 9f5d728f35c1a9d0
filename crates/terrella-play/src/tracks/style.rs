//! Styles of tracks, from a scene's units to the drawable's.

use crate::scene::{Orbit, TrackSpan as SceneTrackSpan};
use terrella::tracks::{Footprint, TrackSpan, TrackStyle};

/// The style of a satellite's track.
pub(super) fn style(index: usize, orbit: &Orbit, width_px: f32) -> TrackStyle {
    let track = &orbit.track;
    let defaults = TrackStyle::new(index);
    let span = |span: Option<SceneTrackSpan>, defaults| {
        span.map(|span| match span {
            SceneTrackSpan::Usual => defaults,
            SceneTrackSpan::Minutes {
                before_min,
                after_min,
            } => TrackSpan::Seconds {
                before_s: 60.0 * before_min,
                after_s: 60.0 * after_min,
            },
        })
    };
    TrackStyle {
        color: track.color.unwrap_or(defaults.color),
        width_px,
        trail: span(track.trail, TrackSpan::TRAIL),
        ground_track: span(track.ground_track, TrackSpan::GROUND_TRACK),
        footprint: track.footprint.map(|footprint| Footprint {
            field: footprint.field,
            is_filled: footprint.fill,
            has_edges: footprint.lines,
            swath: span(footprint.swath, TrackSpan::GROUND_TRACK),
        }),
        subpoint: track.subpoint,
        marker: track.marker,
    }
}
