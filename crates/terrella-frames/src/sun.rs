//! The Sun.

use super::earth_motion::{EarthMotion, earth_motion};
use super::rotation::{itrf_from_gcrf_oriented, itrf_from_pef, rotation_about_z};
use super::time::JulianDate;
use super::{Epoch, Geodetic, Orientation};
use glam::DVec3;

/// Mean angular radius of the Sun's disc, radians.
pub const SUN_RADIUS_RAD: f64 = 0.004_65;

/// Unit vector from the Earth's centre to the Sun in ITRF axes: the apparent direction, where its light comes from.
///
/// From 1900 to 2100 by the Earth ephemeris VSOP2000 (simplified, 11 km at worst, 0.02″) with annual aberration (20.5″)
/// put in and the rest of [`itrf_from_gcrf`](super::itrf_from_gcrf)'s limits: 13.5″, mostly UT1. Outside these years by Meeus' low-precision
/// formula, 0.012° near these years and worse with every century. Parallax (8.8″ at the surface) is left out.
pub fn sun_direction_itrf(epoch: Epoch) -> DVec3 {
    sun_direction_itrf_oriented(epoch, &Orientation::default())
}

/// As [`sun_direction_itrf`], with the measured part of the Earth's rotation: accurate to 0.1″ from 1900 to 2100.
pub fn sun_direction_itrf_oriented(epoch: Epoch, orientation: &Orientation) -> DVec3 {
    match earth_motion(JulianDate::tt(epoch)) {
        Some(earth) => itrf_from_gcrf_oriented(epoch, orientation) * apparent_direction(earth),
        None => low_precision_direction_itrf(epoch, orientation, ABERRATION_DEG),
    }
}

/// The subsolar point, where the Sun is in the zenith: geodetic latitude and longitude, height 0.
///
/// On an ellipsoid the zenith is the direction of the surface normal, so the latitude is that of the Sun's direction (its declination). The point
/// where the line to the Earth's centre meets the surface is up to 0.07° away.
pub fn subsolar_point(epoch: Epoch) -> Geodetic {
    let sun = sun_direction_itrf(epoch);
    Geodetic {
        // By atan2, which is exact where asin loses half its digits.
        lat_rad: sun.z.atan2(sun.x.hypot(sun.y)),
        lon_rad: sun.y.atan2(sun.x),
        height_m: 0.0,
    }
}

/// The Sun's direction in GCRF.
fn apparent_direction(earth: EarthMotion) -> DVec3 {
    // The Sun itself moves 7 km while its light is on the way: 0.01″, left out.
    let to_sun = -earth.from_sun_au;
    let distance_au = to_sun.length();
    let natural = to_sun / distance_au;
    // Speed of light, au per day: IAU 2012 astronomical unit over c.
    let beta = earth.velocity_au_day / sofars::consts::DC;
    aberrated(natural, beta, distance_au)
}

/// Where light is seen to come from that comes along a unit direction, by an eye that moves with this part of the speed of light,
/// so many au from the Sun.
pub(super) fn aberrated(natural: DVec3, beta: DVec3, sun_au: f64) -> DVec3 {
    let inverse_gamma = (1.0 - beta.length_squared()).max(0.0).sqrt();
    let (natural, beta) = (natural.to_array(), beta.to_array());
    DVec3::from(sofars::astro::ab(&natural, &beta, sun_au, inverse_gamma))
}

/// Displacement of the Sun by aberration, degrees of longitude: 20.5″.
const ABERRATION_DEG: f64 = 0.005_69;

/// Meeus, Astronomical Algorithms (1998), chapter 25, with mean equator and equinox of date turned by mean sidereal time, moved back by
/// the aberration given.
pub(super) fn low_precision_direction_itrf(
    epoch: Epoch,
    orientation: &Orientation,
    aberration_deg: f64,
) -> DVec3 {
    let tt = JulianDate::tt(epoch);
    let t = (tt.midnight - 2_451_545.0 + tt.fraction) / 36_525.0;
    // L0, M, C: mean longitude, mean anomaly, equation of the centre, degrees.
    let mean_longitude = 280.466_46 + t * (36_000.769_83 + t * 0.000_303_2);
    let anomaly = (357.529_11 + t * (35_999.050_29 - t * 0.000_153_7)).to_radians();
    let centre = (1.914_602 - t * (0.004_817 + t * 0.000_014)) * anomaly.sin()
        + (0.019_993 - t * 0.000_101) * (2.0 * anomaly).sin()
        + 0.000_289 * (3.0 * anomaly).sin();
    let longitude = (mean_longitude + centre - aberration_deg).to_radians();
    let obliquity = (23.439_291_1 - t * 0.013_004_2).to_radians();
    let direction = DVec3::new(
        longitude.cos(),
        obliquity.cos() * longitude.sin(),
        obliquity.sin() * longitude.sin(),
    );
    let utc = JulianDate::utc(epoch);
    let fraction = utc.fraction + orientation.ut1_minus_utc_s / 86_400.0;
    let pef_from_equator = rotation_about_z(sofars::erst::gmst82(utc.midnight, fraction));
    itrf_from_pef(orientation) * (pef_from_equator * direction)
}

