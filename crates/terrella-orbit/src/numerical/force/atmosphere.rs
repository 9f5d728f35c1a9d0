//! Density of the air.

/// A model of the air's density. Both are averages over day, season and the Sun's activity: above 200 km the true density
/// is from half to twice theirs in most years, above 500 km from a tenth to ten times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AtmosphereModel {
    /// Exponential pieces with Vallado's base densities (2013, table 8-4, after US Standard Atmosphere 1976 and CIRA-72), and scale heights chosen
    /// to join them without steps.
    Exponential,
    /// US Standard Atmosphere 1976: its layers below 80 km, its tabulated densities from 86 to 1000 km, smooth between the
    /// entries. Integrates in fewer steps.
    Standard1976,
}

/// Height above which the density is zero, metres: it would be 1e-17 kg/m³ or less.
pub(super) const TOP_M: f64 = 2_500e3;
/// Lowest height that is looked up, metres: the ground's lowest places.
const BOTTOM_M: f64 = -5_000.0;

/// Height, km, and density, kg/m³ (Vallado 2013, table 8-4).
const EXPONENTIAL: [(f64, f64); 28] = [
    (0.0, 1.225),
    (25.0, 3.899e-2),
    (30.0, 1.774e-2),
    (40.0, 3.972e-3),
    (50.0, 1.057e-3),
    (60.0, 3.206e-4),
    (70.0, 8.770e-5),
    (80.0, 1.905e-5),
    (90.0, 3.396e-6),
    (100.0, 5.297e-7),
    (110.0, 9.661e-8),
    (120.0, 2.438e-8),
    (130.0, 8.484e-9),
    (140.0, 3.845e-9),
    (150.0, 2.070e-9),
    (180.0, 5.464e-10),
    (200.0, 2.789e-10),
    (250.0, 7.248e-11),
    (300.0, 2.418e-11),
    (350.0, 9.518e-12),
    (400.0, 3.725e-12),
    (450.0, 1.585e-12),
    (500.0, 6.967e-13),
    (600.0, 1.454e-13),
    (700.0, 3.614e-14),
    (800.0, 1.170e-14),
    (900.0, 5.245e-15),
    (1000.0, 3.019e-15),
];

/// The same of US Standard Atmosphere 1976, table I, from 86 km.
const STANDARD: [(f64, f64); 23] = [
    (86.0, 6.958e-6),
    (90.0, 3.416e-6),
    (95.0, 1.393e-6),
    (100.0, 5.604e-7),
    (110.0, 9.708e-8),
    (120.0, 2.222e-8),
    (130.0, 8.152e-9),
    (140.0, 3.831e-9),
    (150.0, 2.076e-9),
    (160.0, 1.233e-9),
    (180.0, 5.194e-10),
    (200.0, 2.541e-10),
    (250.0, 6.073e-11),
    (300.0, 1.916e-11),
    (350.0, 7.014e-12),
    (400.0, 2.803e-12),
    (450.0, 1.184e-12),
    (500.0, 5.215e-13),
    (600.0, 1.137e-13),
    (700.0, 3.070e-14),
    (800.0, 1.136e-14),
    (900.0, 5.759e-15),
    (1000.0, 3.561e-15),
];

/// Scale height above the tables, km (Vallado's last).
const LAST_SCALE_KM: f64 = 268.0;

/// Scale height below the tables, km (Vallado's first).
const FIRST_SCALE_KM: f64 = 7.249;

/// Layers of US Standard Atmosphere 1976: base (geopotential km), temperature there (K), gradient (K/km).
const LAYERS: [(f64, f64, f64); 7] = [
    (0.0, 288.15, -6.5),
    (11.0, 216.65, 0.0),
    (20.0, 216.65, 1.0),
    (32.0, 228.65, 2.8),
    (47.0, 270.65, 0.0),
    (51.0, 270.65, -2.8),
    (71.0, 214.65, -2.0),
];
/// g0 M/R*, K/km, and R*/M, J/(kg K).
const HYDROSTATIC_K_KM: f64 = 34.163_195;
const GAS_CONSTANT: f64 = 287.052_87;
/// The effective radius of the geopotential height, km.
const RADIUS_KM: f64 = 6_356.766;

impl AtmosphereModel {
    /// Density at a height above the ellipsoid, kg/m³; continuous, 0 above 2500 km.
    pub fn density_kg_m3(self, height_m: f64) -> f64 {
        if height_m >= TOP_M {
            return 0.0;
        }
        let km = height_m.max(BOTTOM_M) * 1e-3;
        match self {
            Self::Exponential => in_table(&EXPONENTIAL, km, false),
            Self::Standard1976 if km < 80.0 => in_layers(km),
            // Above 80 km the gas is no longer of one molar mass: the layers give way to the table without a step.
            Self::Standard1976 if km < 86.0 => {
                let part = (km - 80.0) / 6.0;
                let part = part * part * (3.0 - 2.0 * part);
                let (layers, table) = (in_layers(km).ln(), in_table(&STANDARD, 86.0, true).ln());
                let at_86 = in_layers(86.0).ln();
                (layers + part * (table - at_86)).exp()
            }
            Self::Standard1976 => in_table(&STANDARD, km, true),
        }
    }
}

