//! Real orbits of January 2018 against what is known of them.

use crate::{ISS, config, edited, from_text, utc};
use glam::DVec3;
use std::path::{Path, PathBuf};
use terrella_frames::{Duration, Ellipsoid, Geodetic, itrf_from_teme, rfc3339};
use terrella_orbit::{Feed, Frame, OrbitState, TleFeed};

fn place(state: &OrbitState) -> Geodetic {
    Ellipsoid::WGS84.geodetic_from_itrf(state.position_itrf_m())
}

fn minutes(n: f64) -> Duration {
    Duration::from_seconds(n * 60.0)
}

#[test]
fn iss_flies_as_it_did() {
    let iss = TleFeed::built_in_iss().unwrap();
    assert_eq!((iss.name(), iss.catalogue_number()), ("ISS (ZARYA)", 25544));
    assert_eq!(rfc3339(iss.epoch()), "2018-01-20T21:33:14.841Z");
    let mut northernmost = 0.0_f64;
    let mut nodes = Vec::new();
    let mut previous: Option<(f64, OrbitState)> = None;
    for step in 0..(24 * 60 * 6) {
        let t = f64::from(step) / 6.0;
        let state = iss.state_at(iss.epoch() + minutes(t)).unwrap();
        assert_eq!(state.frame, Frame::Teme);
        let g = place(&state);
        northernmost = northernmost.max(g.lat_rad.to_degrees());
        assert!(
            (395e3..430e3).contains(&g.height_m),
            "height {}",
            g.height_m
        );
        let speed = state.velocity_m_s.length();
        assert!((7640.0..7690.0).contains(&speed), "speed {speed}");
        // Against the turning Earth an eastbound satellite is slower, by 465 m/s cos i at most there.
        let itrf = state.in_itrf();
        let ground_speed = itrf.velocity_m_s.length() * itrf.position_m.length().recip() * 6.371e6;
        assert!(
            (6750.0..7050.0).contains(&ground_speed),
            "ground speed {ground_speed}"
        );
        assert!(
            state.position_m.cross(state.velocity_m_s).z > 0.0,
            "flies west"
        );
        if let Some((t0, before)) = previous
            && before.position_m.z < 0.0
            && state.position_m.z >= 0.0
        {
            let z = (before.position_m.z, state.position_m.z);
            nodes.push(t0 + (t - t0) * z.0 / (z.0 - z.1));
        }
        previous = Some((t, state));
    }
    // Inclination 51.64°, and 0.19° more in geodetic latitude.
    assert!((northernmost - 51.83).abs() < 0.05, "{northernmost}°");
    let period = (nodes[nodes.len() - 1] - nodes[0]) / (nodes.len() - 1) as f64;
    // 15.5419 revolutions a day between perigees; the node comes 0.06 min sooner.
    assert!((period - 92.60).abs() < 0.08, "{period} min");
}

#[test]
fn goes_16_stands_over_75_degrees_west() {
    // The operational place of GOES-East since 18 December 2017. An Earth turned wrongly would put it elsewhere.
    let goes = config("geostationary.tle");
    let (first, last) = goes.validity();
    let mut t = first;
    while t <= last {
        let g = place(&goes.state_at(t).unwrap());
        let (lat, lon) = (g.lat_rad.to_degrees(), g.lon_rad.to_degrees());
        assert!(
            lat.abs() < 0.1 && (g.height_m - 35_786e3).abs() < 25e3,
            "{g:?}"
        );
        let days = (t - goes.epoch()).to_seconds() / 86_400.0;
        // It is controlled within 0.1°; elements do not include later burns, so far from their epoch it drifts.
        let tolerance = if days.abs() < 7.0 { 0.1 } else { 1.0 };
        assert!(
            (lon + 75.2).abs() < tolerance,
            "{} {days:.1} d: {lon}°",
            rfc3339(t)
        );
        t += Duration::from_hours(5.0);
    }
}

