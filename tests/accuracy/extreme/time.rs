//! The Sun and the Earth's turn over four centuries.

use terrella::frames::{
    Duration, Epoch, TimeError, itrf_from_gcrf, itrf_from_teme, subsolar_point, sun_direction_itrf,
    utc_from_rfc3339,
};

/// Change of the point below the Sun in a minute: degrees of latitude, and of longitude more than a mean Sun's 0.25°.
fn minute(epoch: Epoch) -> (f64, f64) {
    let (now, then) = (
        subsolar_point(epoch),
        subsolar_point(epoch + Duration::from_seconds(60.0)),
    );
    let lon = (then.lon_rad - now.lon_rad).to_degrees() + 0.25;
    (
        (then.lat_rad - now.lat_rad).to_degrees(),
        lon - 360.0 * (lon / 360.0).round(),
    )
}

/// Declination changes by at most 0.4° a day; the equation of time by 30 s a day, 0.0001° a minute.
const LAT_A_MINUTE_DEG: f64 = 3.0e-4;
const LON_A_MINUTE_DEG: f64 = 1.0e-4;

fn j2000() -> Epoch {
    utc_from_rfc3339("2000-01-01T11:58:55.816Z").unwrap()
}

#[test]
fn the_sun_moves_by_a_minute_in_a_minute_from_1800_to_2200() {
    let (mut worst_lat, mut worst_lon, mut count) = (0.0_f64, 0.0_f64, 0);
    // A step without a common measure with day or year.
    for step in -3_600..3_600 {
        let epoch = j2000() + Duration::from_days(f64::from(step) * 20.287_654_3);
        let sun = sun_direction_itrf(epoch);
        assert!((sun.length() - 1.0).abs() < 1e-14, "{epoch:?}: {sun}");
        let (lat, lon) = minute(epoch);
        (worst_lat, worst_lon) = (worst_lat.max(lat.abs()), worst_lon.max(lon.abs()));
        count += 1;
    }
    println!(
        "{count} minutes: {worst_lat:.6}° of latitude, {worst_lon:.6}° of longitude off 0.25°"
    );
    assert!(worst_lat < LAT_A_MINUTE_DEG && worst_lon < LON_A_MINUTE_DEG);
}

/// Third difference of four values a step apart.
fn third(v: &[f64]) -> f64 {
    v[3] - v[0] - 3.0 * (v[2] - v[1])
}

#[test]
fn the_sun_s_path_is_smooth_from_1800_to_2200() {
    // Every two days. A jump appears in a third difference at its full height; the path itself contributes 0.001° of latitude there, 23.4° × (2
    // days × 2π/year)³, and 0.002° of longitude.
    let step = Duration::from_days(2.0);
    let first = j2000() - Duration::from_days(73_000.0);
    let path: Vec<_> = (0..73_000)
        .map(|k| {
            let place = subsolar_point(first + step * f64::from(k));
            (place.lat_rad.to_degrees(), place.lon_rad.to_degrees())
        })
        .collect();
    let (mut worst_lat, mut worst_lon) = (0.0_f64, 0.0_f64);
    for (k, four) in path.windows(4).enumerate() {
        let lat = third(&four.iter().map(|p| p.0).collect::<Vec<_>>()).abs();
        let lon = third(&four.iter().map(|p| p.1).collect::<Vec<_>>()).abs();
        let year = 2_000.0 + (2.0 * (k as f64 + 1.5) - 73_000.0) / 365.25;
        // Two joints, 0.0125° at most and three times that in a third difference, and the leap seconds: 15″ each.
        let joint = [1_900.0, 2_100.0].iter().any(|y| (year - y).abs() < 0.05);
        let leaps = (1_971.9..2_017.1).contains(&year);
        let most_lon = if leaps {
            0.003 + 3.0 * 15.05 / 3_600.0
        } else {
            0.003
        };
        let extra = if joint { 0.0375 } else { 0.0 };
        // The ten seconds of 1971 make 150″.
        let ten = if (year - 1_972.0).abs() < 0.05 {
            3.0 * 150.5 / 3_600.0
        } else {
            0.0
        };
        assert!(lat < 0.0015 + extra, "{year:.2}: {lat}°");
        assert!(lon < most_lon + extra + ten, "{year:.2}: {lon}°");
        if !joint {
            worst_lat = worst_lat.max(lat);
        }
        if !joint && !leaps {
            worst_lon = worst_lon.max(lon);
        }
    }
    println!("third differences: {worst_lat:.5}° of latitude, {worst_lon:.5}° of longitude");
}

