//! Elements whose satellite decays within their nominal validity: there is no state beyond that.
//!
//! The minutes are those of the first error, or the first radius below 6378.135 km, of the reference code in C++ (the Python package sgp4 2.27,
//! WGS72), searched every second from the epoch on.

use crate::{from_text, with_checksum};
use terrella_frames::{Duration, Epoch};
use terrella_orbit::{Feed, OrbitError, TleFeed};

const SETS: &str = include_str!("../data/orbit/SGP4-VER.TLE");

fn verification_set(number: &str) -> TleFeed {
    let mut lines = SETS.lines().filter(|line| line.get(2..7) == Some(number));
    let pair = [lines.next().unwrap(), lines.next().unwrap()];
    let pair = pair.map(|line| with_checksum(line.get(..69).unwrap_or(line)));
    from_text(&pair.join("\n"), None).unwrap()
}

fn made_up(b_star: &str, inclination: &str, eccentricity: &str, mean_motion: &str) -> TleFeed {
    let lines = [
        format!("1 91001U 26001A   26100.50000000  .00000000  00000-0 {b_star} 0  9990"),
        format!(
            "2 91001 {inclination} 100.0000 {eccentricity}  90.0000  10.0000 {mean_motion}  1000"
        ),
    ];
    from_text(&lines.map(|line| with_checksum(&line)).join("\n"), None).unwrap()
}

fn at(feed: &TleFeed, minutes: f64) -> Epoch {
    feed.epoch() + Duration::from_seconds(minutes * 60.0)
}

/// A low orbit with much drag.
fn low(b_star: &str) -> TleFeed {
    made_up(b_star, " 97.5000", "0012000", "15.95000000")
}

#[test]
fn validity_ends_where_the_reference_code_first_fails() {
    let cases = [
        // By drag, forwards and backwards.
        (low(" 50000-1"), Some(1039.3667), Some(-1615.5833)),
        (
            made_up("-50000-1", " 51.6000", "0012000", "15.95000000"),
            Some(1590.05),
            Some(-1018.0333),
        ),
        // By an invalid eccentricity.
        (
            made_up(" 10000-2", " 51.6000", "0010000", "16.30000000"),
            Some(5327.4167),
            None,
        ),
        (verification_set("22312"), Some(489.15), Some(-2035.8167)),
        (verification_set("28350"), Some(1472.1333), None),
        // By a perigee that the Sun and the Moon lower: below the ground for some seconds of a revolution.
        (verification_set("11801"), None, Some(-16093.6333)),
        (verification_set("16925"), None, Some(-13036.15)),
        (verification_set("23333"), Some(20078.85), Some(-7.9)),
        (verification_set("28872"), Some(51.5167), Some(-18.0167)),
        (verification_set("29141"), Some(422.6333), Some(-670.15)),
        // Never within 30 days, low perigees among them.
        (
            made_up(" 50000-3", "  7.0000", "7310000", " 2.28000000"),
            None,
            None,
        ),
        (
            made_up(" 10000-1", " 60.0000", "1000000", "13.30000000"),
            None,
            None,
        ),
        (
            made_up(" 00000-0", " 63.4000", "7440000", " 2.00600000"),
            None,
            None,
        ),
        (verification_set("04632"), None, None),
        (verification_set("14128"), None, None),
        (verification_set("88888"), None, None),
    ];
    for (feed, after, before) in cases {
        let (first, last) = feed.validity();
        let found = [first, last].map(|end| (end - feed.epoch()).to_seconds() / 60.0);
        let month = 30.0 * 1440.0;
        let expected = [before.unwrap_or(-month), after.unwrap_or(month)];
        println!("{}: {found:?}, the reference {expected:?}", feed.name());
        for (found, expected) in found.iter().zip(expected) {
            // The reference was sampled once a second, so its time is up to a second farther out.
            assert!(
                (found - expected).abs() < 1.1 / 60.0,
                "{}: {found}, {expected}",
                feed.name()
            );
        }
        for (end, beyond_s) in [(first, -0.01), (last, 0.01)] {
            assert!(feed.state_at(end).is_ok(), "{}", feed.name());
            let beyond = end + Duration::from_seconds(beyond_s);
            assert!(feed.state_at(beyond).is_err(), "{}", feed.name());
        }
        assert_eq!(feed.decay(), (before.map(|_| first), after.map(|_| last)));
    }
}

/// Each day is requested from a fresh feed.
#[test]
fn nothing_is_answered_after_a_decay() {
    for b_star in [" 50000-1", "-50000-1", " 20000-1", " 90000+0"] {
        for tenth_day in 13..=300 {
            for day in [0.1 * f64::from(tenth_day), -0.1 * f64::from(tenth_day)] {
                let feed = low(b_star);
                let ends = feed.clone().validity();
                let epoch = at(&feed, day * 1440.0);
                let is_inside = ends.0 <= epoch && epoch <= ends.1;
                assert_eq!(feed.state_at(epoch).is_ok(), is_inside, "{b_star} {day}");
            }
        }
    }
    let feed = low(" 50000-1");
    let error = feed.state_at(at(&feed, 29.0 * 1440.0)).unwrap_err();
    let text = error.to_string();
    println!("{text}");
    assert!(matches!(error, OrbitError::Lost { .. }), "{text}");
    assert!(
        text.starts_with("sets.tle:1: 91001 is not known at 2026-05-09T12:00:00.000Z: ")
            && text.contains("no valid orbit for it after 2026-04-11T05:19:21."),
        "{text}"
    );
}

/// A perigee so low that SGP4 takes drag as a square only: backwards the orbit grows without end and never fails.
#[test]
fn an_orbit_that_grows_without_bound_is_not_believed() {
    let feed = made_up(" 50000-2", " 51.6000", "0010000", "16.35000000");
    let (first, _) = feed.validity();
    let radius_km = |state: terrella_orbit::OrbitState| state.position_m.length() / 1e3;
    let days = (feed.epoch() - first).to_seconds() / 86_400.0;
    let at_end = radius_km(feed.state_at(first).unwrap());
    println!("{days} days back, {at_end} km");
    assert!(days < 30.0 && at_end < 20_000.0, "{days} {at_end}");
}
