//! Multiple scattering: successive orders of scattering in spherical shells.
//!
//! The light scattered into a direction depends on the incident light only through its moments with the functions of [`basis`]: the phase function
//! of molecules has no others, and that of the aerosol is truncated there, with the rest counted as unscattered. An order is thus a table of
//! moments by height and Sun cosine, and the next one follows from it along rays from each point.
//!
//! Stored are the sums of all orders, for sunlight over black ground, and for light that white ground reflects once. Ground of albedo A adds the
//! second one A/(1 − A s) times, with s the fraction of upward light that the air scatters back.

use super::air::{Air, horizon_cosine};
use super::field::{Field, Grid, HEIGHTS, MOMENTS, basis, moments, parts};
use super::geometry::ScaledRay;
use super::grid::Gauss;
use super::path::Path;
use super::spectrum::{BANDS, Spectrum};
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Those that light has which is alike all round the vertical.
const ALIKE_ROUND: &[usize] = &[0, 1, 3, 6];

/// Directions above and below the horizon, and round half of it.
const UP: usize = 8;
const DOWN: usize = 6;
const AROUND: usize = 5;

/// Heights between which a ray is integrated in one piece here, metres, and nodes in each.
const SHELLS_M: [f64; 9] = [
    0.0, 1_000.0, 3_000.0, 6_000.0, 10_000.0, 16_000.0, 25_000.0, 40_000.0, 100_000.0,
];
const NODES: usize = 3;

/// Most orders; fewer where an order adds less than this part to the sum, darkness aside: the rest is estimated.
const MAX_ORDERS: usize = 14;
const LEAST: f64 = 5e-3;
const DARKEST: f64 = 1e-4;

/// Adds moments, those of each band this many times.
fn add(sum: &mut [Spectrum; MOMENTS], more: &[Spectrum; MOMENTS], times: &Spectrum) {
    for (sum, more) in sum.iter_mut().zip(more) {
        for i in 0..BANDS {
            sum[i] += more[i] * times[i];
        }
    }
}

/// A ray from a place of the table, in the plane of x and z.
struct Ray {
    cos: f64,
    /// Its fraction of all directions.
    weight: f64,
    direction: DVec3,
    nodes: Vec<RayNode>,
    /// Where it meets the ground, and the fraction of light from there.
    ground: Option<(DVec3, Spectrum)>,
}

struct RayNode {
    up: DVec3,
    height: f64,
    /// Light scattered here towards the ray's start, per incident light: by molecules, by aerosol, and by degree of moments.
    molecules: Spectrum,
    aerosol: Spectrum,
    kernels: [Spectrum; 4],
}

/// Computes fields.
pub(super) struct Solver<'a> {
    air: &'a Air,
    grid: Grid,
    around: usize,
    moments: &'static [usize],
    /// By height.
    rays: Vec<Vec<Ray>>,
}

impl<'a> Solver<'a> {
    /// For all Suns.
    pub fn new(air: &'a Air, grid: &Grid) -> Self {
        let moments = moments(air.matter.is_hazy());
        Self::of(air, grid.clone(), AROUND, moments)
    }

    fn of(air: &'a Air, grid: Grid, around: usize, moments: &'static [usize]) -> Self {
        let (up, down) = (Gauss::new(UP), Gauss::new(DOWN));
        let rule = Gauss::new(NODES);
        let shells: Vec<f64> = SHELLS_M.iter().map(|h| 1.0 + h / air.radius_m).collect();
        let rays = (0..HEIGHTS).into_par_iter().map(|row| {
            let height = grid.height(row);
            directions(height, &up, &down)
                .filter_map(|(cos, weight)| Ray::new(air, height, cos, weight, &shells, &rule))
                .collect()
        });
        Self {
            rays: rays.collect(),
            air,
            grid,
            around,
            moments,
        }
    }

    /// All orders of sunlight over black ground, the light that has been scattered once among them.
    pub fn of_sun(&self) -> Field {
        self.solve(|ray, sun| {
            let mut light = [0.0; BANDS];
            let cos = ray.direction.dot(sun);
            let (molecules, aerosol) = (
                self.air.molecule_phase(cos),
                self.air.aerosol_phase_aside(cos),
            );
            for node in &ray.nodes {
                let Some(columns) = self.air.columns_to_sun(node.height, node.up.dot(sun)) else {
                    continue;
                };
                let through = self.air.matter.through_or_on(columns);
                for i in 0..BANDS {
                    light[i] +=
                        through[i] * (molecules * node.molecules[i] + aerosol * node.aerosol[i]);
                }
            }
            light
        })
    }

    /// All orders of light that white ground returns once, the light that comes straight from it among them, the ground being lit
    /// by `irradiance`.
    pub fn of_ground(&self, irradiance: impl Fn(f64) -> Spectrum + Sync) -> Field {
        self.solve(|ray, sun| match &ray.ground {
            Some((place, through)) => {
                let light = irradiance(place.dot(sun));
                std::array::from_fn(|i| light[i] * through[i] / PI)
            }
            None => [0.0; BANDS],
        })
    }

