//! Ephemerides of STK.

use crate::utc;
use std::path::Path;
use terrella_frames::{Duration, Epoch};
use terrella_orbit::interpolated::{Interpolation, KeplerOrbit};
use terrella_orbit::{Catalogue, Ephemerides, Feed, FileFormat, Frame, OrbitError};

fn read(text: &str) -> Result<Ephemerides, OrbitError> {
    Ephemerides::from_text(text, Path::new("folder/Sat1.e"), true)
}

fn start() -> Epoch {
    utc("2004-06-01T12:00:00Z")
}

/// Rows a minute apart of the low orbit, in units of so many metres.
fn rows(minutes: std::ops::RangeInclusive<i32>, metres: f64, has_velocities: bool) -> String {
    minutes
        .map(|minute| {
            let s = f64::from(minute) * 60.0;
            let (r, v) = KeplerOrbit::LOW.state(s);
            let (r, v) = (r / metres, v / metres);
            let mut row = format!("{s:e} {} {} {}", r.x, r.y, r.z);
            if has_velocities {
                row += &format!(" {} {} {}", v.x, v.y, v.z);
            }
            row + "\n"
        })
        .collect()
}

fn file(header: &str, form: &str, rows: &str) -> String {
    format!(
        "stk.v.11.0\n\n# WrittenBy    NOBODY\nBEGIN Ephemeris\n\nNumberOfEphemerisPoints 21\n\
         ScenarioEpoch            1 Jun 2004 12:00:00.000000000\n{header}\n{form}\n\n{rows}\nEND Ephemeris\n"
    )
}

const J2000_KM: &str = "InterpolationMethod Hermite\nInterpolationSamplesM1 3\nCentralBody Earth\n\
    CoordinateSystem J2000\nDistanceUnit Kilometers\n";

#[test]
fn inertial_and_fixed_states_are_read() {
    for (header, form, metres, has_velocities, frame, interpolation, most_m) in [
        (
            J2000_KM,
            "EphemerisTimePosVel",
            1e3,
            true,
            Frame::Eme2000,
            Interpolation::Hermite { degree: 7 },
            1e-4,
        ),
        (
            "CoordinateSystem ICRF\nInterpolationMethod Lagrange\nInterpolationOrder 5\n",
            "ephemeristimepos",
            1.0,
            false,
            Frame::Gcrf,
            Interpolation::Lagrange { degree: 5 },
            0.1,
        ),
        // Metres and axes fixed in the Earth are what is meant where nothing is said.
        (
            "",
            "EphemerisTimePos",
            1.0,
            false,
            Frame::Itrf,
            Interpolation::WITHOUT_VELOCITIES,
            1e-3,
        ),
        (
            "CoordinateSystem Fixed\nDISTANCEUNIT feet\n",
            "EphemerisTimePosVel",
            0.3048,
            true,
            Frame::Itrf,
            Interpolation::WITH_VELOCITIES,
            1e-4,
        ),
    ] {
        let text = file(header, form, &rows(0..=20, metres, has_velocities));
        assert_eq!(FileFormat::of_text(&text), Some(FileFormat::Stk));
        let read = read(&text).unwrap_or_else(|e| panic!("{e}\n{text}"));
        assert_eq!(
            (read.format, read.faults.len(), read.feeds.len()),
            (FileFormat::Stk, 0, 1)
        );
        let feed = &read.feeds[0];
        assert_eq!((feed.name(), feed.segments().len()), ("Sat1", 1));
        assert_eq!(feed.segments()[0].samples.interpolation(), interpolation);
        assert_eq!(
            feed.validity(),
            (start(), start() + Duration::from_seconds(1200.0))
        );
        for s in [0.0, 305.0, 600.0, 891.0] {
            let state = feed.state_at(start() + Duration::from_seconds(s)).unwrap();
            let off_m = state.position_m.distance(KeplerOrbit::LOW.state(s).0);
            assert!(
                state.frame == frame && off_m < most_m,
                "{header} {s}: {off_m}"
            );
        }
    }
}

#[test]
fn times_are_seconds_or_the_file_is_rejected() {
    let states = rows(0..=20, 1.0, true);
    let with = |header: &str| file(header, "EphemerisTimePosVel", &states);
    let seconds = read(&with("TimeFormat EpSec")).unwrap().feeds.remove(0);
    assert_eq!(seconds.validity().0, start());
    for format in ["EpMin", "\"EpDay\"", "ISO-YMD"] {
        let error = read(&with(&format!("TimeFormat {format}"))).unwrap_err();
        let error = error.to_string();
        assert!(
            error.contains("TimeFormat = ") && error.contains("export them as EpSec"),
            "{error}"
        );
    }
    let one_digit = with("").replace("12:00:00.000000000", "9:30:00");
    let first = read(&one_digit).unwrap().feeds.remove(0).validity().0;
    assert_eq!(first, utc("2004-06-01T09:30:00Z"));
}