#[test]
fn molniya_stays_long_over_the_north() {
    let molniya = config("molniya.tle");
    let (mut lowest, mut highest, mut north, mut all) = (f64::INFINITY, 0.0_f64, 0, 0);
    for step in 0..1436 {
        let g = place(
            &molniya
                .state_at(molniya.epoch() + minutes(f64::from(step)))
                .unwrap(),
        );
        lowest = lowest.min(g.height_m);
        highest = highest.max(g.height_m);
        north += usize::from(g.lat_rad > 0.0);
        all += 1;
    }
    println!("{lowest:.0} … {highest:.0} m, north for {north} of {all} minutes");
    // a = 26 560 km, e = 0.735.
    assert!((500e3..900e3).contains(&lowest) && (39_400e3..40_000e3).contains(&highest));
    assert!(f64::from(north as u32) > 0.9 * f64::from(all));
}

#[test]
fn velocity_in_itrf_is_how_the_position_in_itrf_changes() {
    let feeds = [
        config("iss.tle"),
        config("molniya.tle"),
        config("geostationary.tle"),
    ];
    for feed in feeds {
        let mut worst = [0.0_f64; 2];
        for hour in -40..40 {
            let t = feed.epoch() + minutes(60.0 * f64::from(hour) + 7.0);
            let at = |s: f64| feed.state_at(t + Duration::from_seconds(s)).unwrap();
            // Fourth-order central difference.
            let rate = |of: fn(&OrbitState) -> DVec3| {
                (8.0 * (of(&at(0.5)) - of(&at(-0.5))) - (of(&at(1.0)) - of(&at(-1.0)))) / 6.0
            };
            let state = at(0.0);
            let itrf = state.in_itrf();
            assert_eq!(itrf.frame, Frame::Itrf);
            assert_eq!(itrf.position_m, state.position_itrf_m());
            // SGP4's velocity is not quite the rate of its position: 1 cm/s for the ISS, metres per second where Sun
            // and Moon pull at Molniya.
            let sgp4_off = rate(|s| s.position_m) - state.velocity_m_s;
            assert!(
                sgp4_off.length() < 5.0,
                "{} {hour} h: {sgp4_off}",
                feed.name()
            );
            // 7e-12 rad/s of precession is in sidereal time and not in ω: 0.3 mm/s at 42 000 km.
            let off = rate(OrbitState::position_itrf_m)
                - itrf.velocity_m_s
                - itrf_from_teme(t) * sgp4_off;
            worst = [worst[0].max(sgp4_off.length()), worst[1].max(off.length())];
            assert!(off.length() < 5e-4, "{} {hour} h: {off} m/s", feed.name());
        }
        println!(
            "{}: SGP4 {:.4} m/s, ours {:.5} m/s",
            feed.name(),
            worst[0],
            worst[1]
        );
    }
}

#[test]
fn states_convert_both_ways() {
    let iss = config("iss.tle");
    let teme = iss.state_at(utc("2018-01-15T12:00:00Z")).unwrap();
    let itrf = teme.in_itrf();
    assert_eq!(itrf.in_itrf(), itrf);
    assert_eq!(itrf.position_itrf_m(), itrf.position_m);
    let (a, b) = (
        teme.inertial_velocity_itrf_axes_m_s(),
        itrf.inertial_velocity_itrf_axes_m_s(),
    );
    assert!(a.distance(b) < 1e-11);
    // Turning axes changes no length and no angle.
    assert!((a.length() - teme.velocity_m_s.length()).abs() < 1e-11);
    let angle = teme.velocity_m_s.angle_between(teme.position_m);
    assert!((a.angle_between(itrf.position_m) - angle).abs() < 1e-12);
    assert!((itrf.velocity_m_s - a).length() > 100.0);
}

