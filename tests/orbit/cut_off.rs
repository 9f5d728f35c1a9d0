//! Files that end before their text does, and states that cannot be meant.

use std::path::Path;
use terrella_orbit::{Catalogue, Ephemerides};

const OEM: &str = "CCSDS_OEM_VERS = 2.0
CREATION_DATE = 2026-01-01T00:00:00
ORIGINATOR = TEST
META_START
OBJECT_NAME = SAT
OBJECT_ID = 2026-001A
CENTER_NAME = EARTH
REF_FRAME = EME2000
TIME_SYSTEM = UTC
START_TIME = 2026-01-01T00:00:00
STOP_TIME = 2026-01-01T00:03:00
META_STOP
";

/// A circle in the equator's plane, kilometres and kilometres per second.
fn rows(count: u32, separator: &str, scale: f64) -> Vec<String> {
    let (radius_km, speed_km_s) = (6878.0_f64, 7.6127_f64);
    (0..count)
        .map(|minute| {
            let angle = f64::from(60 * minute) * speed_km_s / radius_km;
            let (sin, cos) = angle.sin_cos();
            let state = [
                radius_km * cos,
                radius_km * sin,
                0.0,
                -speed_km_s * sin,
                speed_km_s * cos,
                0.125,
            ];
            let state = state.map(|number| format!("{:.6}", number * scale));
            format!(
                "2026-01-01T00:{minute:02}:00{separator}{}",
                state.join(separator)
            )
        })
        .collect()
}

fn oem(rows: &[String]) -> String {
    format!("{OEM}{}\n", rows.join("\n"))
}

fn csv(rows: &[String]) -> String {
    let header = "# frame = EME2000\nepoch_utc,x_km,y_km,z_km,vx_km_s,vy_km_s,vz_km_s";
    format!("{header}\n{}\n", rows.join("\n"))
}

fn read(text: &str, is_strict: bool) -> Result<Vec<String>, String> {
    let read = Ephemerides::from_text(text, Path::new("x"), is_strict);
    let reported = |read: Ephemerides| read.faults.iter().map(ToString::to_string).collect();
    read.map(reported).map_err(|error| error.to_string())
}

/// End of a file's validity, seconds after its start.
fn span_s(text: &str) -> f64 {
    let read = Ephemerides::from_text(text, Path::new("x"), false).expect("reads");
    let feed = read.feeds.first().expect("an object");
    let (first, last) = terrella_orbit::Feed::validity(feed);
    (last - first).to_seconds()
}

#[test]
fn whole_files_are_read_without_a_word() {
    for text in [oem(&rows(4, " ", 1.0)), csv(&rows(4, ",", 1.0))] {
        assert_eq!(read(&text, true), Ok(Vec::new()), "{text}");
    }
}

/// However many bytes of the last line are missing, the number that is left is not believed: what is flown ends a minute earlier.
#[test]
fn a_line_that_is_cut_within_is_left_out() {
    for text in [oem(&rows(4, " ", 1.0)), csv(&rows(4, ",", 1.0))] {
        for missing in 2..60 {
            let cut = &text[..text.len() - missing];
            let reported = read(cut, false).expect("the others are flown");
            assert!(reported[0].contains("truncated"), "{missing}: {reported:?}");
            assert!(span_s(cut) <= 120.0 + 1e-9, "{missing}");
            let error = read(cut, true).expect_err("strict");
            assert!(error.contains("truncated"), "{error}");
        }
    }
}

/// Many programs leave out the last line feed: the state is used, with a notice, and `strict` requires the line feed.
#[test]
fn a_whole_line_without_its_line_feed_is_used_and_noticed() {
    for text in [oem(&rows(4, " ", 1.0)), csv(&rows(4, ",", 1.0))] {
        let text = text.trim_end();
        let reported = read(text, false).expect("flown");
        assert_eq!(reported.len(), 1, "{reported:?}");
        assert!(reported[0].contains("may be truncated"), "{reported:?}");
        assert!((span_s(text) - 180.0).abs() < 1e-9);
        let error = read(text, true).expect_err("strict");
        assert!(error.contains("line feed"), "{error}");
    }
}

/// STOP_TIME is three minutes after the start, and whole lines are missing.
#[test]
fn states_that_end_before_their_stop_time_are_noticed() {
    let text = oem(&rows(3, " ", 1.0));
    let reported = read(&text, false).expect("flown");
    assert!(
        reported[0].starts_with("x:15:1: the file is truncated"),
        "{reported:?}"
    );
    assert!(
        reported[0].contains("STOP_TIME = 2026-01-01T00:03:00"),
        "{reported:?}"
    );
    assert!(read(&text, true).is_err());
}

#[test]
fn metres_for_kilometres_and_states_below_the_ground_are_noticed() {
    for (scale, words) in [
        (1000.0, "metres may have been taken for kilometres"),
        (0.001, "below the WGS84 ellipsoid"),
    ] {
        for text in [oem(&rows(4, " ", scale)), csv(&rows(4, ",", scale))] {
            let reported = read(&text, false).expect("flown");
            assert!(
                reported.iter().any(|reported| reported.contains(words)),
                "{reported:?}"
            );
            // The file's format is valid, so strict reading gives the same result.
            assert_eq!(read(&text, true), Ok(reported));
        }
    }
}

/// A loss in the last number of a mean-elements message is undetectable, so its missing line feed is reported.
#[test]
fn elements_without_their_last_line_feed_are_noticed() {
    let text = "CCSDS_OMM_VERS = 2.0\nCREATION_DATE = 2026-01-01T00:00:00\nORIGINATOR = TEST\nOBJECT_NAME = SAT\nOBJECT_ID = 2026-001A\nCENTER_NAME = EARTH\nREF_FRAME = TEME\nTIME_SYSTEM = UTC\nMEAN_ELEMENT_THEORY = SGP4\nEPOCH = 2026-01-01T00:00:00\nMEAN_MOTION = 15.5\nECCENTRICITY = 0.001\nINCLINATION = 51.6\nRA_OF_ASC_NODE = 10\nARG_OF_PERICENTER = 20\nMEAN_ANOMALY = 30\nBSTAR = 0.0001\nMEAN_MOTION_DOT = 0.00001\nMEAN_MOTION_DDOT = 0.0\n";
    let read = |text: &str, is_strict| Catalogue::from_text(text, Path::new("x"), is_strict);
    assert!(read(text, true).expect("whole").faults.is_empty());
    let cut = text.trim_end();
    let reported = read(cut, false).expect("flown").faults;
    assert!(
        reported[0].to_string().contains("may be truncated"),
        "{reported:?}"
    );
    assert!(read(cut, true).is_err());
}
