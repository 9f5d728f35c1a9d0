//! Ephemerides as CSV.

use crate::{config, utc};
use std::fmt::Write;
use std::path::Path;
use terrella_frames::{Duration, Ellipsoid, TimeScale, ccsds_time, rfc3339};
use terrella_orbit::interpolated::Interpolation;
use terrella_orbit::{Ephemerides, EphemerisFeed, Feed, Frame, OrbitError, csv_header, csv_row};

fn read(text: &str) -> Result<EphemerisFeed, OrbitError> {
    let origin = Path::new("folder/sat.csv");
    Ephemerides::from_text(text, origin, true)?.into_one(origin, None)
}

/// The station's states, as `terrella orbit --csv` writes its columns.
fn printed(frame: Frame) -> String {
    let iss = config("iss.tle");
    let mut text = format!("# frame = {}, scale = UTC, name = ISS\n", frame.name());
    text += "epoch_utc,x_km,y_km,z_km,vx_km_s,vy_km_s,vz_km_s,lat_deg,lon_deg,height_km\n";
    for minute in 0..60 {
        let state = iss
            .state_at(iss.epoch() + Duration::from_seconds(f64::from(minute) * 60.0))
            .unwrap();
        let ground = Ellipsoid::WGS84.geodetic_from_itrf(state.position_itrf_m());
        let state = state.in_frame(frame, &Default::default());
        let (r, v) = (state.position_m / 1e3, state.velocity_m_s / 1e3);
        let _ = writeln!(
            text,
            "{},{:.6},{:.6},{:.6},{:.9},{:.9},{:.9},{:.6},{:.6},{:.3}",
            rfc3339(state.epoch),
            r.x,
            r.y,
            r.z,
            v.x,
            v.y,
            v.z,
            ground.lat_rad.to_degrees(),
            ground.lon_rad.to_degrees(),
            ground.height_m / 1e3
        );
    }
    text
}

#[test]
fn printed_states_are_read_back() {
    let iss = config("iss.tle");
    for frame in Frame::ALL {
        let feed = read(&printed(frame)).unwrap();
        assert_eq!(feed.name(), "ISS");
        assert_eq!(
            feed.segments()[0].samples.interpolation(),
            Interpolation::WITH_VELOCITIES
        );
        let mut worst = 0.0_f64;
        for second in 0..59 * 60 {
            let t = iss.epoch() + Duration::from_seconds(f64::from(second) + 0.5);
            let state = feed.state_at(t).unwrap();
            assert_eq!(state.frame, frame);
            let expected = iss
                .state_at(t)
                .unwrap()
                .in_frame(frame, &Default::default());
            worst = worst.max(state.position_m.distance(expected.position_m));
        }
        // Dates are printed to a millisecond, which is up to 4 m of flight; SGP4's velocity is 1 cm/s beside its position's rate.
        println!("{frame:?}: {worst:.2} m");
        assert!(worst < 4.5, "{frame:?}: {worst}");
    }
}

/// The column that `terrella orbit --csv` writes of how far a state may be off.
#[test]
fn errors_are_read_back_and_bad_ones_cost_no_state() {
    let iss = config("iss.tle");
    let at = |minute: i32| iss.epoch() + Duration::from_seconds(f64::from(minute) * 60.0);
    let said = |minute: i32| match minute {
        3 => None,
        minute => Some(10.0 + f64::from(minute)),
    };
    let mut text = csv_header().to_owned();
    for minute in 0..12 {
        let state = iss.state_at(at(minute)).unwrap();
        let place = Ellipsoid::WGS84.geodetic_from_itrf(state.position_itrf_m());
        text += &csv_row("ISS", &state, &place, said(minute));
    }
    let feed = read(&text).unwrap();
    let near = |minute: i32, expected: f64| {
        let error_m = feed.error_m(at(minute)).expect("an error");
        assert!((error_m - expected).abs() < 1e-6, "{minute}: {error_m}");
    };
    for minute in 0..12 {
        // A missing value is interpolated between its neighbours.
        near(minute, 10.0 + f64::from(minute));
    }
    // An invalid error estimate is reported; the state is used without it.
    for wrong in ["-1", "much", "inf"] {
        let bad = text.replacen(",15\n", &format!(",{wrong}\n"), 1);
        assert_ne!(bad, text);
        let origin = Path::new("folder/sat.csv");
        let strict = Ephemerides::from_text(&bad, origin, true)
            .unwrap_err()
            .to_string();
        assert!(
            strict.contains("error_m") && strict.contains(":7:"),
            "{strict}"
        );
        let loose = Ephemerides::from_text(&bad, origin, false).unwrap();
        assert_eq!(loose.faults.len(), 1);
        let feed = loose.into_one(origin, None).unwrap();
        assert_eq!(feed.segments()[0].sigma_m.len(), 10);
        assert_eq!(feed.segments()[0].samples.len(), 12);
    }
}

