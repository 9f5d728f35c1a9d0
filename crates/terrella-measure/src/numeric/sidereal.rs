//! How far the Earth has turned: Greenwich mean sidereal time of 1982.

use super::formula::{AnyFormula, ErrorMeasure, Form, Formula};
use super::oracle::Real;
use std::f64::consts::TAU;
use terrella::frames::{itrf_from_teme, tai_from_utc_day};

/// An instant of UT1.
#[derive(Clone, Copy)]
struct Instant {
    /// Day, as a modified Julian date.
    mjd: i64,
    ns_of_day: i64,
}

const NS_PER_DAY: i64 = 86_400_000_000_000;

/// Twelve instants of a year, none of them round.
fn instants(year: f64) -> Vec<Instant> {
    let first = 51_544 + ((year - 2_000.0) * 365.25).floor() as i64;
    (0..12)
        .map(|k| Instant {
            mjd: first + 30 * k,
            ns_of_day: (k * 7_654_321_987_651 + 12_345_678_901) % NS_PER_DAY,
        })
        .collect()
}

/// Angle from the exact one, arc seconds. Aoki et al. 1982 (Astron. Astrophys. 105, 359), in seconds of time, T in Julian
/// centuries of UT1 from J2000: 24110.54841 + 8640184.812866 T + 0.093104 T² − 6.2e-6 T³ at 0 h, and the time of day.
fn off_arc_seconds(at: &Instant, theta: f64) -> f64 {
    let day = Real::from(86_400.0);
    let of_day = Real::from(at.ns_of_day) / Real::from(NS_PER_DAY);
    let t = (Real::from(at.mjd - 51_544) - Real::from(0.5) + &of_day) / Real::from(36_525.0);
    let seconds = Real::decimal("24110.54841")
        + (Real::decimal("8640184.812866")
            + (Real::decimal("0.093104") - Real::decimal("0.0000062") * &t) * &t)
            * &t;
    let exact = seconds / day + of_day;
    let turns = Real::from(theta) / (Real::pi() + Real::pi()) - exact;
    let off = &turns - (&turns + Real::from(0.5)).floor();
    (off.abs() * Real::from(1_296_000.0)).to_f64()
}

pub(super) fn formulas() -> Vec<Box<dyn AnyFormula>> {
    vec![Box::new(Formula {
        name: "mean sidereal time",
        range: "1800 to 2200",
        parameter: "year",
        values: (0..=80).map(|k| 1_800.0 + 5.0 * f64::from(k)).collect(),
        inputs: instants,
        error_measure: ErrorMeasure::by("arc seconds", |at: &Instant, theta: &f64| {
            off_arc_seconds(at, *theta)
        }),
        forms: vec![
            Form {
                // Vallado 2013, eq. 3-45.
                name: "as printed: one Julian date",
                bound: None,
                value: |at| {
                    let of_day = at.ns_of_day as f64 / NS_PER_DAY as f64;
                    let julian_date = at.mjd as f64 + 2_400_000.5 + of_day;
                    let t = (julian_date - 2_451_545.0) / 36_525.0;
                    let seconds = 67_310.548_41
                        + (876_600.0 * 3_600.0 + 8_640_184.812_866) * t
                        + 0.093_104 * t * t
                        - 6.2e-6 * t * t * t;
                    (seconds / 86_400.0).rem_euclid(1.0) * TAU
                },
            },
            Form {
                name: "stable: day and fraction apart",
                bound: Some(1e-6),
                value: |at| {
                    let r = itrf_from_teme(tai_from_utc_day(at.mjd, at.ns_of_day));
                    (-r.x_axis.y).atan2(r.x_axis.x)
                },
            },
        ],
    })]
}
