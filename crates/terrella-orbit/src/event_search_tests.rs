//! Events against the geometry of conics, and against a look at every step.

use super::*;
use crate::kepler::{Anomaly, Drift, KeplerElements, KeplerFeed, KeplerOptions, OrbitSize};
use crate::{Frame, Sgp4Feed};
use terrella_frames::{Illumination, illumination, utc_from_rfc3339};

fn still(_: Epoch) -> Orientation {
    Orientation::default()
}

fn begin() -> Epoch {
    utc_from_rfc3339("2018-03-20T16:15:00Z").expect("a date")
}

fn conic(axis_m: f64, eccentricity: f64, inclination_deg: f64, anomaly_deg: f64) -> KeplerFeed {
    let elements = KeplerElements {
        size: OrbitSize::SemiMajorAxis(axis_m),
        eccentricity,
        inclination_rad: inclination_deg.to_radians(),
        raan_rad: 0.0,
        argument_of_periapsis_rad: 0.0,
        anomaly: Anomaly::Mean(anomaly_deg.to_radians()),
    };
    let options = KeplerOptions {
        drift: Drift::None,
        first: begin() - Duration::from_days(1.0),
        last: begin() + Duration::from_days(60.0),
    };
    KeplerFeed::from_elements("test", Frame::Teme, begin(), &elements, options).expect("an orbit")
}

fn found(feed: &dyn Feed, sought: SoughtEvents, seconds: f64) -> Vec<(f64, MotionEventKind)> {
    let span = (begin(), begin() + Duration::from_seconds(seconds));
    let events = motion_events(feed, sought, &Ellipsoid::WGS84, &still, span).expect("known");
    let events = events.into_iter();
    events
        .map(|event| ((event.epoch - begin()).to_seconds(), event.kind))
        .collect()
}

fn period_s(axis_m: f64) -> f64 {
    std::f64::consts::TAU * (axis_m.powi(3) / crate::constants::EARTH_GM_M3_S2).sqrt()
}

/// Perigee on the equator: nodes and apsides are together, half a revolution apart.
#[test]
fn nodes_and_apsides_are_half_a_revolution_apart() {
    let period = period_s(7e6);
    let feed = conic(7e6, 0.05, 60.0, 90.0);
    let events = found(&feed, SoughtEvents::All, 1.9 * period);
    let of = |kind| -> Vec<f64> {
        let of = events.iter().filter(|(_, one)| *one == kind);
        of.map(|(t, _)| t / period).collect()
    };
    for (kind, expected) in [
        (MotionEventKind::Apoapsis, &[0.25, 1.25][..]),
        (MotionEventKind::Periapsis, &[0.75, 1.75]),
        (MotionEventKind::DescendingNode, &[0.25, 1.25]),
        (MotionEventKind::AscendingNode, &[0.75, 1.75]),
    ] {
        let times = of(kind);
        assert_eq!(times.len(), expected.len(), "{kind:?}: {times:?}");
        for (time, expected) in times.iter().zip(expected) {
            // The equator of date and that of TEME differ by hundredths of a degree at most.
            assert!((time - expected).abs() < 1e-4, "{kind:?}: {times:?}");
        }
    }
}

#[test]
fn a_circle_has_no_apsides_and_an_equatorial_orbit_no_nodes() {
    let events = found(&conic(7e6, 0.0, 0.0, 90.0), SoughtEvents::All, 20_000.0);
    let is_of_shadow = |kind: &MotionEventKind| {
        !matches!(
            kind,
            MotionEventKind::AscendingNode
                | MotionEventKind::DescendingNode
                | MotionEventKind::Periapsis
                | MotionEventKind::Apoapsis
        )
    };
    assert!(!events.is_empty());
    assert!(
        events.iter().all(|(_, kind)| is_of_shadow(kind)),
        "{events:?}"
    );
}

/// Every change of the class of [`illumination`] from second to second has its event within that second, and there are no others.
#[test]
fn the_shadow_is_that_of_the_illumination_at_every_second() {
    let iss = Sgp4Feed::built_in_iss().expect("built in");
    let low = utc_from_rfc3339("2018-01-20T20:00:00Z").expect("a date");
    // The eclipse of the day is in the middle of the night, two hours later.
    let geostationary = conic(42_164_170.0, 0.0, 0.0, 150.0);
    let feeds: [(&dyn Feed, Epoch); 2] = [(&iss, low), (&geostationary, begin())];
    for (feed, first) in feeds {
        let span = (first, first + Duration::from_seconds(15_000.0));
        let events = motion_events(feed, SoughtEvents::Shadow, &Ellipsoid::WGS84, &still, span);
        let events = events.expect("known");
        let light = |second: u32| {
            let epoch = first + Duration::from_seconds(f64::from(second));
            let state = feed.state_at(epoch).expect("known");
            let sun = sun_position_itrf_m(epoch, &Orientation::default());
            illumination(state.position_itrf_m(), sun, &Ellipsoid::WGS84).0
        };
        let mut before = light(0);
        let mut expected = Vec::new();
        for second in 1..=15_000 {
            let now = light(second);
            expected.extend(
                match (before, now) {
                    (Illumination::Sunlit, Illumination::Penumbra) => {
                        Some(MotionEventKind::PenumbraEntry)
                    }
                    (Illumination::Penumbra, Illumination::Umbra) => {
                        Some(MotionEventKind::UmbraEntry)
                    }
                    (Illumination::Umbra, Illumination::Penumbra) => {
                        Some(MotionEventKind::UmbraExit)
                    }
                    (Illumination::Penumbra, Illumination::Sunlit) => {
                        Some(MotionEventKind::PenumbraExit)
                    }
                    _ => None,
                }
                .map(|kind| (second, kind)),
            );
            before = now;
        }
        assert!(expected.len() >= 4, "{expected:?}");
        assert_eq!(events.len(), expected.len(), "{events:?}");
        for (event, (second, kind)) in events.iter().zip(expected) {
            let late = f64::from(second) - (event.epoch - first).to_seconds();
            assert_eq!(event.kind, kind);
            assert!((-0.002..1.002).contains(&late), "{event:?}: {late} s");
        }
    }
}

/// Near the end of its season an eclipse of a geostationary satellite is a short one in the penumbra: the shortest of a season of 25 days is found
/// as by a look at every ten seconds.
#[test]
fn grazing_eclipses_are_found() {
    let feed = conic(42_164_170.0, 0.0, 0.0, 0.0);
    let first = begin() + Duration::from_days(15.0);
    let span = (first, first + Duration::from_days(12.0));
    let events = motion_events(&feed, SoughtEvents::Shadow, &Ellipsoid::WGS84, &still, span);
    let events = events.expect("known");
    let mut entries = 0;
    let mut was_lit = true;
    for step in 0..=(12 * 8_640) {
        let epoch = first + Duration::from_seconds(10.0 * f64::from(step));
        let state = feed.state_at(epoch).expect("known");
        let sun = sun_position_itrf_m(epoch, &Orientation::default());
        let light = illumination(state.position_itrf_m(), sun, &Ellipsoid::WGS84).0;
        let is_lit = light == Illumination::Sunlit;
        entries += u32::from(was_lit && !is_lit);
        was_lit = is_lit;
    }
    let of = |kind| events.iter().filter(|event| event.kind == kind).count();
    assert!(entries > 2, "{entries}");
    assert_eq!(of(MotionEventKind::PenumbraEntry), entries as usize);
    assert!(of(MotionEventKind::UmbraEntry) < of(MotionEventKind::PenumbraEntry));
}
