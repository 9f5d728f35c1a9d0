//! Behaviour of the time line, without a window.

use super::entry::{date_of, place_of, read_place};
use super::*;
use crate::clock::AtEnd;
use crate::scene::Scene;
use std::path::Path;
use terrella::frames::utc_from_rfc3339;

fn instant(text: &str) -> Epoch {
    utc_from_rfc3339(text).expect("a date")
}

fn opened(scene: &str) -> (TimeLine, Clock, Flight) {
    let scene = Scene::from_toml(scene, Path::new("test.toml")).expect("a good scene");
    let clock = Clock::new(&scene.time, AtEnd::Loop);
    let flight = Flight::open(scene).expect("opens");
    (TimeLine::new(&flight), clock, flight)
}

const SCENE: &str =
    "[time]\nstart = \"2018-01-15T12:00:00Z\"\nduration_s = 5400\n[camera]\nmode = \"nadir\"\n";

fn coverage(flight: &Flight) -> Option<Coverage<'_>> {
    flight.feed().map(Coverage::of)
}

#[test]
fn places_are_read_as_people_write_them() {
    assert_eq!(read_place("48.2, 16.4"), Some((48.2, 16.4)));
    assert_eq!(read_place(" -33.5° -70.25°"), Some((-33.5, -70.25)));
    for bad in [
        "", "48", "48,", "91, 0", "0, 361", "1, 2, 3", "nan, 0", "0, inf", "N 48",
    ] {
        assert_eq!(read_place(bad), None, "{bad}");
    }
}

#[test]
fn places_are_read_with_letters_of_the_compass() {
    for text in [
        "78.23N 15.39E",
        "78.23 N, 15.39 E",
        "78.23° n, 15.39° e",
        "78.23N,15.39E",
    ] {
        assert_eq!(read_place(text), Some((78.23, 15.39)), "{text}");
    }
    assert_eq!(read_place("33.5 S 70.25 W"), Some((-33.5, -70.25)));
    for bad in [
        "95N 15E", "-33S 70W", "48N 16N", "15E 78N", "48N 16", "N S E W",
    ] {
        assert_eq!(read_place(bad), None, "{bad}");
    }
}

#[test]
fn cities_are_found_by_name_or_by_its_only_beginning() {
    let cities = [("London", 51.51), ("San Juan", 18.47), ("San José", 9.93)];
    let later = [("Londrina", -23.31), ("London", 42.98)];
    let cities: Vec<NamedPlace> = cities.into_iter().chain(later).map(city).collect();
    let lat = |text: &str| place_of(text, &cities).map(|(lat, _)| (100.0 * lat).round() / 100.0);
    assert_eq!(lat("LONDON"), Ok(51.51), "the most important of two");
    assert_eq!(lat(" londr"), Ok(-23.31));
    assert_eq!(lat("san jOSÉ"), Ok(9.93));
    assert_eq!(lat("12.5, 0"), Ok(12.5));
    let several = lat("san").expect_err("two");
    assert_eq!(
        several,
        "several cities begin with \"san\": San Juan, San José"
    );
    assert!(lat("95, 15").is_err_and(|message| message.starts_with("expected: latitude")));
    assert!(lat("Atlantis").is_err_and(|message| message.contains("no known city")));
    // The shipped ones are there.
    let (line, ..) = opened(SCENE);
    assert!(place_of("reykjav", &line.cities).is_ok_and(|(lat, _)| (lat - 64.1).abs() < 0.1));
}

fn city((name, lat_deg): (&str, f64)) -> NamedPlace {
    NamedPlace {
        place: Geodetic::from_degrees(lat_deg, 0.0, 0.0),
        name: name.to_owned(),
        is_capital: false,
        isolation_m: 0.0,
    }
}

