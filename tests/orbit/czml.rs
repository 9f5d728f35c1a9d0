//! CZML: the example of cesiumjs, and small documents.

use crate::utc;
use glam::DVec3;
use std::path::Path;
use terrella_frames::Duration;
use terrella_orbit::interpolated::{InterpolatedStates, Interpolation, StateSample};
use terrella_orbit::{Ephemerides, EphemerisFeed, Feed, Frame, OrbitError};

const SIMPLE: &str = include_str!("../data/orbit/simple.czml");

fn read(text: &str) -> Result<Ephemerides, OrbitError> {
    Ephemerides::from_text(text, Path::new("sat.czml"), true)
}

fn simple() -> Vec<EphemerisFeed> {
    read(SIMPLE).unwrap().feeds
}

/// The numbers of a packet's `cartesian`, read by another parser.
fn numbers(name: &str) -> Vec<f64> {
    let document: serde_json::Value = serde_json::from_str(SIMPLE).unwrap();
    let packets = document.as_array().unwrap().iter();
    let mut named = packets.filter(|p| p["name"] == name && p["position"]["epoch"].is_string());
    let cartesian = named.next().unwrap()["position"]["cartesian"]
        .as_array()
        .unwrap();
    cartesian.iter().map(|n| n.as_f64().unwrap()).collect()
}

/// Neville's scheme: another way to the polynomial through the points.
fn neville(points: &[(f64, DVec3)], t: f64) -> DVec3 {
    let mut p: Vec<_> = points.iter().map(|&(_, r)| r).collect();
    for width in 1..points.len() {
        for i in 0..points.len() - width {
            let (a, b) = (points[i].0, points[i + width].0);
            p[i] = ((t - a) * p[i + 1] - (t - b) * p[i]) / (b - a);
        }
    }
    p[0]
}

#[test]
fn the_example_has_three_satellites() {
    let feeds = simple();
    let names: Vec<_> = feeds.iter().map(Feed::name).collect();
    assert_eq!(names, ["Geoeye1", "ISS", "Molniya_1-92"]);
    // The file repeats an instant where it goes from one element set to the next: the motion jumps there.
    let segments: Vec<_> = feeds.iter().map(|f| f.segments().len()).collect();
    assert_eq!(segments, [4, 7, 3]);
    for feed in &feeds {
        for segment in feed.segments() {
            assert_eq!(segment.samples.frame(), Frame::Gcrf);
            let interpolation = segment.samples.interpolation();
            assert_eq!(interpolation, Interpolation::Lagrange { degree: 5 });
        }
        assert_eq!(
            feed.validity(),
            (utc("2012-03-15T10:00:00Z"), utc("2012-03-16T10:00:00Z"))
        );
    }
}

#[test]
fn samples_are_met_and_between_them_the_polynomial() {
    for feed in simple() {
        let numbers = numbers(feed.name());
        let points: Vec<_> = numbers
            .chunks(4)
            .map(|c| (c[0], DVec3::new(c[1], c[2], c[3])))
            .collect();
        let start = utc("2012-03-15T10:00:00Z");
        for (k, &(t, position)) in points.iter().enumerate() {
            if points.get(k + 1).is_some_and(|next| next.0 == t) {
                continue; // The motion jumps: the later one answers.
            }
            let ns = (t * 1e9).round() as i128;
            let at = start + Duration::from_total_nanoseconds(ns);
            let state = feed.state_at(at).unwrap();
            assert_eq!(state.position_m, position, "{} {t}", feed.name());
        }
        // Between: the polynomial of degree 5 through the six samples around, on one side of a jump.
        let mut worst = 0.0_f64;
        for run in points.chunk_by(|a, b| a.0 != b.0) {
            for (k, pair) in run.windows(2).enumerate() {
                let count = run.len().min(6);
                let first = (k + 1).saturating_sub(3).min(run.len() - count);
                for share in [0.1, 0.5, 0.83] {
                    let t = pair[0].0 + share * (pair[1].0 - pair[0].0);
                    let state = feed.state_at(start + Duration::from_seconds(t)).unwrap();
                    let expected = neville(&run[first..first + count], t);
                    worst = worst.max(state.position_m.distance(expected));
                }
            }
        }
        println!(
            "{}: {} samples, {worst:.1e} m from Neville's scheme",
            feed.name(),
            points.len()
        );
        assert!(worst < 1e-5, "{}: {worst}", feed.name());
    }
}

