//! Orbit ephemeris messages as other programs write them: axes and times of date, old line ends, one state a revolution.

use crate::oem::{HEADER, epoch, every_minute, kvn, meta, one, read, rows, xml};
use glam::DVec3;
use std::path::Path;
use terrella_frames::TimeScale;
use terrella_orbit::interpolated::KeplerOrbit;
use terrella_orbit::{Ephemerides, Feed, Frame};

/// A message of two fixed states.
fn of_position(frame: &str, system: &str, date: &str, km: [f64; 3]) -> String {
    let [x, y, z] = km;
    let state = |date: &str| format!("{date} {x} {y} {z} 0 0 0\n");
    let (first, last) = (format!("{date}.386009"), format!("{date}.986009"));
    format!(
        "{HEADER}META_START\nOBJECT_NAME = A\nOBJECT_ID = 2004-001A\nCENTER_NAME = EARTH\nREF_FRAME = {frame}\n\
         TIME_SYSTEM = {system}\nSTART_TIME = {first}\nSTOP_TIME = {last}\nINTERPOLATION = LINEAR\nMETA_STOP\n{}{}",
        state(&first),
        state(&last)
    )
}

/// Vallado, Fundamentals of Astrodynamics and Applications (2013), example 3-15: one place in the axes of its date and in GCRF.
#[test]
fn axes_of_date_are_turned_as_published() {
    let gcrf_m = DVec3::new(5_102_508.957_9, 6_123_011.400_7, 6_378_136.928_2);
    for (frame, km) in [
        ("TOD", [5_094.514_780_4, 6_127.366_461_2, 6_380.344_532_8]),
        ("MOD", [5_094.028_374_5, 6_127.870_816_4, 6_380.248_516_4]),
        ("TEME", [5_094.180_162_1, 6_127.644_659_7, 6_380.344_532_7]),
    ] {
        let feed = one(&of_position(frame, "UTC", "2004-04-06T07:51:28", km));
        let state = feed.state_at(feed.validity().0).unwrap();
        let read = state.in_frame(Frame::Gcrf, &Default::default());
        let off_m = read.position_m.distance(gcrf_m);
        println!("{frame}: {off_m:.2} m");
        assert!(off_m < 10.0, "{frame}: {off_m}");
    }
}

#[test]
fn barycentric_times_are_a_millisecond_from_terrestrial_ones() {
    let km = [7000.0, 0.0, 0.0];
    let at = |system| {
        one(&of_position("GCRF", system, "2018-04-04T00:00:00", km))
            .validity()
            .0
    };
    let apart_s = (at("TT") - at("TDB")).to_seconds();
    assert!((apart_s - 0.001_65).abs() < 5e-5, "{apart_s}");
}

#[test]
fn a_date_of_the_frame_that_says_nothing_is_read() {
    let dated = |frame: &str, form: fn(&crate::oem::Meta<'_>, &[f64]) -> String| {
        let text = form(
            &meta(TimeScale::Utc, 0.0, 600.0).with("REF_FRAME", frame),
            &every_minute(0, 10),
        );
        let (kvn_end, xml_end) = (
            format!("REF_FRAME = {frame}\n"),
            format!("<REF_FRAME>{frame}</REF_FRAME>\n"),
        );
        text.replace(
            &kvn_end,
            &format!("{kvn_end}REF_FRAME_EPOCH = 2000-01-01T12:00:00\n"),
        )
        .replace(
            &xml_end,
            &format!("{xml_end}<REF_FRAME_EPOCH>2000-01-01T12:00:00</REF_FRAME_EPOCH>\n"),
        )
    };
    for form in [kvn, xml] {
        for frame in ["EME2000", "GCRF", "ICRF", "ITRF2014", "GTOD"] {
            let text = dated(frame, form);
            assert!(text.contains("REF_FRAME_EPOCH"));
            assert_eq!(one(&text).validity(), (epoch(0.0), epoch(600.0)), "{frame}");
        }
        for frame in ["TEME", "TOD", "MOD"] {
            let error = read(&dated(frame, form)).unwrap_err().to_string();
            assert!(error.contains("axes of a fixed date"), "{frame}: {error}");
        }
    }
}

#[test]
fn old_line_ends_are_read() {
    let text = kvn(&meta(TimeScale::Utc, 0.0, 600.0), &every_minute(0, 10));
    let old = one(&text.replace('\n', "\r"));
    let new = one(&text);
    let at = epoch(99.0);
    assert_eq!(old.state_at(at).unwrap(), new.state_at(at).unwrap());
    // Lines are counted.
    let wrong = text.replace("EARTH", "MOON").replace('\n', "\r");
    let error = read(&wrong).unwrap_err().to_string();
    assert!(error.starts_with("sat.oem:8:15: "), "{error}");
}

/// Hermite's polynomial of degree 1 passes from state to state, however far they are apart.
#[test]
fn a_low_degree_makes_no_jumps() {
    for degree in ["1", "2", "3"] {
        let half_hours = [0.0, 1800.0, 3600.0, 5400.0];
        let meta = meta(TimeScale::Utc, 0.0, 5400.0).with("INTERPOLATION_DEGREE", degree);
        let feed = one(&kvn(&meta, &half_hours));
        let mut before: Option<DVec3> = None;
        for second in 0..5400 {
            let here = feed.state_at(epoch(f64::from(second))).unwrap().position_m;
            // Half an hour is far too long for a cubic, but it has no steps.
            assert!(
                before.is_none_or(|before| before.distance(here) < 20e3),
                "{degree} {second}"
            );
            before = Some(here);
        }
        for t_s in half_hours {
            let state = feed.state_at(epoch(t_s)).unwrap();
            assert!(state.position_m.distance(KeplerOrbit::LOW.state(t_s).0) < 1e-3);
        }
    }
}

#[test]
fn gaps_between_segments_are_known() {
    let segment = |from: u32, to: u32| {
        let (from_s, to_s) = (f64::from(from) * 60.0, f64::from(to) * 60.0);
        let meta = meta(TimeScale::Utc, from_s, to_s);
        meta.kvn() + &rows(&every_minute(from, to), TimeScale::Utc)
    };
    let feed = one(&format!(
        "{HEADER}{}{}{}",
        segment(0, 10),
        segment(12, 20),
        segment(20, 30)
    ));
    assert_eq!(feed.gaps(), [(epoch(600.0), epoch(720.0))]);
    let error = feed.state_at(epoch(660.0)).unwrap_err().to_string();
    assert!(error.contains("and again from"), "{error}");
}

/// A state that comes twice does no harm, and segments that overlap do: the overlap is named.
#[test]
fn the_fault_that_corrupts_the_message_is_named() {
    let segment = |times: &[f64]| {
        let (from, to) = (times[0], times[times.len() - 1]);
        meta(TimeScale::Utc, from, to).kvn() + &rows(times, TimeScale::Utc)
    };
    let text = format!(
        "{HEADER}{}{}",
        segment(&[0.0, 60.0, 60.0, 120.0, 180.0, 240.0, 300.0]),
        segment(&[240.0, 300.0, 360.0, 420.0])
    );
    for is_strict in [false, true] {
        let read = Ephemerides::from_text(&text, Path::new("sat.oem"), is_strict);
        let error = read.unwrap_err().to_string();
        assert!(
            error.starts_with("sat.oem:23:1: the segment begins at"),
            "{is_strict}: {error}"
        );
    }
}
