//! CZML as documents are written: packets that add to one another, dates of every form, intervals in any order, extrapolation,
//! references.

use crate::utc;
use glam::DVec3;
use std::path::Path;
use terrella_frames::{Duration, Ellipsoid, Epoch, Geodetic};
use terrella_orbit::{Ephemerides, EphemerisFeed, Feed, Frame, Header, OrbitError, write_oem};

fn read(text: &str) -> Result<Ephemerides, OrbitError> {
    Ephemerides::from_text(text, Path::new("sat.czml"), true)
}

/// The feeds of packets behind a document's.
fn feeds(packets: &[String]) -> Vec<EphemerisFeed> {
    let text = document(packets);
    read(&text).unwrap_or_else(|e| panic!("{e}\n{text}")).feeds
}

fn document(packets: &[String]) -> String {
    let packets = packets.join(",\n");
    format!("[{{\"id\":\"document\",\"version\":\"1.0\"}},\n{packets}]")
}

fn packet(id: &str, more: &str) -> String {
    format!("{{\"id\":\"{id}\",{more}}}")
}

/// Positions on the line x = 7e6 + 1000 t, a minute apart.
fn line(minutes: std::ops::RangeInclusive<i32>) -> String {
    on_line(minutes, 1000.0)
}

fn on_line(minutes: std::ops::RangeInclusive<i32>, speed_m_s: f64) -> String {
    let row = |m: i32| {
        let s = f64::from(m) * 60.0;
        format!("{s},{},0,0", 7e6 + speed_m_s * s)
    };
    minutes.map(row).collect::<Vec<_>>().join(",")
}

fn position(numbers: &str, more: &str) -> String {
    format!("\"position\":{{\"epoch\":\"2026-03-01T00:00:00Z\",\"cartesian\":[{numbers}]{more}}}")
}

fn at(s: f64) -> Epoch {
    utc("2026-03-01T00:00:00Z") + Duration::from_seconds(s)
}

fn x(feed: &EphemerisFeed, s: f64) -> Option<f64> {
    feed.state_at(at(s)).ok().map(|state| state.position_m.x)
}

#[test]
fn packets_of_one_id_tell_of_one_object() {
    let lagrange = r#","interpolationAlgorithm":"LAGRANGE","interpolationDegree":5,"referenceFrame":"INERTIAL""#;
    let first = format!("\"name\":\"Sat\",{}", position(&line(0..=10), lagrange));
    let packets = [
        packet("a", &first),
        packet("b", &position(&on_line(0..=3, 5.0), "")),
        packet("a", &position(&line(10..=20), "")),
    ];
    let two = feeds(&packets);
    assert_eq!(two.iter().map(Feed::name).collect::<Vec<_>>(), ["Sat", "b"]);
    let feed = &two[0];
    assert_eq!(feed.validity(), (at(0.0), at(1200.0)));
    assert_eq!((feed.line(), feed.segments().len()), (2, 1));
    let samples = &feed.segments()[0].samples;
    assert_eq!((samples.frame(), samples.len()), (Frame::Gcrf, 21));
    assert_eq!(samples.interpolation().degree(), 5);
    assert!((x(feed, 615.0).unwrap() - 7_615_000.0).abs() < 1e-6);
    // A sample of an instant that is there takes its place; an availability does so as well, and so does a name.
    let changed = [
        packet("a", &first),
        packet("a", &position("120,1,2,3", "")),
        packet(
            "a",
            "\"availability\":\"2026-03-01T00:01Z/2026-03-01T00:05Z\",\"name\":\"New\"",
        ),
    ];
    let feed = &feeds(&changed)[0];
    assert_eq!(x(feed, 120.0), Some(1.0));
    assert_eq!(feed.validity(), (at(60.0), at(300.0)));
    assert_eq!(feed.name(), "New");
    // Settings alone hold for the samples that are there.
    let settings = r#""position":{"interpolationAlgorithm":"LAGRANGE","interpolationDegree":3.0}"#;
    let set = [
        packet("a", &position(&line(0..=5), "")),
        packet("a", settings),
    ];
    let feed = feeds(&set).remove(0);
    let samples = &feed.segments()[0].samples;
    assert_eq!((samples.interpolation().degree(), samples.len()), (3, 6));
}

