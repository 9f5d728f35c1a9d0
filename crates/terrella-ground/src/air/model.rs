//! Composition of the atmosphere: scattering and absorption at the wavelengths of the computation.
//!
//! Tables are computed at the eight wavelengths of [`Spectrum`]. Where shaders multiply coefficients, they use three bands for red, green and blue
//! ([`RGB_BANDS`]). Fitted to daylight spectra alone, they leave an error of 1 %, at most 4 %.

use super::profile::{self, AEROSOL_SCALE_HEIGHT_M, THICKNESS_M};
use super::spectrum::Spectrum;
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// Atmosphere options of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AirOptions {
    /// Vertical optical depth of the aerosol at 550 nm, 0 (clear air) to [`AirOptions::MAX_AEROSOL`]. Density falls with
    /// height with a scale of 1.5 km, and optical depth with wavelength to the power −1.3. The aerosol scatters 95 % of the
    /// light that it removes, mostly forward (Henyey–Greenstein, g = 0.7). This is continental haze; 0.1 is a clear day.
    pub aerosol_optical_depth: f64,
}

impl AirOptions {
    /// Largest aerosol optical depth for which the tables are valid.
    pub const MAX_AEROSOL: f64 = 5.0;
}

impl Default for AirOptions {
    fn default() -> Self {
        Self {
            aerosol_optical_depth: 0.1,
        }
    }
}

/// Optical depths of a vertical column at several wavelengths.
#[derive(Clone, Copy, Debug)]
struct Depths<V> {
    molecules: V,
    /// For 300 Dobson units of ozone.
    ozone: V,
    /// Aerosol, relative to its depth at 550 nm.
    aerosol: V,
}

/// Depths at the wavelengths of [`Spectrum`]. Molecules: Bodhaine et al. 1999 (J. Atmos. Oceanic Technol. 16, 1854),
/// equation 31.
/// Ozone: Serdyuchenko et al. 2014 (Atmos. Meas. Tech. 7, 625) at 233 K, means over 10 nm.
const BANDS: Depths<Spectrum> = Depths {
    molecules: Spectrum::new([
        0.042_97, 0.055_12, 0.069_02, 0.087_60, 0.098_52, 0.131_12, 0.201_95, 0.282_79,
    ]),
    ozone: Spectrum::new([
        0.012_79, 0.027_18, 0.038_66, 0.033_77, 0.025_90, 0.012_52, 0.002_41, 0.000_42,
    ]),
    aerosol: Spectrum::new([
        0.770_7, 0.834_7, 0.896_9, 0.967_9, 1.004_7, 1.100_3, 1.261_5, 1.402_5,
    ]),
};

/// Depths for red, green and blue, fitted to the same spectra.
const RGB_BANDS: Depths<DVec3> = Depths {
    molecules: DVec3::new(0.048_06, 0.101_24, 0.232_35),
    ozone: DVec3::new(0.038_90, 0.023_90, 0.0),
    aerosol: DVec3::new(0.8153, 1.0119, 1.3264),
};

/// Fraction of the aerosol's extinction that is scattering.
const AEROSOL_ALBEDO: f64 = 0.95;
/// Asymmetry g of the aerosol's phase function.
pub const AEROSOL_ASYMMETRY: f64 = 0.7;

/// Rayleigh's phase function is a + b·cos², 1/sr: 3/(16π(1 + 2γ))·((1 + 3γ) + (1 − γ)cos²). γ = 0.0141 for air with a
/// depolarisation ratio of 0.0279 (Young 1981; Bucholtz 1995, equation 12).
pub const RAYLEIGH_PHASE: [f64; 2] = {
    const GAMMA: f64 = 0.0141;
    const SCALE: f64 = 3.0 / (16.0 * PI * (1.0 + 2.0 * GAMMA));
    [SCALE * (1.0 + 3.0 * GAMMA), SCALE * (1.0 - GAMMA)]
};

/// Radius of the surface, metres: scaled space's unit.
pub const RADIUS_M: f64 = 6_378_137.0;
/// Upper boundary in scaled space, 1 + H/a.
pub const TOP: f64 = 1.0 + THICKNESS_M / RADIUS_M;

/// The atmosphere of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AirModel {
    molecules_per_radius: Spectrum,
    ozone_per_radius: Spectrum,
    aerosol_per_radius: Spectrum,
    rgb: RgbCoefficients,
    /// Height above the surface of the sphere of radius 1, metres.
    base_m: f64,
}

/// Coefficients for red, green and blue, 1/m, for ray marching in shaders.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RgbCoefficients {
    /// Scattering by molecules at the ground.
    pub molecules: DVec3,
    /// Absorption by ozone at its peak density.
    pub ozone: DVec3,
    /// Scattering by aerosol at the ground.
    pub aerosol_scattering: DVec3,
    /// Scattering plus absorption by aerosol at the ground.
    pub aerosol_extinction: DVec3,
}

