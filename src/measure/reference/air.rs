//! The air by quadrature: what a ray of sight gathers and loses, and what sunlight is left anywhere.
//!
//! The physical model is that of [`crate::air`]: single scattering by molecules and aerosol, absorption by ozone,
//! on the unit sphere of scaled space, higher orders after Hillaire 2020, section 5. Only its constants
//! ([`AirModel`]) are shared. Each ray is cut where the air changes its law ([`super::path`]) and integrated by Gauss's
//! rule in every piece; the optical depth at the nodes is integrated to the same order.
//!
//! What depends on two coordinates alone is kept in tables with cubic interpolation: the optical depth towards the Sun
//! by height and Sun cosine, and the light of higher orders. `air_tests.rs` measures both against direct quadrature.

use super::geometry::ScaledRay;
use super::grid::{Gauss, Table1d, Table2d};
use super::path::{Path, PathPoint, SHELLS_M};
use crate::air::{AirModel, EARTH_AIR};
use glam::DVec3;
use std::f64::consts::PI;
use std::sync::OnceLock;

/// Numbers of nodes and sizes of tables.
#[derive(Clone, Copy, Debug)]
pub(super) struct Resolution {
    /// Nodes in each piece of a ray of sight.
    pub sight: usize,
    /// Nodes in each piece of a ray to the Sun.
    pub to_sun: usize,
    /// Columns and rows of the table of optical depths.
    pub depths: (usize, usize),
    /// Columns and rows of the table of higher orders.
    pub higher: (usize, usize),
    /// Directions of higher orders: above the horizon, below it, and round half the horizon.
    pub directions: (usize, usize, usize),
}

impl Resolution {
    /// What pictures are made with.
    pub const PICTURE: Self = Self {
        sight: 4,
        to_sun: 5,
        depths: (512, 192),
        higher: (64, 24),
        directions: (10, 8, 8),
    };
}

/// An atmosphere made ready.
#[derive(Clone, Debug)]
pub(super) struct Air {
    model: AirModel,
    /// Upper boundary, equatorial radii.
    pub top: f64,
    shells: Vec<f64>,
    sight: Gauss,
    depths: Table2d,
    higher: Option<Table2d>,
}

/// What a ray of sight gathers and loses.
#[derive(Clone, Copy, Debug)]
pub(super) struct RayScattering {
    /// Light scattered into it, per unit irradiance of the Sun and steradian.
    pub light: DVec3,
    /// Fraction of light that passes all of it.
    pub transmittance: DVec3,
}

/// Coefficients at one place, per equatorial radius.
struct Medium {
    molecules: DVec3,
    aerosol: DVec3,
    extinction: DVec3,
}