/// How far the file's own degree is from the orbit that its samples come from: the polynomial of degree 15 through them,
/// for which 300 s are short. Windows that are one-sided, at the ends of the day and at jumps, are left out.
#[test]
fn between_samples_the_files_degree_is_good_to_metres() {
    // Metres: degree 5 at worst, degree 11 at worst. The Molniya goes through perigee in a few steps.
    let bounds = [(60.0, 0.05), (75.0, 0.05), (1.5e3, 100.0)];
    for (feed, (most_m, finer_m)) in simple().iter().zip(bounds) {
        let mut offs = Vec::new();
        for segment in feed.segments() {
            let all: Vec<StateSample> = segment.samples.samples().collect();
            let with = |degree| {
                InterpolatedStates::new(Frame::Gcrf, &all, Interpolation::Lagrange { degree })
                    .unwrap()
            };
            let (truth, finer) = (with(15), with(11));
            let inner = all.get(8..all.len().saturating_sub(8)).unwrap_or_default();
            for sample in inner {
                let t = sample.epoch + Duration::from_seconds(150.0);
                let at = |s: &InterpolatedStates| s.state_at(t).unwrap().position_m;
                let truth = at(&truth);
                offs.push((
                    at(&segment.samples).distance(truth),
                    at(&finer).distance(truth),
                ));
            }
        }
        offs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (median, worst) = (offs[offs.len() / 2].0, offs[offs.len() - 1].0);
        let finer = offs.iter().fold(0.0_f64, |w, o| w.max(o.1));
        println!(
            "{}: {} midpoints; degree 5 median {median:.2} m, worst {worst:.1} m; degree 11 worst {finer:.1e} m",
            feed.name(),
            offs.len()
        );
        assert!(worst < most_m && finer < finer_m, "{}", feed.name());
    }
}

/// The station was 380 to 400 km high in 2012, and flew at 51.6°.
#[test]
fn the_station_is_where_stations_are() {
    let feeds = simple();
    let iss = feeds.iter().find(|f| f.name() == "ISS").unwrap();
    for k in 0..1440 {
        let state = iss
            .state_at(utc("2012-03-15T10:00:00Z") + Duration::from_seconds(f64::from(k) * 60.0))
            .unwrap();
        let height_km = state.position_m.length() / 1e3 - 6371.0;
        assert!((365.0..425.0).contains(&height_km), "{height_km}");
        let normal = state.position_m.cross(state.velocity_m_s);
        let inclination = (normal.z / normal.length()).acos().to_degrees();
        assert!((inclination - 51.64).abs() < 0.3, "{inclination}");
        assert!((7630.0..7710.0).contains(&state.velocity_m_s.length()));
    }
}

fn document(position: &str) -> String {
    format!(
        "[{{\"id\":\"document\",\"version\":\"1.0\"}},\n{{\"id\":\"a\",\"name\":\"Sat\",\n\"position\":{position}}}]"
    )
}

