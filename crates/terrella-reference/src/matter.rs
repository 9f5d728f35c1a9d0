//! Composition of the air: densities by height, and optical properties by wavelength.
//!
//! Molecules, ozone and aerosol, each a density profile times a spectrum. As in [`super::spectrum`], the inputs are this renderer's own.

use super::spectrum::{Spectrum, band_means};
use glam::DVec3;

/// Thickness of the air, metres.
pub(super) const THICKNESS_M: f64 = 100_000.0;

/// Steps of the tables of densities, metres.
const STEP_M: f64 = 100.0;
const STEPS: usize = (THICKNESS_M / STEP_M) as usize;

/// Bottoms of the layers of the US Standard Atmosphere 1976, geopotential metres, and the change of temperature above them,
/// K/m (its table 4).
const LAYERS: [(f64, f64); 7] = [
    (0.0, -0.0065),
    (11_000.0, 0.0),
    (20_000.0, 0.001),
    (32_000.0, 0.0028),
    (47_000.0, 0.0),
    (51_000.0, -0.0028),
    (71_000.0, -0.002),
];
/// Where those layers end, geometric metres, and the temperature there and up to 91 km, K.
const MESOPAUSE_M: f64 = 86_000.0;
const MESOPAUSE_K: f64 = 186.867_3;

/// Ozone at the even kilometres from 2 to 74, molecules/m³: the mid-latitude model of Krueger and Minzner 1976
/// (J. Geophys. Res. 81, 4477), table 18 of the US Standard Atmosphere 1976.
#[rustfmt::skip]
const OZONE_PER_M3: [f64; 37] = [
    6.8e17, 5.8e17, 5.7e17, 6.5e17, 1.13e18, 2.02e18, 2.35e18, 2.95e18, 4.04e18, 4.77e18, 4.86e18, 4.54e18, 4.03e18,
    3.24e18, 2.52e18, 2.03e18, 1.58e18, 1.22e18, 8.73e17, 6.07e17, 3.98e17, 2.74e17, 1.69e17, 1.03e17, 6.64e16, 3.84e16,
    2.55e16, 1.61e16, 1.12e16, 7.33e15, 4.81e15, 3.17e15, 1.72e15, 7.5e14, 5.4e14, 2.2e14, 1.7e14,
];
/// The column that it is scaled to: 300 Dobson units, molecules/m².
const OZONE_COLUMN_PER_M2: f64 = 300.0 * 2.686_8e20;

/// Absorption cross sections of ozone at 233 K, means from 380, 390, … nm on over 10 nm, m²: the spectra of Serdyuchenko et
/// al. 2014 (Atmos. Meas. Tech. 7, 625).
#[rustfmt::skip]
const OZONE_M2: [f64; 40] = [
    2.818e-28, 6.636e-28, 1.527e-27, 2.763e-27, 5.52e-27, 8.451e-27, 1.582e-26, 2.316e-26, 3.669e-26, 4.924e-26,
    7.752e-26, 9.016e-26, 1.48e-25, 1.602e-25, 2.139e-25, 2.755e-25, 3.091e-25, 3.5e-25, 4.266e-25, 4.672e-25,
    4.398e-25, 4.701e-25, 5.019e-25, 4.305e-25, 3.74e-25, 3.215e-25, 2.662e-25, 2.238e-25, 1.852e-25, 1.473e-25,
    1.209e-25, 9.423e-26, 7.455e-26, 6.566e-26, 5.105e-26, 4.15e-26, 4.228e-26, 3.237e-26, 2.451e-26, 2.801e-26,
];

/// Depolarisation of light by air: Young 1981 (J. Appl. Meteor. 20, 328).
const DEPOLARISATION: f64 = 0.0279;

/// The aerosol is a choice and no measurement: its optical depth follows the wavelength to this power,
const AEROSOL_POWER: f64 = -1.3;
/// it thins out with this scale height, metres,
const AEROSOL_SCALE_M: f64 = 1_500.0;
/// its single scattering albedo is this,
const AEROSOL_SCATTERED: f64 = 0.95;
/// and its phase function is Henyey and Greenstein's with this asymmetry.
pub(super) const AEROSOL_ASYMMETRY: f64 = 0.7;

/// Fraction of the aerosol's scattering that counts as unscattered in multiple scattering: half of the first moment of its phase function that is
/// not kept ([`super::orders`]).
///
/// All of it (the δ-M method, Wiscombe 1977, J. Atmos. Sci. 34, 1408) makes the sky near a low Sun too bright, by up to half at an optical depth of
/// 0.1. None of it makes the opposite sky too dark, by up to a quarter. With half of it both are within a tenth.
pub(super) const AEROSOL_FORWARD: f64 =
    0.5 * AEROSOL_ASYMMETRY * AEROSOL_ASYMMETRY * AEROSOL_ASYMMETRY * AEROSOL_ASYMMETRY;