impl Air {
    /// The Earth's air. Made once per process.
    pub fn earth() -> &'static Self {
        static AIR: OnceLock<Air> = OnceLock::new();
        AIR.get_or_init(|| Self::new(EARTH_AIR, Resolution::PICTURE))
    }

    /// Makes any air ready, on all cores.
    pub fn new(model: AirModel, effort: Resolution) -> Self {
        let top = 1.0 + model.thickness_m / model.radius_m;
        let to_sun = Gauss::new(effort.to_sun);
        let (columns, rows) = effort.depths;
        let shells = Self::shells(&model);
        let medium = |height: f64| medium(&model, height).extinction;
        let depths = Table2d::fill(columns, rows, |x, y| {
            let height = (top - 1.0) * y * y;
            let horizon = horizon_cosine(height);
            let mu = horizon + (1.0 - horizon) * x * x;
            depth(
                &Path::out_of_air(height, mu, top),
                &shells,
                model.radius_m,
                &to_sun,
                medium,
            )
        });
        let mut air = Self {
            model,
            top,
            shells,
            sight: Gauss::new(effort.sight),
            depths,
            higher: None,
        };
        let (columns, rows) = effort.higher;
        let [up, down] = [effort.directions.0, effort.directions.1].map(Gauss::new);
        let height = |y: f64| (top - 1.0) * y * y;
        let around = effort.directions.2;
        let series = Table1d::fill(rows, |y| air.series(height(y), &up, &down));
        let higher = Table2d::fill(columns, rows, |x, y| {
            air.second_order(height(y), spread(x), &up, &down, around) * series.at(y)
        });
        air.higher = Some(higher);
        air
    }

    /// The same air with another number of nodes in each piece of a ray of sight, at most 16.
    #[cfg(test)]
    pub fn with_sight(&self, nodes: usize) -> Self {
        Self {
            sight: Gauss::new(nodes),
            ..self.clone()
        }
    }

    /// Radii at which rays are cut: the usual ones and the kinks of this air's ozone.
    fn shells(model: &AirModel) -> Vec<f64> {
        let ozone = [-1.0, 0.0, 1.0].map(|n| model.ozone_center_m + n * model.ozone_half_width_m);
        let mut heights: Vec<_> = SHELLS_M.into_iter().chain(ozone).collect();
        heights.retain(|h| (0.0..=model.thickness_m).contains(h));
        heights.sort_unstable_by(f64::total_cmp);
        heights.dedup();
        heights.iter().map(|h| 1.0 + h / model.radius_m).collect()
    }

    /// Optical depth from a height, equatorial radii, at zenith cosine `mu` out of the air, by quadrature. The ground is
    /// not looked at.
    #[cfg(test)]
    pub fn depth_to_sun(&self, height: f64, mu: f64, rule: &Gauss) -> DVec3 {
        depth(
            &Path::out_of_air(height, mu, self.top),
            &self.shells,
            self.model.radius_m,
            rule,
            |height| medium(&self.model, height).extinction,
        )
    }

    /// Fraction of the Sun's light that reaches a height, equatorial radii, where the Sun stands at zenith cosine `mu`:
    /// a point without size. Zero where the Earth is in between.
    pub fn sunlight(&self, height: f64, mu: f64) -> DVec3 {
        let horizon = horizon_cosine(height);
        if mu < horizon {
            return DVec3::ZERO;
        }
        let x = ((mu - horizon) / (1.0 - horizon)).sqrt();
        exp(-self.depths.at(x, self.height_coordinate(height)))
    }

    fn height_coordinate(&self, height: f64) -> f64 {
        (height / (self.top - 1.0)).clamp(0.0, 1.0).sqrt()
    }

    /// Light scattered more than once, per unit irradiance and steradian, that leaves a place per scattering.
    pub fn higher(&self, height: f64, mu: f64) -> DVec3 {
        match &self.higher {
            // A cubic through the first nights and the last twilight may swing below nothing.
            Some(table) => table
                .at(gather(mu), self.height_coordinate(height))
                .max(DVec3::ZERO),
            None => DVec3::ZERO,
        }
    }

    /// Light and transmittance along a line of sight; `None` if it meets no air. `sun` is a unit vector of scaled space.
    pub fn sight(&self, line: &ScaledRay, sun: DVec3) -> Option<RayScattering> {
        let path = Path::new(line, self.top)?;
        let cos = path.direction().dot(sun);
        let (molecules, aerosol) = (molecule_phase(cos), self.aerosol_phase(cos));
        Some(self.march(&path, Some(sun), |place, medium| {
            let mu = place.point.dot(sun) / (1.0 + place.height);
            self.sunlight(place.height, mu)
                * (medium.molecules * molecules + medium.aerosol * aerosol)
                + self.higher(place.height, mu) * (medium.molecules + medium.aerosol)
        }))
    }

    /// ∫ source · transmittance along a path, and the transmittance of all of it.
    fn march(
        &self,
        path: &Path,
        sun: Option<DVec3>,
        source: impl Fn(&PathPoint, &Medium) -> DVec3,
    ) -> RayScattering {
        let rule = &self.sight;
        let count = rule.nodes.len();
        let mut light = DVec3::ZERO;
        let mut before = DVec3::ZERO;
        let breakpoints = path.breakpoints(&self.shells, self.model.radius_m, sun);
        let mut found = [(DVec3::ZERO, DVec3::ZERO); MAX_NODES];
        for (from, to) in breakpoints.pieces() {
            let length = to - from;
            for (found, (at, _)) in found.iter_mut().zip(rule.on(from, to)) {
                let place = path.place(at);
                let medium = medium(&self.model, place.height);
                *found = (medium.extinction, source(&place, &medium));
            }
            let found = &found[..count];
            let sum = |weights: &[f64]| -> DVec3 {
                let parts = found.iter().zip(weights);
                parts
                    .map(|((extinction, _), w)| *extinction * *w)
                    .sum::<DVec3>()
                    * length
            };
            for ((running, weight), (_, source)) in
                rule.running.iter().zip(&rule.weights).zip(found)
            {
                light += *source * exp(-(before + sum(running))) * (*weight * length);
            }
            before += sum(&rule.weights);
        }
        RayScattering {
            light,
            transmittance: exp(-before),
        }
    }

    /// Light scattered twice, or once and once by the ground, if the last scattering is even (Hillaire 2020, eq. 5): per
    /// unit irradiance and steradian, per scattering, at a height where the Sun stands at zenith cosine `mu`.
    fn second_order(&self, height: f64, mu: f64, up: &Gauss, down: &Gauss, around: usize) -> DVec3 {
        let sun = DVec3::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, mu);
        let mut light = DVec3::ZERO;
        for (cos, weight) in directions(height, up, down) {
            for turn in 0..around {
                // Both halves of the turn are alike.
                let turn = PI * (turn as f64 + 0.5) / around as f64;
                let Some(path) = self.way_from(height, cos, turn) else {
                    continue;
                };
                let sight = self.march(&path, Some(sun), |place, medium| {
                    let mu = place.point.dot(sun) / (1.0 + place.height);
                    self.sunlight(place.height, mu) * (medium.molecules + medium.aerosol)
                });
                let mut found = sight.light / (4.0 * PI);
                if path.meets_ground {
                    let mu = path.end().normalize().dot(sun);
                    let bounced = self.sunlight(0.0, mu) * mu.max(0.0);
                    found += sight.transmittance * bounced * (self.model.ground_albedo / PI);
                }
                light += found * (weight / around as f64);
            }
        }
        light
    }

    /// What the light of the second order has to be multiplied by for all orders together, 1/(1 − f): f is the part of
    /// evenly scattered light that is scattered again (Hillaire 2020, eqs. 7 to 9).
    fn series(&self, height: f64, up: &Gauss, down: &Gauss) -> DVec3 {
        let again = directions(height, up, down).map(|(cos, weight)| {
            let path = self.way_from(height, cos, 0.0);
            let sight = path.map(|path| self.march(&path, None, |_, m| m.molecules + m.aerosol));
            sight.map_or(DVec3::ZERO, |sight| sight.light * weight)
        });
        DVec3::ONE / (DVec3::ONE - again.sum::<DVec3>())
    }

    /// The way from a height on the z axis at a zenith cosine and turned about the axis.
    fn way_from(&self, height: f64, cos: f64, turn: f64) -> Option<Path> {
        let start = DVec3::new(0.0, 0.0, 1.0 + height);
        let flat = (1.0 - cos * cos).max(0.0).sqrt();
        let direction = DVec3::new(flat * turn.cos(), flat * turn.sin(), cos);
        Path::new(&ScaledRay::new(start, direction), self.top)
    }

    /// Irradiance of level ground by the sky alone where the Sun stands at zenith cosine `mu`, as a fraction of the Sun's
    /// in space.
    ///
    /// `up` and `around` are the nodes of directions of the sky by cosine and round half the horizon.
    pub fn skylight(&self, mu: f64, up: &Gauss, around: usize) -> DVec3 {
        let sun = DVec3::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, mu);
        let mut light = DVec3::ZERO;
        for (cos, weight) in up.on(0.0, 1.0) {
            for turn in 0..around {
                let turn = PI * (turn as f64 + 0.5) / around as f64;
                let flat = (1.0 - cos * cos).max(0.0).sqrt();
                let direction = DVec3::new(flat * turn.cos(), flat * turn.sin(), cos);
                if let Some(sight) = self.sight(&ScaledRay::new(DVec3::Z, direction), sun) {
                    light += sight.light * (2.0 * PI * cos * weight / around as f64);
                }
            }
        }
        light
    }

    /// Cornette and Shanks 1992, 1/sr.
    fn aerosol_phase(&self, cos: f64) -> f64 {
        let g = self.model.aerosol_asymmetry;
        let scale = 3.0 / (8.0 * PI) * (1.0 - g * g) / (2.0 + g * g);
        scale * (1.0 + cos * cos) / (1.0 + g * g - 2.0 * g * cos).powf(1.5)
    }
}

