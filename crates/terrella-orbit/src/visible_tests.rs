//! Visible times against Skyfield, and the magnitude against the formula's own case.

use super::*;
use crate::{Sgp4Feed, passes};
use std::path::Path;
use terrella_frames::{Ellipsoid, Geodetic, Orientation, utc_from_rfc3339};

fn instant(text: &str) -> Epoch {
    utc_from_rfc3339(text).expect("a date")
}

fn station() -> Sgp4Feed {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../config/orbits");
    Sgp4Feed::from_file(&folder.join("iss.tle"), None).expect("released elements")
}

fn still(_: Epoch) -> Orientation {
    Orientation::default()
}

const RULE: VisibilityRule = VisibilityRule {
    sun_below_rad: -0.104_719_755_119_659_77,
    standard_magnitude: Some(-1.8),
};

/// Latitude and longitude, degrees, height, metres, and the days from 2018-01-21 on that are looked through.
type Place = ([f64; 3], [f64; 2]);

/// Rise, set, first and last visible instant, least magnitude.
type Visible = [&'static str; 4];

/// From Skyfield 1.55 with DE421: SGP4 in TEME, the Sun's apparent place, and the umbra by rays to 2000 points of the Sun's limb that are
/// intersected with WGS84; ends by bisection. Its magnitude counts the share of 20 000 points of the Sun's disc that
/// are seen.
const SKYFIELD: &[(Place, &[(Visible, f64)])] = &[
    (
        ([48.2, 16.4, 200.0], [0.0, 6.0]),
        &[
            (
                [
                    "2018-01-25T17:12:40.916Z",
                    "2018-01-25T17:15:24.889Z",
                    "2018-01-25T17:12:40.917Z",
                    "2018-01-25T17:13:47.782Z",
                ],
                -1.573,
            ),
            (
                [
                    "2018-01-26T17:54:41.396Z",
                    "2018-01-26T18:00:49.778Z",
                    "2018-01-26T17:54:41.397Z",
                    "2018-01-26T17:56:37.635Z",
                ],
                -2.064,
            ),
        ],
    ),
    (
        ([60.0, 10.0, 100.0], [7.0, 12.0]),
        &[
            (
                [
                    "2018-01-29T18:31:34.329Z",
                    "2018-01-29T18:35:30.159Z",
                    "2018-01-29T18:31:34.330Z",
                    "2018-01-29T18:31:57.360Z",
                ],
                -0.919,
            ),
            (
                [
                    "2018-01-30T17:40:03.283Z",
                    "2018-01-30T17:42:54.753Z",
                    "2018-01-30T17:40:03.284Z",
                    "2018-01-30T17:41:50.124Z",
                ],
                -1.534,
            ),
            (
                [
                    "2018-01-31T18:22:42.009Z",
                    "2018-01-31T18:27:18.648Z",
                    "2018-01-31T18:22:42.010Z",
                    "2018-01-31T18:24:19.826Z",
                ],
                -1.51,
            ),
            (
                [
                    "2018-02-01T17:30:49.592Z",
                    "2018-02-01T17:34:59.277Z",
                    "2018-02-01T17:30:49.593Z",
                    "2018-02-01T17:34:08.460Z",
                ],
                -1.796,
            ),
            (
                [
                    "2018-02-01T19:06:12.432Z",
                    "2018-02-01T19:11:00.301Z",
                    "2018-02-01T19:06:12.433Z",
                    "2018-02-01T19:06:47.661Z",
                ],
                -0.621,
            ),
        ],
    ),
    (
        ([48.2, 16.4, 200.0], [20.0, 29.0]),
        &[
            (
                [
                    "2018-02-10T17:41:33.587Z",
                    "2018-02-10T17:47:31.095Z",
                    "2018-02-10T17:41:33.588Z",
                    "2018-02-10T17:46:45.017Z",
                ],
                -2.399,
            ),
            (
                [
                    "2018-02-11T16:49:03.145Z",
                    "2018-02-11T16:55:26.843Z",
                    "2018-02-11T16:49:03.146Z",
                    "2018-02-11T16:55:26.842Z",
                ],
                -3.202,
            ),
            (
                [
                    "2018-02-11T18:27:45.417Z",
                    "2018-02-11T18:28:28.879Z",
                    "2018-02-11T18:27:45.418Z",
                    "2018-02-11T18:28:28.878Z",
                ],
                -0.345,
            ),
            (
                [
                    "2018-02-12T17:33:44.500Z",
                    "2018-02-12T17:38:13.556Z",
                    "2018-02-12T17:33:44.501Z",
                    "2018-02-12T17:38:13.555Z",
                ],
                -1.109,
            ),
            (
                [
                    "2018-02-13T16:40:55.192Z",
                    "2018-02-13T16:46:37.712Z",
                    "2018-02-13T16:45:15.630Z",
                    "2018-02-13T16:46:37.711Z",
                ],
                -1.7,
            ),
        ],
    ),
    (([-33.5, -70.25, 520.0], [0.0, 6.0]), &[]),
];

#[test]
fn visible_times_are_those_of_skyfield() {
    let station = station();
    let start = instant("2018-01-21T00:00:00Z");
    let mut farthest = (0.0_f64, 0.0_f64);
    for (([lat, lon, height_m], days), wanted) in SKYFIELD {
        let place = Geodetic::from_degrees(*lat, *lon, *height_m);
        let observer = Observer::new(place, &Ellipsoid::WGS84, 10_f64.to_radians(), &still);
        let [from, until] = days.map(|days| start + Duration::from_days(days));
        let mut found = Vec::new();
        for pass in passes(&station, &observer, from, until) {
            let pass = pass.expect("known");
            let visible = visible_intervals(&station, &observer, &pass, &RULE).expect("known");
            found.extend(visible.into_iter().map(|one| (pass, one)));
        }
        assert_eq!(found.len(), wanted.len(), "{lat} {lon}: {found:#?}");
        for ((pass, one), (times, magnitude)) in found.iter().zip(*wanted) {
            let ours = [pass.begin, pass.end, one.begin, one.end];
            for (ours, wanted) in ours.iter().zip(times) {
                let off = (*ours - instant(wanted)).to_seconds().abs();
                assert!(off < 1.0, "{wanted}: {off} s");
                farthest.0 = farthest.0.max(off);
            }
            let (at, least) = one.brightest.expect("a magnitude");
            assert!((one.begin..=one.end).contains(&at));
            let off = (least - magnitude).abs();
            assert!(off < 0.01, "{times:?}: {least}");
            farthest.1 = farthest.1.max(off);
        }
    }
    println!(
        "{:.3} s, {:.3} magnitudes apart at most",
        farthest.0, farthest.1
    );
}

#[test]
fn a_bright_sky_and_the_shadow_hide_a_satellite() {
    let station = station();
    let start = instant("2018-01-25T00:00:00Z");
    let place = Geodetic::from_degrees(48.2, 16.4, 200.0);
    let observer = Observer::new(place, &Ellipsoid::WGS84, 10_f64.to_radians(), &still);
    let end = start + Duration::from_days(6.0);
    let visible_s = |sun_below_deg: f64| -> f64 {
        let rule = VisibilityRule {
            sun_below_rad: f64::to_radians(sun_below_deg),
            standard_magnitude: None,
        };
        let mut sum = 0.0;
        for pass in passes(&station, &observer, start, end) {
            let visible = visible_intervals(&station, &observer, &pass.expect("known"), &rule);
            for one in visible.expect("known") {
                assert_eq!(one.brightest, None);
                sum += (one.end - one.begin).to_seconds();
            }
        }
        sum
    };
    let [day, dusk, night] = [90.0, -6.0, -90.0].map(visible_s);
    assert_eq!(night, 0.0);
    // Passes of the day are sunlit.
    assert!(dusk > 60.0 && day > dusk + 60.0, "{dusk} {day}");
}

#[test]
fn the_standard_magnitude_is_that_of_half_a_disc_at_1000_km() {
    let half = std::f64::consts::FRAC_PI_2;
    let magnitude = |range_m, phase| RULE.magnitude(range_m, phase).expect("given");
    // −15.75 is rounded from −15.7526.
    assert!((magnitude(1e6, half) + 1.8).abs() < 0.003);
    assert!((magnitude(2e6, half) - magnitude(1e6, half) - 5.0 * 2_f64.log10()).abs() < 1e-12);
    assert!((magnitude(1e6, half) - magnitude(1e6, 0.0) - 2.5 * 2_f64.log10()).abs() < 1e-12);
    assert_eq!(VisibilityRule::default().magnitude(1e6, half), None);
}
