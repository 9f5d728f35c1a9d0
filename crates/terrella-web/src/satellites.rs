//! Satellites of a text, and how they are drawn.

use std::path::Path;
use terrella::Epoch;
use terrella::orbit::pushed::PushedFeed;
use terrella::orbit::{
    Catalogue, Ephemerides, EphemerisFeed, Feed, FileFormat, OrbitError, Sgp4Feed,
};
use terrella::tracks::{Footprint, TrackSpan, TrackStyle};

/// Most satellites that have trail, ground track and footprint; of more each is a dot.
const WITH_TRACKS: usize = 10;
/// Most satellites drawn of one text.
pub const MOST: usize = 20_000;

/// A satellite of a text, or one whose states the page pushes.
pub enum Satellite {
    /// Mean elements.
    Elements(Sgp4Feed),
    /// States over time.
    States(EphemerisFeed),
    /// States that the page pushes.
    Pushed(PushedFeed),
}

impl Satellite {
    pub fn feed(&self) -> &dyn Feed {
        match self {
            Self::Elements(feed) => feed,
            Self::States(feed) => feed,
            Self::Pushed(feed) => feed,
        }
    }

    /// The epoch of its elements, or that of its first state.
    pub fn epoch(&self) -> Epoch {
        match self {
            Self::Elements(feed) => feed.epoch(),
            Self::States(feed) => feed.validity().0,
            Self::Pushed(feed) => feed.validity().0,
        }
    }
}

/// The satellites of a text: two-line elements, an OMM, OEM, CZML, SP3, an STK ephemeris or states in columns. With a name or catalogue number only
/// that one. Faulty satellites are left out.
///
/// # Errors
/// A text without a satellite, or without one of that name: names the place and the reason.
pub fn read(text: &str, name: Option<&str>) -> Result<Vec<Satellite>, OrbitError> {
    let origin = Path::new("satellites");
    match FileFormat::of_text(text) {
        Some(
            FileFormat::Oem
            | FileFormat::Czml
            | FileFormat::Csv
            | FileFormat::Sp3
            | FileFormat::Stk,
        ) => {
            let mut states = Ephemerides::from_text(text, origin, false)?;
            let feeds = match name {
                Some(_) => vec![states.one(origin, name)?],
                None => std::mem::take(&mut states.feeds),
            };
            Ok(feeds
                .into_iter()
                .take(MOST)
                .map(Satellite::States)
                .collect())
        }
        // The reader of elements also explains texts of no format.
        _ => {
            let catalogue = Catalogue::from_text(text, origin, false)?;
            let feeds = match name {
                Some(_) => vec![catalogue.into_one(origin, name)?],
                None => catalogue.feeds,
            };
            Ok(feeds
                .into_iter()
                .take(MOST)
                .map(Satellite::Elements)
                .collect())
        }
    }
}

/// What is drawn of satellites.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShownTracks {
    pub markers: bool,
    pub trails: bool,
    pub ground_tracks: bool,
    pub subpoints: bool,
    pub footprints: bool,
}

impl ShownTracks {
    /// What is drawn of so many by default.
    fn of(count: usize) -> Self {
        let has_tracks = count <= WITH_TRACKS;
        Self {
            markers: true,
            trails: has_tracks,
            ground_tracks: has_tracks,
            subpoints: has_tracks,
            footprints: count == 1,
        }
    }
}

/// How so many satellites are drawn; by default without what would hide the globe.
pub fn styles(count: usize, shown: Option<ShownTracks>) -> Vec<TrackStyle> {
    let shown = shown.unwrap_or_else(|| ShownTracks::of(count));
    let style = |index: usize| TrackStyle {
        marker: shown.markers,
        trail: shown.trails.then_some(TrackSpan::TRAIL),
        ground_track: shown.ground_tracks.then_some(TrackSpan::GROUND_TRACK),
        footprint: shown.footprints.then(Footprint::default),
        subpoint: shown.subpoints,
        ..TrackStyle::new(index)
    };
    (0..count).map(style).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const ISS: &str = include_str!("../../terrella-orbit/data/iss.tle");

    #[test]
    fn elements_are_read_and_faults_explained() {
        let feeds = read(ISS, None).expect("sound elements");
        assert_eq!(feeds.len(), 1);
        assert!(styles(1, None)[0].footprint.is_some());
        assert!(styles(WITH_TRACKS + 1, None)[0].trail.is_none());
        assert_eq!(read(ISS, Some("25544")).expect("the number").len(), 1);
        let error = read(ISS, Some("HUBBLE")).err().expect("not there");
        let error = error.to_string();
        assert!(error.contains("satellites"), "{error}");
        assert!(read("no elements", None).is_err());
    }

    #[test]
    fn ephemerides_are_read_too() {
        let czml = r#"[{"id": "document", "version": "1.0"}, {"id": "A", "name": "Alpha", "position": {"epoch": "2026-01-01T00:00:00Z",
            "referenceFrame": "INERTIAL", "cartesian": [0, 7000000, 0, 0, 60, 6990000, 450000, 0, 120, 6960000, 900000, 0]}}]"#;
        let satellites = read(czml, None).expect("sound states");
        assert_eq!(satellites[0].feed().name(), "Alpha");
        assert_eq!(
            satellites[0].epoch().to_unix_milliseconds(),
            1_767_225_600_000.0
        );
        assert!(read(czml, Some("Beta")).is_err());
    }
}
