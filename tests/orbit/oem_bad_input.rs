//! Orbit ephemeris messages that are wrong: one message with file, line, column and cause.

use crate::oem::{COVARIANCE, HEADER, every_minute, kvn, meta, read, rows, xml};
use std::path::Path;
use terrella_frames::TimeScale;
use terrella_orbit::{Ephemerides, Feed, OrbitError};

/// Each with one error: the replaced text, its replacement, the place, and the message.
#[test]
fn wrong_messages_are_named() {
    let good = kvn(&meta(TimeScale::Utc, 0.0, 600.0), &every_minute(0, 10)) + COVARIANCE;
    for (from, to, place, says) in [
        ("VERS = 2.0", "VERS = 7", "1:18", "versions 1 to 3 are read"),
        (
            "CENTER_NAME = EARTH",
            "CENTER_NAME = MOON",
            "8:15",
            "only orbits about the Earth",
        ),
        (
            "REF_FRAME = EME2000",
            "REF_FRAME = MCI",
            "9:13",
            "known frames are",
        ),
        (
            "REF_FRAME = EME2000",
            "REF_FRAME = TEME\nREF_FRAME_EPOCH = 2000-01-01T00:00:00",
            "10:19",
            "axes of a fixed date",
        ),
        (
            "TIME_SYSTEM = UTC",
            "TIME_SYSTEM = UT1",
            "10:15",
            "known time systems are UTC, TAI, TT, TDB and GPS; none is guessed",
        ),
        (
            "TIME_SYSTEM = UTC\n",
            "",
            "5:1",
            "the metadata without TIME_SYSTEM",
        ),
        (
            "OBJECT_ID = 2016-001A\n",
            "",
            "5:1",
            "the metadata without OBJECT_ID",
        ),
        ("= HERMITE", "= SPLINE", "13:17", "known interpolations are"),
        (
            "INTERPOLATION_DEGREE = 7\n",
            "",
            "5:1",
            "without INTERPOLATION_DEGREE; INTERPOLATION needs it",
        ),
        (
            "_DEGREE = 7",
            "_DEGREE = 32",
            "14:24",
            "a whole number from 1 to 31",
        ),
        (
            "META_STOP\n",
            "",
            "16:1",
            "is not allowed here; expected KEY = value, or META_STOP",
        ),
        (
            "META_START\n",
            "",
            "14:1",
            "is not allowed here; expected an epoch and six numbers",
        ),
        (
            "2016-12-31T23:51:00.000 ",
            "2016-12-31T23:50:00.000 ",
            "18:1",
            "2016-12-31T23:50:00.000Z is not later than 2016-12-31T23:50:00.000Z",
        ),
        (
            "2016-12-31T23:53:00.000 ",
            "2016-12-31T23:41:00.000 ",
            "20:1",
            "is not later than",
        ),
        (
            "2016-12-31T23:53:00.000 ",
            "2016-12-32T23:53:00.000 ",
            "20:1",
            "day 32 is not from 1 to 31",
        ),
        (
            "2016-12-31T23:53:00.000 ",
            "2016-12-31T23:53:00.000 0 ",
            "20:1",
            "expected an epoch and six numbers",
        ),
        (
            "2016-12-31T23:53:00.000 ",
            "2016-12-31T23:53:00.000 0 0 ",
            "20:1",
            "expected an epoch and six numbers",
        ),
        (
            "2016-12-31T23:53:00.000 ",
            "2016-12-31T23:53:00.000 0 0 1e12 ",
            "20:1",
            "not finite, is farther than",
        ),
        (
            "2016-12-31T23:53:00.000 ",
            "2016-12-31T23:53:00.000 0 nan 0 ",
            "20:27",
            "Y is \"nan\"; expected a number",
        ),
        (
            "START_TIME = 2016-12-31T23:50:00.000",
            "START_TIME = 2017-12-31T23:50:00.000",
            "5:1",
            "is outside its states",
        ),
        (
            "STOP_TIME = 2016-12-31T23:59:60.000",
            "STOP_TIME = soon",
            "12:13",
            "STOP_TIME: \"soon\" is not a date",
        ),
        (
            "COV_REF_FRAME = RTN\n4.0e-4",
            "4.0e-4 1",
            "30:1",
            "the six rows of a lower triangle",
        ),
        ("EPOCH = 2016-12-31T23:50:00\n", "", "30:1", "EPOCH = …"),
        ("4.0e-4\n", "-4.0e-4\n", "36:1", "squares of km"),
        (
            "EPOCH = 2017-01-01T00:49:59",
            "EPOCH = 2015-01-01T00:49:59",
            "45:1",
            "a later one than the one before it",
        ),
        (
            "COVARIANCE_STOP\n",
            "",
            "1:18",
            "without COVARIANCE_STOP; the file is truncated",
        ),
    ] {
        let text = good.replacen(from, to, 1);
        assert_ne!(text, good, "{from}");
        let error = read(&text).unwrap_err().to_string();
        assert!(
            error.starts_with(&format!("sat.oem:{place}: ")),
            "{from} {to}: {error}"
        );
        assert!(error.contains(says), "{to}: {error}");
    }
    // No state, and no message at all.
    let error = read(&format!(
        "{HEADER}{}",
        meta(TimeScale::Utc, 0.0, 600.0).kvn()
    ))
    .unwrap_err();
    assert_eq!(error.to_string(), "sat.oem:5:1: no sample");
    assert_eq!(
        read(HEADER).unwrap_err().to_string(),
        "sat.oem:1:18: no segment"
    );
    for nothing in ["", "hello\n", "<ndm/>"] {
        assert!(
            matches!(read(nothing), Err(OrbitError::NoEphemeris { .. })),
            "{nothing}"
        );
    }
    // Two segments for one time, and two objects in one message.
    let text = good.clone()
        + &meta(TimeScale::Utc, 300.0, 900.0).kvn()
        + &rows(&every_minute(5, 15), TimeScale::Utc);
    let error = read(&text).unwrap_err().to_string();
    assert!(
        error.starts_with("sat.oem:47:1: the segment begins at")
            && error.contains("USEABLE_START_TIME"),
        "{error}"
    );
    let other = meta(TimeScale::Utc, 600.0, 900.0).with("OBJECT_ID", "1998-067A");
    let text = good + &other.kvn() + &rows(&every_minute(10, 15), TimeScale::Utc);
    let error = read(&text).unwrap_err().to_string();
    assert!(
        error.starts_with("sat.oem:49:13: ") && error.contains("a message tells of one object"),
        "{error}"
    );
}