/// Coefficients of the air at one position, per equatorial radius.
#[derive(Clone, Copy, Debug)]
pub(super) struct Medium {
    /// Scattering by molecules.
    pub molecules: Spectrum,
    /// Scattering by aerosol.
    pub aerosol: Spectrum,
    /// Total extinction.
    pub extinction: Spectrum,
}

impl Medium {
    /// Scattering by molecules and aerosol.
    pub fn scattering(&self) -> Spectrum {
        (self.molecules + self.aerosol).max(1e-12)
    }
}

impl AirModel {
    /// The Earth's atmosphere with these options.
    pub fn new(options: &AirOptions) -> Self {
        Self::above(options, 0.0)
    }

    /// The part of the atmosphere above a height in metres, as if the ground were at that height.
    pub(super) fn above(options: &AirOptions, base_m: f64) -> Self {
        let molecules_m = profile::column_m(profile::molecules);
        let ozone_m = profile::column_m(profile::ozone);
        let depth = options.aerosol_optical_depth;
        let aerosol_extinction = RGB_BANDS.aerosol * (depth / AEROSOL_SCALE_HEIGHT_M);
        Self {
            molecules_per_radius: BANDS.molecules * (RADIUS_M / molecules_m) as f32,
            ozone_per_radius: BANDS.ozone * (RADIUS_M / ozone_m) as f32,
            aerosol_per_radius: BANDS.aerosol * (RADIUS_M * depth / AEROSOL_SCALE_HEIGHT_M) as f32,
            rgb: RgbCoefficients {
                molecules: RGB_BANDS.molecules / molecules_m,
                ozone: RGB_BANDS.ozone / ozone_m,
                aerosol_scattering: aerosol_extinction * AEROSOL_ALBEDO,
                aerosol_extinction,
            },
            base_m,
        }
    }

    /// Coefficients for ray marching in shaders.
    pub fn rgb(&self) -> &RgbCoefficients {
        &self.rgb
    }

    /// Fraction of a vertical optical depth in front of a layer; heights are in metres. For an eye above the layer the column runs from
    /// the eye to the ground. For an eye below it, the column runs from the eye to space.
    pub fn part_before(&self, layer_m: f64, eye_m: f64) -> DVec3 {
        let between = |low_m: f64, high_m: f64| {
            let column_m =
                |density: fn(f64) -> f64| profile::column_between_m(density, low_m, high_m);
            self.rgb.molecules * column_m(profile::molecules)
                + self.rgb.ozone * column_m(profile::ozone)
                + self.rgb.aerosol_extinction * column_m(profile::aerosol)
        };
        let (before, beyond) = match eye_m > layer_m {
            true => (between(layer_m, eye_m), between(0.0, layer_m)),
            false => (
                between(eye_m, layer_m),
                between(layer_m, profile::THICKNESS_M),
            ),
        };
        before / (before + beyond)
    }

    /// Scattering by molecules and aerosol at radius `r`, per equatorial radius, RGB, with the shaders'
    /// coefficients.
    pub(super) fn scattering_rgb(&self, r: f64) -> Vec3 {
        let h = self.height_m(r);
        let molecules = self.rgb.molecules * profile::molecules(h);
        let aerosol = self.rgb.aerosol_scattering * profile::aerosol(h);
        ((molecules + aerosol) * RADIUS_M).as_vec3()
    }

    /// The medium at radius `r` of scaled space.
    pub(super) fn medium(&self, r: f64) -> Medium {
        let h = self.height_m(r);
        let molecules = self.molecules_per_radius * profile::molecules(h) as f32;
        let aerosol = self.aerosol_per_radius * profile::aerosol(h) as f32;
        let ozone = self.ozone_per_radius * profile::ozone(h) as f32;
        Medium {
            molecules,
            aerosol: aerosol * AEROSOL_ALBEDO as f32,
            extinction: molecules + aerosol + ozone,
        }
    }

    fn height_m(&self, r: f64) -> f64 {
        self.base_m + ((r - 1.0) * RADIUS_M).max(0.0)
    }
}

/// Rayleigh phase function for air, 1/sr.
pub fn molecule_phase(cos: f64) -> f64 {
    let [a, b] = RAYLEIGH_PHASE;
    a + b * cos * cos
}

/// Henyey–Greenstein phase function of the aerosol, 1/sr.
pub fn aerosol_phase(cos: f64) -> f64 {
    let g = AEROSOL_ASYMMETRY;
    (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * cos).max(1e-9).powf(1.5))
}
