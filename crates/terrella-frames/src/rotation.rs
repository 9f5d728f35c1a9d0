//! Earth rotation: from the axes that orbits and ephemerides use to axes fixed in the Earth.
//!
//! Computed with `sofars`, a Rust translation of the IAU's SOFA routines; the functions here are our own.

use super::time::JulianDate;
use super::{Epoch, Orientation};
use glam::{DMat3, DVec3};

/// Angular velocity of the Earth about ITRF z, radians per second of UT1 (Vallado 2013, eq. 3-40; length of day 86 400 s).
pub const EARTH_ROTATION_RATE_RAD_S: f64 = 7.292_115_146_706_98e-5;

/// Rotation from TEME axes (true equator, mean equinox: the output of SGP4) to ITRF axes at `epoch`, with UT1 = UTC.
///
/// R = R3(θ), θ = Greenwich mean sidereal time of UT1, IAU 1982 (Vallado, Crawford, Hujsak & Kelso 2006, appendix C).
/// Neglected effects, as the largest shift of a point at the equator:
/// - UT1 − UTC, which leap seconds keep below 0.9 s: 13.5″, 420 m. [`itrf_from_teme_with_ut1`] takes the true value. With UT1 = UTC, a leap second
///   is a real step: the Earth rotates through 23:59:60 and then jumps back by one second, 15″, at 0 h.
/// - Polar motion, 0.6″, 20 m.
pub fn itrf_from_teme(epoch: Epoch) -> DMat3 {
    itrf_from_teme_with_ut1(epoch, 0.0)
}

/// As [`itrf_from_teme`], with UT1 − UTC in seconds (IERS Bulletin A): what is left is polar motion, 20 m.
pub fn itrf_from_teme_with_ut1(epoch: Epoch, ut1_minus_utc_s: f64) -> DMat3 {
    let ut1 = ut1(epoch, ut1_minus_utc_s);
    rotation_about_z(sofars::erst::gmst82(ut1.midnight, ut1.fraction))
}

/// Rotation from GCRF axes (J2000 to within 0.02″) to ITRF axes at `epoch`, with UT1 = UTC.
///
/// IAU 2000B precession and nutation, accurate to 0.001″ in 1995…2050 and to 0.1″ over 1900…2100, with the Earth rotation angle of 2000. Neglected
/// effects are those of [`itrf_from_teme`]: UT1 − UTC up to 13.5″ and polar motion 0.6″.
pub fn itrf_from_gcrf(epoch: Epoch) -> DMat3 {
    itrf_from_gcrf_with_ut1(epoch, 0.0)
}

/// As [`itrf_from_gcrf`], with UT1 − UTC in seconds.
pub fn itrf_from_gcrf_with_ut1(epoch: Epoch, ut1_minus_utc_s: f64) -> DMat3 {
    let ut1 = ut1(epoch, ut1_minus_utc_s);
    let tt = JulianDate::tt(epoch);
    let rows = sofars::pnp::c2t00b(
        tt.midnight,
        tt.fraction,
        ut1.midnight,
        ut1.fraction,
        0.0,
        0.0,
    );
    DMat3::from_cols_array_2d(&rows).transpose()
}

/// As [`itrf_from_gcrf`], with the measured part of the Earth's rotation.
pub fn itrf_from_gcrf_oriented(epoch: Epoch, orientation: &Orientation) -> DMat3 {
    let ut1 = ut1(epoch, orientation.ut1_minus_utc_s);
    let tt = JulianDate::tt(epoch);
    let rows = sofars::pnp::c2t00b(
        tt.midnight,
        tt.fraction,
        ut1.midnight,
        ut1.fraction,
        orientation.x_pole_rad,
        orientation.y_pole_rad,
    );
    DMat3::from_cols_array_2d(&rows).transpose()
}

