//! Density of the atmosphere's constituents by height, relative to the ground or to the peak.

/// Upper boundary of the air, metres above the surface.
pub const THICKNESS_M: f64 = 100_000.0;
pub const AEROSOL_SCALE_HEIGHT_M: f64 = 1_500.0;

/// Layers of the US Standard Atmosphere 1976 (NOAA-S/T 76-1562, table 4): base, geopotential metres, and lapse rate of the
/// molecular-scale temperature, K/m.
const LAYERS: [(f64, f64); 7] = [
    (0.0, -6.5e-3),
    (11_000.0, 0.0),
    (20_000.0, 1.0e-3),
    (32_000.0, 2.8e-3),
    (47_000.0, 0.0),
    (51_000.0, -2.8e-3),
    (71_000.0, -2.0e-3),
];
/// Temperature at the ground, kelvins.
const GROUND_TEMPERATURE_K: f64 = 288.15;
/// g₀M₀/R*, kelvins a metre.
const HYDROSTATIC_K_PER_M: f64 = 0.034_163_195;
/// Radius of the Earth in the standard, metres, for conversion between geometric and geopotential
/// heights.
const STANDARD_RADIUS_M: f64 = 6_356_766.0;
/// Geometric height above which the air counts as isothermal, metres.
const ISOTHERMAL_FROM_M: f64 = 86_000.0;

/// Number density of ozone, 10¹⁸ m⁻³, every 2 km from the ground. Source: the mid-latitude model of Krueger and
/// Minzner 1976 (J. Geophys. Res. 81, 4477), which the US Standard Atmosphere 1976 adopts. Below 2 km the value of 2
/// km is repeated.
const OZONE: [f64; 38] = [
    0.68, 0.68, 0.58, 0.57, 0.65, 1.13, 2.02, 2.35, 2.95, 4.04, 4.77, 4.86, 4.54, 4.03, 3.24, 2.52,
    2.03, 1.58, 1.22, 0.873, 0.607, 0.398, 0.274, 0.169, 0.103, 6.64e-2, 3.84e-2, 2.55e-2, 1.61e-2,
    1.12e-2, 7.33e-3, 4.81e-3, 3.17e-3, 1.72e-3, 7.5e-4, 5.4e-4, 2.2e-4, 1.7e-4,
];
/// Step of [`OZONE`], metres.
const OZONE_STEP_M: f64 = 2_000.0;
/// Maximum of [`OZONE`].
const OZONE_PEAK: f64 = 4.86;

/// Number density of all molecules at a height, relative to the ground: US Standard Atmosphere 1976.
pub fn molecules(height_m: f64) -> f64 {
    let isothermal = (height_m - ISOTHERMAL_FROM_M).max(0.0);
    let geometric = height_m.clamp(0.0, ISOTHERMAL_FROM_M);
    let at = STANDARD_RADIUS_M * geometric / (STANDARD_RADIUS_M + geometric);
    let (mut temperature, mut ln_pressure) = (GROUND_TEMPERATURE_K, 0.0);
    for (n, (base, lapse)) in LAYERS.iter().enumerate() {
        let top = LAYERS.get(n + 1).map_or(f64::INFINITY, |next| next.0);
        let rise = at.min(top) - base;
        if rise <= 0.0 {
            break;
        }
        let after = temperature + lapse * rise;
        ln_pressure -= match *lapse == 0.0 {
            true => HYDROSTATIC_K_PER_M * rise / temperature,
            false => HYDROSTATIC_K_PER_M / lapse * (after / temperature).ln(),
        };
        temperature = after;
    }
    let gravity = (STANDARD_RADIUS_M / (STANDARD_RADIUS_M + height_m.max(0.0))).powi(2);
    ln_pressure -= HYDROSTATIC_K_PER_M * gravity * isothermal / temperature;
    ln_pressure.exp() * GROUND_TEMPERATURE_K / temperature
}

/// Number density of ozone at a height, relative to its peak.
pub fn ozone(height_m: f64) -> f64 {
    let at = (height_m / OZONE_STEP_M).max(0.0);
    let low = at as usize;
    let of = |n: usize| OZONE.get(n).copied().unwrap_or(0.0);
    (of(low) + (of(low + 1) - of(low)) * (at - low as f64)) / OZONE_PEAK
}

/// Aerosol density at a height, relative to the ground.
pub fn aerosol(height_m: f64) -> f64 {
    (-height_m.max(0.0) / AEROSOL_SCALE_HEIGHT_M).exp()
}

/// Column of a density above the ground, metres at unit density.
pub(super) fn column_m(density: impl Fn(f64) -> f64) -> f64 {
    const STEPS: u32 = 4_000;
    column_in_steps_m(density, (0.0, THICKNESS_M), STEPS)
}

/// Column of a density between two heights, metres, accurate to a few thousandths. Fast enough for
/// every frame.
pub(super) fn column_between_m(density: impl Fn(f64) -> f64, low_m: f64, high_m: f64) -> f64 {
    const STEPS: u32 = 16;
    column_in_steps_m(density, (low_m, high_m.min(THICKNESS_M)), STEPS)
}

fn column_in_steps_m(density: impl Fn(f64) -> f64, (low_m, high_m): (f64, f64), steps: u32) -> f64 {
    let step = (high_m - low_m) / f64::from(steps);
    let middles = (0..steps).map(|n| low_m + (f64::from(n) + 0.5) * step);
    middles.map(density).sum::<f64>() * step
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn density_is_that_of_the_published_standard() {
        // US Standard Atmosphere 1976, table 1: geometric height, km, and density relative to 1.2250 kg/m³.
        for (height_km, ratio) in [
            (0.0, 1.0),
            (5.0, 6.0117e-1),
            (11.0, 2.9780e-1),
            (20.0, 7.2580e-2),
            (30.0, 1.5029e-2),
            (50.0, 8.3827e-4),
            (70.0, 6.7616e-5),
            (80.0, 1.5068e-5),
        ] {
            let found = molecules(height_km * 1e3);
            assert!(
                (found / ratio - 1.0).abs() < 3e-3,
                "{height_km} km: {found}"
            );
        }
    }

    #[test]
    fn densities_fall_to_nothing_and_are_even_below_the_ground() {
        for density in [molecules, ozone, aerosol] {
            assert!((0.0..1e-5).contains(&density(THICKNESS_M)));
            assert_eq!(density(-500.0), density(0.0));
        }
    }

    #[test]
    fn a_column_of_ozone_is_about_345_dobson_units() {
        // A Dobson unit is 2.687e20 molecules a square metre.
        let column = column_m(ozone) * OZONE_PEAK * 1e18 / 2.687e20;
        assert!((column - 345.0).abs() < 5.0, "{column}");
    }
}