#[test]
fn real_time_needs_a_satellite_that_is_known_now() {
    let (mut line, mut clock, flight) = opened(SCENE);
    let before = clock.span();
    let message = line.begin_real_time(
        &mut clock,
        instant("2026-03-01T08:00:00Z"),
        coverage(&flight),
    );
    assert!(
        message.contains("ISS (ZARYA) is known from 2017-12-21T"),
        "{message}"
    );
    assert!(message.contains("2026-03-01T08:00:00Z"), "{message}");
    assert!(!line.is_real_time() && clock.span() == before);

    // Thirty days after its elements' epoch the satellite is lost: the span ends there.
    let now = instant("2018-02-19T21:00:00Z");
    clock.reverse();
    clock.set_paused(true);
    line.begin_real_time(&mut clock, now, coverage(&flight));
    assert!(line.is_real_time() && clock.speed() == 1.0 && !clock.is_paused());
    assert!((clock.now() - now).to_seconds().abs() < 1e-6);
    let (first, last) = clock.span();
    assert!(((now - first).to_seconds() - 2700.0).abs() < 1e-6);
    assert_eq!(Some(last), flight.feed().map(|feed| feed.validity().1));
    // It is followed until then, and no further.
    let later = now + Duration::from_seconds(10.0);
    assert_eq!(line.follow(&mut clock, later, coverage(&flight)), None);
    assert!((clock.now() - later).to_seconds().abs() < 1e-6);
    let too_late = now + Duration::from_days(1.0);
    let message = line
        .follow(&mut clock, too_late, coverage(&flight))
        .expect("a message");
    assert!(message.contains("real time ends"), "{message}");
    assert!(!line.is_real_time() && clock.is_paused());
}

#[test]
fn real_time_moves_its_span_on() {
    let (mut line, mut clock, _) =
        opened("[camera]\nmode = \"geodetic\"\n[time]\nduration_s = 60\n");
    let now = instant("2026-03-01T08:00:00Z");
    line.begin_real_time(&mut clock, now, None);
    let (first, last) = clock.span();
    assert!(((last - first).to_seconds() - REAL_TIME_SPAN_S).abs() < 1e-6);
    line.follow(&mut clock, now + Duration::from_seconds(1000.0), None);
    assert_eq!(clock.span().0, first);
    line.follow(&mut clock, now + Duration::from_seconds(1400.0), None);
    let moved_s = (clock.span().0 - first).to_seconds();
    assert!((moved_s - 1400.0).abs() < 1e-6);
    assert!((clock.progress() - 0.5).abs() < 1e-9);
}

#[test]
fn a_pass_beyond_the_flight_takes_the_span_there() {
    let (mut line, mut clock, flight) = opened(SCENE);
    assert!(
        line.next_pass_query(&clock, coverage(&flight))
            .is_err_and(|message| message.contains("place"))
    );
    line.place = Some(Geodetic::from_degrees(48.2, 16.4, 0.0));
    assert!(
        line.next_pass_query(&clock, None)
            .is_err_and(|message| message.contains("satellite"))
    );
    assert!(line.next_pass_query(&clock, coverage(&flight)).is_ok());
    let begin = instant("2018-01-16T02:00:00Z");
    let pass = Pass {
        begin,
        rises: true,
        highest: begin + Duration::from_seconds(200.0),
        elevation_rad: 0.7,
        end: begin + Duration::from_seconds(400.0),
        sets: true,
    };
    let message = line.receive(
        &mut clock,
        PassResult::Next(Upcoming::Pass(pass)),
        coverage(&flight),
    );
    assert_eq!(
        message.as_deref(),
        Some(
            "ISS (ZARYA) over 48.200° N, 16.400° E: 2018-01-16T02:00:00Z to 02:06:40Z, 40° high at 02:03:20Z. Space plays it"
        )
    );
    assert_eq!(clock.now(), begin);
    // It stands, and plays the pass alone, in 20 s.
    assert!(clock.is_paused() && clock.speed().abs() == 20.0);
    let (from, to) = clock.range();
    assert!((from - clock.progress()).abs() < 1e-9);
    assert!(((to - from) * clock.duration_s() - 400.0).abs() < 1e-6);
    assert!(!clock.is_on_scene_span() && (clock.duration_s() - 5400.0).abs() < 1e-6);
    assert!((clock.progress() - PASS_LEAD_FRACTION).abs() < 1e-9);
    // One in the flight leaves the span as it is.
    clock.return_to_scene_span();
    let near = clock.now() + Duration::from_seconds(600.0);
    let pass = Pass {
        begin: near,
        highest: near,
        end: near + Duration::from_seconds(9.0),
        ..pass
    };
    line.receive(
        &mut clock,
        PassResult::Next(Upcoming::Pass(pass)),
        coverage(&flight),
    );
    assert!(clock.is_on_scene_span() && clock.now() == near);
    let message = line
        .receive(
            &mut clock,
            PassResult::Next(Upcoming::NoneFound),
            coverage(&flight),
        )
        .expect("a message");
    assert!(
        message.contains("does not rise 10° above 48.200° N"),
        "{message}"
    );
    assert_eq!(clock.now(), near);
}