/// Rotation that takes TEME axes to PEF axes (Earth-fixed, z to the pole of rotation): R3(GMST 1982).
pub fn pef_from_teme(epoch: Epoch, orientation: &Orientation) -> DMat3 {
    itrf_from_teme_with_ut1(epoch, orientation.ut1_minus_utc_s)
}

/// Rotation that takes PEF axes to ITRF axes: polar motion, R2(−x)·R1(−y) (IERS Conventions 2010, 5.4.1; s′ left out,
/// 5e-5″ a century).
pub fn itrf_from_pef(orientation: &Orientation) -> DMat3 {
    let rows = sofars::pnp::pom00(orientation.x_pole_rad, orientation.y_pole_rad, 0.0);
    DMat3::from_cols_array_2d(&rows).transpose()
}

/// Rotation that takes EME2000 axes (mean equator and equinox of J2000) to GCRF axes: the frame bias, 0.02″.
pub fn gcrf_from_eme2000() -> DMat3 {
    const J2000: f64 = 2_451_545.0;
    let (bias, _, _) = sofars::pnp::bp00(J2000, 0.0);
    // Rows of B, which takes GCRF to EME2000: read as columns they are its transpose.
    DMat3::from_cols_array_2d(&bias)
}

/// Rotation that takes axes of the true equator and equinox of date (CCSDS name TOD) to GCRF axes: IAU 2000B, as
/// [`itrf_from_gcrf`]. With the theory of 1976 and 1980 the axes differ by some hundredths of an arc second.
pub fn gcrf_from_tod(epoch: Epoch) -> DMat3 {
    let tt = JulianDate::tt(epoch);
    // Rows of a matrix that takes GCRF to the axes of date: read as columns they are its transpose.
    DMat3::from_cols_array_2d(&sofars::pnp::pnm00b(tt.midnight, tt.fraction))
}

/// Rotation that takes axes of the mean equator and equinox of date (CCSDS name MOD) to GCRF axes: frame bias and precession, IAU
/// 2000.
pub fn gcrf_from_mod(epoch: Epoch) -> DMat3 {
    let tt = JulianDate::tt(epoch);
    DMat3::from_cols_array_2d(&sofars::pnp::pmat00(tt.midnight, tt.fraction))
}

fn ut1(epoch: Epoch, ut1_minus_utc_s: f64) -> JulianDate {
    let mut date = JulianDate::utc(epoch);
    date.fraction += ut1_minus_utc_s / 86_400.0;
    date
}

/// R3(θ): coordinates in axes turned by θ about z.
pub(super) fn rotation_about_z(theta_rad: f64) -> DMat3 {
    let (s, c) = theta_rad.sin_cos();
    DMat3::from_cols(DVec3::new(c, -s, 0.0), DVec3::new(s, c, 0.0), DVec3::Z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::utc_from_rfc3339;

    /// Vallado, Fundamentals of Astrodynamics and Applications (2013), example 3-15: by the theory of 1976 and 1980 with the IERS's nutation
    /// corrections, from which that of 2000 differs by thousandths of an arc second.
    #[test]
    fn axes_of_date_lie_as_published() {
        let epoch = utc_from_rfc3339("2004-04-06T07:51:28.386009Z").unwrap();
        let gcrf_km = DVec3::new(5_102.508_957_9, 6_123.011_400_7, 6_378.136_928_2);
        for (name, km, gcrf_from_date) in [
            (
                "TOD",
                [5_094.514_780_4, 6_127.366_461_2, 6_380.344_532_8],
                gcrf_from_tod(epoch),
            ),
            (
                "MOD",
                [5_094.028_374_5, 6_127.870_816_4, 6_380.248_516_4],
                gcrf_from_mod(epoch),
            ),
        ] {
            let off_m = (gcrf_from_date * DVec3::from(km) - gcrf_km).length() * 1e3;
            println!("{name}: {off_m:.2} m");
            assert!(off_m < 5.0, "{name}: {off_m}");
        }
    }
}