/// Distance that goes with it (Meeus 25.5), astronomical units.
pub(super) fn low_precision_distance_au(epoch: Epoch) -> f64 {
    let tt = JulianDate::tt(epoch);
    let t = (tt.midnight - 2_451_545.0 + tt.fraction) / 36_525.0;
    let anomaly = (357.529_11 + t * (35_999.050_29 - t * 0.000_153_7)).to_radians();
    let eccentricity = 0.016_708_634 - t * (0.000_042_037 + t * 0.000_000_126_7);
    let centre = (1.914_602 * anomaly.sin() + 0.019_993 * (2.0 * anomaly).sin()).to_radians();
    1.000_001_018 * (1.0 - eccentricity * eccentricity)
        / (1.0 + eccentricity * (anomaly + centre).cos())
}

#[cfg(test)]
mod tests {
    use super::super::Duration;
    use super::*;

    #[test]
    fn both_formulas_agree_where_both_hold() {
        let mut worst = 0.0_f64;
        for step in 0..2000 {
            let epoch = Epoch::from_gregorian_utc_at_midnight(1900, 1, 2)
                + Duration::from_days(f64::from(step) * 36.4 + 0.123);
            let other =
                low_precision_direction_itrf(epoch, &Orientation::default(), ABERRATION_DEG);
            let angle = sun_direction_itrf(epoch).angle_between(other);
            worst = worst.max(angle.to_degrees());
        }
        println!("low precision against ephemeris, 1900…2099: {worst:.5}°");
        assert!(worst < 0.0125, "{worst}°");
    }

    #[test]
    fn the_sun_moves_with_the_earths_clock_and_pole() {
        let arcsecond = 1f64.to_radians() / 3600.0;
        // Inside the ephemeris and outside it. At noon UTC the Sun is near 0° E.
        for year in [2018, 2150] {
            let noon = Epoch::from_gregorian_utc(year, 4, 15, 12, 0, 0, 0);
            let place = |orientation| {
                let sun = sun_direction_itrf_oriented(noon, &orientation);
                (sun.z.asin(), sun.y.atan2(sun.x))
            };
            let still = place(Orientation::default());
            assert!(still.1.abs() < 0.01);
            assert_eq!(
                sun_direction_itrf(noon).y.atan2(sun_direction_itrf(noon).x),
                still.1
            );
            // UT1 ahead by half a second: the Earth has rotated 15.041″ a second further, and the Sun is farther west.
            let ahead = place(Orientation {
                ut1_minus_utc_s: 0.5,
                ..Orientation::default()
            });
            assert!(
                ((still.1 - ahead.1) / arcsecond - 7.5205).abs() < 1e-3,
                "{year}"
            );
            assert!((ahead.0 - still.0).abs() / arcsecond < 1e-3);
            // The pole is displaced by 0.3″ towards 0° E: the Sun there is that much nearer to it than to ITRF's z axis.
            let leaning = place(Orientation {
                x_pole_rad: 0.3 * arcsecond,
                ..Orientation::default()
            });
            assert!(
                ((still.0 - leaning.0) / arcsecond - 0.3).abs() < 1e-3,
                "{year}"
            );
        }
    }

    #[test]
    fn the_two_ranges_join() {
        // The ephemeris ends at 12 h TT on 1 January 2100.
        let end = super::super::utc_from_rfc3339("2099-12-31T23:59:59Z").unwrap();
        for hours in [1.0, 11.0, 12.0, 13.0, 24.0] {
            let angle = |h: f64| {
                let sun = subsolar_point(end + Duration::from_hours(h));
                (sun.lon_rad.to_degrees() + 15.0 * h).rem_euclid(360.0)
            };
            assert!((angle(hours) - angle(0.0)).abs() < 0.15, "{hours} h");
        }
    }

    #[test]
    fn any_epoch_gives_a_unit_vector() {
        for epoch in [
            Epoch::from_tai_duration(Duration::MAX),
            Epoch::from_tai_duration(Duration::MIN),
            Epoch::from_gregorian_tai_at_noon(-4712, 1, 1),
            Epoch::from_gregorian_tai_at_noon(9999, 1, 1),
        ] {
            let sun = sun_direction_itrf(epoch);
            assert!((sun.length() - 1.0).abs() < 1e-9, "{epoch:?}: {sun}");
            let _ = super::super::rfc3339(epoch);
        }
    }
}
