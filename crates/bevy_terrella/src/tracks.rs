//! Tracks of satellites over the Earth, ground stations, and lines on the globe.

use crate::EarthFrame;
use bevy::ecs::component::Component;
use bevy::ecs::reflect::ReflectComponent;
use bevy::math::DVec3;
use bevy::reflect::Reflect;
use std::fmt;
use std::sync::Arc;
use terrella::frames::{Epoch, Orientation};
use terrella::orbit::{Feed, Frame, OrbitError};
use terrella::tracks::{Polylines, Station, TrackSpan, TrackStyle};

/// The track of a satellite, drawn over the Earth for all of the Earth's cameras. Use one entity per satellite.
///
/// Lines and marks have their display colours on cameras without `Hdr`. On cameras with `Hdr` the same values are linear light. They are drawn before
/// Bevy's transparent pass, and your meshes hide them by depth.
#[derive(Component, Clone, Reflect)]
#[reflect(opaque)]
#[reflect(Component, Clone, Debug)]
pub struct EarthTrack {
    /// Source of the satellite's state: mean elements, an ephemeris, a propagator, or your own.
    pub feed: Arc<dyn Feed>,
    /// Parts of the track that are drawn.
    pub style: TrackStyle,
}

impl EarthTrack {
    /// The last revolution in space, the ground track, the subsatellite point and a marker, with the colour of list index `index`.
    pub fn new(feed: impl Feed + 'static, index: usize) -> Self {
        Self {
            feed: Arc::new(feed),
            style: TrackStyle {
                trail: Some(TrackSpan::TRAIL),
                ground_track: Some(TrackSpan::GROUND_TRACK),
                subpoint: true,
                marker: true,
                ..TrackStyle::new(index)
            },
        }
    }

    /// Position of the satellite in the world, in its unit.
    ///
    /// # Errors
    /// An instant without a state in the feed.
    pub fn place(&self, epoch: Epoch, frame: &EarthFrame) -> Result<DVec3, OrbitError> {
        let state = self.feed.state_at(epoch)?;
        let state = state.in_frame(Frame::Itrf, &Orientation::default());
        Ok(frame.world_from_itrf(state.position_m))
    }
}

impl fmt::Debug for EarthTrack {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("EarthTrack")
            .field("feed", &self.feed.name())
            .field("style", &self.style)
            .finish()
    }
}

/// A ground station: a marker, the area where it can see the first satellite, and a line to each visible satellite.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(opaque)]
#[reflect(Component, Clone, Debug, PartialEq)]
pub struct EarthStation(pub Station);

/// Lines fixed to the Earth, for example [`Polylines::graticule`] or coast lines of a [`VectorMap`](terrella::tracks::VectorMap).
#[derive(Component, Clone, Debug, Reflect)]
#[reflect(opaque)]
#[reflect(Component, Clone, Debug)]
pub struct EarthLines(pub Arc<Polylines>);

impl EarthLines {
    /// Creates the component from lines.
    pub fn new(lines: Polylines) -> Self {
        Self(Arc::new(lines))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use terrella::orbit::Catalogue;

    #[test]
    fn a_satellite_has_a_place_in_the_world_while_its_elements_hold() {
        let text = include_str!("../../terrella-orbit/data/iss.tle");
        let catalogue = Catalogue::from_text(text, Path::new("iss.tle"), true);
        let feed = catalogue.expect("elements").feeds.into_iter().next();
        let track = EarthTrack::new(feed.expect("one satellite"), 0);
        let epoch: Epoch = "2018-01-20T22:00:00Z".parse().expect("a date");
        let frame = EarthFrame::default().in_unit(1000.0);
        let place_km = track.place(epoch, &frame).expect("a state");
        assert!((place_km.length() - 6780.0).abs() < 20.0, "{place_km}");
        let later: Epoch = "2028-01-20T22:00:00Z".parse().expect("a date");
        assert!(track.place(later, &frame).is_err());
        assert!(format!("{track:?}").contains("ISS (ZARYA)"));
    }
}