#[test]
fn all_forms_of_a_position_are_read() {
    let t = |s: f64| utc("2018-01-01T00:00:00Z") + Duration::from_seconds(s);
    let one = |text: &str| {
        read(text)
            .unwrap_or_else(|e| panic!("{e}\n{text}"))
            .feeds
            .remove(0)
    };
    // Dates instead of seconds, the default frame and interpolation.
    let feed = one(&document(
        r#"{"cartesian":["2018-01-01T00:00:00Z",7e6,0,0,"2018-01-01T00:01:00.0Z",7.0e6,6e4,0]}"#,
    ));
    let state = feed.state_at(t(30.0)).unwrap();
    assert_eq!(
        (state.frame, state.position_m),
        (Frame::Itrf, DVec3::new(7e6, 3e4, 0.0))
    );
    let off = state.velocity_m_s - DVec3::new(0.0, 1000.0, 0.0);
    assert!(off.length() < 1e-9);
    assert_eq!((feed.name(), feed.line()), ("Sat", 2));
    // Velocities: Hermite's cubic.
    let feed = one(&document(
        r#"{"epoch":"2018-01-01T00:00:00Z","referenceFrame":"INERTIAL","interpolationAlgorithm":"HERMITE","interpolationDegree":3,
            "cartesianVelocity":[0,7e6,0,0,0,0,0, 10,7000100,0,0,0,0,0]}"#,
    ));
    let state = feed.state_at(t(5.0)).unwrap();
    assert_eq!(
        (state.frame, state.position_m.x),
        (Frame::Gcrf, 7_000_050.0)
    );
    assert!((state.velocity_m_s.x - 15.0).abs() < 1e-9);
    // Without velocities HERMITE is LAGRANGE.
    let feed = one(&document(
        r#"{"epoch":"2018-01-01T00:00:00Z","interpolationAlgorithm":"HERMITE","interpolationDegree":2,"cartesian":[0,0,0,7e6,1,1,0,7e6,2,4,0,7e6]}"#,
    ));
    assert_eq!(
        feed.segments()[0].samples.interpolation(),
        Interpolation::Lagrange { degree: 2 }
    );
    assert!((feed.state_at(t(1.5)).unwrap().position_m.x - 2.25).abs() < 1e-9);
    // Pieces, each in its interval.
    let piece = |from: u32, x: f64| {
        format!(
            r#"{{"interval":"2018-01-01T00:0{from}:00Z/2018-01-01T00:0{}:00Z","epoch":"2018-01-01T00:00:00Z","cartesian":[{},{x},0,0,{},{x},60,0]}}"#,
            from + 1,
            from * 60,
            from * 60 + 60
        )
    };
    let feed = one(&document(&format!("[{},{}]", piece(0, 7e6), piece(2, 8e6))));
    assert_eq!(feed.segments().len(), 2);
    assert_eq!(
        feed.state_at(t(150.0)).unwrap().position_m,
        DVec3::new(8e6, 30.0, 0.0)
    );
    assert!(feed.state_at(t(90.0)).is_err());
    // Availability cuts.
    let text = document(&piece(0, 7e6)).replace(
        "\"name\"",
        r#""availability":["2018-01-01T00:00:10Z/2018-01-01T00:00:20Z","2018-01-01T00:00:30Z/2018-01-02T00:00:00Z"],"name""#,
    );
    let feed = one(&text);
    for (s, known) in [
        (5.0, false),
        (15.0, true),
        (25.0, false),
        (30.0, true),
        (60.0, true),
    ] {
        assert_eq!(feed.state_at(t(s)).is_ok(), known, "{s}");
    }
}

#[test]
fn what_does_not_move_is_passed_over() {
    for position in [
        r#"{"cartesian":[1,2,3]}"#,
        r##"{"reference":"document#position"}"##,
        r#"{"cartographicDegrees":[1,2,3]}"#,
        "{}",
    ] {
        assert!(
            matches!(
                read(&document(position)),
                Err(OrbitError::NotRead { kind: "CZML", .. })
            ),
            "{position}"
        );
    }
}