#[test]
fn segments_meet_where_the_motion_jumps() {
    // A time that comes twice.
    let twice = rows(0..=10, 1e3, true) + &rows(10..=20, 1e3, true);
    let feed = read(&file(J2000_KM, "EphemerisTimePosVel", &twice))
        .unwrap()
        .feeds
        .remove(0);
    assert_eq!((feed.segments().len(), feed.gaps().len()), (2, 0));
    // Boundaries that are listed, at the ends as well, whether the state at them comes twice or not.
    let listed = format!(
        "{J2000_KM}BEGIN SegmentBoundaryTimes\n 1200.0 0.0\n 600.0\nEND SegmentBoundaryTimes\n"
    );
    for states in [twice, rows(0..=20, 1e3, true)] {
        let feed = read(&file(&listed, "EphemerisTimePosVel", &states))
            .unwrap()
            .feeds
            .remove(0);
        let counts: Vec<_> = feed.segments().iter().map(|s| s.samples.len()).collect();
        assert_eq!(counts, [11, 11]);
        assert_eq!(
            feed.validity(),
            (start(), start() + Duration::from_seconds(1200.0))
        );
    }
    // Covariances behind the states are skipped.
    let more = rows(0..=20, 1e3, true) + "CovarianceTimePos\n0.0 1 2 3 4 5 6\n";
    assert_eq!(
        read(&file(J2000_KM, "EphemerisTimePosVel", &more))
            .unwrap()
            .faults
            .len(),
        0
    );
}