#[test]
fn the_sun_is_continuous_through_the_ends_of_the_scenes_years() {
    // Scenes are of 1900…2099; where the ephemeris ends, 12 h TT on 1 January 2100 and 1900, another formula takes over,
    // 0.0125° at most from it.
    for text in ["1900-01-01T00:00:00Z", "2099-12-31T23:59:59Z"] {
        let epoch = utc_from_rfc3339(text).unwrap();
        let mut largest = 0.0_f64;
        for minutes in -3_000..3_000 {
            let (lat, lon) = minute(epoch + Duration::from_seconds(60.0 * f64::from(minutes)));
            let jump = lat.abs().max(lon.abs());
            assert!(jump < 0.0135, "{text} and {minutes} min: {jump}°");
            largest = largest.max(jump);
        }
        println!("about {text}: {largest:.5}° at most in a minute");
        // There is a joint, and the test has skipped it.
        assert!(largest > LAT_A_MINUTE_DEG, "{text}: {largest}°");
    }
    for text in ["1899-12-31T23:59:59Z", "2100-01-01T00:00:00Z"] {
        let error = utc_from_rfc3339(text).expect_err("outside the scenes' years");
        assert!(
            matches!(error, TimeError::Field { field: "year", .. }),
            "{error}"
        );
    }
}

#[test]
fn a_leap_second_moves_the_sun_by_a_second_and_no_more() {
    for text in [
        "1972-06-30T23:59:30Z",
        "1998-12-31T23:59:30Z",
        "2016-12-31T23:59:30Z",
    ] {
        let (lat, lon) = minute(utc_from_rfc3339(text).unwrap());
        // Sixty seconds passed and the clock shows 59: 15″ less.
        assert!(
            (lon - 1.0 / 240.0).abs() < LON_A_MINUTE_DEG,
            "{text}: {lon}°"
        );
        assert!(lat.abs() < LAT_A_MINUTE_DEG);
    }
    // The ten seconds that were left over in 1971.
    let (_, lon) = minute(utc_from_rfc3339("1971-12-31T23:59:30Z").unwrap());
    assert!((lon - 10.0 / 240.0).abs() < 2e-4, "{lon}°");
}

#[test]
fn the_sun_comes_back_after_a_year() {
    let year = Duration::from_days(365.242_19);
    for step in -190..190 {
        let epoch = j2000() + Duration::from_days(f64::from(step) * 365.242_19 + 100.0);
        let (now, then) = (subsolar_point(epoch), subsolar_point(epoch + year));
        let off = (now.lat_rad - then.lat_rad).to_degrees().abs();
        // Moon and planets pull the Earth about its mean place by 0.01°.
        assert!(off < 0.02, "{step} years from 2000: {off}°");
    }
}

#[test]
fn the_earth_turns_evenly_from_1800_to_2200() {
    // Both rotations stay rotations, and in one minute of UTC the Earth turns by a minute of sidereal time.
    let rate = 1.002_737_909_35 * std::f64::consts::TAU / 1_440.0;
    for step in -730..730 {
        let epoch = j2000() + Duration::from_days(f64::from(step) * 100.053_217);
        let later = epoch + Duration::from_seconds(60.0);
        for rotation in [itrf_from_teme, itrf_from_gcrf] {
            let (now, then) = (rotation(epoch), rotation(later));
            assert!((now.determinant() - 1.0).abs() < 1e-13);
            let turn = then * now.transpose();
            let angle = (turn.y_axis.x - turn.x_axis.y).atan2(turn.x_axis.x + turn.y_axis.y);
            assert!(
                (angle - rate).abs() < 2e-9,
                "{epoch:?}: {angle} instead of {rate}"
            );
        }
    }
}