#[test]
fn wrong_xml_is_named() {
    let good = xml(&meta(TimeScale::Utc, 0.0, 600.0), &every_minute(0, 10));
    for (from, to, place, says) in [
        (
            "<CENTER_NAME>EARTH",
            "<CENTER_NAME>MARS",
            "5:14",
            "only orbits about the Earth",
        ),
        (
            "<X units=\"km\">",
            "<X units=\"m\">",
            "15:14",
            "X is in \"m\"; the format requires km",
        ),
        (
            "<Z units=\"km\">",
            "<ZZ units=\"km\"/><Q>",
            "15:",
            "not XML",
        ),
        (
            "<EPOCH>2016-12-31T23:51:00.000",
            "<EPOCH>2016-12-31T23:50:00.000",
            "16:1",
            "is not later than",
        ),
        (
            "<EPOCH>2016-12-31T23:51:00.000</EPOCH>",
            "",
            "16:1",
            "the state without EPOCH",
        ),
        ("</oem>", "", "36:", "<oem> is not closed"),
    ] {
        let text = good.replacen(from, to, 1);
        assert_ne!(text, good, "{from}");
        let error = read(&text).unwrap_err().to_string();
        assert!(
            error.starts_with(&format!("sat.oem:{place}")),
            "{from}: {error}\n{text}"
        );
        assert!(error.contains(says), "{to}: {error}");
    }
}

