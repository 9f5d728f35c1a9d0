//! Earth rotation.

use super::utc;
use glam::{DMat3, DVec3};
use terrella::frames::{
    Duration, EARTH_ROTATION_RATE_RAD_S, Epoch, itrf_from_gcrf, itrf_from_gcrf_with_ut1,
    itrf_from_teme, itrf_from_teme_with_ut1,
};

/// θ of R3(θ), 0…2π.
fn angle_about_z(r: DMat3) -> f64 {
    (-r.x_axis.y)
        .atan2(r.x_axis.x)
        .rem_euclid(std::f64::consts::TAU)
}

#[test]
fn sidereal_time_is_that_of_the_published_examples() {
    // SOFA's own test of GMST82: 53736.0 MJD (UT1) gives 1.754174981860675096 rad.
    let theta = angle_about_z(itrf_from_teme(utc("2006-01-01T00:00:00Z")));
    assert!((theta - 1.754_174_981_860_675).abs() < 1e-14, "{theta}");
    // Vallado 2013, example 3-5: 20 August 1992, 12:14 UT1, GMST = 152.578 787 810°, from a Julian date in one number,
    // which is good to 2e-5 s or 1e-7°.
    let theta = angle_about_z(itrf_from_teme(utc("1992-08-20T12:14:00Z"))).to_degrees();
    assert!((theta - 152.578_787_810).abs() < 1e-7, "{theta}");
}

#[test]
fn earth_rotation_angle_is_sofas() {
    // SOFA's own test of ERA00: 54388.0 MJD (UT1) gives 0.4022837240028158102 rad. The celestial-to-terrestrial
    // matrix is R3(ERA) Q, and Q Qᵀ = 1 with Q's third row that of the matrix.
    let epoch = utc("2007-10-15T00:00:00Z");
    let r = itrf_from_gcrf(epoch);
    let tt = 54_388.0 + (33.0 + 32.184) / 86_400.0;
    let q = sofars::pnp::c2i00b(2_400_000.5, tt);
    let q = DMat3::from_cols_array_2d(&q).transpose();
    let era = angle_about_z(r * q.transpose());
    assert!((era - 0.402_283_724_002_815_8).abs() < 1e-12, "{era}");
}

/// Vallado 2013, example 3-15: 6 April 2004, 07:51:28.386009 UTC, UT1 − UTC = −0.4399619 s.
#[test]
fn teme_to_earth_fixed_is_vallados_example() {
    let epoch = utc("2004-04-06T07:51:28.386009Z");
    let dut1_s = -0.439_961_9;
    let arc_second = (1.0_f64 / 3600.0).to_radians();
    let (xp, yp) = (-0.140_682 * arc_second, 0.333_309 * arc_second);
    let teme_km = DVec3::new(5_094.180_162_10, 6_127.644_659_50, 6_380.344_532_70);
    let teme_km_s = DVec3::new(-4.746_131_487, 0.785_818_041, 5.531_931_288);
    let itrf_km = DVec3::new(-1_033.479_383_00, 7_901.295_275_40, 6_380.356_595_80);
    let itrf_km_s = DVec3::new(-3.225_636_520, -2.872_451_450, 5.531_924_446);

    let r = itrf_from_teme_with_ut1(epoch, dut1_s);
    let pef_km = r * teme_km;
    let pef_km_s = r * teme_km_s - DVec3::new(0.0, 0.0, EARTH_ROTATION_RATE_RAD_S).cross(pef_km);
    // Polar motion, which we leave out, is put in here: W = R1(−yp) R2(−xp) to first order.
    let w = |v: DVec3| DVec3::new(v.x + xp * v.z, v.y - yp * v.z, v.z - xp * v.x + yp * v.y);
    println!(
        "PEF {pef_km} km, ITRF off by {:.1e} km",
        (w(pef_km) - itrf_km).length()
    );
    // 15 µs of time: the example was computed from a Julian date in one number, which is good to 23 µs.
    assert!((w(pef_km) - itrf_km).length() < 1.4e-5, "{}", w(pef_km));
    assert!((w(pef_km_s) - itrf_km_s).length() < 2e-8, "{}", w(pef_km_s));
    // Rounded in the same way, it comes out to the last printed digit.
    let jd_ut1 = 2_453_101.5 + (28_288.386_009 + dut1_s) / 86_400.0;
    let theta = sofars::erst::gmst82(jd_ut1, 0.0);
    let rounded = DMat3::from_rotation_z(-theta) * teme_km;
    assert!((w(rounded) - itrf_km).length() < 1e-7, "{}", w(rounded));

    // The documented error of neglecting polar motion, and then UT1 − UTC too.
    assert!((pef_km - itrf_km).length() < 0.02);
    let plain = itrf_from_teme(epoch) * teme_km;
    assert!((plain - pef_km).length() > 0.2 && (plain - pef_km).length() < 0.42);
}

