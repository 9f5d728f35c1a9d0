//! Orbit parameter messages: the standard's own example, all formats, manoeuvres, and errors.

use crate::utc;
use glam::DVec3;
use std::path::Path;
use std::sync::Arc;
use terrella_frames::{Duration, Epoch, Orientation};
use terrella_orbit::numerical::{Spacecraft, ThrustAxes};
use terrella_orbit::{
    Catalogue, Ephemerides, FileFormat, Frame, OpmFeed, OrbitError, ParameterMessage,
    ParameterMessages,
};

/// CCSDS 502.0-B-2, figure 3-2, with its manoeuvres moved after the state's epoch. The standard labels the mean anomaly TRUE_ANOMALY: the elements
/// are those of the state with the anomaly as the mean one.
const W4: &str = "\
CCSDS_OPM_VERS = 2.0
COMMENT GEOCENTRIC, CARTESIAN, EARTH FIXED
CREATION_DATE = 2006-06-03T05:33:00.000
ORIGINATOR = GSOC
OBJECT_NAME = EUTELSAT W4
OBJECT_ID = 2000-028A
CENTER_NAME = EARTH
REF_FRAME = TOD
TIME_SYSTEM = UTC
EPOCH = 2006-06-03T00:00:00.000
X = 6655.9942 [km]
Y = -40218.5751 [km]
Z = -82.9177 [km]
X_DOT = 3.11548208 [km/s]
Y_DOT = 0.47042605 [km/s]
Z_DOT = -0.00101495 [km/s]
SEMI_MAJOR_AXIS = 41399.5123 [km]
ECCENTRICITY = 0.020842611
INCLINATION = 0.117746 [deg]
RA_OF_ASC_NODE = 17.604721 [deg]
ARG_OF_PERICENTER = 218.242943 [deg]
MEAN_ANOMALY = 41.922339 [deg]
GM = 398600.4415 [km**3/s**2]
MASS = 1913.000 [kg]
SOLAR_RAD_AREA = 10.000 [m**2]
SOLAR_RAD_COEFF = 1.300
DRAG_AREA = 10.000 [m**2]
DRAG_COEFF = 2.300
MAN_EPOCH_IGNITION = 2006-06-03T04:23:00.00
MAN_DURATION = 132.60 [s]
MAN_DELTA_MASS = -18.418 [kg]
MAN_REF_FRAME = EME2000
MAN_DV_1 = -0.02325700 [km/s]
MAN_DV_2 = 0.01683160 [km/s]
MAN_DV_3 = -0.00893444 [km/s]
MAN_EPOCH_IGNITION = 2006-06-05T18:59:21.000
MAN_DURATION = 0.00 [s]
MAN_DELTA_MASS = -1.469 [kg]
MAN_REF_FRAME = RTN
MAN_DV_1 = 0.00101500 [km/s]
MAN_DV_2 = -0.00187300 [km/s]
MAN_DV_3 = 0.00000000 [km/s]
USER_DEFINED_EARTH_MODEL = WGS-84
";

fn read(text: &str, is_strict: bool) -> Result<ParameterMessages, OrbitError> {
    ParameterMessages::from_text(text, Path::new("w4.opm"), is_strict)
}

pub fn one(text: &str) -> Arc<ParameterMessage> {
    let read = read(text, true).unwrap_or_else(|error| panic!("{error}"));
    Arc::new(read.one(Path::new("w4.opm"), None).unwrap().clone())
}

pub fn flown(text: &str, first: Epoch, last: Epoch) -> OpmFeed {
    let flown = one(text).propagated(first, last, &Orientation::default());
    flown.unwrap_or_else(|error| panic!("{error}"))
}

/// The example without lines whose keys begin so.
fn without(keys: &[&str]) -> String {
    let kept = W4
        .lines()
        .filter(|line| !keys.iter().any(|key| line.starts_with(key)));
    kept.map(|line| line.to_owned() + "\n").collect()
}

pub fn start() -> Epoch {
    utc("2006-06-03T00:00:00Z")
}

fn with(line: &str, by: &str) -> String {
    assert!(W4.contains(line), "{line}");
    W4.replacen(line, by, 1)
}

