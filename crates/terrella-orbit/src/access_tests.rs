//! Access against a look at every second, and against passes.

use super::*;
use crate::kepler::{Anomaly, Drift, KeplerElements, KeplerFeed, KeplerOptions, OrbitSize};
use crate::{Frame, Sgp4Feed, passes};
use std::path::Path;
use terrella_frames::{Geodetic, utc_from_rfc3339};

fn still(_: Epoch) -> Orientation {
    Orientation::default()
}

fn begin() -> Epoch {
    utc_from_rfc3339("2018-01-20T00:00:00Z").expect("a date")
}

fn iss() -> Sgp4Feed {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../config/orbits/iss.tle");
    Sgp4Feed::from_file(&path, None).expect("released elements")
}

/// A circular orbit.
fn circle(axis_m: f64, inclination_deg: f64, anomaly_deg: f64) -> KeplerFeed {
    let elements = KeplerElements {
        size: OrbitSize::SemiMajorAxis(axis_m),
        eccentricity: 0.0,
        inclination_rad: inclination_deg.to_radians(),
        raan_rad: 1.0,
        argument_of_periapsis_rad: 0.0,
        anomaly: Anomaly::True(anomaly_deg.to_radians()),
    };
    let options = KeplerOptions {
        drift: Drift::None,
        first: begin() - Duration::from_days(1.0),
        last: begin() + Duration::from_days(60.0),
    };
    KeplerFeed::from_elements("test", Frame::Teme, begin(), &elements, options).expect("an orbit")
}

fn seconds(access: &Access) -> (f64, f64) {
    let since = |epoch: Epoch| (epoch - begin()).to_seconds();
    (since(access.begin), since(access.end))
}

/// Points of the longest line are 230 km apart: between them it may pass 1 km below the limb, for half a second.
const MISSED_S: f64 = 0.6;

/// For every second: whether 200 points of the line are outside the ellipsoid, the distance is in range, and the Sun is not completely hidden.
fn brute_force(a: &dyn Feed, b: &dyn Feed, rule: &AccessRule, end_s: u32) -> Vec<(f64, f64)> {
    let mut found: Vec<(f64, f64)> = Vec::new();
    let mut is_open = false;
    for second in 0..=end_s {
        let t = f64::from(second);
        let epoch = begin() + Duration::from_seconds(t);
        let place = |feed: &dyn Feed| {
            let state = feed.state_at(epoch).expect("known");
            state.in_frame(Frame::Itrf, &still(epoch)).position_m
        };
        let (from, to) = (place(a), place(b));
        let is_clear = (0..=200).all(|k| {
            let point = from.lerp(to, f64::from(k) / 200.0);
            let (a, b) = (
                6_378_137.0 + rule.min_height_m,
                6_356_752.314_245 + rule.min_height_m,
            );
            point.truncate().length_squared() / (a * a) + point.z * point.z / (b * b) > 1.0
        });
        let is_lit = !rule.needs_sunlight || {
            let sun = sun_position_itrf_m(epoch, &still(epoch));
            illumination(to, sun, &Ellipsoid::WGS84).0 != Illumination::Umbra
        };
        let has = is_clear && is_lit && from.distance(to) <= rule.max_range_m;
        match (has, is_open) {
            (true, false) => found.push((t, t)),
            (true, true) => found.last_mut().expect("open").1 = t,
            _ => {}
        }
        is_open = has;
    }
    found
}