#[test]
fn columns_are_found_by_their_names() {
    let first = utc("2018-01-01T00:00:00Z");
    for (scale, column) in
        TimeScale::ALL
            .into_iter()
            .zip(["epoch_utc", "epoch_tai", "epoch_tt", "epoch_gps"])
    {
        let date = |s: f64| ccsds_time(first + Duration::from_seconds(s), scale);
        let text = format!(
            "# made by hand\n#frame=ITRF\n\n\"z_m\",note,x_m, {column} ,y_m\r\n3,\"a, b\",1,{},2\r\n# in between\n3,,2,{},4\n",
            date(0.0),
            date(1.0)
        );
        let feed = read(&text).unwrap();
        assert_eq!((feed.name(), feed.validity().0), ("sat", first));
        let state = feed.state_at(first + Duration::from_seconds(0.5)).unwrap();
        assert_eq!(
            (state.frame, state.position_m.to_array()),
            (Frame::Itrf, [1.5, 3.0, 3.0])
        );
        assert_eq!(state.velocity_m_s.to_array(), [1.0, 2.0, 0.0]);
        assert_eq!(
            feed.segments()[0].samples.interpolation(),
            Interpolation::WITHOUT_VELOCITIES
        );
    }
    let text = printed(Frame::Teme).replace("name = ISS", "interpolation = lagrange, degree = 11");
    let feed = read(&text).unwrap();
    assert_eq!(
        feed.segments()[0].samples.interpolation(),
        Interpolation::Lagrange { degree: 11 }
    );
}