/// Frame and interpolation stand in the first packet of an object, its samples in another.
#[test]
fn settings_apply_whichever_packet_they_are_in() {
    let settings = "\"referenceFrame\":\"INERTIAL\",\"interpolationAlgorithm\":\"LAGRANGE\",\"interpolationDegree\":2";
    let alone = packet("A", &format!("\"position\":{{{settings}}}"));
    let curve = "0,7e6,0,0,60,7e6,1e5,0,120,7e6,4e5,0,180,7e6,9e5,0";
    let samples = packet("A", &position(curve, ""));
    let together = packet("A", &position(curve, &format!(",{settings}")));
    let wanted = feeds(&[together]).remove(0).state_at(at(90.0)).unwrap();
    assert_eq!(wanted.frame, Frame::Gcrf);
    assert!((wanted.position_m.y - 225_000.0).abs() < 1e-6);
    for packets in [
        [alone.clone(), samples.clone()],
        [samples.clone(), alone.clone()],
    ] {
        let state = feeds(&packets).remove(0).state_at(at(90.0)).unwrap();
        assert_eq!(state, wanted, "{packets:?}");
    }
    // An interval that has no value yet is named.
    let interval = "\"position\":{\"interval\":\"2026-03-01T00Z/2026-03-01T01Z\",\"referenceFrame\":\"INERTIAL\"}";
    let reported = read(&document(&[packet("A", interval), samples])).unwrap();
    let faults: Vec<_> = reported.faults.iter().map(ToString::to_string).collect();
    assert!(
        matches!(faults.as_slice(), [one] if one.contains("gives a value for this interval")),
        "{faults:?}"
    );
}

#[test]
fn documents_without_orbits_say_why() {
    for (packets, says) in [
        (
            vec![packet("A", "\"position\":{\"cartesian\":[7e6,0,0]}")],
            "sat.czml: CZML with no object that moves",
        ),
        (
            vec![packet("A", "\"position\":{\"cartesian\":\"abc\"}")],
            "\"\\\"abc\\\"\" is not allowed here; expected an array",
        ),
        (
            vec![packet("A", &position("0,7e6,0,0", ""))],
            "one state alone, of 2026-03-01T00:00:00.000Z; an orbit needs two or more",
        ),
    ] {
        let error = read(&document(&packets)).unwrap_err().to_string();
        assert!(error.contains(says), "{error}");
    }
    // Neither has an id or a name.
    let nameless = format!("{{{}}}", position(&line(0..=3), ""));
    let two = read(&document(&[nameless.clone(), nameless])).unwrap();
    let error = two.into_one(Path::new("sat.czml"), None).unwrap_err();
    let error = error.to_string();
    assert!(error.contains("one without a name (line 2)"), "{error}");
    assert!(error.ends_with("give each a name in the file"), "{error}");
}

#[test]
fn what_is_deleted_is_gone() {
    let moving = packet("a", &position(&line(0..=5), ""));
    let gone = [moving.clone(), packet("a", "\"delete\":true")];
    assert!(matches!(
        read(&document(&gone)),
        Err(OrbitError::NotRead { kind: "CZML", .. })
    ));
    // An object of that id that follows is a new one.
    let again = [
        moving.clone(),
        packet("a", "\"delete\":true"),
        packet("a", &position(&line(7..=9), "")),
    ];
    let new = &feeds(&again)[0];
    assert_eq!(new.validity(), (at(420.0), at(540.0)));
    // A position, or a part of it.
    let none = [
        moving.clone(),
        packet("a", "\"position\":{\"delete\":true}"),
    ];
    assert!(matches!(
        read(&document(&none)),
        Err(OrbitError::NotRead { kind: "CZML", .. })
    ));
    let part = r#""position":{"interval":"2026-03-01T00:02Z/2026-03-01T00:03Z","delete":true}"#;
    let feed = &feeds(&[moving, packet("a", part)])[0];
    assert_eq!(feed.gaps(), [(at(120.0), at(180.0))]);
    assert!(x(feed, 150.0).is_none() && x(feed, 200.0).is_some());
}

#[test]
fn dates_are_read_in_every_form() {
    let whole = |epoch: &str, availability: &str| {
        format!(
            "\"availability\":\"{availability}\",\"position\":{{\"epoch\":\"{epoch}\",\"cartesian\":[{}]}}",
            line(0..=5)
        )
    };
    for (epoch, availability) in [
        (
            "2026-03-01T00:00:00.000Z",
            "2026-03-01T00:00:00Z/2026-03-01T00:05:00Z",
        ),
        ("20260301T00Z", "20260301T00Z/20260301T0005Z"),
        ("2026-02-28T24:00:00Z", "20260228T24Z/20260301T000500Z"),
        (
            "2026-02-28T21:00:00-03:00",
            "2026-03-01T01:00:00+01:00/2026-02-28T21:05-0300",
        ),
        (
            "2026-060T00:00:00Z",
            "0000-00-00T00:00:00Z/9999-12-31T24:00:00Z",
        ),
        ("2026-03-01T00:00:00", "00000000T00Z/99991231T24Z"),
    ] {
        let feed = &feeds(&[packet("a", &whole(epoch, availability))])[0];
        assert_eq!(
            feed.validity(),
            (at(0.0), at(300.0)),
            "{epoch} {availability}"
        );
        assert_eq!(x(feed, 90.0), Some(7_090_000.0), "{epoch}");
    }
    let error = read(&document(&[packet(
        "a",
        &whole("2026-13-01T00Z", "2026/2027"),
    )]))
    .unwrap_err();
    assert!(
        error.to_string().contains("month 13 is not from 1 to 12"),
        "{error}"
    );
}