/// The air's matter.
#[derive(Clone, Debug)]
pub(super) struct Matter {
    /// Logarithms of the densities of molecules (1/m³), ozone (1/m³) and aerosol (part of its column, 1/m) every
    /// [`STEP_M`] from the ground.
    densities: Vec<DVec3>,
    /// Scattering cross section of molecules, m².
    pub molecules: Spectrum,
    /// Absorption cross section of ozone, m².
    pub ozone: Spectrum,
    /// Optical depth of the aerosol's whole column.
    pub aerosol: Spectrum,
    /// The part of it that is scattering.
    pub aerosol_scattering: Spectrum,
    /// Optical depth of the aerosol without light that it scatters [`AEROSOL_FORWARD`].
    aerosol_aside: Spectrum,
    /// Height of its ground, metres above that of the densities.
    base_m: f64,
}

impl Matter {
    /// Air with an aerosol of this optical depth at 550 nm.
    pub fn new(aerosol_optical_depth: f64) -> Self {
        let aerosol = band_means(|nm| aerosol_optical_depth * (nm / 550.0).powf(AEROSOL_POWER));
        let molecules = air_densities();
        let ozone = ozone_densities(&molecules);
        let densities = molecules
            .iter()
            .zip(ozone)
            .enumerate()
            .map(|(i, (air, ozone))| {
                let height_m = i as f64 * STEP_M;
                let aerosol = (-height_m / AEROSOL_SCALE_M).exp() / AEROSOL_SCALE_M;
                DVec3::new(air.ln(), ozone.ln(), aerosol.ln())
            });
        Self {
            densities: densities.collect(),
            molecules: band_means(molecule_cross_section_m2),
            ozone: band_means(|nm| {
                let at = ((nm - 380.0) / 10.0) as usize;
                OZONE_M2[at.min(OZONE_M2.len() - 1)]
            }),
            aerosol,
            aerosol_scattering: aerosol.map(|depth| AEROSOL_SCATTERED * depth),
            aerosol_aside: aerosol.map(|depth| (1.0 - AEROSOL_FORWARD * AEROSOL_SCATTERED) * depth),
            base_m: 0.0,
        }
    }

    /// The same air without the part below a height, metres: its ground is there.
    pub fn above(self, base_m: f64) -> Self {
        Self { base_m, ..self }
    }

    /// Densities of molecules, ozone and aerosol at a height above its ground, metres.
    pub fn densities(&self, height_m: f64) -> DVec3 {
        let at = ((self.base_m + height_m) / STEP_M).clamp(0.0, STEPS as f64);
        let low = (at as usize).min(STEPS - 1);
        let log = self.densities[low].lerp(self.densities[low + 1], at - low as f64);
        DVec3::new(log.x.exp(), log.y.exp(), log.z.exp())
    }

    /// Whether there is an aerosol.
    pub fn is_hazy(&self) -> bool {
        self.aerosol[0] > 0.0
    }

    /// Transmittance of columns of molecules, ozone (1/m²) and aerosol (fraction of the whole).
    pub fn through(&self, columns: DVec3) -> Spectrum {
        self.left(columns, &self.aerosol)
    }

    /// The same with light that the aerosol scatters nearly straight on.
    pub fn through_or_on(&self, columns: DVec3) -> Spectrum {
        self.left(columns, &self.aerosol_aside)
    }

    fn left(&self, columns: DVec3, aerosol: &Spectrum) -> Spectrum {
        let (molecules, ozone) = (&self.molecules, &self.ozone);
        std::array::from_fn(|i| {
            (-(columns.x * molecules[i] + columns.y * ozone[i] + columns.z * aerosol[i])).exp()
        })
    }
}

/// Rayleigh scattering by a molecule of air: Bucholtz 1995 (Appl. Opt. 34, 2765), eq. 8 with table 3.
fn molecule_cross_section_m2(nm: f64) -> f64 {
    let um = nm / 1000.0;
    let [a, b, c, d] = match um <= 0.5 {
        true => [3.015_77e-28, 3.552_12, 1.355_79, 0.115_63],
        false => [4.010_61e-28, 3.996_68, 1.102_98e-3, 2.713_93e-2],
    };
    // The paper's are cm².
    1e-4 * a * um.powf(-(b + c * um + d / um))
}

/// The phase function of molecules is (1 + this · P₂(cos))/4π: Chandrasekhar's for light that is not polarised,
/// 3/(4(1 + 2γ)) ((1 + 3γ) + (1 − γ) cos²) with γ = ρ/(2 − ρ).
pub(super) fn molecule_second_moment() -> f64 {
    let gamma = DEPOLARISATION / (2.0 - DEPOLARISATION);
    (1.0 - gamma) / (2.0 * (1.0 + 2.0 * gamma))
}