#[test]
fn the_station_flies_on_through_a_leap_second() {
    let text = format!("{}\n{}", edited(ISS[0], 19, "16366.83333333"), ISS[1]);
    let iss = from_text(&text, None).unwrap();
    let seconds = [
        "2016-12-31T23:59:58Z",
        "2016-12-31T23:59:59Z",
        "2016-12-31T23:59:60Z",
        "2017-01-01T00:00:00Z",
        "2017-01-01T00:00:01Z",
    ];
    let states = seconds.map(|text| iss.state_at(utc(text)).unwrap());
    for pair in states.windows(2) {
        let step_m = pair[1].position_m.distance(pair[0].position_m);
        assert!(
            (step_m - 7665.0).abs() < 25.0,
            "{step_m} m from {}",
            rfc3339(pair[0].epoch)
        );
    }
}

#[test]
fn reach_is_thirty_days_both_ways() {
    let iss = config("iss.tle");
    let (first, last) = iss.validity();
    assert_eq!(
        (rfc3339(first), rfc3339(last)),
        (
            "2017-12-21T21:33:14.841Z".into(),
            "2018-02-19T21:33:14.841Z".into()
        )
    );
    assert!(iss.state_at(first).is_ok() && iss.state_at(last).is_ok());
    for outside in [
        first - Duration::from_seconds(1e-3),
        last + Duration::from_seconds(1e-3),
        utc("1950-01-01T00:00:00Z"),
    ] {
        let error = iss.state_at(outside).unwrap_err().to_string();
        let expected = format!(
            "ISS (ZARYA) is not known at {}: its elements are valid from 2017-12-21T21:33:14.841Z to 2018-02-19T21:33:14.841Z",
            rfc3339(outside)
        );
        assert!(error.starts_with(&expected), "{error}");
    }
}

#[test]
fn no_epoch_makes_a_feed_panic() {
    let iss = config("iss.tle");
    for duration in [Duration::MAX, Duration::MIN, Duration::ZERO] {
        for scale in [
            hifitime::TimeScale::TAI,
            hifitime::TimeScale::UTC,
            hifitime::TimeScale::TDB,
            hifitime::TimeScale::GPST,
        ] {
            assert!(
                iss.state_at(hifitime::Epoch::from_duration(duration, scale))
                    .is_err()
            );
        }
    }
}

/// About a thousand real sets: all are read, and those still in orbit fly for a week.
#[test]
fn a_catalogue_of_real_sets_is_read() {
    let shared = std::env::var_os("TERRELLA_SHARED").map_or_else(
        || Path::new(crate::REPOSITORY).join("../shared"),
        PathBuf::from,
    );
    let path = shared.join("data/orbits/gpredict_tle_2018.dat");
    let Ok(text) = std::fs::read_to_string(&path) else {
        eprintln!(
            "SKIPPED: a_catalogue_of_real_sets_is_read, for want of {}",
            path.display()
        );
        return;
    };
    let field = |line: &'static str| text.lines().filter_map(move |l| l.strip_prefix(line));
    let (ones, twos, names): (Vec<_>, Vec<_>, Vec<_>) = (
        field("TLE1=").collect(),
        field("TLE2=").collect(),
        field("NAME=").collect(),
    );
    assert!(ones.len() > 900 && ones.len() == twos.len() && ones.len() == names.len());
    let sets: Vec<_> = names
        .iter()
        .zip(&ones)
        .zip(&twos)
        .map(|((n, a), b)| format!("0 {n}\r\n{a}\r\n{b}\r\n"))
        .collect();
    let (mut flown, mut failed) = (0, Vec::new());
    for set in &sets {
        let week = from_text(set, None)
            .and_then(|feed| feed.state_at(feed.epoch() + Duration::from_days(7.0)));
        match week {
            Ok(_) => flown += 1,
            Err(error) => failed.push(error.to_string()),
        }
    }
    println!(
        "{flown} of {} fly for a week; the others: {failed:#?}",
        sets.len()
    );
    assert!(failed.len() * 50 < sets.len(), "{failed:#?}");
    // As one file, each found by its number.
    let all = sets.concat();
    assert_eq!(
        from_text(&all, Some("iss (zarya)"))
            .unwrap()
            .catalogue_number(),
        25544
    );
    assert_eq!(from_text(&all, Some("41866")).unwrap().name(), "GOES 16");
}
