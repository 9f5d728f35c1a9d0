//! The table of the Earth's orientation around the leap second at the end of 2016.

use std::path::{Path, PathBuf};
use terrella::frames::{
    Duration, EarthOrientation, EarthOrientationError, Epoch, Orientation, utc_from_rfc3339,
};

const EXTRACT: &str = include_str!("../../data/orbit/finals2000A.extract");

fn utc(text: &str) -> Epoch {
    utc_from_rfc3339(text).unwrap()
}

fn read(text: &str) -> Result<EarthOrientation, EarthOrientationError> {
    EarthOrientation::from_finals2000a(text, Path::new("finals"))
}

fn arcsec(radians: f64) -> f64 {
    radians.to_degrees() * 3600.0
}

#[test]
fn rows_are_met_and_between_them_values_are_linear() {
    let table = read(EXTRACT).unwrap();
    assert_eq!(
        table.span(),
        (utc("2016-12-16T00:00:00Z"), utc("2017-01-07T00:00:00Z"))
    );
    assert_eq!(table.measured_until(), Some(utc("2017-01-07T00:00:00Z")));
    let at = |text: &str| table.at(utc(text)).unwrap();
    let near = |o: Orientation, ut1: f64, x: f64, y: f64| {
        assert!((o.ut1_minus_utc_s - ut1).abs() < 1e-9, "{o:?}");
        assert!((arcsec(o.x_pole_rad) - x).abs() < 1e-9, "{o:?}");
        assert!((arcsec(o.y_pole_rad) - y).abs() < 1e-9, "{o:?}");
    };
    near(at("2016-12-31T00:00:00Z"), -0.4077601, 0.081400, 0.263094);
    near(at("2017-01-01T00:00:00Z"), 0.5912821, 0.080504, 0.263145);
    near(
        at("2017-01-01T12:00:00Z"),
        (0.5912821 + 0.5901752) / 2.0,
        (0.080504 + 0.080285) / 2.0,
        (0.263145 + 0.263605) / 2.0,
    );
}

/// UT1 − UTC jumps by the second; UT1, and so the Earth, does not.
#[test]
fn the_leap_second_is_a_jump_of_utc_only() {
    let table = read(EXTRACT).unwrap();
    let at = |text: &str| table.at(utc(text)).unwrap().ut1_minus_utc_s;
    let (before, within, after) = (
        at("2016-12-31T23:59:59.999Z"),
        at("2016-12-31T23:59:60.999Z"),
        at("2017-01-01T00:00:00Z"),
    );
    assert!((before - -0.4087179).abs() < 1e-6, "{before}");
    assert!((within - before).abs() < 1e-7);
    assert!((after - within - 1.0).abs() < 1e-7);
    // UT1 − TAI through the whole day of 86 401 s, and no kink at its end.
    let mut last: Option<f64> = None;
    for k in -86_000..86_000_i32 {
        let epoch = utc("2017-01-01T00:00:00Z") + Duration::from_seconds(f64::from(k));
        let tai_minus_utc = if k < 0 { 36.0 } else { 37.0 };
        let ut1_minus_tai = table.at(epoch).unwrap().ut1_minus_utc_s - tai_minus_utc;
        if let Some(last) = last {
            assert!((ut1_minus_tai - last).abs() < 2e-8, "{k}");
        }
        last = Some(ut1_minus_tai);
    }
}

#[test]
fn outside_the_table_nothing_is_known() {
    let table = read(EXTRACT).unwrap();
    let (first, last) = table.span();
    let moment = Duration::from_total_nanoseconds(1);
    assert!(table.at(first).is_some() && table.at(last).is_some());
    assert!(table.at(first - moment).is_none() && table.at(last + moment).is_none());
    for far in [Duration::MAX, Duration::MIN] {
        assert!(
            table
                .at(Epoch::from_duration(far, hifitime::TimeScale::TAI))
                .is_none()
        );
    }
    // Dates without values yet end the table.
    let blank: String = format!("{EXTRACT}17 1 8 57761.00\n17 1 9 57762.00  \n\n");
    assert_eq!(read(&blank).unwrap().span(), table.span());
    let predicted = EXTRACT.replace(" I ", " P ").replace(" I-", " P-");
    assert_eq!(read(&predicted).unwrap().measured_until(), None);
}