/// In low orbit, where drag acts, followed by `more`.
pub fn low(more: &str) -> String {
    let head = without(&["MAN_", "SEMI", "ECC", "INC", "RA_", "ARG", "MEAN", "GM"]);
    let head = head
        .replace("TOD", "GCRF")
        .replace("6655.9942", "6778.137")
        .replace("-40218.5751", "0")
        .replace("-82.9177", "0")
        .replace("3.11548208", "0")
        .replace("0.47042605", "4.7")
        .replace("-0.00101495", "6.05");
    head + more
}

#[test]
fn the_example_of_the_standard_is_read() {
    assert_eq!(FileFormat::of_text(W4), Some(FileFormat::Opm));
    let read = read(W4, true).unwrap();
    assert!(read.faults.is_empty(), "{:?}", read.faults);
    let message = read.one(Path::new("w4.opm"), Some("2000-028a")).unwrap();
    assert_eq!(message.name, "EUTELSAT W4");
    assert_eq!(message.object_id.as_deref(), Some("2000-028A"));
    assert_eq!((message.state.epoch, message.line()), (start(), 1));
    assert_eq!(
        message.craft,
        Spacecraft {
            mass_kg: 1913.0,
            drag_area_m2: 10.0,
            drag_coefficient: 2.3,
            sunlit_area_m2: 10.0,
            reflectivity: 1.3,
        }
    );
    // Axes of date have been turned: 6.4 years of precession are 5 minutes of arc, 60 km here.
    assert_eq!(message.state.frame, Frame::Gcrf);
    let as_written = DVec3::new(6_655_994.2, -40_218_575.1, -82_917.7);
    let turned_m = message.state.position_m.distance(as_written);
    assert!((40e3..80e3).contains(&turned_m), "{turned_m}");
    assert!((message.state.position_m.length() / as_written.length() - 1.0).abs() < 1e-12);
    let [burn, impulse] = message.maneuvers.as_slice() else {
        panic!("two manoeuvres");
    };
    assert_eq!(burn.duration, Duration::from_seconds(132.6));
    assert_eq!(
        (burn.axes, impulse.axes),
        (ThrustAxes::Gcrf, ThrustAxes::Radial)
    );
    assert_eq!(impulse.delta_v_m_s, DVec3::new(1.015, -1.873, 0.0));
    assert!(impulse.is_impulse() && !burn.is_impulse());
    assert!((burn.delta_v_m_s.length() - 30.067).abs() < 1e-3);
}

#[test]
fn elements_give_the_state_that_stands_beside_them() {
    let state = one(W4).state;
    let elements = without(&["X", "Y", "Z"]);
    // ν of M = 41.922339°.
    let by_true = elements.replace("MEAN_ANOMALY = 41.922339", "TRUE_ANOMALY = 43.549375");
    for (text, most_m) in [(&elements, 3.0), (&by_true, 30.0)] {
        let of_elements = one(text).state;
        let off_m = of_elements.position_m.distance(state.position_m);
        let off_m_s = of_elements.velocity_m_s.distance(state.velocity_m_s);
        assert!(off_m < most_m && off_m_s < 0.01, "{off_m} m, {off_m_s} m/s");
    }
    // Elements of another place are named, and the state is used.
    let printed = with("MEAN_ANOMALY", "TRUE_ANOMALY");
    let other = read(&printed, true).unwrap();
    assert!(other.faults[0].is_notice());
    let text = other.faults[0].to_string();
    assert!(text.starts_with("w4.opm:17:19: SEMI_MAJOR_AXIS"), "{text}");
    assert_eq!(other.messages[0].state, state);
}

#[test]
fn xml_says_the_same_as_kvn() {
    let value = |line: &str| -> Option<String> {
        let (key, rest) = line.split_once(" = ")?;
        let (value, unit) = match rest.split_once(" [") {
            Some((value, unit)) => (value, format!(" units=\"{}\"", unit.trim_end_matches(']'))),
            None => (rest, String::new()),
        };
        Some(format!("<{key}{unit}>{value}</{key}>"))
    };
    let mut xml = String::from(
        "<?xml version=\"1.0\"?>\n<ndm><opm id=\"CCSDS_OPM_VERS\" version=\"2.0\"><body><segment><data><stateVector>",
    );
    for line in W4.lines().skip(4) {
        if line.starts_with("MAN_EPOCH") {
            xml += "</stateVector><stateVector>";
        }
        xml += &value(line).unwrap();
    }
    xml += "</stateVector></data></segment></body></opm></ndm>";
    let (xml, kvn) = (one(&xml), one(W4));
    assert_eq!((xml.state, xml.craft), (kvn.state, kvn.craft));
    assert_eq!((&xml.maneuvers, &xml.name), (&kvn.maneuvers, &kvn.name));
}