/// Most nodes in a piece of a ray of sight.
const MAX_NODES: usize = 16;

/// Zenith cosines and weights of directions evenly round a place, sum 1. Those above and below the horizon stand apart,
/// both crowded towards it: there the light changes most, and jumps.
fn directions<'g>(
    height: f64,
    up: &'g Gauss,
    down: &'g Gauss,
) -> impl Iterator<Item = (f64, f64)> + 'g {
    let horizon = horizon_cosine(height);
    let side = move |rule: &'g Gauss, end: f64| {
        rule.on(0.0, 1.0).map(move |(s, weight)| {
            let reach = end - horizon;
            (horizon + reach * s * s, reach.abs() * s * weight)
        })
    };
    side(up, 1.0).chain(side(down, -1.0))
}

/// Rayleigh, 1/sr.
fn molecule_phase(cos: f64) -> f64 {
    3.0 / (16.0 * PI) * (1.0 + cos * cos)
}

/// The air at a height, equatorial radii.
fn medium(model: &AirModel, height: f64) -> Medium {
    let h = height * model.radius_m;
    let molecules = (-h / model.molecules.scale_height_m).exp() * model.radius_m;
    let aerosol = (-h / model.aerosol.scale_height_m).exp() * model.radius_m;
    let from_center = (h - model.ozone_center_m).abs() / model.ozone_half_width_m;
    let ozone = (1.0 - from_center).max(0.0) * model.radius_m;
    Medium {
        molecules: model.molecules.scattering_per_m * molecules,
        aerosol: model.aerosol.scattering_per_m * aerosol,
        extinction: model.molecules.extinction_per_m * molecules
            + model.aerosol.extinction_per_m * aerosol
            + model.ozone_absorption_per_m * ozone,
    }
}

