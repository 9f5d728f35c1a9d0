//! Multiply scattered light and light reflected by the ground, anywhere in the atmosphere.
//!
//! Scattering by molecules depends exactly on the moments E = ∫L dω and M = ∫L d dᵀ dω of the incoming light. This holds because Rayleigh's phase
//! function is a polynomial of second order. For the aerosol we keep the first three Legendre terms (and F = ∫L d dω), enough for light that was
//! already scattered. The source function is J(v) = a0 + bx vx + bz vz + cxx vx² + czz vz² + cxz vx vz. Here v is the view direction, z is up, and x is
//! horizontal towards the Sun. The orders follow the method of successive orders: collect light along rays from J, compute its moments, and form the
//! next J. Rays follow the spherical Earth; light varies along them with the Sun's height.

use super::path::{Light, Path, Ray};
use super::quadrature::{gauss_legendre_8, gauss_legendre_10};
use super::source_table::{HEIGHTS, SUNS, SourceFunction, SourceTable};
use super::transmittance::{TransmittanceTable, horizon_cosine, to_ground, to_top};
use super::{height_radius, sun_cosine};
use crate::air::model::{AEROSOL_ASYMMETRY, AirModel, RAYLEIGH_PHASE};
use crate::air::spectrum::Spectrum;
use std::f64::consts::PI;
use terrella_files::parallel;

/// Azimuths of rays, on one side of the Sun's vertical plane.
const AZIMUTHS: usize = 4;
/// Steps of a ray.
const STEPS: u32 = 14;

/// Sources of all orders of scattering.
pub(super) struct Sources {
    /// Sources over black ground.
    pub black: SourceTable,
    /// Sources of light from the ground, for albedo 1 and one reflection.
    pub bounce: SourceTable,
    /// Fraction of the ground's light that the atmosphere returns to the ground.
    pub sky_albedo: Spectrum,
}

/// Moments of the light that reaches a point.
#[derive(Clone, Copy, Default)]
struct Moments {
    e: Spectrum,
    fx: Spectrum,
    fz: Spectrum,
    xx: Spectrum,
    zz: Spectrum,
    xz: Spectrum,
    /// Irradiance of the light from above on a level surface.
    down: Spectrum,
}

impl Moments {
    fn add(&mut self, light: Spectrum, x: f32, z: f32) {
        self.e += light;
        self.fx += light * x;
        self.fz += light * z;
        self.xx += light * (x * x);
        self.zz += light * (z * z);
        self.xz += light * (x * z);
        self.down += light * z.max(0.0);
    }

    /// The source function of this light, with these scattering fractions of molecules and aerosol.
    fn source(&self, molecules: Spectrum, aerosol: Spectrum) -> SourceFunction {
        let [a, b] = RAYLEIGH_PHASE.map(|c| c as f32);
        let g = AEROSOL_ASYMMETRY as f32;
        let aerosol = aerosol / (4.0 * std::f32::consts::PI);
        let yy = self.e - self.xx - self.zz;
        let second = molecules * b + aerosol * (7.5 * g * g);
        SourceFunction([
            molecules * (self.e * a) + aerosol * (self.e * (1.0 - 2.5 * g * g)) + second * yy,
            aerosol * self.fx * (3.0 * g),
            aerosol * self.fz * (3.0 * g),
            second * (self.xx - yy),
            second * (self.zz - yy),
            second * self.xz * 2.0,
        ])
    }
}

/// A direction from which light is collected at every height.
struct Direction {
    mu: f64,
    weight: f64,
}

/// Directions up and down at radius `r`, dense on both sides of the horizon.
fn looks(r: f64) -> Vec<Direction> {
    let horizon = horizon_cosine(r);
    let part = |nodes: &[(f64, f64)], low: f64, high: f64| -> Vec<Direction> {
        let half = 0.5 * (high - low);
        let look = |&(x, w): &(f64, f64)| Direction {
            mu: low + half * (1.0 + x),
            weight: w * half,
        };
        nodes.iter().map(look).collect()
    };
    let mut all = part(&gauss_legendre_10(), horizon, 1.0);
    all.extend(part(&gauss_legendre_8(), -1.0, horizon));
    all
}

/// One order of scattering: light from all directions at every height and Sun.
struct Order<'a> {
    air: &'a AirModel,
    transmittance: &'a TransmittanceTable,
    light: Light<'a>,
    /// Radiance of the ground by Sun cosine; empty for black ground.
    ground: &'a [Spectrum],
}

