//! The Moon: where it is, and how it is turned.

// As the theory prints them.
#[allow(clippy::approx_constant)]
mod series;

use super::rotation::rotation_about_z;
use super::time::JulianDate;
use super::{Duration, Epoch};
use glam::{DMat3, DVec3};
use series::{DISTANCE, DISTANCE_T, LATITUDE, LATITUDE_T, LONGITUDE, LONGITUDE_T};
use std::f64::consts::PI;

/// Mean radius of the Moon, metres (IAU 2015).
pub const MOON_RADIUS_M: f64 = 1_737_400.0;

const ARCSEC: f64 = PI / 648_000.0;
/// Mean longitude W1, radians: its polynomial in Julian centuries of TDB from J2000.
const MEAN_LONGITUDE: [f64; 5] = [
    3.810_344_090_830_880_3,
    8_399.684_730_071_93,
    -3.318_952_042_550_094e-5,
    3.110_249_449_106_061_6e-8,
    -2.032_823_764_892_284_5e-10,
];
/// Inclination of the ecliptic of date to that of J2000, coefficients of powers 1…5 (Laskar 1986).
const LEAN_P: [f64; 6] = [
    0.0,
    0.101_803_91e-4,
    0.470_204_39e-6,
    -0.541_736_7e-9,
    -0.250_794_8e-11,
    0.463_486e-14,
];
const LEAN_Q: [f64; 6] = [
    0.0,
    -0.113_469_002e-3,
    0.123_726_74e-6,
    0.126_541_70e-8,
    -0.137_180_8e-11,
    -0.320_334e-14,
];
/// Obliquity of the inertial mean ecliptic of J2000 to the ICRS, and its node's distance from the ICRS' origin, arc seconds.
const OBLIQUITY: f64 = 84_381.409_28;
const NODE: f64 = -0.050_28;

/// The Moon's centre from the Earth's in GCRF axes, metres; geometric.
///
/// The 944 largest terms of ELP/MPP02 (Chapront and Francou 2003). They are within 0.6″ and 1 km of JPL's DE421 from 1900 to 2050 (0.12″
/// root mean square), and of the whole theory within 0.7″ from 1800 to 2200; the polynomials lose their meaning some thousand years away.
pub fn moon_position_gcrf_m(epoch: Epoch) -> DVec3 {
    // TDB is within 2 ms of TT: 2 m.
    let t = centuries(epoch);
    let sum = |terms: &[[f64; 6]]| {
        let value = |[amplitude, phase @ ..]: &[f64; 6]| amplitude * power_series(phase, t).sin();
        terms.iter().map(value).sum::<f64>()
    };
    let longitude =
        power_series(&MEAN_LONGITUDE, t) + (sum(&LONGITUDE) + t * sum(&LONGITUDE_T)) * ARCSEC;
    let latitude = (sum(&LATITUDE) + t * sum(&LATITUDE_T)) * ARCSEC;
    let distance_km = sum(&DISTANCE) + t * sum(&DISTANCE_T);
    let (sin, cos) = latitude.sin_cos();
    let of_date = DVec3::new(cos * longitude.cos(), cos * longitude.sin(), sin) * distance_km * 1e3;
    let (p, q) = (power_series(&LEAN_P, t), power_series(&LEAN_Q, t));
    let s = 2.0 * (1.0 - p * p - q * q).sqrt();
    let j2000_from_date = DMat3::from_cols(
        DVec3::new(1.0 - 2.0 * p * p, 2.0 * p * q, -p * s),
        DVec3::new(2.0 * p * q, 1.0 - 2.0 * q * q, q * s),
        DVec3::new(p * s, -q * s, 1.0 - 2.0 * (p * p + q * q)),
    );
    let (sin, cos) = (OBLIQUITY * ARCSEC).sin_cos();
    let equator_from_ecliptic = DMat3::from_cols(
        DVec3::X,
        DVec3::new(0.0, cos, sin),
        DVec3::new(0.0, -sin, cos),
    );
    rotation_about_z(-NODE * ARCSEC) * equator_from_ecliptic * j2000_from_date * of_date
}