#[test]
fn wrong_tables_are_named() {
    let good = "# frame = TEME, scale = UTC\n# degree = 3\nepoch_utc,x_km,y_km,z_km\n2018-01-01T00:00:00Z,7000,0,0\n2018-01-01T00:01:00Z,7000,400,0\n";
    assert!(read(good).is_ok());
    for (from, to, place, says) in [
        (
            "frame = TEME, ",
            "",
            "1:1",
            "the table without frame; add a column frame that says it in every row",
        ),
        (
            "TEME",
            "XYZ",
            "1:11",
            "known frames are TEME, PEF, ITRF, GCRF and EME2000",
        ),
        (
            "scale = UTC",
            "scale = TAI",
            "1:25",
            "the column of time is of another scale",
        ),
        (
            "degree = 3",
            "degree = x",
            "2:12",
            "degree is \"x\"; expected a whole number from 1 to 31",
        ),
        (
            "degree = 3",
            "frame = ITRF",
            "2:11",
            "duplicate frame; the first is in line 1",
        ),
        (
            "degree = 3",
            "interpolation = best",
            "2:19",
            "known interpolations are",
        ),
        (
            "degree = 3",
            "interpolation = HERMITE",
            "4:1",
            "Hermite interpolation needs a velocity",
        ),
        (
            "epoch_utc",
            "epoch_ut1",
            "3:1",
            "the header without one column of time; expected epoch_utc",
        ),
        (
            "epoch_utc,",
            "epoch_utc,epoch_tai,",
            "3:1",
            "one column of time",
        ),
        (
            "y_km",
            "y_m",
            "3:1",
            "the header without columns of position; expected x_km,y_km,z_km or x_m,y_m,z_m",
        ),
        ("y_km", "x_km", "3:16", "duplicate column \"x_km\""),
        (
            "7000,400",
            "7000,4oo",
            "5:27",
            "y is \"4oo\"; expected a number",
        ),
        (
            "7000,400",
            "7000",
            "5:1",
            "\"3 fields\" is not allowed here; expected as many as the header has",
        ),
        (
            "7000,400",
            "7000,\"400",
            "5:1",
            "a quotation mark without its partner",
        ),
        (
            "2018-01-01T00:01",
            "2018-01-01T00:00",
            "5:1",
            "is not later than",
        ),
        ("2018-01-01T00:01", "2018-01-01", "5:1", "the epoch: "),
        ("00Z,7000,0,0\n", "00Z,7000,0,0,\n", "4:1", "\"5 fields\""),
    ] {
        assert!(good.contains(from), "{from}");
        let error = read(&good.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(
            error.starts_with(&format!("folder/sat.csv:{place}: ")),
            "{to}: {error}"
        );
        assert!(error.contains(says), "{to}: {error}");
    }
    assert_eq!(
        read("epoch_utc,x_km,y_km,z_km\n").unwrap_err().to_string(),
        "folder/sat.csv:1:1: the table without frame; add a column frame that says it in every row: TEME, PEF, ITRF, GCRF or EME2000; or put a line before the header: # frame = TEME"
    );
    assert!(
        read("# frame = TEME\nepoch_utc,x_km,y_km,z_km\n")
            .unwrap_err()
            .to_string()
            .contains("no sample")
    );
}

/// Output of the command: the header first, a name and a frame in every row.
#[test]
fn a_table_of_several_satellites_says_in_each_row_whose_it_is() {
    let row = |name: &str, frame: &str, minute: u32, x: &str| {
        format!("{name},{frame},2018-01-01T00:{minute:02}:00Z,{x},0,0\n")
    };
    let header = "name,frame,epoch_utc,x_km,y_km,z_km\n";
    let origin = Path::new("folder/sat.csv");
    let good: String = (0..4)
        .map(|k| row("\"A, \"\"1\"\"\"", "TEME", k, "7000") + &row("B", "ITRF", k, "8000"))
        .collect();
    let all = Ephemerides::from_text(&format!("{header}{good}"), origin, true).unwrap();
    let names: Vec<_> = all.feeds.iter().map(Feed::name).collect();
    assert_eq!(names, ["A, \"1\"", "B"]);
    let b = all.into_one(origin, Some("b")).unwrap();
    assert_eq!(b.segments()[0].samples.frame(), Frame::Itrf);
    assert_eq!(b.segments()[0].samples.len(), 4);
    // Without a name it is the file's.
    let unnamed = [0, 1].map(|k| row("", "GCRF", k, "7000")).concat();
    let unnamed = format!("{header}{unnamed}");
    assert_eq!(read(&unnamed).unwrap().name(), "sat");
    for (text, place, says) in [
        (
            format!(
                "{header}{}{}",
                row("A", "TEME", 0, "7000"),
                row("A", "ITRF", 1, "7000")
            ),
            "3:1",
            "the satellite's first row is in another",
        ),
        (
            format!("{header}{}", row("A", "XYZ", 0, "7000")),
            "2:3",
            "known frames are TEME, PEF, ITRF, GCRF and EME2000",
        ),
        (
            format!("# frame = TEME\n{header}{good}"),
            "1:11",
            "the table has a column of that name",
        ),
        (header.to_owned(), "1:1", "no sample"),
    ] {
        let error = read(&text).unwrap_err().to_string();
        assert!(
            error.starts_with(&format!("folder/sat.csv:{place}: ")) && error.contains(says),
            "{error}"
        );
    }
}

#[test]
fn a_bad_row_costs_that_row() {
    let good = printed(Frame::Gcrf);
    let corrupt = good
        .replacen("T21:38:14", "T21:3x:14", 1)
        .replacen("T21:43:14", "T21:03:14", 1);
    assert_ne!(corrupt, good);
    let origin = Path::new("sat.csv");
    let error = Ephemerides::from_text(&corrupt, origin, true).unwrap_err();
    assert!(error.to_string().starts_with("sat.csv:"), "{error}");
    let loose = Ephemerides::from_text(&corrupt, origin, false).unwrap();
    let reported: Vec<_> = loose.faults.iter().map(OrbitError::to_string).collect();
    assert_eq!(reported.len(), 2, "{reported:?}");
    let feed = loose.into_one(origin, None).unwrap();
    assert_eq!(feed.segments()[0].samples.len(), 58);
}
