//! The Sun's direction and the place below it.

use super::utc;
use terrella::frames::{Duration, Ellipsoid, Epoch, rfc3339, subsolar_point, sun_direction_itrf};

/// Astronomical Almanac, page C5: 0.01° in longitude between 1950 and 2050. Returns declination, longitude, degrees.
fn almanac_subsolar_deg(unix_like_days_since_j2000: f64, ut_hours: f64) -> (f64, f64) {
    let n = unix_like_days_since_j2000;
    let mean_longitude = 280.460 + 0.985_647_4 * n;
    let g = (357.528 + 0.985_600_3 * n).to_radians();
    let longitude = (mean_longitude + 1.915 * g.sin() + 0.020 * (2.0 * g).sin()).to_radians();
    let obliquity = (23.439 - 0.000_000_4 * n).to_radians();
    let declination = (obliquity.sin() * longitude.sin()).asin().to_degrees();
    let ascension = (obliquity.cos() * longitude.sin())
        .atan2(longitude.cos())
        .to_degrees();
    let equation_of_time = (mean_longitude - ascension + 180.0).rem_euclid(360.0) - 180.0;
    let lon = (-15.0 * (ut_hours - 12.0) - equation_of_time + 180.0).rem_euclid(360.0) - 180.0;
    (declination, lon)
}

#[test]
fn sun_agrees_with_the_almanac_formula_from_1950_to_2050() {
    let start = utc("1950-01-01T00:00:00Z");
    let mut worst = 0.0_f64;
    for step in 0..3600 {
        // 10.14 days and 7 h 13 min: every season and hour.
        let hours = f64::from(step) * 243.387;
        let epoch = Epoch::from_gregorian_utc_at_midnight(1950, 1, 1) + Duration::from_hours(hours);
        assert!(epoch >= start);
        let n = -18_262.5 + hours / 24.0;
        let (lat, lon) = almanac_subsolar_deg(n, hours.rem_euclid(24.0));
        let expected = Ellipsoid::normal(lat.to_radians(), lon.to_radians());
        let angle = sun_direction_itrf(epoch)
            .angle_between(expected)
            .to_degrees();
        worst = worst.max(angle);
        assert!(angle < 0.02, "{}: {angle}°", rfc3339(epoch));
    }
    println!("Sun against the Astronomical Almanac's formula, 1950…2050: {worst:.4}° at worst");
}

#[test]
fn sun_stands_where_the_calendar_says() {
    // Equinoxes and solstices of 2018 (US Naval Observatory, to the minute): declination 0 or ±obliquity.
    let lat = |text: &str| subsolar_point(utc(text)).lat_rad.to_degrees();
    let obliquity = 23.4369;
    assert!(lat("2018-03-20T16:15:00Z").abs() < 0.001);
    assert!(lat("2018-09-23T01:54:00Z").abs() < 0.001);
    assert!((lat("2018-06-21T10:07:00Z") - (obliquity - 0.0021)).abs() < 0.003);
    assert!((lat("2018-12-21T22:23:00Z") + (obliquity - 0.0021)).abs() < 0.003);
    // Before the March equinox south, after it north.
    assert!(lat("2018-03-20T15:15:00Z") < 0.0 && lat("2018-03-20T17:15:00Z") > 0.0);

    // Equation of time: the Sun is overhead at 0° E at 12 h minus it. +16 min 25 s on 3 November, −14 min 14 s on
    // 11 February, near 0 on 15 April, 13 June, 1 September, 25 December (Meeus 1998, chapter 28).
    for (text, minutes) in [
        ("2018-11-03T12:00:00Z", 16.43),
        ("2018-02-11T12:00:00Z", -14.22),
        ("2018-04-15T12:00:00Z", 0.0),
        ("2018-06-13T12:00:00Z", 0.0),
        ("2018-09-01T12:00:00Z", 0.0),
        ("2018-12-25T12:00:00Z", 0.0),
        ("2018-07-26T12:00:00Z", -6.53),
        ("2018-05-14T12:00:00Z", 3.65),
    ] {
        let equation = -subsolar_point(utc(text)).lon_rad.to_degrees() * 4.0;
        assert!(
            (equation - minutes).abs() < 0.3,
            "{text}: {equation:.2} min"
        );
    }
}

/// Meeus 1998, example 25.b: 13 October 1992, 0 h TD, apparent right ascension 13 h 13 m 30.749 s, declination
/// −7° 47′ 01.74″ (from the complete VSOP87).
#[test]
fn sun_is_at_meeus_example() {
    // TD − UT was 59.2 s; TT − UTC 59.184 s.
    let epoch = utc("1992-10-12T23:59:00.816Z");
    let sun = subsolar_point(epoch);
    let declination = -(7.0 + 47.0 / 60.0 + 1.74 / 3600.0);
    let arc_seconds = |deg: f64| deg * 3600.0;
    let off = arc_seconds(sun.lat_rad.to_degrees() - declination);
    assert!(off.abs() < 0.1, "declination off by {off}″");
    // Right ascension from longitude and apparent sidereal time: GMST and the equation of the equinoxes.
    let ut = (2_448_907.5, 86_340.816 / 86_400.0);
    let gast = sofars::erst::gst00b(ut.0, ut.1);
    let ascension = (sun.lon_rad + gast).to_degrees().rem_euclid(360.0);
    let expected = 15.0 * (13.0 + 13.0 / 60.0 + 30.749 / 3600.0);
    let off = arc_seconds(ascension - expected);
    assert!(off.abs() < 0.1, "right ascension off by {off}″");
}
