//! Conversion from the light of a scene to electrons.
//!
//! The light of a scene is relative: 1 is the radiance E/π of a white diffuse sheet that faces the Sun in space, in each band separately.

use crate::error::{SensorError, check_range};
use crate::lens::Lens;
use crate::limits;
use glam::DVec2;
use std::f64::consts::PI;

/// Planck's constant, J s, and the speed of light, m/s: exact by the SI.
const PLANCK_J_S: f64 = 6.626_070_15e-34;
const LIGHT_M_S: f64 = 299_792_458.0;

/// The astronomical unit, metres: exact by IAU 2012 resolution B2.
pub const ASTRONOMICAL_UNIT_M: f64 = 149_597_870_700.0;

/// Wavelength at which [`SOLAR`] begins, and the width of its intervals, nanometres.
const SOLAR_FIRST_NM: f64 = 300.0;
const SOLAR_STEP_NM: f64 = 10.0;
/// Its last wavelength.
const SOLAR_LAST_NM: f64 = SOLAR_FIRST_NM + SOLAR_STEP_NM * SOLAR.len() as f64;

/// Irradiance of the Sun outside the air at 1 au, W/m²/µm, means over intervals: the extraterrestrial spectrum of ASTM G173-03.
#[rustfmt::skip]
const SOLAR: [f64; 80] = [
    566.3, 697.1, 864.9, 958.3, 954.6, 988.5, 1122.9, 1139.1, 1015.0, 1158.1,
    1720.1, 1733.6, 1669.4, 1643.4, 1923.9, 2031.2, 2017.5, 2028.6, 1932.0, 1952.3,
    1916.6, 1827.3, 1870.1, 1888.5, 1854.6, 1846.6, 1836.2, 1834.8, 1809.1, 1784.0,
    1751.0, 1695.8, 1679.6, 1643.9, 1600.4, 1523.0, 1555.0, 1509.3, 1473.3, 1445.4,
    1409.3, 1365.0, 1341.2, 1311.7, 1282.6, 1266.8, 1234.5, 1207.1, 1186.2, 1144.6,
    1122.9, 1104.0, 1070.4, 1049.6, 1019.7, 972.8, 968.0, 958.8, 938.0, 926.7,
    905.0, 892.8, 865.4, 860.5, 827.7, 809.7, 793.6, 777.4, 768.4, 751.9,
    729.5, 715.2, 697.4, 682.1, 667.2, 653.6, 634.7, 623.4, 608.1, 588.9,
];

/// Wavelengths from the shorter to the longer one, nanometres.
pub type Band = [f64; 2];

/// Conversion of light to electrons.
#[derive(Clone, Debug, PartialEq)]
pub struct Radiometry {
    /// Focal length over the diameter of the aperture.
    pub f_number: f64,
    /// Time of exposure, seconds.
    pub exposure_s: f64,
    /// The part of the light that passes lens and filters, 0…1.
    pub transmission: f64,
    /// Wavelength ranges of the red, green and blue light of a scene.
    pub bands_nm: [Band; 3],
    /// Electrons per photon in each of the bands, 0…1.
    pub quantum_efficiency: [f64; 3],
    /// Whether light falls off with the angle from the axis: as the fourth power of its cosine, and by distortion as much as that enlarges.
    pub cos4: bool,
    /// Falling off besides: 1 + v1 r² + v2 r⁴ + v3 r⁶, r the distance from the principal point over the focal length.
    pub vignetting: [f64; 3],
}

impl Radiometry {
    /// Checks all numbers.
    ///
    /// # Errors
    /// The first that is out of range.
    pub fn check(&self, lens: &Lens) -> Result<(), SensorError> {
        check_range("f_number", self.f_number, limits::F_NUMBER, "")?;
        check_range("exposure_s", self.exposure_s, limits::EXPOSURE_S, " s")?;
        check_range("transmission", self.transmission, limits::PART, "")?;
        for quantum_efficiency in self.quantum_efficiency {
            check_range("quantum_efficiency", quantum_efficiency, limits::PART, "")?;
        }
        for [first, last] in self.bands_nm {
            if !(first >= SOLAR_FIRST_NM && first < last && last <= SOLAR_LAST_NM) {
                return Err(SensorError::Band {
                    first,
                    last,
                    least: SOLAR_FIRST_NM,
                    most: SOLAR_LAST_NM,
                });
            }
        }
        let [width, height] = lens.size().map(f64::from);
        for corner in [[0.0, 0.0], [width, 0.0], [0.0, height], [width, height]] {
            let factor = self.vignetting_at(lens, DVec2::from(corner) - 0.5);
            check_range(
                "vignetting",
                factor,
                0.0..=10.0,
                " times the light, in the corners",
            )?;
        }
        Ok(())
    }

    fn vignetting_at(&self, lens: &Lens, pixel: DVec2) -> f64 {
        let r2 = ((pixel - lens.principal_point_px()) / lens.focal_px()).length_squared();
        let [v1, v2, v3] = self.vignetting;
        1.0 + r2 * (v1 + r2 * (v2 + r2 * v3))
    }