#[test]
fn passes_are_asked_for_once() {
    let (mut line, mut clock, _flight) = opened(SCENE);
    assert_eq!(line.passes_query(&clock), None);
    line.place = Some(Geodetic::from_degrees(48.2, 16.4, 0.0));
    assert!(
        matches!(line.passes_query(&clock), Some(PassQuery::InSpan(_, span)) if span == clock.span())
    );
    assert_eq!(line.passes_query(&clock), None);
    line.min_elevation_deg = 20.0;
    assert!(line.passes_query(&clock).is_some());
    clock.set_span(clock.span().0, clock.now() + Duration::from_days(2.0));
    line.shown = false;
    assert_eq!(line.passes_query(&clock), None);
    line.shown = true;
    assert!(line.passes_query(&clock).is_some());
}

#[test]
fn the_place_is_that_of_a_camera_that_looks_at_one() {
    let (line, ..) = opened(SCENE);
    assert_eq!(line.place, None);
    let scene = "[orbit]\n[camera]\nlat_deg = 46.5\nlon_deg = 8\nheight_km = 700\n";
    let (line, ..) = opened(scene);
    let place = line.place.expect("a place");
    assert_eq!(place, Geodetic::from_degrees(46.5, 8.0, 0.0));
}

#[test]
fn a_date_that_is_typed_sets_the_clock_and_moves_the_span() {
    let (mut line, mut clock, flight) = opened(SCENE);
    let within = instant("2018-01-15T12:30:00Z");
    assert_eq!(line.go_to(&mut clock, within, coverage(&flight)), None);
    assert!(clock.is_on_scene_span());
    assert!((clock.now() - within).to_seconds().abs() < 1e-6);
    let other_day = instant("2018-01-20T06:00:00Z");
    assert_eq!(line.go_to(&mut clock, other_day, coverage(&flight)), None);
    assert!((clock.now() - other_day).to_seconds().abs() < 1e-6);
    assert!((clock.duration_s() - 5400.0).abs() < 1e-6);
    let message = line.go_to(
        &mut clock,
        instant("2030-01-01T00:00:00Z"),
        coverage(&flight),
    );
    let message = message.expect("a message");
    assert!(
        message.contains("and not at 2030-01-01T00:00:00Z"),
        "{message}"
    );
    assert!((clock.now() - other_day).to_seconds().abs() < 1e-6);
}

#[test]
fn dates_are_read_with_and_without_a_time() {
    let whole = instant("2018-01-20T06:05:00Z");
    for text in [
        "2018-01-20T06:05:00Z",
        "2018-01-20T06:05",
        " 2018-01-20 06:05 ",
        "2018-01-20 06:05:00",
    ] {
        assert_eq!(date_of(text), Ok(whole), "{text}");
    }
    assert_eq!(
        date_of("2018-01-20").ok(),
        Some(instant("2018-01-20T00:00:00Z"))
    );
    for bad in ["", "06:05", "2018-13-01", "2018-01-20 25:00", "tomorrow"] {
        assert_eq!(date_of(bad).ok(), None, "{bad}");
    }
}