#[test]
fn intervals_samples_and_availabilities_have_no_order() {
    let piece = |from: &str, to: &str, numbers: &str| {
        format!(
            "{{\"interval\":\"2026-03-01T00:{from}Z/2026-03-01T00:{to}Z\",\"epoch\":\"2026-03-01T00:00:00Z\",\"cartesian\":[{numbers}]}}"
        )
    };
    let positions =
        |pieces: &[String]| packet("a", &format!("\"position\":[{}]", pieces.join(",")));
    // The later one first: both are used in their own time.
    let (first, second) = (
        piece("00", "10", &line(0..=10)),
        piece("10", "20", &on_line(10..=20, 50.0)),
    );
    for order in [[&second, &first], [&first, &second]] {
        let feed = &feeds(&[positions(&order.map(String::clone))])[0];
        assert_eq!(feed.validity(), (at(0.0), at(1200.0)));
        assert!(feed.gaps().is_empty());
        assert_eq!(
            (x(feed, 570.0), x(feed, 630.0)),
            (Some(7_570_000.0), Some(7_031_500.0))
        );
    }
    // Later packets replace earlier ones.
    let over = piece("02", "04", &on_line(0..=20, 50.0));
    let feed = &feeds(&[positions(&[piece("00", "10", &line(0..=10)), over])])[0];
    let read = [90.0, 150.0, 270.0].map(|s| x(feed, s));
    assert_eq!(
        read,
        [Some(7_090_000.0), Some(7_007_500.0), Some(7_270_000.0)]
    );
    assert!(feed.gaps().is_empty());
    // Samples.
    let shuffled = [line(3..=5), line(0..=2), line(6..=6)].join(",");
    let feed = &feeds(&[packet("a", &position(&shuffled, ""))])[0];
    assert_eq!(
        (feed.validity(), feed.segments().len()),
        ((at(0.0), at(360.0)), 1)
    );
    assert_eq!(x(feed, 150.0), Some(7_150_000.0));
    // Availabilities, two of which overlap.
    let available = r#""availability":["2026-03-01T00:10Z/2026-03-01T00:20Z","2026-03-01T00:00Z/2026-03-01T00:04Z","2026-03-01T00:03Z/2026-03-01T00:05Z"]"#;
    let feed = &feeds(&[packet(
        "a",
        &format!("{available},{}", position(&line(0..=20), "")),
    )])[0];
    assert_eq!(feed.validity(), (at(0.0), at(1200.0)));
    assert_eq!(feed.gaps(), [(at(300.0), at(600.0))]);
    // Before, between and after samples a fixed point applies during its interval.
    let still =
        r#"{"interval":"2026-03-01T00:10Z/2026-03-01T00:15Z","cartesian":[1,2,3]}"#.to_owned();
    let feed = &feeds(&[positions(&[first, still])])[0];
    assert_eq!((x(feed, 800.0), feed.validity().1), (Some(1.0), at(900.0)));
}

#[test]
fn a_member_that_stands_there_twice_counts_the_second_time() {
    let twice = format!(
        "\"name\":\"One\",\"name\":\"Two\",\"position\":null,{}",
        position(&line(0..=5), "")
    );
    assert_eq!(feeds(&[packet("a", &twice)])[0].name(), "Two");
}

