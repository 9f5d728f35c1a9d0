//! Passes against a look at every second.

use super::*;
use crate::interpolated::{EphemerisSegment, InterpolatedStates, Interpolation, StateSample};
use crate::kepler::{Anomaly, Drift, KeplerElements, KeplerFeed, KeplerOptions, OrbitSize};
use crate::{EphemerisFeed, Sgp4Feed};
use std::path::Path;
use terrella_frames::utc_from_rfc3339;

const DAY_S: f64 = 86_400.0;

fn still(_: Epoch) -> Orientation {
    Orientation::default()
}

fn instant(text: &str) -> Epoch {
    utc_from_rfc3339(text).expect("a date")
}

fn observer(lat_deg: f64, lon_deg: f64, least_deg: f64) -> Observer<'static> {
    let place = Geodetic::from_degrees(lat_deg, lon_deg, 200.0);
    Observer::new(place, &Ellipsoid::WGS84, least_deg.to_radians(), &still)
}

fn released(file: &str) -> Sgp4Feed {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../config/orbits");
    Sgp4Feed::from_file(&folder.join(file), None).expect("released elements")
}

fn kepler(elements: KeplerElements) -> KeplerFeed {
    let epoch = instant("2018-01-15T00:00:00Z");
    let options = KeplerOptions {
        drift: Drift::None,
        first: epoch - Duration::from_days(1.0),
        last: epoch + Duration::from_days(60.0),
    };
    KeplerFeed::from_elements("test", Frame::Teme, epoch, &elements, options).expect("an orbit")
}

fn circle(axis_m: f64, inclination_deg: f64) -> KeplerElements {
    KeplerElements {
        size: OrbitSize::SemiMajorAxis(axis_m),
        eccentricity: 0.0,
        inclination_rad: inclination_deg.to_radians(),
        raan_rad: 1.0,
        argument_of_periapsis_rad: 0.0,
        anomaly: Anomaly::True(0.0),
    }
}

/// Places worth a look: a town, the poles, the date line from both sides, the equator.
const PLACES: [(f64, f64); 7] = [
    (48.2, 16.4),
    (90.0, 0.0),
    (-90.0, 77.0),
    (51.0, 179.999),
    (-17.0, -179.999),
    (0.0, -78.5),
    (67.9, 21.1),
];

/// First second, last second, greatest elevation and its second, of each time above; cut ones as they are.
fn brute_force(path: &[DVec3], observer: &Observer<'_>) -> Vec<(f64, f64, f64, f64)> {
    let above = |r: &DVec3| {
        let line = *r - observer.place_itrf_m;
        (
            line.dot(observer.up) - observer.sin_least * line.length(),
            line.dot(observer.up) / line.length(),
        )
    };
    let heights: Vec<_> = path.iter().map(above).collect();
    let mut found = Vec::new();
    let mut pass: Option<(f64, f64, f64)> = None;
    for (second, (height, sine)) in heights.iter().enumerate() {
        let t = second as f64;
        // Where linear interpolation between two seconds crosses 0.
        let crossing = |before: f64| t - height / (height - before);
        match (&mut pass, *height >= 0.0) {
            (None, true) => {
                let before = second.checked_sub(1).map(|i| heights[i].0);
                pass = Some((before.map_or(0.0, crossing), *sine, t));
            }
            (Some(present), true) if *sine > present.1 => (present.1, present.2) = (*sine, t),
            (Some((begin, sine, at)), false) => {
                found.push((*begin, crossing(heights[second - 1].0), sine.asin(), *at));
                pass = None;
            }
            _ => {}
        }
    }
    if let Some((begin, sine, at)) = pass {
        found.push((begin, (path.len() - 1) as f64, sine.asin(), at));
    }
    found
}

