//! The air by quadrature: light and transmittance along a line of sight, and sunlight at any point, by wavelength.
//!
//! Spherical shells of the unit sphere of scaled space, straight rays, light without polarisation. Each ray is divided where the density laws
//! change ([`super::path`]) and integrated by Gauss's rule in every piece; columns at the nodes are integrated to the same order. Single scattering
//! uses the full phase functions; multiple scattering is in [`super::orders`]. In hazy air the nearly forward part of the aerosol's scattering
//! counts as unscattered in both (the TMS method of Nakajima and Tanaka 1988, J. Quant. Spectrosc. Radiat. Transfer 40, 51); in clear air only
//! integrals are approximated. Neither the drawn air's model nor its tables are used.
//!
//! Columns towards the Sun are stored in a table by height and Sun cosine with cubic interpolation; `air_tests.rs` compares it with direct
//! quadrature.

use super::field::{BySun, Field, Grid, basis, moments, parts};
use super::geometry::ScaledRay;
use super::grid::{Gauss, Table2d};
use super::matter::{
    AEROSOL_ASYMMETRY, AEROSOL_FORWARD, Matter, THICKNESS_M, molecule_second_moment,
};
use super::path::{Path, SHELLS_M};
use super::spectrum::{BANDS, Spectrum};
use glam::DVec3;
use std::f64::consts::PI;

/// Nodes in each piece of a ray of sight, and of a ray to the Sun.
const SIGHT_NODES: usize = 3;
const SUN_NODES: usize = 5;
/// Columns and rows of the table of columns towards the Sun.
const COLUMNS: (usize, usize) = (384, 160);
/// Directions of the sky by cosine and round half the horizon, for its light on the ground.
const SKY: (usize, usize) = (14, 10);

/// An atmosphere made ready.
#[derive(Clone, Debug)]
pub(super) struct Air {
    pub matter: Matter,
    /// Radius of the ground, metres.
    pub radius_m: f64,
    /// Upper boundary, equatorial radii.
    pub top: f64,
    shells: Vec<f64>,
    sight: Gauss,
    /// Of molecules, ozone and aerosol, as [`Matter::densities`].
    columns: Table2d,
    /// Light that is scattered more than once, where it is known.
    pub scattered: Option<Scattered>,
}

/// Light scattered more than once.
#[derive(Clone, Debug)]
pub(super) struct Scattered {
    /// Points of its tables.
    pub grid: Grid,
    /// Over black ground.
    pub sun: Field,
    /// Returned once by white ground.
    pub ground: Field,
    /// The part of light going up evenly from the ground that the air sends back.
    pub sky_albedo: Spectrum,
    /// Irradiance of black ground by the sky.
    pub sky: BySun,
}

/// Light and transmittance along a line of sight.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sight {
    /// Light scattered into it over black ground, per unit irradiance of the Sun and steradian.
    pub black: Spectrum,
    /// Light added by white ground that reflects its light once.
    pub bounced: Spectrum,
    /// Fraction of light that passes all of it, or goes nearly straight on.
    pub transmittance: Spectrum,
}

impl Air {
    /// Computes an air over ground of a radius, without multiple scattering.
    pub fn without_orders(matter: Matter, radius_m: f64) -> Self {
        let top = 1.0 + THICKNESS_M / radius_m;
        let shells: Vec<f64> = SHELLS_M.iter().map(|h| 1.0 + h / radius_m).collect();
        let to_sun = Gauss::new(SUN_NODES);
        let columns = Table2d::fill(COLUMNS.0, COLUMNS.1, |x, y| {
            let height = (top - 1.0) * y * y;
            let horizon = horizon_cosine(height);
            let mu = horizon + (1.0 - horizon) * x * x;
            columns_out(&matter, radius_m, &shells, height, mu, &to_sun)
        });
        Self {
            matter,
            radius_m,
            top,
            shells,
            sight: Gauss::new(SIGHT_NODES),
            columns,
            scattered: None,
        }
    }

    /// The same air with another number of nodes in each piece of a ray of sight, at most 16.
    #[cfg(test)]
    pub fn with_sight(&self, nodes: usize) -> Self {
        Self {
            sight: Gauss::new(nodes),
            ..self.clone()
        }
    }

    /// Columns from a height, equatorial radii, at zenith cosine `mu` out of the air, by quadrature. The ground is not
    /// looked at.
    #[cfg(test)]
    pub fn columns_by_quadrature(&self, height: f64, mu: f64, rule: &Gauss) -> DVec3 {
        columns_out(&self.matter, self.radius_m, &self.shells, height, mu, rule)
    }