    /// The part of light going up evenly from the ground that the air sends back.
    pub fn sky_albedo(air: &'a Air) -> Spectrum {
        let solver = Self::of(air, Grid::without_sun(air.top - 1.0), 1, ALIKE_ROUND);
        let field = solver.of_ground(|_| [1.0; BANDS]);
        let mut back = [0.0; BANDS];
        for ray in solver.rays[0].iter().filter(|ray| ray.cos > 0.0) {
            let light = solver.along(ray, DVec3::Z, &field);
            for i in 0..BANDS {
                back[i] += light[i] * 4.0 * PI * ray.weight * ray.cos;
            }
        }
        back
    }

    /// Sums orders, the first one given by the light along each ray.
    fn solve(&self, first: impl Fn(&Ray, DVec3) -> Spectrum + Sync) -> Field {
        let mut order = Field::new(self.gather(first));
        let mut sum = order.values.clone();
        for _ in 1..MAX_ORDERS {
            let next = self.gather(|ray, sun| self.along(ray, sun, &order));
            let mut largest = 0.0_f64;
            for (sum, next) in sum.iter_mut().zip(&next) {
                add(sum, next, &[1.0; BANDS]);
                largest = largest.max(next[0][0] / sum[0][0].max(DARKEST));
            }
            let before = std::mem::replace(&mut order, Field::new(next));
            if largest < LEAST {
                // The rest is nearly a geometric series.
                for ((sum, last), before) in sum.iter_mut().zip(&order.values).zip(&before.values) {
                    let rest = std::array::from_fn(|i| {
                        let ratio = last[0][i] / before[0][i].max(f64::MIN_POSITIVE);
                        let ratio = ratio.clamp(0.0, 0.8);
                        ratio / (1.0 - ratio)
                    });
                    add(sum, last, &rest);
                }
                break;
            }
        }
        Field::new(sum)
    }

    /// Moments at all places of light that comes along each ray.
    fn gather(&self, light: impl Fn(&Ray, DVec3) -> Spectrum + Sync) -> Vec<[Spectrum; MOMENTS]> {
        let columns = self.grid.suns.len();
        let places = (0..HEIGHTS * columns).into_par_iter();
        let places = places.map(|place| {
            let mu = self.grid.suns[place % columns];
            let flat = ((1.0 - mu) * (1.0 + mu)).max(0.0).sqrt();
            let mut found = [[0.0; BANDS]; MOMENTS];
            for ray in &self.rays[place / columns] {
                for turn in 0..self.around {
                    let (sin, cos) = (PI * (turn as f64 + 0.5) / self.around as f64).sin_cos();
                    let sun = DVec3::new(flat * cos, flat * sin, mu);
                    let light = light(ray, sun);
                    // Light travels against the ray.
                    let basis = basis(-ray.direction.x * cos, -ray.cos);
                    let weight = 4.0 * PI * ray.weight / self.around as f64;
                    for moment in self.moments {
                        for i in 0..BANDS {
                            found[*moment][i] += weight * basis[*moment] * light[i];
                        }
                    }
                }
            }
            found
        });
        places.collect()
    }

    /// The light that a field is scattered to along a ray.
    fn along(&self, ray: &Ray, sun: DVec3, field: &Field) -> Spectrum {
        let mut light = [0.0; BANDS];
        for node in &ray.nodes {
            let Some(corners) = self.grid.corners(node.height, node.up.dot(sun)) else {
                continue;
            };
            let (x, z) = parts(-ray.direction, node.up, sun);
            field.add_source(
                &corners,
                &basis(x, z),
                &node.kernels,
                self.moments,
                &mut light,
            );
        }
        light
    }
}

impl Ray {
    fn new(
        air: &Air,
        height: f64,
        cos: f64,
        weight: f64,
        shells: &[f64],
        rule: &Gauss,
    ) -> Option<Self> {
        let start = DVec3::new(0.0, 0.0, 1.0 + height);
        let direction = DVec3::new(((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt(), 0.0, cos);
        let path = Path::new(&ScaledRay::new(start, direction), air.top)?;
        let mut columns = DVec3::ZERO;
        let mut nodes = Vec::new();
        for (from, to) in path.breakpoints(shells, air.radius_m, None).pieces() {
            let found: Vec<_> = rule
                .on(from, to)
                .map(|(at, weight)| {
                    let place = path.place(at);
                    (place, weight, air.densities(place.height))
                })
                .collect();
            let sum = |weights: &[f64]| -> DVec3 {
                let parts = found.iter().zip(weights);
                parts
                    .map(|((_, _, densities), weight)| *densities * *weight)
                    .sum::<DVec3>()
                    * (to - from)
            };
            for ((place, weight, densities), running) in found.iter().zip(&rule.running) {
                let through = air.matter.through_or_on(columns + sum(running));
                let [molecules, aerosol] = air.scattering(*densities);
                let [molecules, aerosol] = [molecules, aerosol]
                    .map(|part| std::array::from_fn(|i| part[i] * through[i] * weight));
                nodes.push(RayNode {
                    up: place.point / (1.0 + place.height),
                    height: place.height,
                    kernels: air.kernels(&molecules, &aerosol),
                    molecules,
                    aerosol,
                });
            }
            columns += sum(&rule.weights);
        }
        let ground = path
            .meets_ground
            .then(|| (path.end().normalize(), air.matter.through_or_on(columns)));
        Some(Self {
            cos,
            weight,
            direction,
            nodes,
            ground,
        })
    }
}

/// Zenith cosines and weights of directions evenly around a point, sum 1. Those above and below the horizon are separate, and both are denser
/// towards it: there the light changes most, and jumps.
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