#[test]
fn celestial_to_terrestrial_is_sofas_full_model() {
    // IAU 2006/2000A with the same UT1: another precession and a nutation of 1365 terms.
    let mut worst = 0.0_f64;
    for year in (1900..2100).step_by(5) {
        let epoch = utc(&format!("{year}-03-07T05:06:07Z"));
        let r = itrf_from_gcrf_with_ut1(epoch, 0.0);
        let tt = epoch.to_tai_duration().to_seconds() + 32.184;
        let (days, rest) = ((tt / 86_400.0).floor(), (tt / 86_400.0).fract());
        let jd = 2_415_020.5 + days;
        let ut = (5.0 * 3600.0 + 6.0 * 60.0 + 7.0) / 86_400.0;
        let midnight = if rest < ut { jd - 1.0 } else { jd };
        let full = sofars::pnp::c2t06a(jd, rest, midnight.max(jd - 1.0), ut, 0.0, 0.0);
        let full = DMat3::from_cols_array_2d(&full).transpose();
        let angle = (r * full.transpose())
            .mul_vec3(DVec3::new(0.6, 0.48, 0.64))
            .angle_between(DVec3::new(0.6, 0.48, 0.64));
        worst = worst.max(angle.to_degrees() * 3600.0);
    }
    println!("GCRF to ITRF against IAU 2006/2000A, 1900…2095: {worst:.4}″");
    assert!(worst < 0.1, "{worst}″");
}

#[test]
fn rotations_are_rotations() {
    for text in [
        "1900-01-01T00:00:00Z",
        "1969-07-20T20:17:40Z",
        "2018-01-15T12:00:00Z",
        "2099-12-31T00:00:00Z",
    ] {
        for r in [itrf_from_teme(utc(text)), itrf_from_gcrf(utc(text))] {
            assert!((r.determinant() - 1.0).abs() < 1e-14);
            assert!((r * r.transpose()).abs_diff_eq(DMat3::IDENTITY, 1e-14));
        }
    }
}

#[test]
fn the_earth_turns_evenly_through_a_leap_second_where_ut1_is_given() {
    // UT1 − UTC was −0.408 s before the leap second of 2016 and 0.592 s after it.
    let start = utc("2016-12-31T23:59:58Z");
    let step = utc("2017-01-01T00:00:00Z");
    let theta = |ms: i64| {
        let epoch = start + Duration::from_milliseconds(ms as f64);
        let dut1 = if epoch < step { -0.408 } else { 0.592 };
        angle_about_z(itrf_from_teme_with_ut1(epoch, dut1))
    };
    for ms in (0..5000).step_by(100) {
        let turned = (theta(ms + 100) - theta(ms)).rem_euclid(std::f64::consts::TAU);
        // Mean sidereal time runs with precession too: 1.002737909350795 turns a day.
        let expected = 0.1 * 1.002_737_909_350_795 * std::f64::consts::TAU / 86_400.0;
        assert!(
            (turned - expected).abs() < 1e-13,
            "{ms} ms: {turned} {expected}"
        );
    }
    // With UT1 = UTC the step is one second, as documented: back by 15″.
    let plain = |ms: i64| {
        angle_about_z(itrf_from_teme(
            start + Duration::from_milliseconds(ms as f64),
        ))
    };
    let back = (plain(3000) - plain(2999)).to_degrees() * 3600.0;
    assert!((back + 15.04).abs() < 0.05, "{back}″");
}

#[test]
fn the_earth_turns_eastwards_once_in_a_sidereal_day() {
    let epoch = utc("2018-01-15T12:00:00Z");
    let star = DVec3::X;
    let lon = |e: Epoch| {
        let v = itrf_from_teme(e) * star;
        v.y.atan2(v.x)
    };
    let later = epoch + Duration::from_seconds(86_164.090_53);
    assert!((lon(later) - lon(epoch)).abs() < 1e-8);
    // A star drifts west.
    assert!(lon(epoch + Duration::from_seconds(60.0)) < lon(epoch));
}