#[test]
fn wrong_files_are_named() {
    let good = file(J2000_KM, "EphemerisTimePosVel", &rows(0..=20, 1e3, true));
    for (from, to, line, says) in [
        ("1 Jun 2004", "1 Foo 2004", 7, "is not a date"),
        ("1 Jun 2004", "31 Jun 2004", 7, "day 31"),
        (
            "ScenarioEpoch",
            "# ScenarioEpoch",
            16,
            "without ScenarioEpoch",
        ),
        (
            "CentralBody Earth",
            "CentralBody Moon",
            10,
            "only orbits about the Earth",
        ),
        (
            "J2000",
            "B1950",
            11,
            "known systems are ICRF, Inertial, J2000, Fixed, TEMEOfDate, TrueOfDate and MeanOfDate",
        ),
        ("Kilometers", "Parsecs", 12, "known units are"),
        ("Hermite", "Spline", 8, "known methods are"),
        (
            "SamplesM1 3",
            "SamplesM1 32",
            9,
            "a whole number from 1 to 31",
        ),
        (
            "EphemerisTimePosVel",
            "EphemerisLLRTimePos",
            14,
            "states are read from",
        ),
        (
            "6e1 ",
            "6e1 x ",
            17,
            "three coordinates and three of the velocity",
        ),
        ("END Ephemeris", "", 14, "is not closed"),
    ] {
        assert!(good.contains(from), "{from}");
        let error = read(&good.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(
            error.starts_with(&format!("folder/Sat1.e:{line}:1: ")) && error.contains(says),
            "{from}: {error}"
        );
    }
    let reported = read(&good.replace("Hermite", "LagrangeVOP")).unwrap();
    assert!(
        reported.faults[0].is_notice()
            && reported.faults[0]
                .to_string()
                .contains("Lagrange is taken instead")
    );
}

#[test]
fn messages_that_are_not_read_are_named() {
    let of_ocm = "(OCM) is not read; export its trajectory as an OEM";
    for (text, words) in [
        (
            "CCSDS_OCM_VERS = 3.0\nCREATION_DATE = 2022-11-06T09:23:57\n",
            of_ocm,
        ),
        (
            "<?xml version=\"1.0\"?>\n<ndm><ocm id=\"CCSDS_OCM_VERS\" version=\"3.0\"/></ndm>",
            of_ocm,
        ),
        (
            "CCSDS_CDM_VERS = 1.0\nORIGINATOR = X\n",
            "(CDM) has states of one instant alone",
        ),
        (
            "CCSDS_TDM_VERS = 2.0\nORIGINATOR = X\n",
            "(TDM) has measurements and no orbit",
        ),
    ] {
        let origin = Path::new("a.ocm");
        let errors = [
            Ephemerides::from_text(text, origin, false).unwrap_err(),
            Catalogue::from_text(text, origin, false).unwrap_err(),
        ];
        for error in errors.map(|error| error.to_string()) {
            assert!(error.contains(words), "{error}");
        }
    }
}

/// Wherever a file ends or holds a strange character, it is read or an error: nothing panics.
#[test]
fn files_may_end_anywhere() {
    let listed = format!("{J2000_KM}BEGIN SegmentBoundaryTimes\n 60.0\nEND SegmentBoundaryTimes\n");
    let text = file(&listed, "EphemerisTimePosVel", &rows(0..=2, 1e3, true));
    for end in 0..text.len() {
        for cut in [
            text[..end].to_owned(),
            format!("{}é{}", &text[..end], &text[end..]),
        ] {
            let read = Ephemerides::from_text(&cut, Path::new("a.e"), false);
            if let Ok(read) = read {
                assert!(
                    read.feeds
                        .iter()
                        .all(|feed| feed.validity().0 <= feed.validity().1)
                );
            }
        }
    }
}

/// Rotation about an axis of a frame, as the matrices of Vallado (2013), 3.4: of a vector into axes that are turned.
fn turn(axis: usize, angle_rad: f64, v: [f64; 3]) -> [f64; 3] {
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let (sin, cos) = angle_rad.sin_cos();
    let mut out = v;
    out[i] = cos * v[i] + sin * v[j];
    out[j] = cos * v[j] - sin * v[i];
    out
}

#[test]
fn axes_of_the_date_are_turned_by_precession() {
    // IAU 1976 (Lieske 1979), arcseconds by Julian centuries of TT; the models of 1976 and 2000 differ by 0.02 arcseconds, 0.7 m here.
    let t = (utc("2004-06-01T12:10:00Z") - utc("2000-01-01T11:58:56Z")).to_seconds()
        / 86_400.0
        / 36_525.0;
    let angle = |a: f64, b: f64, c: f64| (t * (a + t * (b + t * c)) / 3600.0).to_radians();
    let zeta = angle(2306.2181, 0.30188, 0.017998);
    let theta = angle(2004.3109, -0.42665, -0.041833);
    let z = angle(2306.2181, 1.09468, 0.018203);
    for (name, most_m) in [("MeanOfDate", 10.0), ("TrueOfDate", 800.0)] {
        let header = J2000_KM.replace("J2000", name);
        let text = file(&header, "EphemerisTimePosVel", &rows(0..=20, 1e3, true));
        let feed = read(&text).unwrap().feeds.remove(0);
        let state = feed.state_at(utc("2004-06-01T12:10:00Z")).unwrap();
        assert_eq!(state.frame, Frame::Gcrf);
        let of_date = turn(2, -zeta, state.position_m.to_array());
        let of_date = turn(2, -z, turn(1, theta, of_date));
        let off_m = KeplerOrbit::LOW.state(600.0).0.distance(of_date.into());
        // Nutation, 17 arcseconds at most, is 600 m.
        assert!(off_m < most_m, "{name}: {off_m}");
        let unturned_m = KeplerOrbit::LOW.state(600.0).0.distance(state.position_m);
        assert!(unturned_m > 2000.0, "{name}: {unturned_m}");
    }
}

#[test]
fn places_above_the_ellipsoid_are_read() {
    // A geostationary point that drifts by a degree in 20 minutes.
    let rows: String = (0..=20)
        .map(|minute| {
            format!(
                "{} 0.0 {} 35786000\n",
                minute * 60,
                10.0 + f64::from(minute) / 20.0
            )
        })
        .collect();
    for (unit, metres) in [("", 1.0), ("DistanceUnit Kilometers\n", 1e3)] {
        let rows = rows.replace("35786000", &format!("{}", 35_786_000.0 / metres));
        let feed = read(&file(unit, "EphemerisLLATimePos", &rows))
            .unwrap()
            .feeds
            .remove(0);
        let state = feed
            .state_at(start() + Duration::from_seconds(630.0))
            .unwrap();
        let (sin, cos) = (10.525_f64).to_radians().sin_cos();
        let expected = glam::DVec3::new(cos, sin, 0.0) * (6_378_137.0 + 35_786_000.0);
        assert_eq!(state.frame, Frame::Itrf);
        assert!(
            state.position_m.distance(expected) < 0.1,
            "{}",
            state.position_m
        );
    }
    let bad = rows.replace(" 0.0 ", " 95.0 ");
    assert!(read(&file("", "EphemerisLLATimePos", &bad)).is_err());
    let inertial = file("CoordinateSystem J2000\n", "EphemerisLLATimePos", &rows);
    let error = read(&inertial).unwrap_err().to_string();
    assert!(
        error.contains("latitudes and longitudes are Fixed"),
        "{error}"
    );
}