/// Optical depth of a path.
fn depth(
    path: &Path,
    shells: &[f64],
    radius_m: f64,
    rule: &Gauss,
    extinction: impl Fn(f64) -> DVec3,
) -> DVec3 {
    let breakpoints = path.breakpoints(shells, radius_m, None);
    breakpoints
        .nodes(rule)
        .map(|(at, weight)| extinction(path.place(at).height) * weight)
        .sum()
}

/// Cosine of the horizon's zenith angle from a height, equatorial radii.
fn horizon_cosine(height: f64) -> f64 {
    -(height * (height + 2.0)).sqrt() / (1.0 + height)
}

/// How much finer Sun cosines are divided at the terminator than they would be evenly, as the parameter of a sinh.
const SPREAD: f64 = 4.0;

/// Sun cosine of a coordinate 0…1.
pub(super) fn spread(x: f64) -> f64 {
    (SPREAD * (2.0 * x - 1.0)).sinh() / SPREAD.sinh()
}

/// Its inverse.
pub(super) fn gather(mu: f64) -> f64 {
    0.5 + 0.5 * (mu * SPREAD.sinh()).asinh() / SPREAD
}

fn exp(v: DVec3) -> DVec3 {
    DVec3::new(v.x.exp(), v.y.exp(), v.z.exp())
}