#[test]
fn wrong_documents_are_named() {
    let good = r#"{"epoch":"2018-01-01T00:00:00Z","interpolationAlgorithm":"LAGRANGE","interpolationDegree":1,
"referenceFrame":"FIXED","interval":"2018-01-01T00:00:00Z/2019-01-01T00:00:00Z","cartesian":[0,7e6,0,0,60,
7e6,1,0]}"#;
    assert!(read(&document(good)).is_ok());
    for (from, to, place, says) in [
        (
            "\"2018-01-01T00:00:00Z\",",
            "\"yesterday\",",
            "3:21",
            "epoch: \"yesterday\" is not a date",
        ),
        (
            "\"epoch\":\"2018-01-01T00:00:00Z\",",
            "",
            "4:94",
            "a sample's time is \"0\"; expected seconds since the epoch",
        ),
        (
            "LAGRANGE",
            "MAGIC",
            "3:69",
            "known algorithms are LINEAR, LAGRANGE and HERMITE",
        ),
        (
            "Degree\":1",
            "Degree\":0",
            "3:102",
            "a whole number from 1 to 31",
        ),
        (
            "FIXED",
            "TEME",
            "4:18",
            "known frames are INERTIAL and FIXED",
        ),
        ("\"7e6", "x", "", ""),
        (
            "60,\n7e6,1",
            "60,\n7e6,\"x\"",
            "5:5",
            "a coordinate is \"\\\"x\\\"\"; expected a number of metres",
        ),
        ("[0,7e6", "[0,7e66", "4:94", "not finite, is farther than"),
        (
            "60,\n",
            "",
            "4:93",
            "\"7 numbers\" is not allowed here; expected groups of four",
        ),
        (
            "\"cartesian\"",
            "\"forwardExtrapolationType\":\"GUESS\",\"cartesian\"",
            "4:108",
            "known types are NONE, HOLD and EXTRAPOLATE",
        ),
        (
            "Z/2019",
            "Z-2019",
            "4:37",
            "two dates with a slash between them",
        ),
        (
            "2018-01-01T00:00:00Z/2019-01-01T00:00:00Z",
            "2019-01-01T00:00:00Z/2020-01-01T00:00:00Z",
            "3:12",
            "an interval without samples",
        ),
        ("1,0]}", "1,0}", "5:8", "not JSON"),
    ] {
        if place.is_empty() {
            continue;
        }
        assert!(good.contains(from), "{from}");
        let error = read(&document(&good.replacen(from, to, 1)))
            .unwrap_err()
            .to_string();
        assert!(
            error.starts_with(&format!("sat.czml:{place}: ")),
            "{to}: {error}"
        );
        assert!(error.contains(says), "{to}: {error}");
    }
    // The others are used.
    let bad = document(good).replace("}]", "},{\"id\":\"b\",\"position\":7}]");
    let some = Ephemerides::from_text(&bad, Path::new("sat.czml"), false).unwrap();
    assert_eq!((some.feeds.len(), some.faults.len()), (1, 1));
}

/// Seven samples a minute apart on a line, as cartesian numbers; the first, as a group of text, can be put in another's place.
fn row(minute: i32) -> String {
    let s = f64::from(minute) * 60.0;
    format!("{s}, {}, {}, 0", 7e6 + 10.0 * s, 20.0 * s)
}

#[test]
fn bad_samples_are_listed_and_the_good_ones_used() {
    let origin = Path::new("folder/sat.czml");
    let whole: Vec<_> = (0..7).map(row).collect();
    let with = |minute: usize, row: &str| {
        let mut rows = whole.clone();
        row.clone_into(&mut rows[minute]);
        let numbers = rows.join(",\n");
        let position =
            format!("\"epoch\": \"2018-01-01T00:00:00Z\", \"cartesian\": [\n{numbers}\n]");
        format!(
            "[{{\"id\": \"document\", \"version\": \"1.0\"}},\n{{\"id\": \"a\", \"position\": {{{position}}}}}]"
        )
    };
    for (what, minute, row, word) in [
        (
            "a coordinate that is text",
            3,
            "180, \"far\", 3600, 0",
            "a coordinate",
        ),
        (
            "one that is not there",
            3,
            "180, null, 3600, 0",
            "a coordinate",
        ),
        ("a time that is none", 2, "true, 7001200, 2400, 0", "time"),
        ("no state: too far away", 5, "300, 1e14, 0, 0", ""),
    ] {
        let text = with(minute, row);
        let read = Ephemerides::from_text(&text, origin, false).expect(what);
        assert_eq!(
            (read.feeds.len(), read.faults.len()),
            (1, 1),
            "{what}: {:?}",
            read.faults
        );
        let fault = read.faults[0].to_string();
        let line = format!(":{}:", 3 + minute);
        assert!(
            fault.contains(&line) && fault.contains(word),
            "{what}: {fault}"
        );
        let samples = &read.feeds[0].segments()[0].samples;
        assert_eq!(samples.len(), 6, "{what}");
        // Linear between those beside it: on the line.
        let at = utc("2018-01-01T00:00:00Z") + Duration::from_seconds(60.0 * minute as f64);
        let state = read.feeds[0].state_at(at).expect(what);
        assert!(
            (state.position_m.y - 1200.0 * minute as f64).abs() < 1e-6,
            "{what}"
        );
        let strict = Ephemerides::from_text(&text, origin, true).expect_err(what);
        assert_eq!(strict.to_string(), fault, "{what}");
    }
    // One number too few: it is unknown which sample lacks it.
    let text = with(3, "180, 3600, 0");
    let error = Ephemerides::from_text(&text, origin, false).expect_err("27 numbers");
    assert!(error.to_string().contains("27 numbers"), "{error}");
}