/// Temperature of the US Standard Atmosphere 1976 at a height, K.
fn temperature_k(height_m: f64) -> f64 {
    if height_m >= MESOPAUSE_M {
        // Above 91 km its arc of an ellipse.
        let arc = ((height_m - 91_000.0).max(0.0) / 19_942.9).min(1.0);
        return match arc > 0.0 {
            true => 263.190_5 - 76.323_2 * (1.0 - arc * arc).sqrt(),
            false => MESOPAUSE_K,
        };
    }
    const RADIUS_M: f64 = 6_356_766.0;
    let geopotential_m = RADIUS_M * height_m / (RADIUS_M + height_m);
    let mut found = 288.15;
    for (i, (bottom, slope)) in LAYERS.iter().enumerate() {
        let top = LAYERS
            .get(i + 1)
            .map_or(f64::INFINITY, |(bottom, _)| *bottom);
        found += slope * (geopotential_m.min(top) - bottom).max(0.0);
    }
    found
}

/// Molecules of air, 1/m³, every [`STEP_M`]: the hydrostatic equation, d ln p = −M g/(R T) dz, by Simpson's rule.
fn air_densities() -> Vec<f64> {
    const AIR_KG_PER_MOL: f64 = 0.028_964_4;
    const GAS_J_PER_MOL_K: f64 = 8.314_32;
    const BOLTZMANN_J_PER_K: f64 = 1.380_622e-23;
    let slope = |height_m: f64| {
        let gravity = 9.806_65 * (6_356_766.0 / (6_356_766.0 + height_m)).powi(2);
        -AIR_KG_PER_MOL * gravity / (GAS_J_PER_MOL_K * temperature_k(height_m))
    };
    let mut log_pressure = 101_325_f64.ln();
    let mut densities = Vec::with_capacity(STEPS + 1);
    for i in 0..=STEPS {
        let from = i as f64 * STEP_M;
        densities.push(log_pressure.exp() / (BOLTZMANN_J_PER_K * temperature_k(from)));
        let simpson = slope(from) + 4.0 * slope(from + 0.5 * STEP_M) + slope(from + STEP_M);
        log_pressure += simpson * STEP_M / 6.0;
    }
    densities
}

/// Ozone, 1/m³, every [`STEP_M`]: geometric means between the model's heights; below them as much of the air as at 2 km,
/// above them thinning out as between the last two.
fn ozone_densities(air: &[f64]) -> Vec<f64> {
    let last = OZONE_PER_M3.len() - 2;
    let shape = |i: usize| {
        let at = i as f64 * STEP_M / 2_000.0 - 1.0;
        if at < 0.0 {
            let model = (2_000.0 / STEP_M) as usize;
            return OZONE_PER_M3[0] * air[i] / air[model];
        }
        let low = (at as usize).min(last);
        let (from, to) = (OZONE_PER_M3[low], OZONE_PER_M3[low + 1]);
        from * (to / from).powf(at - low as f64)
    };
    let shape: Vec<f64> = (0..=STEPS).map(shape).collect();
    let ends = 0.5 * (shape[0] + shape[STEPS]);
    let column = (shape.iter().sum::<f64>() - ends) * STEP_M;
    shape
        .iter()
        .map(|density| density * OZONE_COLUMN_PER_M2 / column)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::spectrum::BANDS;
    use super::*;

    #[test]
    fn densities_are_those_of_the_standard() {
        // Number densities of its table, 1/m³.
        let air = Matter::new(0.1);
        for (height_m, wanted) in [
            (0.0, 2.547e25),
            (5_000.0, 1.531e25),
            (10_000.0, 8.598e24),
            (30_000.0, 3.828e23),
            (50_000.0, 2.135e22),
            (80_000.0, 3.838e20),
            (90_000.0, 7.116e19),
        ] {
            let found = air.densities(height_m).x;
            assert!(
                (found / wanted - 1.0).abs() < 3e-3,
                "{height_m}: {found} for {wanted}"
            );
        }
        let sum: DVec3 = (0..4000)
            .map(|i| air.densities(25.0 * f64::from(i) + 12.5) * 25.0)
            .sum();
        assert!((sum.x / 2.1537e29 - 1.0).abs() < 2e-3, "{}", sum.x);
        assert!(
            (sum.y / OZONE_COLUMN_PER_M2 - 1.0).abs() < 1e-3,
            "{}",
            sum.y
        );
        assert!((sum.z - 1.0).abs() < 1e-3, "{}", sum.z);
    }

    #[test]
    fn depths_are_those_of_the_literature() {
        let air = Matter::new(0.1);
        let columns = DVec3::new(2.1537e29, OZONE_COLUMN_PER_M2, 1.0);
        let clear = Matter::new(0.0);
        assert!(!clear.is_hazy() && air.is_hazy());
        let depth = |air: &Matter| air.through(columns).map(|through| -through.ln());
        // About 565 nm: molecules 0.087 (Bodhaine et al. 1999), ozone 0.033, aerosol 0.097.
        let green = |air: &Matter| {
            let depth = depth(air);
            let at = BANDS * 175 / 400;
            depth[at]
        };
        assert!((green(&air) - green(&clear) - 0.097).abs() < 2e-3);
        assert!((green(&clear) - 0.122).abs() < 0.005, "{}", green(&clear));
        let aside = air.through_or_on(columns)[5];
        assert!(aside > air.through(columns)[5] && aside < clear.through(columns)[5]);
        assert_eq!(clear.through_or_on(columns), clear.through(columns));
    }
}