#[test]
fn satellites_see_each_other_as_at_every_second() {
    let (iss, other) = (iss(), circle(7.2e6, 98.0, 40.0));
    let geostationary = circle(42_164e3, 0.1, 200.0);
    let end_s = 9000;
    let span = (begin(), begin() + Duration::from_seconds(f64::from(end_s)));
    let find = |to: &dyn Feed, rule: &AccessRule| {
        let from = AccessFrom::Satellite(&iss);
        accesses(from, to, rule, &Ellipsoid::WGS84, &still, span).expect("known")
    };
    let any = AccessRule::default();
    // A range that cuts the first access.
    let (least_m, greatest_m) = find(&other, &any)[0].range_m;
    let in_range = AccessRule {
        max_range_m: 0.5 * (least_m + greatest_m),
        ..any
    };
    let above_air = AccessRule {
        min_height_m: 80e3,
        ..any
    };
    let sunlit = AccessRule {
        needs_sunlight: true,
        ..any
    };
    let mut count = 0;
    for (to, rule) in [
        (&other, any),
        (&other, in_range),
        (&other, above_air),
        (&other, sunlit),
        (&geostationary, any),
    ] {
        let found = find(to, &rule);
        count += found.len();
        let expected = brute_force(&iss, to, &rule, end_s);
        assert_eq!(found.len(), expected.len(), "{rule:?}");
        for (access, (first, last)) in found.iter().zip(expected) {
            let (begin, end) = seconds(access);
            assert!(
                begin < first + MISSED_S && begin > first - 1.01,
                "{begin} {first}"
            );
            assert!(end > last - MISSED_S && end < last + 1.01, "{end} {last}");
            assert!(
                access.range_m.0 <= access.range_m.1
                    && access.range_m.1 <= rule.max_range_m * (1.0 + 1e-6)
            );
        }
    }
    assert!(count > 4, "{count}");
}

#[test]
fn stations_have_access_in_passes_and_within_range() {
    let iss = iss();
    let place = Geodetic::from_degrees(48.2, 16.4, 200.0);
    let observer = Observer::new(place, &Ellipsoid::WGS84, 5_f64.to_radians(), &still);
    let span = (begin(), begin() + Duration::from_days(2.0));
    let find = |rule: &AccessRule| {
        let from = AccessFrom::Station(&observer);
        accesses(from, &iss, rule, &Ellipsoid::WGS84, &still, span).expect("known")
    };
    let all = find(&AccessRule::default());
    let passes: Vec<_> = passes(&iss, &observer, span.0, span.1)
        .collect::<Result<_, _>>()
        .expect("known");
    assert_eq!(all.len(), passes.len());
    for (access, pass) in all.iter().zip(&passes) {
        assert!((access.begin - pass.begin).to_seconds().abs() < 3e-3);
        assert!((access.end - pass.end).to_seconds().abs() < 3e-3);
        let least = observer
            .look_angles(&iss.state_at(pass.highest).expect("known"))
            .distance_m;
        assert!(access.range_m.0 >= least - 1e3 && access.range_m.1 < 2.5e6);
    }
    let near = find(&AccessRule {
        max_range_m: 1e6,
        ..AccessRule::default()
    });
    assert!(!near.is_empty() && near.len() < all.len());
    for access in &near {
        let range = |epoch| {
            observer
                .look_angles(&iss.state_at(epoch).expect("known"))
                .distance_m
        };
        assert!((range(access.begin) - 1e6).abs() < 20.0 && (range(access.end) - 1e6).abs() < 20.0);
    }
}

/// Two satellites on one orbit always or never have each other in sight.
#[test]
fn what_never_changes_has_no_ends() {
    let (near, ahead, opposite) = (
        circle(7e6, 50.0, 0.0),
        circle(7e6, 50.0, 20.0),
        circle(7e6, 50.0, 180.0),
    );
    let span = (begin(), begin() + Duration::from_seconds(20_000.0));
    let find = |to: &KeplerFeed| {
        let from = AccessFrom::Satellite(&near);
        accesses(
            from,
            to,
            &AccessRule::default(),
            &Ellipsoid::WGS84,
            &still,
            span,
        )
        .expect("known")
    };
    let [always] = find(&ahead)[..] else {
        panic!("one access")
    };
    assert!(!always.starts && !always.stops && seconds(&always) == (0.0, 20_000.0));
    // The chord of 20° at 7000 km.
    let chord = 2.0 * 7e6 * 10_f64.to_radians().sin();
    assert!((always.range_m.0 - chord).abs() < 1.0 && (always.range_m.1 - chord).abs() < 1.0);
    assert!(find(&opposite).is_empty());
    let none = (
        span.1 + Duration::from_days(100.0),
        span.1 + Duration::from_days(101.0),
    );
    let from = AccessFrom::Satellite(&near);
    let found = accesses(
        from,
        &ahead,
        &AccessRule::default(),
        &Ellipsoid::WGS84,
        &still,
        none,
    );
    assert_eq!(found.expect("nothing to look at"), []);
}
