//! Satellites of a text of orbit elements, and how they are drawn.

use std::path::Path;
use terrella::orbit::{Catalogue, OrbitError, Sgp4Feed};
use terrella::tracks::{Footprint, TrackSpan, TrackStyle};

/// Most satellites that have trail, ground track and footprint; of more each is a dot.
const WITH_TRACKS: usize = 10;
/// Most satellites drawn of one text.
pub const MOST: usize = 20_000;

/// The satellites of two-line elements or an OMM; with a name or catalogue number only that one. Faulty sets are left out.
///
/// # Errors
/// A text without a satellite, or without one of that name: names the place and the reason.
pub fn read(text: &str, name: Option<&str>) -> Result<Vec<Sgp4Feed>, OrbitError> {
    let origin = Path::new("elements");
    let catalogue = Catalogue::from_text(text, origin, false)?;
    if name.is_some() {
        return Ok(vec![catalogue.into_one(origin, name)?]);
    }
    let mut feeds = catalogue.feeds;
    feeds.truncate(MOST);
    Ok(feeds)
}

/// How so many satellites are drawn.
pub fn styles(count: usize) -> Vec<TrackStyle> {
    let style = |index: usize| {
        let style = TrackStyle {
            marker: true,
            ..TrackStyle::new(index)
        };
        if count > WITH_TRACKS {
            return style;
        }
        TrackStyle {
            trail: Some(TrackSpan::TRAIL),
            ground_track: Some(TrackSpan::GROUND_TRACK),
            footprint: (count == 1).then_some(Footprint::default()),
            subpoint: true,
            ..style
        }
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
        assert!(styles(1)[0].footprint.is_some());
        assert!(styles(WITH_TRACKS + 1)[0].trail.is_none());
        assert_eq!(read(ISS, Some("25544")).expect("the number").len(), 1);
        let error = read(ISS, Some("HUBBLE"))
            .expect_err("not there")
            .to_string();
        assert!(error.contains("elements"), "{error}");
        assert!(read("no elements", None).is_err());
    }
}
