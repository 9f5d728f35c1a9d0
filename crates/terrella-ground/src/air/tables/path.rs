//! A straight ray through the atmosphere in steps, ready to be lit by any Sun.
//!
//! Steps, densities and transmittance along the ray do not depend on the Sun. They are computed once for all Suns.

use super::source_table::{COEFFICIENTS, SUNS, SourceFunction, SourceTable};
use super::transmittance::{SunRow, TransmittanceTable};
use super::{LOWEST_SUN, sun_coordinate};
use crate::air::model::{AirModel, aerosol_phase, molecule_phase};
use crate::air::spectrum::Spectrum;

/// A ray by one of its points. Lengths are in equatorial radii of scaled space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ray {
    /// Distance of the point from the Earth's centre.
    pub r: f64,
    /// Cosine between the ray and the point's zenith.
    pub mu: f64,
    /// Start of the ray, as a distance along it from the point.
    pub from: f64,
    /// End of the ray.
    pub to: f64,
    /// Distance in `from`…`to` around which steps are dense: where the ray is lowest.
    pub crowd: f64,
}

/// A step of a ray.
struct Step {
    /// The cosine of the Sun's zenith angle at the step is `a·mu_s + b·nu`.
    a: f32,
    b: f32,
    /// Cosine between the ray and the step's zenith.
    up: f32,
    /// Light that molecules and aerosol scatter per unit of sunlight at the step, times the transmittance up to the step.
    molecules: Spectrum,
    aerosol: Spectrum,
    /// Sunlight by Sun cosine.
    sun: SunRow,
    /// Sources by Sun cosine, with the same factor; empty without sources.
    sources: Vec<SourceFunction>,
}

/// A ray cut into steps.
pub(super) struct Path {
    steps: Vec<Step>,
    /// Transmittance of the whole ray.
    pub through: Spectrum,
    lowest: f32,
}

/// Light that a ray collects.
#[derive(Clone, Copy)]
pub(super) struct Light<'a> {
    /// Direct sunlight, scattered once.
    pub sun: bool,
    /// Light that was scattered earlier.
    pub sources: Option<&'a SourceTable>,
}

impl Path {
    /// Cuts a ray into `count` steps.
    pub fn new(
        air: &AirModel,
        table: &TransmittanceTable,
        ray: Ray,
        count: u32,
        light: Light<'_>,
    ) -> Self {
        let length = ray.to - ray.from;
        let crowd = ((ray.crowd - ray.from) / length.max(1e-12)).clamp(0.0, 1.0);
        // Positions are crowd + signed square on each side.
        let (low, high) = (-crowd.sqrt(), (1.0 - crowd).sqrt());
        let place = |n: u32| {
            let x = low + f64::from(n) / f64::from(count) * (high - low);
            ray.from + length * (crowd + x * x.abs())
        };
        let mut through = Spectrum::ONE;
        let mut steps = Vec::with_capacity(count as usize);
        for n in 0..count {
            let (begin, end) = (place(n), place(n + 1));
            let (t, step) = (0.5 * (begin + end), (end - begin) as f32);
            let r = (ray.r * ray.r + t * t + 2.0 * ray.r * ray.mu * t).sqrt();
            let medium = air.medium(r);
            // ∫ e^(−σt) over the step, exact for a constant σ.
            let depth = medium.extinction * step;
            let fade = depth.exp_of_minus();
            let weight = through * (Spectrum::ONE - fade) / medium.extinction.max(1e-9);
            through = through * fade;
            let sources = light.sources.map_or_else(Vec::new, |table| {
                let weight = weight * medium.scattering();
                table.at(r).iter().map(|s| s.scaled(weight)).collect()
            });
            steps.push(Step {
                a: (ray.r / r) as f32,
                b: (t / r) as f32,
                up: ((ray.r * ray.mu + t) / r) as f32,
                molecules: weight * medium.molecules,
                aerosol: weight * medium.aerosol,
                sun: table.row(r, light.sun),
                sources,
            });
        }
        Self {
            steps,
            through,
            lowest: LOWEST_SUN as f32,
        }
    }

    /// Radiance per unit of the Sun's irradiance, for the Sun's cosine `mu_s` at the ray's point and `nu` between ray and Sun.
    pub fn radiance(&self, mu_s: f32, nu: f32) -> Spectrum {
        let molecules = molecule_phase(f64::from(nu)) as f32;
        let aerosol = aerosol_phase(f64::from(nu)) as f32;
        let mut light = Spectrum::ZERO;
        for step in &self.steps {
            let mu = (step.a * mu_s + step.b * nu).clamp(-1.0, 1.0);
            if mu <= self.lowest {
                continue;
            }
            if let Some(sun) = step.sun.at(mu) {
                light += sun * (step.molecules * molecules + step.aerosol * aerosol);
            }
            if !step.sources.is_empty() {
                let at = sun_coordinate(mu) * (SUNS - 1) as f32;
                let low = (at as usize).min(SUNS - 2);
                let part = at - low as f32;
                let (first, second) = (&step.sources[low].0, &step.sources[low + 1].0);
                // The Sun's horizontal direction at the step, from the angles between ray, Sun and zenith.
                let flat = (1.0 - mu * mu).max(1e-6).sqrt();
                let across = ((nu - mu * step.up) / flat).clamp(-1.0, 1.0);
                let up = step.up;
                let by = [1.0, across, up, across * across, up * up, across * up];
                for n in 0..COEFFICIENTS {
                    light += (first[n] + (second[n] - first[n]) * part) * by[n];
                }
            }
        }
        light
    }
}