/// Interpolates the logarithm between the entries: linearly, or by a cubic whose slope at an entry is that of the parabola through it and its
/// neighbours. Extrapolated with the first slope below and the last scale height above.
fn in_table(table: &[(f64, f64)], km: f64, smooth: bool) -> f64 {
    let above = table.partition_point(|(height, _)| *height <= km);
    let Some(&(h1, d1)) = table.get(above) else {
        let (h, d) = table.last().copied().unwrap_or((0.0, 0.0));
        return d * ((h - km) / LAST_SCALE_KM).exp();
    };
    let Some(&(h0, d0)) = above.checked_sub(1).and_then(|k| table.get(k)) else {
        return d1 * ((h1 - km) / FIRST_SCALE_KM).exp();
    };
    let (step, rise) = (h1 - h0, (d1 / d0).ln());
    let x = (km - h0) / step;
    if !smooth {
        return d0 * (rise * x).exp();
    }
    let secant = |k: usize| match (table.get(k), table.get(k + 1)) {
        (Some(&(a, da)), Some(&(b, db))) => Some(((db / da).ln() / (b - a), b - a)),
        _ => None,
    };
    // The slope at entry k from its two secants, each weighted by the other's length.
    let slope = |k: usize, own: f64| {
        let below = k.checked_sub(1).and_then(secant);
        match (below, secant(k)) {
            (Some((s0, l0)), Some((s1, l1))) => (s0 * l1 + s1 * l0) / (l0 + l1),
            _ => own,
        }
    };
    let m0 = slope(above - 1, rise / step) * step;
    let m1 = slope(above, rise / step) * step;
    d0 * (x * (m0 + x * (3.0 * rise - 2.0 * m0 - m1 + x * (m0 + m1 - 2.0 * rise)))).exp()
}

fn in_layers(km: f64) -> f64 {
    let geopotential = RADIUS_KM * km / (RADIUS_KM + km);
    let mut pressure = 101_325.0;
    let mut temperature = 288.15;
    for (k, &(base, base_temperature, gradient)) in LAYERS.iter().enumerate() {
        let top = LAYERS.get(k + 1).map_or(f64::INFINITY, |next| next.0);
        let rise = geopotential.min(top) - base;
        if rise <= 0.0 && k > 0 {
            break;
        }
        temperature = base_temperature + gradient * rise;
        pressure *= match gradient == 0.0 {
            true => (-HYDROSTATIC_K_KM * rise / base_temperature).exp(),
            false => (base_temperature / temperature).powf(HYDROSTATIC_K_KM / gradient),
        };
    }
    pressure / (GAS_CONSTANT * temperature)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_standard_layers_are_those_of_its_table() {
        // US Standard Atmosphere 1976, table I, geometric altitudes.
        for (km, density) in [
            (0.0, 1.2250),
            (5.0, 7.3643e-1),
            (10.0, 4.1351e-1),
            (20.0, 8.8910e-2),
            (30.0, 1.8410e-2),
            (40.0, 3.9957e-3),
            (50.0, 1.0269e-3),
            (60.0, 3.0968e-4),
            (70.0, 8.2829e-5),
            (80.0, 1.8458e-5),
            (86.0, 6.958e-6),
            (200.0, 2.541e-10),
            (1000.0, 3.561e-15),
        ] {
            let found = AtmosphereModel::Standard1976.density_kg_m3(km * 1e3);
            assert!(
                (found / density - 1.0).abs() < 2e-4,
                "{km} km: {found:e} {density:e}"
            );
        }
    }

    #[test]
    fn the_air_thins_without_steps_from_the_ground_to_the_top() {
        for model in [AtmosphereModel::Exponential, AtmosphereModel::Standard1976] {
            let mut before = model.density_kg_m3(-6_000.0);
            assert_eq!(before, model.density_kg_m3(-5_000.0));
            for k in 0..250_000 {
                let density = model.density_kg_m3(-5_000.0 + 10.0 * f64::from(k));
                assert!(
                    density <= before && density > 0.996 * before,
                    "{model:?} {k}: {density:e} {before:e}"
                );
                before = density;
            }
            assert!(before < 2e-17);
            assert_eq!(model.density_kg_m3(3e6), 0.0);
        }
    }

    #[test]
    fn both_models_agree_to_the_spread_between_them() {
        for km in 0..1000 {
            let h = f64::from(km) * 1e3;
            let ratio = AtmosphereModel::Exponential.density_kg_m3(h)
                / AtmosphereModel::Standard1976.density_kg_m3(h);
            assert!((0.6..1.45).contains(&ratio), "{km}: {ratio}");
        }
    }
}