/// Rotation from GCRF axes to axes fixed in the Moon: x to the middle of the near side, z to the north pole (mean Earth and mean axis of rotation).
///
/// By the report of the IAU's working group on cartographic coordinates of 2009 (Archinal et al. 2011), with the largest terms of its physical
/// librations: within 0.03° of JPL's DE421.
pub fn moon_from_gcrf(epoch: Epoch) -> DMat3 {
    let days = centuries(epoch) * 36_525.0;
    let angle = |at_j2000: f64, per_day: f64| (at_j2000 + per_day * days).to_radians();
    let e = [
        angle(125.045, -0.052_992_1),
        angle(250.089, -0.105_984_2),
        angle(260.008, 13.012_000_9),
        angle(176.625, 13.340_715_4),
        angle(357.529, 0.985_600_3),
        angle(311.589, 26.405_708_4),
        angle(134.963, 13.064_993_0),
        angle(276.617, 0.328_714_6),
        angle(34.226, 1.748_487_7),
        angle(15.134, -0.158_976_3),
        angle(119.743, 0.003_609_6),
        angle(239.961, 0.164_357_3),
        angle(25.053, 12.959_008_8),
    ];
    let sines = |factors: [f64; 13]| (0..13).map(|n| factors[n] * e[n].sin()).sum::<f64>();
    let cosines = |factors: [f64; 13]| (0..13).map(|n| factors[n] * e[n].cos()).sum::<f64>();
    let t = days / 36_525.0;
    #[rustfmt::skip]
    let right_ascension = 269.994_9 + 0.003_1 * t
        + sines([-3.8787, -0.1204, 0.0700, -0.0172, 0.0, 0.0072, 0.0, 0.0, 0.0, -0.0052, 0.0, 0.0, 0.0043]);
    #[rustfmt::skip]
    let declination = 66.539_2 + 0.013_0 * t
        + cosines([1.5419, 0.0239, -0.0278, 0.0068, 0.0, -0.0029, 0.0009, 0.0, 0.0, 0.0008, 0.0, 0.0, -0.0009]);
    #[rustfmt::skip]
    let turn = 38.321_3 + days * (13.176_358_15 - 1.4e-12 * days)
        + sines([3.5610, 0.1208, -0.0642, 0.0158, 0.0252, -0.0066, -0.0047, -0.0046, 0.0028, 0.0052, 0.0040, 0.0019, -0.0044]);
    let (sin, cos) = (90.0 - declination).to_radians().sin_cos();
    let about_x = DMat3::from_cols(
        DVec3::X,
        DVec3::new(0.0, cos, -sin),
        DVec3::new(0.0, sin, cos),
    );
    rotation_about_z(turn.to_radians())
        * about_x
        * rotation_about_z((right_ascension + 90.0).to_radians())
}

/// Where the Moon was when the light left it that reaches the Earth at `epoch`, as [`moon_position_gcrf_m`], and how long ago, seconds.
pub(super) fn retarded(epoch: Epoch, eye_gcrf_m: DVec3) -> (DVec3, f64) {
    const LIGHT_M_S: f64 = 299_792_458.0;
    // The Moon goes a kilometre a second: the second step is good to a metre.
    let mut seconds = 1.3;
    let mut moon = DVec3::ZERO;
    for _ in 0..2 {
        moon = moon_position_gcrf_m(epoch - Duration::from_seconds(seconds));
        seconds = (moon - eye_gcrf_m).length() / LIGHT_M_S;
        if !seconds.is_finite() {
            // Of an epoch that the series does not reach, or an eye that is nowhere.
            return (DVec3::NAN, 0.0);
        }
    }
    (moon, seconds)
}

/// Julian centuries of TT from J2000.
fn centuries(epoch: Epoch) -> f64 {
    let tt = JulianDate::tt(epoch);
    (tt.midnight - 2_451_545.0 + tt.fraction) / 36_525.0
}

fn power_series(factors: &[f64], t: f64) -> f64 {
    factors
        .iter()
        .rev()
        .fold(0.0, |sum, factor| sum * t + factor)
}