#[test]
fn extrapolation_is_followed() {
    let available = r#""availability":"2026-03-01T00:00Z/2026-03-01T00:20Z""#;
    let lagrange = r#","interpolationAlgorithm":"LAGRANGE","interpolationDegree":2"#;
    let parabola: Vec<_> = (0..=10)
        .map(|m| format!("{},{},0,0", 60 * m, 7_000_000 + m * m))
        .collect();
    let parabola = parabola.join(",");
    let feed = |numbers: &str, more: &str| {
        let more = format!("{lagrange},{more}");
        let packet = packet("a", &format!("{available},{}", position(numbers, &more)));
        feeds(&[packet]).remove(0)
    };
    // The polynomial goes on for a minute, and no longer.
    let on = feed(
        &parabola,
        r#""forwardExtrapolationType":"EXTRAPOLATE","forwardExtrapolationDuration":60"#,
    );
    assert_eq!(on.validity(), (at(0.0), at(660.0)));
    for m in [10.25_f64, 10.5, 11.0] {
        let wanted = 7e6 + m * m;
        let state = on.state_at(at(60.0 * m)).unwrap();
        assert!((state.position_m.x - wanted).abs() < 1e-6, "{m}");
        assert!((state.velocity_m_s.x - 2.0 * m / 60.0).abs() < 1e-9, "{m}");
    }
    assert!(x(&on, 661.0).is_none());
    // It stays where it was last, and without a duration to the end of the availability.
    let held = feed(&parabola, r#""forwardExtrapolationType":"HOLD""#);
    assert_eq!(held.validity().1, at(1200.0));
    assert!((x(&held, 1100.0).unwrap() - 7_000_100.0).abs() < 1e-6);
    assert_eq!(held.state_at(at(1100.0)).unwrap().velocity_m_s, DVec3::ZERO);
    assert!(held.gaps().is_empty());
    // Backwards.
    let late: Vec<_> = (10..=20)
        .map(|m| format!("{},{},0,0", 60 * m, 7_000_000 + m * m))
        .collect();
    let back = feed(
        &late.join(","),
        r#""backwardExtrapolationType":"EXTRAPOLATE""#,
    );
    assert!((x(&back, 60.0).unwrap() - 7_000_001.0).abs() < 1e-6);
    assert_eq!(back.validity(), (at(0.0), at(1200.0)));
    let first = feed(
        &late.join(","),
        r#""backwardExtrapolationType":"HOLD","backwardExtrapolationDuration":120"#,
    );
    assert_eq!(first.validity().0, at(480.0));
    assert!((x(&first, 500.0).unwrap() - 7_000_100.0).abs() < 1e-6);
    // Where nothing ends it, it is not followed, and that is reported.
    let endless = position(&parabola, r#","forwardExtrapolationType":"HOLD""#);
    let reported = read(&document(&[packet("a", &endless)])).unwrap();
    assert_eq!(reported.feeds[0].validity().1, at(600.0));
    let notice = reported.faults[0].to_string();
    assert!(
        notice.contains("forwardExtrapolationType = HOLD is not followed"),
        "{notice}"
    );
    assert!(reported.faults[0].is_notice());
}

/// An OEM has no extrapolation: such an object is written within its samples only.
#[test]
fn what_is_extrapolated_is_not_written() {
    let more = r#","forwardExtrapolationType":"EXTRAPOLATE","forwardExtrapolationDuration":60"#;
    let feed = &feeds(&[packet("a", &position(&line(0..=5), more))])[0];
    assert_eq!(feed.validity().1, at(360.0));
    let header = Header {
        originator: "NOBODY".to_owned(),
        created: at(0.0),
    };
    let text = write_oem(feed, &header);
    let again = Ephemerides::from_text(&text, Path::new("a.oem"), true).unwrap();
    assert_eq!(again.feeds[0].validity(), (at(0.0), at(300.0)));
}

/// Wherever a document ends it is read or an error: nothing panics.
#[test]
fn documents_may_end_anywhere() {
    let text = document(&[
        packet(
            "a",
            &position(&line(0..=2), r#","forwardExtrapolationType":"HOLD""#),
        ),
        packet(
            "b",
            r##""availability":"20260301T00Z/9999-12-31T24Z","position":{"reference":"a#position"}"##,
        ),
    ]);
    assert!(Ephemerides::from_text(&text, Path::new("sat.czml"), false).is_ok());
    for end in 0..text.len() {
        for cut in [
            text[..end].to_owned(),
            format!("{}é{}", &text[..end], &text[end..]),
        ] {
            if let Ok(read) = Ephemerides::from_text(&cut, Path::new("sat.czml"), false) {
                assert!(
                    read.feeds
                        .iter()
                        .all(|feed| feed.validity().0 <= feed.validity().1)
                );
            }
        }
    }
}

#[test]
fn places_above_the_ellipsoid_are_read() {
    let place = |lon_deg: f64| {
        Ellipsoid::WGS84.itrf_from_geodetic(Geodetic {
            lon_rad: lon_deg.to_radians(),
            lat_rad: 0.5,
            height_m: 4e5,
        })
    };
    let numbers = |unit: f64| {
        let rows: Vec<_> = [10.0_f64, 12.0]
            .iter()
            .map(|lon_deg| {
                format!(
                    "{},{},{},400000",
                    30.0 * (lon_deg - 10.0),
                    lon_deg * unit,
                    0.5_f64.to_degrees() * unit
                )
            })
            .collect();
        rows.join(",")
    };
    for (key, unit) in [
        ("cartographicDegrees", 1.0),
        ("cartographicRadians", 1f64.to_radians()),
    ] {
        let text = format!(
            "\"position\":{{\"epoch\":\"2026-03-01T00:00:00Z\",\"{key}\":[{}]}}",
            numbers(unit)
        );
        let feed = &feeds(&[packet("a", &text)])[0];
        for (s, lon_deg) in [(0.0, 10.0), (60.0, 12.0)] {
            let state = feed.state_at(at(s)).unwrap();
            assert_eq!(state.frame, Frame::Itrf);
            assert!(state.position_m.distance(place(lon_deg)) < 1e-6, "{key}");
        }
        let inertial = text.replace("\"epoch\"", "\"referenceFrame\":\"INERTIAL\",\"epoch\"");
        let error = read(&document(&[packet("a", &inertial)]))
            .unwrap_err()
            .to_string();
        assert!(error.contains("places on the Earth are FIXED"), "{error}");
        // Latitudes before longitudes.
        let swapped = text.replace(&format!(",{},", 12.0 * unit), &format!(",{},", 0.5 * unit));
        let latitude = format!(",{},400000", 0.5_f64.to_degrees() * unit);
        let swapped = swapped.replace(&latitude, &format!(",{},400000", 112.0 * unit));
        let error = read(&document(&[packet("a", &swapped)]))
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("latitude of at most 90° either way"),
            "{error}"
        );
    }
}

#[test]
fn a_reference_is_where_the_other_object_is() {
    let moving = packet("S\\\\#1", &position(&line(0..=10), ""));
    let follower = |reference: &str| {
        packet(
            "S2",
            &format!("\"name\":\"Follower\",\"position\":{{\"reference\":\"{reference}\"}}"),
        )
    };
    // The referenced object may come later; its id contains a backslash and a number sign.
    for packets in [
        [moving.clone(), follower("S\\\\\\\\\\\\#1#position")],
        [follower("S\\\\\\\\\\\\#1#position"), moving.clone()],
    ] {
        let all = Ephemerides::from_text(&document(&packets), Path::new("sat.czml"), true).unwrap();
        let feed = all
            .into_one(Path::new("sat.czml"), Some("Follower"))
            .unwrap();
        assert_eq!(
            (x(&feed, 90.0), feed.validity()),
            (Some(7_090_000.0), (at(0.0), at(600.0)))
        );
        // Without a name the one that moves by itself is selected.
        let all = read(&document(&packets)).unwrap();
        assert_eq!(all.feeds.len(), 1);
        let only = all.into_one(Path::new("sat.czml"), None).unwrap();
        assert_eq!(only.name(), "S\\#1");
    }
    for (packets, says) in [
        (vec![follower("none#position")], "no object has this id"),
        (
            vec![follower("S2#position")],
            "refer to one another in a circle",
        ),
        (vec![follower("S2")], "write id#position"),
        (
            vec![moving, follower("S1#billboard.color")],
            "write id#position",
        ),
    ] {
        let error = read(&document(&packets)).unwrap_err().to_string();
        assert!(
            error.contains(says) && error.contains("reference"),
            "{error}"
        );
    }
}

#[test]
fn objects_are_chosen_by_their_id_where_names_repeat() {
    let named = |id: &str, speed: f64| {
        packet(
            id,
            &format!(
                "\"name\":\"Satellite\",{}",
                position(&on_line(0..=5, speed), "")
            ),
        )
    };
    let text = document(&[named("A-1", 1.0), named("A-2", 2.0)]);
    let origin = Path::new("sat.czml");
    let one = |name| read(&text).unwrap().into_one(origin, name);
    let second = one(Some("A-2")).unwrap();
    assert_eq!(
        (x(&second, 60.0), second.id()),
        (Some(7_000_120.0), Some("A-2"))
    );
    for name in [Some("Satellite"), None] {
        let error = one(name).unwrap_err().to_string();
        assert!(
            error.contains("Satellite (id \"A-1\", line 2), Satellite (id \"A-2\", line 3)"),
            "{error}"
        );
        let remedy = if name.is_some() {
            "give the id instead"
        } else {
            "name the satellite"
        };
        assert!(error.ends_with(remedy), "{error}");
    }
}
