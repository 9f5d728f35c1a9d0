//! Axes that turn with the Earth, from those of the stars.

use crate::failure::{TerrellaStatus, answer};
use crate::pointers::write;
use crate::time::TerrellaTime;
use terrella::frames::itrf_from_gcrf;

/// The Earth's rate of rotation about the z axis of ITRF, radians per second.
pub const TERRELLA_EARTH_ROTATION_RAD_S: f64 = 7.292_115_146_706_98e-5;

/// Writes the rotation from GCRF axes (those of ICRF and, to 0.02 arc seconds, J2000) to Earth-fixed axes (ITRF) at an instant: nine
/// numbers, row by row. A position or direction in ITRF is this matrix times the one in GCRF.
///
/// A velocity in ITRF is relative to the rotating Earth: with the matrix R, the position r in ITRF and the vector w = (0, 0,
/// `TERRELLA_EARTH_ROTATION_RAD_S`), it is R v − w × r.
///
/// Precession and nutation are those of IAU 2000B. UT1 is taken as UTC, and polar motion as zero: up to 420 m and 20 m at the ground. Scenes
/// without measured Earth orientation use the same rotation.
///
/// # Safety
/// `matrix` points to writable memory for nine numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_itrf_from_gcrf(
    time: TerrellaTime,
    matrix: *mut f64,
) -> TerrellaStatus {
    answer(|| {
        let rotation = itrf_from_gcrf(time.epoch("time")?);
        let rows = rotation.transpose().to_cols_array();
        // SAFETY: the caller's promise: room for nine numbers.
        unsafe { write(matrix.cast::<[f64; 9]>(), "matrix", rows) }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DMat3, DVec3};
    use terrella::frames::{Duration, EARTH_ROTATION_RATE_RAD_S, utc_from_rfc3339};

    /// Vallado, Fundamentals of Astrodynamics and Applications (2013), example 3-15: 6 April 2004, 07:51:28.386009 UTC,
    /// UT1 − UTC = −0.4399619 s.
    #[test]
    fn a_state_of_the_stars_is_that_of_the_published_example() {
        let gcrf_m = DVec3::new(5_102_508.957_9, 6_123_011.400_7, 6_378_136.928_2);
        let gcrf_m_s = DVec3::new(-4_743.220_157, 790.536_497, 5_533.755_727);
        let itrf_m = DVec3::new(-1_033_479.383, 7_901_295.275_4, 6_380_356.595_8);
        let itrf_m_s = DVec3::new(-3_225.636_520, -2_872.451_450, 5_531.924_446);
        let utc = utc_from_rfc3339("2004-04-06T07:51:28.386009Z").expect("a date");
        let at = |dut1_s: f64| {
            let mut rows = [0.0; 9];
            let time = TerrellaTime::of(utc + Duration::from_seconds(dut1_s));
            // SAFETY: memory for nine numbers.
            let status = unsafe { terrella_itrf_from_gcrf(time, rows.as_mut_ptr()) };
            assert_eq!(status, TerrellaStatus::TERRELLA_OK);
            let rotation = DMat3::from_cols_array(&rows).transpose();
            let position_m = rotation * gcrf_m;
            let turning = DVec3::Z * TERRELLA_EARTH_ROTATION_RAD_S;
            let velocity_m_s = rotation * gcrf_m_s - turning.cross(position_m);
            (
                (position_m - itrf_m).length(),
                (velocity_m_s - itrf_m_s).length(),
            )
        };
        // UT1 is the time that is given: polar motion is left.
        let (off_m, off_m_s) = at(-0.439_961_9);
        assert!(off_m < 20.0 && off_m_s < 0.03, "{off_m} {off_m_s}");
        // The documented error of UT1 = UTC.
        let (off_m, _) = at(0.0);
        assert!((200.0..440.0).contains(&off_m), "{off_m}");
    }

    #[test]
    fn the_rate_is_that_of_states() {
        let rate = TERRELLA_EARTH_ROTATION_RAD_S;
        assert_eq!(rate.to_bits(), EARTH_ROTATION_RATE_RAD_S.to_bits());
    }
}