    /// Fraction of the on-axis light that a pixel receives which looks in this direction (X/Z, Y/Z).
    ///
    /// With `cos4` it is E(θ)/E(0) = cos θ · dΩ/dΩ₀: the aperture is foreshortened, and a pixel covers cos³ θ / |J| of the solid angle of one at
    /// the axis, where J is the Jacobian of the distortion. Without distortion that is cos⁴ θ; for an equidistant fisheye sin θ cos θ / θ. The
    /// light of a star is thus independent of the distortion, except for the cosine.
    pub fn falloff(&self, lens: &Lens, pixel: DVec2, direction: DVec2) -> f64 {
        let natural = match self.cos4 {
            true => {
                // cos² θ = 1/(1 + tan² θ)
                let cos2 = 1.0 / (1.0 + direction.length_squared());
                let enlarged = lens.distortion().jacobian(direction).determinant();
                cos2 * cos2 / enlarged
            }
            false => 1.0,
        };
        let part = natural * self.vignetting_at(lens, pixel);
        if part.is_finite() { part.max(0.0) } else { 0.0 }
    }

    /// Electrons in a pixel at the axis for light of 1 in each band, before quantum efficiency: photons that reach it.
    ///
    /// N = E/π · π/4 (f/N)² · p²/f² · τ · t / (hc/λ), the focal length cancels.
    pub fn photons(&self, lens: &Lens, sun_distance_au: f64) -> [f64; 3] {
        let pitch_m = 1e-6 * lens.pixel_pitch_um();
        let etendue_m2_sr = 0.25 * PI * (pitch_m / self.f_number).powi(2);
        let per_flux = etendue_m2_sr * self.transmission * self.exposure_s / PI;
        let nearer = sun_distance_au.powi(-2);
        self.bands_nm
            .map(|band| per_flux * nearer * solar_photons_m2_s(band))
    }
}

/// Photons of the Sun at 1 au in a band, per square metre and second. The spectrum is 0 outside 300 to 1100 nm.
pub fn solar_photons_m2_s([first, last]: Band) -> f64 {
    let intervals = SOLAR.iter().zip(0_u16..).map(|(irradiance, k)| {
        let start = SOLAR_FIRST_NM + SOLAR_STEP_NM * f64::from(k);
        let (from, to) = (start.max(first), (start + SOLAR_STEP_NM).min(last));
        let width_nm = (to - from).max(0.0);
        // W/m²/µm over nanometres, each photon with hc/λ of the middle.
        let middle_m = 0.5e-9 * (from + to);
        1e-3 * irradiance * width_nm * middle_m / (PLANCK_J_S * LIGHT_M_S)
    });
    intervals.sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::distortion::Distortion;

    /// Trapezoidal sums of E λ / (hc) over all 2002 wavelengths of ASTM G173-03, as in pvlib 0.16.1.
    #[test]
    fn photons_are_those_of_the_whole_spectrum() {
        for (band, photons) in [
            ([600.0, 700.0], 5.181_159_0e20),
            ([500.0, 600.0], 5.108_885_8e20),
            ([400.0, 500.0], 4.241_640_4e20),
            ([437.3, 523.9], 4.065_287_0e20),
            ([300.0, 1100.0], 3.277_228_4e21),
        ] {
            let found = solar_photons_m2_s(band);
            assert!((found / photons - 1.0).abs() < 2e-3, "{band:?}: {found:e}");
        }
    }

    /// A pixel of 10 µm behind f/2 for 1 ms, computed by hand: 518.1e18 photons/m²/s / π · π/4 · 1e-10 / 4 · 1e-3.
    #[test]
    fn photons_of_a_pixel_are_those_by_hand() {
        let lens = Lens::new([4, 4], 50.0, 10.0, None, Distortion::NONE).expect("a lens");
        let radiometry = Radiometry {
            f_number: 2.0,
            exposure_s: 1e-3,
            transmission: 0.8,
            bands_nm: [[600.0, 700.0], [500.0, 600.0], [400.0, 500.0]],
            quantum_efficiency: [0.5; 3],
            cos4: true,
            vignetting: [0.0; 3],
        };
        radiometry.check(&lens).expect("good");
        let [red, ..] = radiometry.photons(&lens, 1.0);
        let by_hand = 5.181e20 / 4.0 * 1e-10 / 4.0 * 1e-3 * 0.8;
        assert!((red / by_hand - 1.0).abs() < 2e-3, "{red} {by_hand}");
        let [far, ..] = radiometry.photons(&lens, 2.0);
        assert!((far / red - 0.25).abs() < 1e-12);
        // 45° from the axis, cos⁴ is a quarter.
        let quarter = radiometry.falloff(&lens, DVec2::ZERO, DVec2::new(0.6, 0.8));
        assert!((quarter - 0.25).abs() < 1e-12, "{quarter}");
        // An equidistant fisheye has sin θ cos θ / θ, 2/π there.
        let fisheye = Lens::new([4, 4], 50.0, 10.0, None, Distortion::Fisheye([0.0; 4]));
        let fisheye = fisheye.expect("a lens");
        let part = radiometry.falloff(&fisheye, DVec2::ZERO, DVec2::new(0.6, 0.8));
        assert!((part - std::f64::consts::FRAC_2_PI).abs() < 1e-9, "{part}");
    }
}