#[test]
fn what_is_not_followed_is_named() {
    for (text, reported) in [
        (
            W4.to_owned() + "COV_REF_FRAME = RTN\nCX_X = 1e-3\nCY_X = 0\nCY_Y = 1e-3\n",
            "CX_X = 1e-3 is not followed",
        ),
        (
            without(&["MASS"]),
            "DRAG_AREA = 10.000 is not followed: drag needs MASS",
        ),
        (
            without(&["SOLAR_RAD_COEFF"]),
            "SOLAR_RAD_AREA = 10.000 is not followed",
        ),
        (
            with("X = 6655.9942", "X = 6655994.2"),
            "km from the Earth's centre",
        ),
        (
            with("TOD", "ITRF-97"),
            "SEMI_MAJOR_AXIS = 41399.5123 is not followed",
        ),
    ] {
        let text = text.replace(
            "3.11548208",
            if reported.contains("centre") {
                "3115.48"
            } else {
                "3.11548208"
            },
        );
        let read = read(&text, true).unwrap_or_else(|error| panic!("{error}"));
        let faults: Vec<_> = read.faults.iter().map(ToString::to_string).collect();
        assert!(
            faults.iter().any(|fault| fault.contains(reported)),
            "{reported}: {faults:?}"
        );
        assert!(read.faults.iter().all(OrbitError::is_notice));
    }
    assert_eq!(one(&without(&["MASS"])).craft.drag_area_m2, 0.0);
    // The last line may have lost digits.
    let open = low("").trim_end().to_owned();
    let cut = read(&open, false).unwrap();
    assert!(
        cut.faults[0].to_string().contains("truncated"),
        "{}",
        cut.faults[0]
    );
}

#[test]
fn frames_and_times_are_those_of_an_ephemeris_message() {
    let fixed = one(&without(&["SEMI"]).replace("TOD", "ITRF-97"));
    assert_eq!(fixed.state.frame, Frame::Itrf);
    let gps = one(&with("TIME_SYSTEM = UTC", "TIME_SYSTEM = GPS"));
    assert!(((start() - gps.state.epoch).to_seconds() - 14.0).abs() < 1e-9);
    assert!(read(&with("UTC\n", "TDB\n"), true).is_ok());
}