/// Compares passes of some days over all positions; returns their number.
fn compare(feed: &dyn Feed, from: Epoch, days: f64, least_deg: f64) -> usize {
    let seconds = (days * DAY_S) as i32;
    let path: Vec<_> = (0..=seconds)
        .map(|second| {
            let state = feed.state_at(from + Duration::from_seconds(f64::from(second)));
            state.expect("in its validity").position_itrf_m()
        })
        .collect();
    let until = from + Duration::from_seconds(f64::from(seconds));
    let mut count = 0;
    for (lat_deg, lon_deg) in PLACES {
        let observer = observer(lat_deg, lon_deg, least_deg);
        let found: Result<Vec<_>, _> = passes(feed, &observer, from, until).collect();
        // A second's look may miss a pass of a second.
        let length = |pass: &Pass| (pass.end - pass.begin).to_seconds();
        let found: Vec<_> = found
            .expect("no rejection")
            .into_iter()
            .filter(|p| length(p) > 2.0)
            .collect();
        let meant: Vec<_> = brute_force(&path, &observer)
            .into_iter()
            .filter(|p| p.1 - p.0 > 2.0)
            .collect();
        let place = format!("{} over {lat_deg}, {lon_deg}", feed.name());
        assert_eq!(found.len(), meant.len(), "{place}: {found:#?} {meant:#?}");
        for (pass, (begin, end, elevation, at)) in found.iter().zip(meant) {
            let after = |epoch: Epoch| (epoch - from).to_seconds();
            assert!(
                (after(pass.begin) - begin).abs() < 0.1,
                "{place}: {pass:?} {begin}"
            );
            assert!(
                (after(pass.end) - end).abs() < 0.1,
                "{place}: {pass:?} {end}"
            );
            assert!(
                (pass.elevation_rad - elevation).abs() < 0.02,
                "{place}: {pass:?} {elevation}"
            );
            assert!(
                pass.elevation_rad > elevation - 1e-9,
                "{place}: {pass:?} {elevation}"
            );
            // The maximum at whole seconds is within a second of the true one, unless the elevation hardly changes.
            let near_s = if pass.elevation_rad - elevation < 1e-9 {
                60.0
            } else {
                0.6
            };
            assert!(
                (after(pass.highest) - at).abs() < near_s,
                "{place}: {pass:?} {at}"
            );
            assert_eq!(pass.rises, begin > 0.0, "{place}: {pass:?}");
            assert_eq!(pass.sets, end < f64::from(seconds), "{place}: {pass:?}");
        }
        count += found.len();
    }
    count
}

#[test]
fn the_space_station_passes_as_every_second_says() {
    let from = instant("2018-01-19T00:00:00Z");
    assert!(compare(&released("iss.tle"), from, 2.0, 10.0) > 15);
    assert!(compare(&released("iss.tle"), from, 1.0, 0.0) > 15);
}

#[test]
fn a_molniya_passes_as_every_second_says() {
    let from = instant("2018-01-19T00:00:00Z");
    assert!(compare(&released("molniya.tle"), from, 2.0, 10.0) > 10);
}

#[test]
fn polar_and_retrograde_orbits_pass_as_every_second_says() {
    let from = instant("2018-01-15T12:00:00Z");
    assert!(compare(&kepler(circle(7_078_000.0, 90.0)), from, 1.0, 10.0) > 20);
    assert!(compare(&kepler(circle(6_978_000.0, 148.0)), from, 1.0, 5.0) > 10);
    // Near the bottom of the air, and a long way out.
    assert!(compare(&kepler(circle(6_528_000.0, 97.0)), from, 1.0, 1.0) > 10);
    assert!(compare(&kepler(circle(2.4e8, 23.0)), from, 1.5, 0.0) > 5);
}

#[test]
fn a_geostationary_satellite_is_always_there_or_never() {
    let feed = released("geostationary.tle");
    let from = instant("2018-01-18T00:00:00Z");
    let until = from + Duration::from_days(10.0);
    // GOES 16 is above 75° W.
    let quito = observer(0.0, -78.5, 10.0);
    let pass = next_pass(&feed, &quito, from, until)
        .expect("known")
        .expect("there");
    assert!(!pass.rises && !pass.sets, "{pass:?}");
    assert_eq!((pass.begin, pass.end), (from, until));
    assert!(pass.elevation_rad > 1.45 && pass.highest > from, "{pass:?}");
    assert_eq!(passes(&feed, &quito, from, until).count(), 1);
    assert_eq!(
        next_pass(&feed, &observer(0.0, 105.0, 10.0), from, until).expect("known"),
        None
    );
    assert_eq!(
        next_pass(&feed, &observer(90.0, 0.0, 10.0), from, until).expect("known"),
        None
    );
}

/// A feed that counts its calls.
struct Counting<F>(F, std::sync::atomic::AtomicUsize);

impl<F: Feed> Feed for Counting<F> {
    fn name(&self) -> &str {
        self.0.name()
    }
    fn validity(&self) -> (Epoch, Epoch) {
        self.0.validity()
    }
    fn state_at(&self, epoch: Epoch) -> Result<OrbitState, OrbitError> {
        self.1.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        self.0.state_at(epoch)
    }
}