#[test]
fn several_messages_and_a_bad_one() {
    let times = every_minute(0, 10);
    let named = |name: &str| meta(TimeScale::Utc, 0.0, 600.0).with("OBJECT_NAME", name);
    let bad = named("B").with("CENTER_NAME", "SUN");
    let kvns = [
        kvn(&named("A"), &times),
        kvn(&bad, &times),
        kvn(&named("C"), &times),
    ]
    .concat();
    let xmls = format!(
        "<ndm>\n{}\n{}\n{}</ndm>",
        xml(&named("A"), &times),
        xml(&bad, &times),
        xml(&named("C"), &times)
    );
    for text in [kvns, xmls] {
        let origin = Path::new("sat.oem");
        let read = Ephemerides::from_text(&text, origin, false).unwrap();
        let names: Vec<_> = read.feeds.iter().map(Feed::name).collect();
        assert_eq!(names, ["A", "C"]);
        assert_eq!(read.faults.len(), 1);
        assert!(Ephemerides::from_text(&text, origin, true).is_err());
        assert_eq!(read.into_one(origin, Some("c")).unwrap().name(), "C");
    }
}

/// Each with one bad line in it: the other states are flown, the line is reported; strictly it is rejected.
#[test]
fn a_bad_state_costs_that_state() {
    let times = every_minute(0, 10);
    let kvn = kvn(&meta(TimeScale::Utc, 0.0, 600.0), &times);
    let with_covariance = kvn.clone() + COVARIANCE;
    let xml = xml(&meta(TimeScale::Utc, 0.0, 600.0), &times);
    let date = "2016-12-31T23:53:00.000";
    for (good, from, to, states, says) in [
        (&kvn, date, "2016-12-32T23:53:00.000", 10, "day 32 is not"),
        (&kvn, date, "2016-12-31T23:53:00.000 7", 10, "six numbers"),
        (&kvn, date, "2016-12-31T23:41:00.000", 10, "not later than"),
        (&kvn, date, "2018-12-31T23:53:00.000", 10, "is later than"),
        (&kvn, date, "garbage", 10, "is not a date"),
        (
            &kvn,
            "META_STOP\n",
            "META_STOP\nnonsense\n",
            11,
            "\"nonsense\"",
        ),
        (
            &with_covariance,
            "\n4.0e-4\n",
            "\n-4.0e-4\n",
            11,
            "squares of km",
        ),
        (&with_covariance, "\n4.0e-4\n", "\nfour\n", 11, "\"four\""),
        (
            &with_covariance,
            "EPOCH = 2016-12-31T23:50:00\n",
            "EPOCH = soon\n",
            11,
            "\"soon\"",
        ),
        (
            &xml,
            "<X units=\"km\">",
            "<X units=\"m\">",
            10,
            "X is in \"m\"",
        ),
        (&xml, date, "2016-12-32T23:53:00.000", 10, "day 32 is not"),
        (&xml, date, "2016-12-31T23:41:00.000", 10, "not later than"),
    ] {
        let text = good.replacen(from, to, 1);
        assert_ne!(&text, good, "{from}");
        let origin = Path::new("sat.oem");
        let strict = Ephemerides::from_text(&text, origin, true);
        let error = strict.expect_err(to).to_string();
        assert!(
            error.starts_with("sat.oem:") && error.contains(says),
            "{error}"
        );
        let loose = Ephemerides::from_text(&text, origin, false).expect(to);
        let reported: Vec<_> = loose.faults.iter().map(OrbitError::to_string).collect();
        assert_eq!(reported, [error], "{to}");
        let feed = loose.into_one(origin, None).expect(to);
        assert_eq!(feed.segments()[0].samples.len(), states, "{to}");
    }
    // A misplaced keyword corrupts the message: the meaning of its other lines is unknown.
    let text = kvn.replacen("META_START\n", "", 1);
    assert!(Ephemerides::from_text(&text, Path::new("sat.oem"), false).is_err());
}
