//! When a satellite passes over a station, and when it is in the Earth's shadow.

use terrella::Epoch;
use terrella::frames::{Ellipsoid, Illumination, Orientation, illumination, sun_position_itrf_m};
use terrella::orbit::{
    Feed, Frame, MotionEventKind, Observer, OrbitError, Pass, SoughtEvents, VisibilityRule,
    motion_events, passes, visible_intervals,
};
use terrella::tracks::Station;

/// Longest span that is searched, days: a search occupies the page's thread.
pub const MOST_DAYS: f64 = 31.0;

fn orientation(_: Epoch) -> Orientation {
    Orientation::default()
}

/// A pass, and whether the satellite can be seen in it: it is in sunlight and the observer's sky is dark.
pub struct SeenPass {
    pub pass: Pass,
    pub is_visible: bool,
}

/// The passes of a satellite over a station, in order.
///
/// # Errors
/// Errors of the feed within its validity.
pub fn station_passes(
    feed: &dyn Feed,
    station: &Station,
    (from, to): (Epoch, Epoch),
) -> Result<Vec<SeenPass>, OrbitError> {
    let mask = station.min_elevation_rad;
    let observer = Observer::new(station.place, &Ellipsoid::WGS84, mask, &orientation);
    let rule = VisibilityRule::default();
    let found = passes(feed, &observer, from, to).map(|pass| {
        let pass = pass?;
        let seen = visible_intervals(feed, &observer, &pass, &rule)?;
        Ok(SeenPass {
            pass,
            is_visible: !seen.is_empty(),
        })
    });
    found.collect()
}

/// The times at which a satellite is in the Earth's umbra, in order.
///
/// # Errors
/// Errors of the feed within its validity.
pub fn shadows(
    feed: &dyn Feed,
    (from, to): (Epoch, Epoch),
) -> Result<Vec<(Epoch, Epoch)>, OrbitError> {
    let known = feed.validity();
    let (from, to) = (from.max(known.0), to.min(known.1));
    if from >= to {
        return Ok(Vec::new());
    }
    let ellipsoid = &Ellipsoid::WGS84;
    let events = motion_events(
        feed,
        SoughtEvents::Shadow,
        ellipsoid,
        &orientation,
        (from, to),
    )?;
    let mut begun = is_in_umbra(feed, from).then_some(from);
    let mut found = Vec::new();
    for event in events {
        match event.kind {
            MotionEventKind::UmbraEntry => begun = Some(event.epoch),
            MotionEventKind::UmbraExit => {
                found.extend(begun.take().map(|begin| (begin, event.epoch)));
            }
            _ => {}
        }
    }
    found.extend(begun.map(|begin| (begin, to)));
    Ok(found)
}

fn is_in_umbra(feed: &dyn Feed, epoch: Epoch) -> bool {
    let orientation = orientation(epoch);
    feed.state_at(epoch).is_ok_and(|state| {
        let place = state.in_frame(Frame::Itrf, &orientation).position_m;
        let sun_m = sun_position_itrf_m(epoch, &orientation);
        illumination(place, sun_m, &Ellipsoid::WGS84).0 == Illumination::Umbra
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::satellites;
    use terrella::frames::{Duration, Geodetic};

    const ISS: &str = include_str!("../../terrella-orbit/data/iss.tle");

    #[test]
    fn a_day_of_the_station_has_its_passes_and_shadows() {
        let satellites = satellites::read(ISS, None).expect("sound elements");
        let feed = satellites[0].feed();
        let from = satellites[0].epoch();
        let day = (from, from + Duration::from_days(1.0));
        let station = Station {
            place: Geodetic::from_degrees(52.5, 13.4, 0.0),
            min_elevation_rad: 10.0_f64.to_radians(),
            color: [255; 3],
            width_px: 2.0,
        };
        let found = station_passes(feed, &station, day).expect("known");
        // At this latitude the station is over the horizon in five or six successive revolutions.
        assert!((3..=7).contains(&found.len()), "{}", found.len());
        for SeenPass { pass, .. } in &found {
            let seconds = (pass.end - pass.begin).to_seconds();
            assert!(pass.begin < pass.highest && pass.highest < pass.end && seconds < 500.0);
            assert!(pass.elevation_rad >= station.min_elevation_rad);
        }
        let dark = shadows(feed, day).expect("known");
        assert!((15..=16).contains(&dark.len()), "{}", dark.len());
        let minutes = |(begin, end): &(Epoch, Epoch)| (*end - *begin).to_seconds() / 60.0;
        assert!(
            dark[1..dark.len() - 1]
                .iter()
                .all(|one| (30.0..37.0).contains(&minutes(one)))
        );

        // A span that begins and ends in the shadow is dark throughout.
        let (begin, end) = dark[2];
        let inside = (
            begin + Duration::from_seconds(60.0),
            end - Duration::from_seconds(60.0),
        );
        assert_eq!(shadows(feed, inside).expect("known"), [inside]);
        let lit = (
            dark[2].1 + Duration::from_seconds(60.0),
            dark[3].0 - Duration::from_seconds(60.0),
        );
        assert_eq!(shadows(feed, lit).expect("known"), []);
    }
}
