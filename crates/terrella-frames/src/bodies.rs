//! Where the Sun is, and the axes between the stars and the Earth.

use super::earth_motion::earth_motion;
use super::time::JulianDate;
use super::{Epoch, Orientation, itrf_from_gcrf_oriented, sun};
use glam::{DMat3, DVec3};

/// Metres in an astronomical unit (IAU 2012 resolution B2).
pub const ASTRONOMICAL_UNIT_M: f64 = 149_597_870_700.0;

/// Position of the Sun's centre relative to the Earth's in GCRF axes, metres; geometric, without light time and aberration.
///
/// From 1900 to 2100 by VSOP2000 (simplified): within 7 km and 0.01″ of DE440 for the dates of the tests. Outside these years by Meeus'
/// low-precision formula: accurate to 0.012° and 0.0001 au near them, less with every century.
pub fn sun_position_gcrf_m(epoch: Epoch) -> DVec3 {
    match earth_motion(JulianDate::tt(epoch)) {
        Some(earth) => -earth.from_sun_au * ASTRONOMICAL_UNIT_M,
        None => {
            let orientation = Orientation::default();
            let direction = sun::low_precision_direction_itrf(epoch, &orientation, 0.0);
            let distance = sun::low_precision_distance_au(epoch) * ASTRONOMICAL_UNIT_M;
            let itrf_from_gcrf = itrf_from_gcrf_oriented(epoch, &orientation);
            itrf_from_gcrf.transpose() * direction * distance
        }
    }
}

/// Rotation from GCRF axes to those of the celestial intermediate pole and origin (IAU 2000B): precession and nutation, without the daily rotation.
/// Combined with R3(ERA) and polar motion it gives [`super::itrf_from_gcrf_oriented`].
pub fn intermediate_from_gcrf(epoch: Epoch) -> DMat3 {
    let tt = JulianDate::tt(epoch);
    let rows = sofars::pnp::c2i00b(tt.midnight, tt.fraction);
    DMat3::from_cols_array_2d(&rows).transpose()
}

/// The Earth rotation angle of 2000, radians, 0…2π.
pub fn earth_rotation_angle_rad(epoch: Epoch, ut1_minus_utc_s: f64) -> f64 {
    let utc = JulianDate::utc(epoch);
    sofars::erst::era00(utc.midnight, utc.fraction + ut1_minus_utc_s / 86_400.0)
}

#[cfg(test)]
mod tests {
    use super::super::{Duration, itrf_from_pef, moon_position_gcrf_m};
    use super::*;

    /// JPL DE440 (Park, Folkner, Williams & Boggs 2021), geocentric, ICRF, km: Julian date (TDB, taken as TT), Moon, Sun.
    /// Evaluated from the published Chebyshev records.
    const DE440: [(f64, [f64; 3], [f64; 3]); 13] = [
        (
            2_433_282.50,
            [186_511.671, 312_836.791, 164_402.440],
            [27_334_093.1, -132_596_410.0, -57_505_195.2],
        ),
        (
            2_440_000.50,
            [359_052.235, 168_123.546, 79_029.516],
            [68_012_346.0, 124_219_815.2, 53_866_896.2],
        ),
        (
            2_445_500.50,
            [-261_330.281, 221_753.389, 124_507.012],
            [16_957_662.8, 138_544_485.3, 60_073_089.4],
        ),
        (
            2_448_724.50,
            [-252_118.712, 253_974.507, 87_497.137],
            [138_606_931.4, 52_541_670.9, 22_780_431.7],
        ),
        (
            2_451_545.00,
            [-291_608.385, -266_716.833, -76_102.487],
            [26_499_033.7, -132_757_417.3, -57_556_718.5],
        ),
        (
            2_453_750.50,
            [-207_820.363, 302_530.325, 166_233.285],
            [61_274_482.7, -122_743_253.4, -53_213_380.9],
        ),
        (
            2_455_000.50,
            [351_772.327, 115_081.885, 87_077.539],
            [8_549_745.3, 139_233_852.0, 60_362_069.4],
        ),
        (
            2_456_789.25,
            [-378_624.754, -75_389.883, -42_931.968],
            [95_563_632.9, 107_381_298.1, 46_550_966.5],
        ),
        (
            2_458_133.50,
            [13_141.872, -382_098.835, -137_979.262],
            [61_093_558.8, -122_829_535.5, -53_246_906.3],
        ),
        (
            2_459_580.50,
            [-91_868.546, -315_040.557, -145_304.427],
            [26_127_801.0, -132_825_709.3, -57_579_560.5],
        ),
        (
            2_460_676.50,
            [152_052.359, -307_823.632, -166_879.886],
            [26_730_662.3, -132_724_681.0, -57_534_860.6],
        ),
        (
            2_463_000.50,
            [306_241.420, -208_914.651, -52_968.258],
            [91_822_544.3, 110_174_677.4, 47_757_279.5],
        ),
        (
            2_469_807.50,
            [359_580.596, 98_050.678, 66_910.927],
            [25_672_814.9, -132_903_322.9, -57_602_712.0],
        ),
    ];