    /// Densities at a height, equatorial radii: of columns over lengths in equatorial radii.
    pub fn densities(&self, height: f64) -> DVec3 {
        self.matter.densities(height * self.radius_m) * self.radius_m
    }

    /// Coefficients of scattering by molecules and by aerosol, of such densities.
    pub fn scattering(&self, densities: DVec3) -> [Spectrum; 2] {
        [
            self.matter.molecules.map(|m| m * densities.x),
            self.matter.aerosol_scattering.map(|a| a * densities.z),
        ]
    }

    /// Factors of the moments of light, by degree, in light scattered with these coefficients: 1/sr.
    pub fn kernels(&self, molecules: &Spectrum, aerosol: &Spectrum) -> [Spectrum; 4] {
        std::array::from_fn(|degree| {
            let of_molecules = [1.0, 0.0, molecule_second_moment(), 0.0][degree];
            let of_aerosol = aerosol_moment(degree);
            std::array::from_fn(|i| {
                (of_molecules * molecules[i] + of_aerosol * aerosol[i]) / (4.0 * PI)
            })
        })
    }

    /// Columns between a height, equatorial radii, and a Sun at zenith cosine `mu`; `None` if the Earth is in between.
    pub fn columns_to_sun(&self, height: f64, mu: f64) -> Option<DVec3> {
        let horizon = horizon_cosine(height);
        if mu < horizon {
            return None;
        }
        let x = ((mu - horizon) / (1.0 - horizon)).sqrt();
        let y = (height / (self.top - 1.0)).clamp(0.0, 1.0).sqrt();
        Some(self.columns.at(x, y))
    }

    /// Fraction of the light of a Sun without size that reaches a height, equatorial radii.
    pub fn sunlight(&self, height: f64, mu: f64) -> Spectrum {
        match self.columns_to_sun(height, mu) {
            Some(columns) => self.matter.through(columns),
            None => [0.0; BANDS],
        }
    }

    /// Irradiance of horizontal black ground by the sky alone for a Sun at zenith cosine `mu`, as a fraction of the Sun's in space.
    pub fn skylight_on_ground(&self, mu: f64) -> Spectrum {
        self.scattered
            .as_ref()
            .map_or([0.0; BANDS], |scattered| scattered.sky.at(mu))
    }

    /// The part of light going up evenly from the ground that the air sends back.
    pub fn sky_albedo(&self) -> Spectrum {
        self.scattered
            .as_ref()
            .map_or([0.0; BANDS], |scattered| scattered.sky_albedo)
    }