impl Order<'_> {
    fn moments(&self) -> Vec<Moments> {
        let rows = parallel::map(HEIGHTS, |height| self.row(height));
        rows.into_iter().flatten().collect()
    }

    fn row(&self, height: usize) -> Vec<Moments> {
        let r = height_radius(height as f64 / (HEIGHTS - 1) as f64);
        let mut row = vec![Moments::default(); SUNS];
        for look in looks(r) {
            let meets_ground = look.mu < horizon_cosine(r);
            let length = match meets_ground {
                true => to_ground(r, look.mu),
                false => to_top(r, look.mu),
            };
            let ray = Ray {
                r,
                mu: look.mu,
                from: 0.0,
                to: length,
                crowd: (-r * look.mu).clamp(0.0, length),
            };
            let path = Path::new(self.air, self.transmittance, ray, STEPS, self.light);
            let flat = (1.0 - look.mu * look.mu).max(0.0).sqrt();
            let weight = (look.weight * 2.0 * PI / AZIMUTHS as f64) as f32;
            for (n, moments) in row.iter_mut().enumerate() {
                let mu_s = sun_cosine(n as f64 / (SUNS - 1) as f64);
                let sun_flat = (1.0 - mu_s * mu_s).max(0.0).sqrt();
                for turn in 0..AZIMUTHS {
                    let azimuth = PI * (turn as f64 + 0.5) / AZIMUTHS as f64;
                    let nu = look.mu * mu_s + flat * sun_flat * azimuth.cos();
                    let mut light = path.radiance(mu_s as f32, nu as f32);
                    if meets_ground && !self.ground.is_empty() {
                        let cos = (r * mu_s + length * nu).clamp(-1.0, 1.0);
                        light += path.through * by_sun(self.ground, cos);
                    }
                    let x = (flat * azimuth.cos()) as f32;
                    moments.add(light * weight, x, look.mu as f32);
                }
            }
        }
        row
    }

    fn sources(&self, moments: &[Moments]) -> SourceTable {
        let mut table = SourceTable::zero();
        for (n, (source, moments)) in table.texels.iter_mut().zip(moments).enumerate() {
            let r = height_radius((n / SUNS) as f64 / (HEIGHTS - 1) as f64);
            let medium = self.air.medium(r);
            let scattering = medium.scattering();
            *source = moments.source(medium.molecules / scattering, medium.aerosol / scattering);
        }
        table
    }
}

/// Interpolates a value by Sun cosine.
pub(super) fn by_sun(values: &[Spectrum], mu_s: f64) -> Spectrum {
    let at = f64::from(super::sun_coordinate(mu_s as f32)) * (SUNS - 1) as f64;
    let low = (at as usize).min(SUNS - 2);
    values[low].lerp(values[low + 1], (at - low as f64) as f32)
}

impl Sources {
    pub fn compute(air: &AirModel, transmittance: &TransmittanceTable) -> Self {
        let order = |light: Light<'_>, ground: &[Spectrum]| {
            let order = Order {
                air,
                transmittance,
                light,
                ground,
            };
            let moments = order.moments();
            let down: Vec<Spectrum> = moments[..SUNS].iter().map(|m| m.down).collect();
            (order.sources(&moments), down)
        };
        let from_sun = Light {
            sun: true,
            sources: None,
        };
        let mut sky = vec![Spectrum::ZERO; SUNS];
        let black = sum_of_orders(&mut sky, |before| match before {
            None => order(from_sun, &[]),
            Some(table) => order(
                Light {
                    sun: false,
                    sources: Some(table),
                },
                &[],
            ),
        });
        let ground: Vec<Spectrum> = (0..SUNS)
            .map(|n| {
                let mu_s = sun_cosine(n as f64 / (SUNS - 1) as f64);
                let direct = transmittance.to_sun(1.0, mu_s) * mu_s.max(0.0) as f32;
                (direct + sky[n]) / std::f32::consts::PI
            })
            .collect();
        let dark = Light {
            sun: false,
            sources: None,
        };
        let mut back = vec![Spectrum::ZERO; SUNS];
        let bounce = sum_of_orders(&mut back, |before| match before {
            None => order(dark, &ground),
            Some(table) => order(
                Light {
                    sun: false,
                    sources: Some(table),
                },
                &[],
            ),
        });
        let high_sun = SUNS - 1;
        Self {
            black,
            bounce,
            sky_albedo: back[high_sun] / (ground[high_sun] * std::f32::consts::PI),
        }
    }
}

/// Sums successive orders, with a geometric series for the rest. Adds the irradiance on the ground to `down`.
fn sum_of_orders(
    down: &mut [Spectrum],
    mut order: impl FnMut(Option<&SourceTable>) -> (SourceTable, Vec<Spectrum>),
) -> SourceTable {
    const ORDERS: usize = 4;
    let mut total = SourceTable::zero();
    let mut before: Option<SourceTable> = None;
    let mut down_before = vec![Spectrum::ZERO; down.len()];
    for n in 0..ORDERS {
        let (mut next, mut falls) = order(before.as_ref());
        if n + 1 == ORDERS {
            if let Some(before) = &before {
                for (texel, before) in next.texels.iter_mut().zip(&before.texels) {
                    *texel = texel.scaled(tail(before.0[0], texel.0[0]));
                }
            }
            for (falls, before) in falls.iter_mut().zip(&down_before) {
                *falls = *falls * tail(*before, *falls);
            }
        }
        for (total, texel) in total.texels.iter_mut().zip(&next.texels) {
            *total += *texel;
        }
        for (down, falls) in down.iter_mut().zip(&falls) {
            *down += *falls;
        }
        down_before = falls;
        before = Some(next);
    }
    total
}

/// Sum of a geometric series relative to its first term: 1/(1 − ratio). The ratio is that of the last
/// term to the one before.
fn tail(before: Spectrum, last: Spectrum) -> Spectrum {
    let ratio = (last / before.max(1e-30)).max(0.0).min(0.9);
    Spectrum::ONE / (Spectrum::ONE - ratio)
}