    fn epoch_of_tt(julian_date: f64) -> Epoch {
        let seconds = (julian_date - 2_451_545.0) * 86_400.0 - 32.184;
        Epoch::from_gregorian_tai_at_noon(2000, 1, 1) + Duration::from_seconds(seconds)
    }

    #[test]
    fn the_moon_and_the_sun_are_where_de440_has_them() {
        let (mut moon_km, mut moon_arcsec, mut sun_km, mut sun_arcsec) =
            (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
        for (date, moon, sun) in DE440 {
            let epoch = epoch_of_tt(date);
            let off = |found: DVec3, expected: [f64; 3]| {
                let expected = DVec3::from(expected) * 1e3;
                let arcsec = found.cross(expected).length() / expected.length_squared() * 206_264.8;
                ((found - expected).length() / 1e3, arcsec)
            };
            let (km, arcsec) = off(moon_position_gcrf_m(epoch), moon);
            (moon_km, moon_arcsec) = (moon_km.max(km), moon_arcsec.max(arcsec));
            let (km, arcsec) = off(sun_position_gcrf_m(epoch), sun);
            (sun_km, sun_arcsec) = (sun_km.max(km), sun_arcsec.max(arcsec));
        }
        println!("Moon: {moon_km:.1} km, {moon_arcsec:.1}″; Sun: {sun_km:.1} km, {sun_arcsec:.4}″");
        assert!(moon_km < 1.5 && moon_arcsec < 0.7);
        assert!(sun_km < 7.0 && sun_arcsec < 0.01);
    }

    /// Compared with JPL DE423, 1800 to 2200; the head of the table states how it was made.
    #[test]
    fn sun_and_moon_hold_for_two_hundred_years() {
        let table = include_str!("../../../tests/data/sky/sun_moon_de423.csv");
        let rows = table.lines().filter(|line| !line.starts_with('#')).skip(1);
        // ″ and km: the Sun within the theory's years, beyond them, and the Moon.
        let mut worst = [[0.0_f64; 2]; 3];
        let mut count = 0;
        for row in rows {
            let numbers = row
                .split(',')
                .map(|number| number.parse().expect("a number"));
            let numbers: Vec<f64> = numbers.collect();
            let epoch = epoch_of_tt(numbers[0]);
            let is_within = (2_415_020.5..2_488_070.0).contains(&numbers[0]);
            for (of, found, expected) in [
                (
                    usize::from(!is_within),
                    sun_position_gcrf_m(epoch),
                    &numbers[1..4],
                ),
                (2, moon_position_gcrf_m(epoch), &numbers[4..7]),
            ] {
                let expected = DVec3::from_slice(expected) * 1e3;
                let apart = found.cross(expected).length().atan2(found.dot(expected));
                let km = (found.length() - expected.length()).abs() / 1e3;
                let now = [apart.to_degrees() * 3600.0, km];
                worst[of] = [0, 1].map(|k| worst[of][k].max(now[k]));
            }
            count += 1;
        }
        println!("{count} rows, ″ and km: {worst:?}");
        assert!(count > 40);
        let bounds = [[0.02, 12.0], [30.0, 15_000.0], [0.7, 1.2]];
        for (worst, bound) in worst.iter().zip(bounds) {
            assert!(
                worst[0] < bound[0] && worst[1] < bound[1],
                "{worst:?} {bound:?}"
            );
        }
    }

    #[test]
    fn the_moon_is_where_meeus_has_it() {
        // Meeus 1998, example 47.a: 1992 April 12, 0 h TD: 368 409.7 km.
        let distance = moon_position_gcrf_m(epoch_of_tt(2_448_724.5)).length() / 1e3;
        // His selection of terms is within some kilometres of the whole theory.
        assert!((distance - 368_409.7).abs() < 5.0, "{distance}");
    }

    #[test]
    fn both_solar_formulas_join_in_2100() {
        let end = epoch_of_tt(2_488_070.0);
        let (before, after) = (
            sun_position_gcrf_m(end - Duration::from_seconds(1.0)),
            sun_position_gcrf_m(end + Duration::from_seconds(1.0)),
        );
        assert!(
            (before - after).length() < 4e7,
            "{}",
            (before - after).length()
        );
    }

    #[test]
    fn the_parts_make_the_whole_rotation() {
        let orientation = Orientation {
            ut1_minus_utc_s: 0.3,
            x_pole_rad: 1e-6,
            y_pole_rad: -2e-6,
        };
        for days in [0.0, 3000.25, 9000.7] {
            let epoch = Epoch::from_gregorian_tai_at_noon(2000, 1, 1) + Duration::from_days(days);
            let (sin, cos) = earth_rotation_angle_rad(epoch, 0.3).sin_cos();
            let turn = DMat3::from_cols(
                DVec3::new(cos, -sin, 0.0),
                DVec3::new(sin, cos, 0.0),
                DVec3::Z,
            );
            let parts = itrf_from_pef(&orientation) * turn * intermediate_from_gcrf(epoch);
            let whole = itrf_from_gcrf_oriented(epoch, &orientation);
            assert!(parts.abs_diff_eq(whole, 1e-10), "{days}");
        }
    }
}
