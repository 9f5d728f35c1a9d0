//! SP3 in its versions, with gaps, manoeuvres and errors.

use crate::utc;
use glam::DVec3;
use std::path::Path;
use terrella_frames::{Duration, Epoch};
use terrella_orbit::interpolated::KeplerOrbit;
use terrella_orbit::{Ephemerides, EphemerisFeed, Feed, FileFormat, Frame, OrbitError};

fn read(text: &str, is_strict: bool) -> Result<Ephemerides, OrbitError> {
    Ephemerides::from_text(text, Path::new("igs.sp3"), is_strict)
}

/// A navigation satellite's orbit, seen from axes that do not turn: the reader does not look at that.
const ORBIT: KeplerOrbit = KeplerOrbit {
    semi_major_axis_m: 26_560_000.0,
    eccentricity: 0.01,
};

const STEP_S: f64 = 900.0;

/// The lines of an epoch with satellites, positions and, in `V` files, velocities.
fn at(step: usize, satellites: &[&str], has_velocities: bool) -> String {
    let minute = step * 15;
    let mut text = format!(
        "*  2020  6 24 {:>2} {:>2}  0.00000000\n",
        minute / 60,
        minute % 60
    );
    let (r, v) = ORBIT.state(step as f64 * STEP_S);
    for id in satellites {
        let [x, y, z] = (r / 1e3).to_array();
        text += &format!("P{id}{x:14.6}{y:14.6}{z:14.6}    189.163300 18 18 18 219\n");
        if has_velocities {
            let [x, y, z] = (v * 10.0).to_array();
            text += &format!("V{id}{x:14.6}{y:14.6}{z:14.6}     -4.534317 14 14 14 191\n");
        }
    }
    text
}

fn header(version: char, content: char, system: &str) -> String {
    format!(
        "#{version}{content}2020  6 24  0  0  0.00000000      20 ORBIT IGS14 HLM  IGS\n\
         ## 2111 259200.00000000   900.00000000 59024 0.0000000000000\n\
         +    2   G01R24  0  0\n++         7  8  0  0\n\
         %c M  cc {system} ccc cccc cccc cccc cccc ccccc ccccc ccccc ccccc\n\
         %c cc cc ccc ccc cccc cccc cccc cccc ccccc ccccc ccccc ccccc\n\
         %f  1.2500000  1.025000000  0.00000000000  0.000000000000000\n%i    0    0\n/* A COMMENT\n"
    )
}

fn whole(
    header: &str,
    steps: std::ops::Range<usize>,
    ids: &[&str],
    has_velocities: bool,
) -> String {
    let epochs: String = steps.map(|step| at(step, ids, has_velocities)).collect();
    format!("{header}{epochs}EOF\n")
}

fn start() -> Epoch {
    // 24 June 2020, 0 h of GPS, 18 s ahead of UTC.
    utc("2020-06-23T23:59:42Z")
}

fn worst_m(feed: &EphemerisFeed, steps: std::ops::Range<usize>) -> f64 {
    let mut worst = 0.0_f64;
    for tenth in steps.start * 10..(steps.end - 1) * 10 {
        let t_s = tenth as f64 * STEP_S / 10.0;
        let state = feed
            .state_at(start() + Duration::from_seconds(t_s))
            .unwrap();
        assert_eq!(state.frame, Frame::Itrf);
        worst = worst.max(state.position_m.distance(ORBIT.state(t_s).0));
    }
    worst
}

#[test]
fn all_versions_are_read() {
    for (version, id, name) in [
        ('a', "  1", "G01"),
        ('c', "R24", "R24"),
        ('d', "L 7", "L07"),
        ('b', "G01", "G01"),
    ] {
        for (content, has_velocities) in [('P', false), ('V', true)] {
            let text = whole(
                &header(version, content, "GPS"),
                0..20,
                &[id, "E11"],
                has_velocities,
            );
            assert_eq!(FileFormat::of_text(&text), Some(FileFormat::Sp3));
            let read = read(&text, true).unwrap();
            assert_eq!((read.format, read.faults.len()), (FileFormat::Sp3, 0));
            let names: Vec<_> = read.feeds.iter().map(Feed::name).collect();
            assert_eq!(names, [name, "E11"]);
            let feed = read.into_one(Path::new("igs.sp3"), Some(name)).unwrap();
            let span = feed.validity();
            assert_eq!(
                (span.0, (span.1 - span.0).to_seconds()),
                (start(), 19.0 * STEP_S)
            );
            let worst = worst_m(&feed, 5..15);
            println!("{version}{content}: {worst:.1e} m");
            assert!(worst < 0.05, "{version}{content}: {worst}");
        }
    }
    let velocities = whole(&header('c', 'V', "GPS"), 0..8, &["G01"], true);
    let state = read(&velocities, true).unwrap().feeds[0]
        .state_at(start())
        .unwrap();
    assert!(state.velocity_m_s.distance(ORBIT.state(0.0).1) < 1e-6);
}

#[test]
fn time_systems_are_followed() {
    for (system, ahead_of_utc_s) in [
        ("GPS", 18.0),
        ("GAL", 18.0),
        ("BDT", 4.0),
        ("GLO", 0.0),
        ("UTC", 0.0),
        ("TAI", 37.0),
        ("ccc", 18.0),
    ] {
        let text = whole(&header('d', 'P', system), 0..12, &["G01"], false);
        let first = read(&text, true).unwrap().feeds[0].validity().0;
        let wanted = utc("2020-06-24T00:00:00Z") - Duration::from_seconds(ahead_of_utc_s);
        assert_eq!(first, wanted, "{system}");
    }
    let error = read(
        &whole(&header('d', 'P', "XYZ"), 0..2, &["G01"], false),
        false,
    )
    .unwrap_err();
    let error = error.to_string();
    assert!(
        error.starts_with("igs.sp3:5:1: the time system = \"XYZ\""),
        "{error}"
    );
}

