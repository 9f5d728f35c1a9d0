//! The verification cases of AIAA 2006-6753, "Revisiting Spacetrack Report #3": 33 element sets and the reference
//! code's positions and velocities.
//!
//! The file of sets carries start, stop and step in minutes after column 69 of line 2, and some sets are made up and
//! have no valid checksum; the test takes the former off and mends the latter.

use crate::{from_text, with_checksum};
use glam::DVec3;
use terrella_frames::Duration;
use terrella_orbit::{Feed, OrbitError, OrbitState, TleFeed};

const SETS: &str = include_str!("../data/orbit/SGP4-VER.TLE");
const REFERENCE: &str = include_str!("../data/orbit/tcppver.out");

struct Case {
    satellite: String,
    lines: [String; 2],
    /// Start, stop and step, minutes.
    times: [f64; 3],
    rows: Vec<Row>,
}

struct Row {
    minutes: f64,
    position_km: DVec3,
    velocity_km_s: DVec3,
}

fn cases() -> Vec<Case> {
    let numbers = |text: &str| -> Vec<f64> {
        let words = text.split_whitespace().take(7);
        words.map(|word| word.parse().unwrap()).collect()
    };
    let mut cases = Vec::new();
    let mut line1 = "";
    for line in SETS.lines() {
        if line.starts_with("1 ") {
            line1 = line.trim_end();
        } else if line.starts_with("2 ") {
            let (line2, times) = line.split_at(69);
            cases.push(Case {
                satellite: String::new(),
                lines: [line1, line2].map(with_checksum),
                times: numbers(times).try_into().unwrap(),
                rows: Vec::new(),
            });
        }
    }
    let mut case = 0;
    for line in REFERENCE.lines() {
        if let Some(satellite) = line.strip_suffix(" xx") {
            case += 1;
            cases[case - 1].satellite = satellite.to_owned();
        } else {
            let n = numbers(line);
            cases[case - 1].rows.push(Row {
                minutes: n[0],
                position_km: DVec3::new(n[1], n[2], n[3]),
                velocity_km_s: DVec3::new(n[4], n[5], n[6]),
            });
        }
    }
    assert_eq!((cases.len(), case), (33, 33));
    cases
}

fn fly(feed: &TleFeed, minutes: f64) -> Result<OrbitState, OrbitError> {
    feed.state_at(feed.epoch() + Duration::from_seconds(minutes * 60.0))
}

#[test]
fn positions_and_velocities_are_the_reference_codes() {
    let (mut compared, mut worst_km, mut worst_km_s) = (0, 0.0_f64, 0.0_f64);
    for case in cases() {
        let satellite = &case.satellite;
        if satellite == "33334" {
            continue; // fails before its first row: below
        }
        let feed = from_text(&case.lines.join("\n"), None).unwrap();
        let (mut case_km, mut case_km_s) = (0.0_f64, 0.0_f64);
        for row in &case.rows {
            // 23599 crosses node 0 at 410 minutes, where the two modes of the reference code part; its file was
            // written in the other one. See below.
            if satellite == "23599" && row.minutes > 410.0 {
                continue;
            }
            // 20413 again, 1281 days later: outside a feed's validity. See below.
            if row.minutes > 1e6 {
                continue;
            }
            let state = fly(&feed, row.minutes).unwrap();
            case_km = case_km.max(state.position_m.distance(row.position_km * 1e3) / 1e3);
            case_km_s = case_km_s.max(state.velocity_m_s.distance(row.velocity_km_s * 1e3) / 1e3);
            compared += 1;
        }
        println!("{satellite:>6}: {case_km:.1e} km, {case_km_s:.1e} km/s");
        assert!(case_km < 1e-6, "{satellite}: {case_km} km");
        assert!(case_km_s < 1e-8, "{satellite}: {case_km_s} km/s");
        worst_km = worst_km.max(case_km);
        worst_km_s = worst_km_s.max(case_km_s);
    }
    println!("{compared} states; worst {worst_km:.1e} km, {worst_km_s:.1e} km/s");
    let all: usize = cases().iter().map(|c| c.rows.len()).sum();
    // Left out: 16 rows of 23599, 69 of the far 20413, one stale row of 33334.
    assert_eq!(compared, all - 16 - 69 - 1);
}