#[test]
fn the_work_is_bounded() {
    let asked = |feed: Sgp4Feed, observer: &Observer<'_>| {
        let feed = Counting(feed, 0.into());
        let (from, until) = feed.validity();
        let count = passes(&feed, observer, from, until).count();
        (feed.1.into_inner(), count)
    };
    // Sixty days: 930 revolutions that never come into sight, and those that do.
    let (states, count) = asked(released("iss.tle"), &observer(90.0, 0.0, 10.0));
    assert_eq!(count, 0);
    assert!(states < 15_000, "{states}");
    let (states, count) = asked(released("iss.tle"), &observer(48.2, 16.4, 10.0));
    assert!(count > 200, "{count}");
    assert!(states < 80_000, "{states}");
    // A satellite at the very edge: every step is short, and none is shorter than that.
    let goes = released("geostationary.tle");
    let edge = |lon_deg: f64| {
        let observer = observer(0.0, lon_deg, 0.0);
        let state = goes.state_at(goes.epoch()).expect("known");
        observer.look_angles(&state).elevation_rad.to_degrees()
    };
    let lon = (0..60).fold((-20.0, 20.0), |(low, high), _| {
        let middle = 0.5 * (low + high);
        if edge(middle) > 10.0 {
            (middle, high)
        } else {
            (low, middle)
        }
    });
    let (states, _) = asked(goes.clone(), &observer(0.0, lon.0, 10.0));
    assert!(states < 200_000, "{states}");
}

#[test]
fn gaps_end_passes_and_are_passed_over() {
    let orbit = kepler(circle(7_178_000.0, 60.0));
    let from = orbit.validity().0 + Duration::from_days(1.0);
    let place = observer(48.2, 16.4, 5.0);
    let whole = next_pass(&orbit, &place, from, from + Duration::from_days(1.0));
    let whole = whole.expect("known").expect("a pass");
    assert!(whole.rises && whole.sets);
    let middle = whole.begin + (whole.end - whole.begin) * 0.4;
    let segment = |first: Epoch, last: Epoch| {
        let steps = ((last - first).to_seconds() / 10.0) as i32;
        let samples: Vec<_> = (0..=steps)
            .map(|k| {
                let epoch = first + Duration::from_seconds(10.0 * f64::from(k));
                let state = orbit.state_at(epoch).expect("known").in_itrf();
                StateSample {
                    epoch,
                    position_m: state.position_m,
                    velocity_m_s: Some(state.velocity_m_s),
                }
            })
            .collect();
        let sampled =
            InterpolatedStates::new(Frame::Itrf, &samples, Interpolation::WITH_VELOCITIES);
        EphemerisSegment::whole(sampled.expect("good samples"))
    };
    let minutes = Duration::from_seconds(60.0);
    let segments = vec![
        segment(whole.begin - minutes * 10, middle),
        segment(middle + minutes, whole.end + minutes * 10),
    ];
    let known = segments[0].usable;
    let again = segments[1].usable.0;
    let feed = EphemerisFeed::new("gap".to_owned(), None, segments).expect("in order");
    let found: Result<Vec<_>, _> =
        passes(&feed, &place, from, from + Duration::from_days(1.0)).collect();
    let found = found.expect("gaps are no errors");
    let [one, two] = found[..] else {
        panic!("{found:?}")
    };
    let apart_s = |a: Epoch, b: Epoch| (a - b).to_seconds().abs();
    assert!(
        one.rises && !one.sets && !two.rises && two.sets,
        "{found:?}"
    );
    assert!(apart_s(one.begin, whole.begin) < 0.01 && apart_s(two.end, whole.end) < 0.01);
    assert!(
        apart_s(one.end, known.1) < 0.01 && apart_s(two.begin, again) < 0.01,
        "{found:?}"
    );
}