/// Frames are named as Orekit's `IGSUtils` names them.
#[test]
fn inertial_frames_are_known_by_their_names() {
    let plain = header('d', 'P', "GPS");
    let framed = |name: &str| whole(&plain.replace("IGS14", name), 0..3, &["G01"], false);
    for (name, frame) in [
        ("IGS14", Frame::Itrf),
        ("ITR97", Frame::Itrf),
        ("     ", Frame::Itrf),
        ("WGS84", Frame::Itrf),
        ("GCRF ", Frame::Gcrf),
        ("EME00", Frame::Eme2000),
        ("EME2K", Frame::Eme2000),
        ("J2000", Frame::Eme2000),
        ("TEME ", Frame::Teme),
    ] {
        let feed = read(&framed(name), true).unwrap().feeds.remove(0);
        let state = feed.state_at(start()).unwrap();
        assert_eq!(state.frame, frame, "{name}");
        assert!(state.position_m.distance(ORBIT.state(0.0).0) < 1e-3);
    }
    let error = read(&framed("ECI  "), false).unwrap_err().to_string();
    assert!(
        error.starts_with("igs.sp3:1:1: the frame = \"ECI\" cannot be used"),
        "{error}"
    );
}

#[test]
fn zeros_and_manoeuvres_end_a_run() {
    let ids = ["G01", "G02"];
    let text = whole(&header('c', 'P', "GPS"), 0..30, &ids, false);
    let (r, _) = ORBIT.state(12.0 * STEP_S);
    let line = format!("PG01{:14.6}{:14.6}{:14.6}", r.x / 1e3, r.y / 1e3, r.z / 1e3);
    assert!(text.contains(&line));
    let absent = text.replacen(
        &line,
        &format!("PG01{:14.6}{:14.6}{:14.6}", 0.0, 0.0, 0.0),
        1,
    );
    let all = read(&absent, true).unwrap();
    let step = |k: f64| start() + Duration::from_seconds(k * STEP_S);
    assert_eq!(all.feeds[0].gaps(), [(step(11.0), step(13.0))]);
    assert!(all.feeds[1].gaps().is_empty());
    assert!(all.feeds[0].state_at(step(12.0)).is_err());
    // An M in column 79: an engine has fired since the epoch before.
    let whole_line = text.lines().find(|one| one.starts_with(&line)).unwrap();
    let flagged = format!("{whole_line:<78}M");
    let moved = read(&text.replacen(whole_line, &flagged, 1), true).unwrap();
    assert_eq!(moved.feeds[0].gaps(), [(step(11.0), step(12.0))]);
}

#[test]
fn wrong_files_are_named() {
    let good = whole(&header('c', 'P', "GPS"), 0..12, &["G01"], false);
    let second = good
        .lines()
        .position(|line| line.starts_with("*  2020  6 24  0 15"))
        .unwrap()
        + 1;
    for (from, to, line, says) in [
        ("#cP", "#zP", 1, "versions a to d are read"),
        ("/* A", "!! A", 9, "a line of SP3"),
        (
            "*  2020  6 24  0 15",
            "*  2020 16 24  0 15",
            second,
            "month 16",
        ),
        (
            "*  2020  6 24  0 15  0.00000000",
            "*  2020  6 24",
            second,
            "hour, minute and second",
        ),
        (
            "*  2020  6 24  0  0  0.00000000\n",
            "",
            10,
            "the epoch before it",
        ),
        ("EOF\n", "", second + 21, "is not closed"),
    ] {
        assert!(good.contains(from), "{from}");
        let error = read(&good.replacen(from, to, 1), true)
            .unwrap_err()
            .to_string();
        assert!(
            error.starts_with(&format!("igs.sp3:{line}:1: ")) && error.contains(says),
            "{from}: {error}"
        );
    }
    // A wrong number costs its state, and the line is reported.
    let line = good.lines().find(|line| line.starts_with("PG01")).unwrap();
    let wrong = good.replacen(line, &format!("PG01      here{}", &line[18..]), 1);
    let some = read(&wrong, false).unwrap();
    assert_eq!((some.feeds.len(), some.faults.len()), (1, 1));
    let fault = some.faults[0].to_string();
    assert!(fault.starts_with("igs.sp3:11:1: x is \"here\""), "{fault}");
    let samples: usize = some.feeds[0]
        .segments()
        .iter()
        .map(|s| s.samples.len())
        .sum();
    assert_eq!(samples, 11);
    // Short lines and letters of several bytes.
    let cut = read(&good.replacen(line, "PG01 1.0 2é", 1), false).unwrap();
    assert!(cut.faults[0].to_string().contains("columns 5 to 46"));
    assert!(read("#cP2020 é\nPé\n*\n", false).is_err());
    assert_ne!(
        DVec3::ZERO,
        some.feeds[0]
            .state_at(some.feeds[0].validity().0)
            .unwrap()
            .position_m
    );
}

/// Wherever a file ends or holds a strange character, it is read or an error: nothing panics.
#[test]
fn files_may_end_anywhere() {
    let text = whole(&header('c', 'V', "GPS"), 0..3, &["G01"], true);
    for end in 0..text.len() {
        for cut in [
            text[..end].to_owned(),
            format!("{}é{}", &text[..end], &text[end..]),
        ] {
            if let Ok(read) = read(&cut, false) {
                assert!(
                    read.feeds
                        .iter()
                        .all(|feed| feed.validity().0 <= feed.validity().1)
                );
            }
        }
    }
}