/// The reference output for 23599 was written in the reference code's "improved" mode. In its AFSPC mode, which
/// distributed elements are made for, an angle in the Lyddane terms is taken from 0 to 2π instead of −π to π, so
/// positions jump by 0.96 km at the node of 410 minutes. These rows are the reference code's (C++, as packaged for
/// Python in sgp4 2.27) with `opsmode = 'a'`.
#[test]
fn afspc_mode_is_the_reference_codes_where_the_modes_differ() {
    let case = cases()
        .into_iter()
        .find(|c| c.satellite == "23599")
        .unwrap();
    let feed = from_text(&case.lines.join("\n"), None).unwrap();
    for (minutes, x, y, z) in [
        (
            400.0,
            7_008.514_702_632_767,
            20_725.474_712_268_38,
            2_520.560_642_887_537,
        ),
        (
            420.0,
            4_083.185_511_798_364_6,
            22_910.883_068_023_188,
            2_786.356_426_599_174,
        ),
        (
            720.0,
            7_141.247_425_264_598,
            20_538.971_151_583_6,
            2_501.180_599_656_911,
        ),
    ] {
        let state = fly(&feed, minutes).unwrap();
        let off_km = state.position_m.distance(DVec3::new(x, y, z) * 1e3) / 1e3;
        println!("{minutes} min: {off_km:.1e} km");
        assert!(off_km < 1e-6);
    }
    let row = case.rows.iter().find(|row| row.minutes == 480.0).unwrap();
    let between_modes_km = fly(&feed, 480.0)
        .unwrap()
        .position_m
        .distance(row.position_km * 1e3)
        / 1e3;
    assert!((0.9..1.0).contains(&between_modes_km), "{between_modes_km}");
}

/// 20413 from 1 844 000 minutes: a feed rejects, and the propagator below it still agrees.
#[test]
fn far_from_its_epoch_the_feed_rejects_and_the_propagator_agrees() {
    let case = cases().pop().unwrap();
    assert_eq!(case.satellite, "20413");
    let [line1, line2] = &case.lines;
    let feed = from_text(&case.lines.join("\n"), None).unwrap();
    let elements = sgp4::Elements::from_tle(None, line1.as_bytes(), line2.as_bytes()).unwrap();
    let constants = sgp4::Constants::from_elements_afspc_compatibility_mode(&elements).unwrap();
    let mut worst_km = 0.0_f64;
    for row in &case.rows[1..] {
        assert!(matches!(
            fly(&feed, row.minutes),
            Err(OrbitError::OutsideValidity { .. })
        ));
        let minutes = sgp4::MinutesSinceEpoch(row.minutes);
        let state = constants
            .propagate_afspc_compatibility_mode(minutes)
            .unwrap();
        worst_km = worst_km.max(row.position_km.distance(DVec3::from(state.position)));
    }
    println!("1281 days on: {worst_km:.1e} km");
    assert!(worst_km < 1e-6);
}

/// Where the reference code's rows end before its stop time, it met an error at the next step; so must we, and with the
/// same cause.
#[test]
fn errors_come_at_the_reference_codes_times() {
    let mut met = Vec::new();
    for case in cases() {
        let [_, stop, step] = case.times;
        let last = case.rows.last().unwrap().minutes;
        if last + step > stop || case.satellite == "33334" || last > 1e6 {
            continue;
        }
        let feed = from_text(&case.lines.join("\n"), None).unwrap();
        let error = fly(&feed, last + step).expect_err(&case.satellite);
        let kind = match &error {
            OrbitError::Decayed { .. } => "decayed",
            OrbitError::Sgp4 { cause, .. } if cause.contains("before adding third-body") => {
                "eccentricity"
            }
            OrbitError::Sgp4 { cause, .. } if cause.contains("after adding third-body") => {
                "perturbed eccentricity"
            }
            OrbitError::Sgp4 { cause, .. } if cause.contains("semi-latus rectum") => {
                "semi-latus rectum"
            }
            other => panic!("{other}"),
        };
        let text = error.to_string();
        assert!(
            text.contains(feed.name()) && text.starts_with("sets.tle:1: "),
            "{text}"
        );
        met.push((case.satellite.clone(), last + step, kind));
    }
    let met: Vec<_> = met
        .iter()
        .map(|(s, t, k)| (s.as_str(), t.round(), *k))
        .collect();
    assert_eq!(
        met,
        [
            ("22312", 494.0, "eccentricity"),
            ("28350", 1560.0, "eccentricity"),
            ("28872", 55.0, "decayed"),
            ("29141", 440.0, "decayed"),
            ("33333", 25.0, "semi-latus rectum"),
        ]
    );
}

/// 33334 is synthetic, with a mean motion of 1e-5 a day. The reference code reports an error immediately and prints the row of the case before it.
#[test]
fn a_set_that_fails_at_its_own_epoch_is_rejected_when_read() {
    let all = cases();
    let at = all.iter().position(|c| c.satellite == "33334").unwrap();
    assert_eq!(all[at].rows.len(), 1);
    assert_eq!(
        all[at].rows[0].position_km,
        all[at - 1].rows.last().unwrap().position_km
    );
    let error = from_text(&all[at].lines.join("\n"), None).unwrap_err();
    println!("{error}");
    assert!(matches!(error, OrbitError::Sgp4 { .. }), "{error:?}");
}