#[test]
fn a_decayed_satellite_is_reported_and_a_pass_before_is_found() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../config/orbits/iss.tle");
    let text = std::fs::read_to_string(folder).expect("released");
    // Air drag a thousandfold: it comes down within days.
    let mut elements = Sgp4Feed::from_text(&text, Path::new("x"), None)
        .expect("good")
        .elements()
        .clone();
    elements.drag_term_per_er *= 1000.0;
    let feed = Sgp4Feed::from_elements(elements, Path::new("x").into(), 1).expect("starts");
    let place = observer(48.2, 16.4, 10.0);
    let (from, until) = (feed.epoch(), feed.validity().1);
    let mut found = passes(&feed, &place, from, until);
    assert!(found.next().is_some_and(|pass| pass.is_ok()));
    let rest: Vec<_> = found.collect();
    // It is known to its decay, and that is within the elements' own validity.
    let decay = feed.decay().1.expect("a decay");
    assert!(decay == until && until < feed.epoch() + Duration::from_days(30.0));
    let ends = rest.iter().map(|pass| pass.as_ref().map(|pass| pass.end));
    assert!(
        ends.into_iter()
            .all(|end| end.is_ok_and(|end| end <= until)),
        "{rest:?}"
    );
    assert!(rest.len() < 100);
}

#[test]
fn spans_outside_the_validity_have_no_pass() {
    let feed = released("iss.tle");
    let place = observer(48.2, 16.4, 10.0);
    let late = feed.validity().1 + Duration::from_days(1.0);
    let found = next_pass(&feed, &place, late, late + Duration::from_days(9.0));
    assert_eq!(found.expect("no rejection"), None);
    let backwards = next_pass(
        &feed,
        &place,
        feed.epoch(),
        feed.epoch() - Duration::from_days(9.0),
    );
    assert_eq!(backwards.expect("no rejection"), None);
    // At the end of the validity, no later state is requested.
    let last = feed.validity().1 - Duration::from_seconds(60.0);
    assert!(next_pass(&feed, &place, last, late).is_ok());
}

/// The passes of a search, each searched from the end of the one before.
fn one_by_one(feed: &dyn Feed, observer: &Observer<'_>, from: Epoch, until: Epoch) -> Vec<Pass> {
    let (mut found, mut from) = (Vec::new(), from);
    while let Some(pass) = next_pass(feed, observer, from, until).expect("known") {
        from = pass.end;
        found.push(pass);
        assert!(found.len() <= 100, "{pass:?}");
    }
    found
}

#[test]
fn a_search_from_the_end_of_a_pass_finds_the_next() {
    let feed = released("iss.tle");
    let from = instant("2018-01-19T00:00:00Z");
    let until = from + Duration::from_days(1.0);
    for (lat_deg, lon_deg) in [(48.2, 16.4), (51.0, 179.999), (0.0, -78.5)] {
        let place = observer(lat_deg, lon_deg, 10.0);
        let whole: Result<Vec<_>, _> = passes(&feed, &place, from, until).collect();
        let whole = whole.expect("known");
        assert!(!whole.is_empty());
        assert_eq!(one_by_one(&feed, &place, from, until), whole);
    }
    // A pass that the end of the search, or of the data, cuts is not repeated.
    let place = observer(48.2, 16.4, 10.0);
    let first = next_pass(&feed, &place, from, until)
        .expect("known")
        .expect("there");
    assert_eq!(
        one_by_one(&feed, &place, first.begin, first.highest).len(),
        1
    );
    let quito = observer(0.0, -78.5, 10.0);
    let goes = released("geostationary.tle");
    let last = goes.validity().1;
    let late = one_by_one(
        &goes,
        &quito,
        last - Duration::from_days(1.0),
        last + Duration::from_days(1.0),
    );
    assert_eq!(late.len(), 1, "{late:?}");
}

#[test]
fn bearings_point_where_they_should() {
    let place = observer(0.0, 0.0, 0.0);
    let at = |position_m: DVec3| {
        place.look_angles(&OrbitState {
            epoch: instant("2018-01-15T00:00:00Z"),
            frame: Frame::Itrf,
            position_m,
            velocity_m_s: DVec3::ZERO,
        })
    };
    let from_place = DVec3::X * (6_378_137.0 + 200.0);
    let east = at(from_place + DVec3::new(1e5, 1e5, 0.0));
    assert!((east.azimuth_rad.to_degrees() - 90.0).abs() < 1e-9);
    assert!((east.elevation_rad.to_degrees() - 45.0).abs() < 1e-9);
    assert!((east.distance_m - 2f64.sqrt() * 1e5).abs() < 1e-3);
    let north = at(from_place + DVec3::Z * 1e6);
    assert!(north.azimuth_rad.to_degrees() < 1e-9 && north.elevation_rad.abs() < 1e-9);
    let below = at(DVec3::X * -1e7);
    assert!((below.elevation_rad.to_degrees() + 90.0).abs() < 1e-9);
}