#[test]
fn wrong_tables_are_named() {
    for (from, to, place, says) in [
        (
            "161217 57739.00",
            "161218 57739.00",
            "2:1",
            "the date is \"161218 57739.00\"",
        ),
        ("161217 57739.00", " 161217 57739.0", "2:1", "the date"),
        ("161217 57739.00", "161217 57739.50", "2:1", "the date"),
        (
            "161217 57739.00 I",
            "161217 57739.00 X",
            "2:17",
            "the flag is \"X\"; expected I (measured) or P (predicted)",
        ),
        (
            "0.110788",
            "0.11O788",
            "2:19",
            "the pole's x is \" 0.11O788\"; expected arc seconds, at most 2",
        ),
        ("0.110788", "9.110788", "2:19", "the pole's x"),
        ("0.266593", "     nan", "2:38", "the pole's y"),
        (
            "-0.3927602",
            "-1.3927602",
            "2:59",
            "UT1 − UTC is \"-1.3927602\"; expected seconds, at most 1",
        ),
        ("-0.3927602", "          ", "2:59", "UT1 − UTC"),
    ] {
        assert!(EXTRACT.contains(from), "{from}");
        let error = read(&EXTRACT.replacen(from, to, 1))
            .unwrap_err()
            .to_string();
        assert!(
            error.starts_with(&format!("finals:{place}: ")),
            "{to}: {error}"
        );
        assert!(error.contains(says), "{to}: {error}");
    }
    let mut lines: Vec<_> = EXTRACT.lines().collect();
    lines.remove(4);
    let error = read(&lines.join("\n")).unwrap_err().to_string();
    assert!(
        error.starts_with("finals:5: MJD 57743 follows MJD 57741"),
        "{error}"
    );
    let gap = EXTRACT
        .lines()
        .enumerate()
        .map(|(k, l)| if k == 3 { &l[..16] } else { l });
    let error = read(&gap.collect::<Vec<_>>().join("\n"))
        .unwrap_err()
        .to_string();
    assert!(error.starts_with("finals:5:17: the row is"), "{error}");
    assert!(matches!(read(""), Err(EarthOrientationError::Empty { .. })));
    assert!(read("é7 1 1 57754.00").is_err() && read("hello").is_err());
}

/// The whole table of the IERS, and the documented bound of the error of linear interpolation.
#[test]
fn the_whole_table_is_read() {
    let shared = std::env::var_os("TERRELLA_SHARED").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared"),
        PathBuf::from,
    );
    let path = shared.join("data/orbits/finals2000A.all");
    if !path.exists() {
        eprintln!(
            "SKIPPED: the_whole_table_is_read, for want of {}",
            path.display()
        );
        return;
    }
    let table = EarthOrientation::from_file(&path).unwrap();
    let (first, last) = table.span();
    assert_eq!(first, utc("1973-01-02T00:00:00Z"));
    let measured = table.measured_until().unwrap();
    assert!(measured < last && last - measured > Duration::from_days(300.0));
    // From two neighbours, two days apart, the day between them: four times the error of one day's step.
    let (mut ut1_s, mut pole_arcsec) = (0.0_f64, 0.0_f64);
    let mut day = utc("1990-01-02T00:00:00Z");
    while day + Duration::from_days(1.0) < measured {
        let at = |days: f64| table.at(day + Duration::from_days(days)).unwrap();
        let (a, b, c) = (at(-1.0), at(0.0), at(1.0));
        let middle = |f: fn(&Orientation) -> f64| ((f(&a) + f(&c)) / 2.0 - f(&b)).abs() / 4.0;
        let ut1 = middle(|o| o.ut1_minus_utc_s);
        // If a leap second is in between, UTC's own step is included.
        if ut1 < 0.1 {
            ut1_s = ut1_s.max(ut1);
        }
        pole_arcsec = pole_arcsec.max(arcsec(
            middle(|o| o.x_pole_rad).max(middle(|o| o.y_pole_rad)),
        ));
        day += Duration::from_days(1.0);
    }
    println!("linear from day to day since 1990: {ut1_s:.1e} s, {pole_arcsec:.1e}″");
    assert!(ut1_s < 7e-5 && pole_arcsec < 2e-4);
}