    /// The sky's irradiance on level black ground, gathered from all directions.
    pub fn skylight(&self, mu: f64) -> Spectrum {
        let sun = DVec3::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, mu);
        let mut light = [0.0; BANDS];
        let around = SKY.1;
        for (s, weight) in Gauss::new(SKY.0).on(0.0, 1.0) {
            // Crowded towards the horizon.
            let (cos, weight) = (s * s, 2.0 * s * weight);
            for turn in 0..around {
                let turn = PI * (turn as f64 + 0.5) / around as f64;
                let flat = (1.0 - cos * cos).max(0.0).sqrt();
                let direction = DVec3::new(flat * turn.cos(), flat * turn.sin(), cos);
                if let Some(sight) = self.sight(&ScaledRay::new(DVec3::Z, direction), sun) {
                    let part = 2.0 * PI * cos * weight / around as f64;
                    light
                        .iter_mut()
                        .zip(sight.black)
                        .for_each(|(sum, light)| *sum += part * light);
                }
            }
        }
        light
    }

    /// Light and transmittance along a line of sight; `None` if it meets no air. `sun` is a unit vector of scaled space.
    pub fn sight(&self, line: &ScaledRay, sun: DVec3) -> Option<Sight> {
        Some(self.sight_along(&Path::new(line, self.top)?, sun))
    }

    /// The same along a path.
    pub fn sight_along(&self, path: &Path, sun: DVec3) -> Sight {
        let direction = path.direction();
        let cos = direction.dot(sun);
        let (molecule_phase, aerosol_phase) = (self.molecule_phase(cos), self.aerosol_phase(cos));
        let moments = moments(self.matter.is_hazy());
        let rule = &self.sight;
        let count = rule.nodes.len();
        let (mut black, mut bounced) = ([0.0; BANDS], [0.0; BANDS]);
        let mut before = DVec3::ZERO;
        let mut found = [(DVec3::ZERO, DVec3::ZERO, 0.0); MAX_NODES];
        let breakpoints = path.breakpoints(&self.shells, self.radius_m, Some(sun));
        for (from, to) in breakpoints.pieces() {
            let length = to - from;
            for (found, (at, _)) in found.iter_mut().zip(rule.on(from, to)) {
                let place = path.place(at);
                let up = place.point / (1.0 + place.height);
                *found = (self.densities(place.height), up, place.height);
            }
            let found = &found[..count];
            let sum = |weights: &[f64]| -> DVec3 {
                let parts = found.iter().zip(weights);
                parts
                    .map(|((densities, ..), w)| *densities * *w)
                    .sum::<DVec3>()
                    * length
            };
            for ((running, weight), (densities, up, height)) in
                rule.running.iter().zip(&rule.weights).zip(found)
            {
                let columns = before + sum(running);
                let weight = weight * length;
                let [molecules, aerosol] = self.scattering(*densities);
                let mu = up.dot(sun);
                if let Some(to_sun) = self.columns_to_sun(*height, mu) {
                    let through = self.matter.through_or_on(columns + to_sun);
                    for i in 0..BANDS {
                        let scattered = molecules[i] * molecule_phase + aerosol[i] * aerosol_phase;
                        black[i] += weight * through[i] * scattered;
                    }
                }
                let Some(scattered) = &self.scattered else {
                    continue;
                };
                let Some(corners) = scattered.grid.corners(*height, mu) else {
                    continue;
                };
                let through = self
                    .matter
                    .through_or_on(columns)
                    .map(|through| through * weight);
                let [molecules, aerosol] =
                    [molecules, aerosol].map(|part| std::array::from_fn(|i| part[i] * through[i]));
                let kernels = self.kernels(&molecules, &aerosol);
                let (x, z) = parts(-direction, *up, sun);
                let basis = basis(x, z);
                scattered
                    .sun
                    .add_source(&corners, &basis, &kernels, moments, &mut black);
                scattered
                    .ground
                    .add_source(&corners, &basis, &kernels, moments, &mut bounced);
            }
            before += sum(&rule.weights);
        }
        Sight {
            black,
            bounced,
            transmittance: self.matter.through_or_on(before),
        }
    }

    /// Rayleigh's, 1/sr.
    pub fn molecule_phase(&self, cos: f64) -> f64 {
        (1.0 + molecule_second_moment() * 0.5 * (3.0 * cos * cos - 1.0)) / (4.0 * PI)
    }

    /// The aerosol's phase function without its nearly forward part, to the degree of the moments: 1/sr.
    pub fn aerosol_phase_aside(&self, cos: f64) -> f64 {
        // Legendre's polynomials.
        let degrees = [
            1.0,
            cos,
            0.5 * (3.0 * cos * cos - 1.0),
            0.5 * cos * (5.0 * cos * cos - 3.0),
        ];
        let parts = degrees.into_iter().enumerate();
        parts
            .map(|(degree, value)| aerosol_moment(degree) * value)
            .sum::<f64>()
            / (4.0 * PI)
    }

    /// Henyey and Greenstein 1941, 1/sr.
    pub fn aerosol_phase(&self, cos: f64) -> f64 {
        let g = AEROSOL_ASYMMETRY;
        (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * cos).powf(1.5))
    }
}

/// Most nodes in a piece of a ray of sight.
const MAX_NODES: usize = 16;

/// The moment of the aerosol's phase function without light that goes nearly straight on, times 2l + 1.
fn aerosol_moment(degree: usize) -> f64 {
    (2 * degree + 1) as f64 * (AEROSOL_ASYMMETRY.powi(degree as i32) - AEROSOL_FORWARD)
}

/// Columns of a path out of the air.
fn columns_out(
    matter: &Matter,
    radius_m: f64,
    shells: &[f64],
    height: f64,
    mu: f64,
    rule: &Gauss,
) -> DVec3 {
    let path = Path::out_of_air(height, mu, 1.0 + THICKNESS_M / radius_m);
    let breakpoints = path.breakpoints(shells, radius_m, None);
    let sum: DVec3 = breakpoints
        .nodes(rule)
        .map(|(at, weight)| matter.densities(path.place(at).height * radius_m) * weight)
        .sum();
    sum * radius_m
}

/// Cosine of the horizon's zenith angle from a height, equatorial radii.
pub(super) fn horizon_cosine(height: f64) -> f64 {
    -(height * (height + 2.0)).sqrt() / (1.0 + height)
}