#[test]
fn errors_name_line_key_and_remedy() {
    let elements = without(&["X", "Y", "Z"]);
    for (text, reported) in [
        (
            with("= 2.0", "= 9.0"),
            "w4.opm:1:18: CCSDS_OPM_VERS = \"9.0\" cannot be used: versions 1 to 3",
        ),
        (
            with("TOD", "MARS_FIXED"),
            "w4.opm:8:13: REF_FRAME = \"MARS_FIXED\" cannot be used: known frames",
        ),
        (
            with("EARTH\nREF", "MOON\nREF"),
            "only orbits about the Earth are flown",
        ),
        (
            with("= UTC", "= UT2"),
            "w4.opm:9:15: TIME_SYSTEM = \"UT2\" cannot be used",
        ),
        (
            with("TOD", "TEME\nREF_FRAME_EPOCH = 2000-01-01T12:00:00"),
            "w4.opm:9:19: REF_FRAME_EPOCH",
        ),
        (
            without(&["Z_DOT"]),
            "the message without Z_DOT; a state has six numbers",
        ),
        (
            with("6655.9942", "6655,9942"),
            "w4.opm:11:5: X is \"6655,9942 [km]\"; expected a number",
        ),
        (
            with("X = 6655.9942 [km]", "X = 6655994.2 [m]"),
            "X is in \"m\"; the format requires km",
        ),
        (
            without(&["X", "Y", "Z", "SEMI"]),
            "w4.opm:1:18: the message without X; it needs a state",
        ),
        (
            without(&["X", "Y", "Z", "MEAN"]),
            "TRUE_ANOMALY or MEAN_ANOMALY",
        ),
        (
            elements.replace("TOD", "ITRF"),
            "do not rotate with the Earth",
        ),
        (
            elements.replace("0.020842611", "1.5"),
            "is inconsistent with eccentricity",
        ),
        (
            with("MAN_REF_FRAME = RTN", "MAN_REF_FRAME = LVLH"),
            "w4.opm:39:17: MAN_REF_FRAME = \"LVLH\" cannot be used: known frames of manoeuvres",
        ),
        (
            with("MAN_DURATION = 132.60", "MAN_DURATION = -1"),
            "w4.opm:30:16: MAN_DURATION",
        ),
        (
            with("= -18.418", "= 18.418"),
            "MAN_DELTA_MASS is \"18.418\"; expected kilograms, 0 or below",
        ),
        (without(&["MAN_DV_3"]), "the manoeuvre without MAN_DV_3"),
        (
            without(&["MAN_EPOCH"]),
            "MAN_EPOCH_IGNITION, with which a manoeuvre begins",
        ),
        (
            with("MASS = ", "MASS = 2\nMASS = "),
            "duplicate MASS; the first is in line 24",
        ),
        (
            with("ORIGINATOR = GSOC", "GSOC"),
            "w4.opm:4:1: \"GSOC\" is not allowed here; expected KEY = value",
        ),
        (with("2006-06-03T00", "2006-13-03T00"), "w4.opm:10:9: EPOCH"),
        (
            "CREATION_DATE = 2006-06-03\n".to_owned(),
            "contains no orbit parameter message",
        ),
        (
            "CCSDS_OCM_VERS = 3.0\n".to_owned(),
            "(OCM) is not read; export its trajectory as an OEM, or its state as an OPM",
        ),
    ] {
        for is_strict in [false, true] {
            let error = read(&text, is_strict).unwrap_err().to_string();
            assert!(error.contains(reported), "{reported}: {error}");
        }
    }
    // An impossible start is an error of the message, with its line.
    let deep = with("X = 6655.9942", "X = 1.0")
        .replace("-40218.5751", "2.0")
        .replace("-82.9177", "3.0");
    let deep = read(&without_elements(&deep), false).unwrap();
    let deep = Arc::new(deep.messages[0].clone());
    let error = deep.propagated(start(), start(), &Orientation::default());
    let error = error.unwrap_err().to_string();
    assert!(
        error.starts_with("w4.opm:1:18: at its epoch EUTELSAT W4 is")
            && error.contains("below the ground"),
        "{error}"
    );
    // Other readers identify it.
    let origin = Path::new("w4.opm");
    for error in [
        Ephemerides::from_text(W4, origin, false).unwrap_err(),
        Catalogue::from_text(W4, origin, false).unwrap_err(),
    ] {
        assert!(error.to_string().contains("source = \"opm\""), "{error}");
    }
}

fn without_elements(text: &str) -> String {
    let kept = text.lines().filter(|line| !line.starts_with("SEMI"));
    kept.map(|line| line.to_owned() + "\n").collect()
}

#[test]
fn a_faulty_message_costs_itself() {
    let other = W4
        .replace("EUTELSAT W4", "OTHER")
        .replace("2000-028A", "2001-001A");
    let bad = W4
        .replace("EUTELSAT W4", "BAD")
        .replace("X = 6655", "X = six");
    let text = format!("{W4}{bad}{other}");
    assert!(read(&text, true).unwrap_err().to_string().contains("X is"));
    let read = read(&text, false).unwrap();
    let origin = Path::new("w4.opm");
    assert_eq!((read.messages.len(), read.faults.len()), (2, 1));
    assert_eq!(read.one(origin, Some("other")).unwrap().name, "OTHER");
    for (name, reported) in [
        (None, "X is"),
        (
            Some("BAD"),
            "X is \"six.9942 [km]\"; expected a number; \"BAD\" has no other record",
        ),
        (
            Some("OTHE"),
            "no satellite \"OTHE\" among its 2; the nearest name is \"OTHER\"",
        ),
    ] {
        let error = read.one(origin, name).unwrap_err().to_string();
        assert!(error.contains(reported), "{error}");
    }
}

/// Wherever a file ends or holds a strange character, it is read or an error: nothing panics.
#[test]
fn files_may_end_anywhere() {
    for end in 0..W4.len() {
        for cut in [
            W4[..end].to_owned(),
            format!("{}\u{fffd}{}", &W4[..end], &W4[end..]),
            format!("<opm>{}", &W4[..end]),
        ] {
            if let Ok(read) = read(&cut, false) {
                assert!(!read.messages.is_empty());
            }
        }
    }
}
