//! Tables of light at places of the air, by height and Sun cosine: the moments of [`super::orders`], and spectra.

use super::spectrum::{BANDS, Spectrum};
use glam::DVec3;
use rayon::prelude::*;

/// Moments of light at a place.
pub(super) const MOMENTS: usize = 10;

pub(super) const DEGREE: [usize; MOMENTS] = [0, 1, 1, 2, 2, 2, 3, 3, 3, 3];

/// Moments of even degree up to 2, which suffice for molecules.
const OF_MOLECULES: &[usize] = &[0, 3, 4, 5];
const ALL: &[usize] = &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9];

/// Which moments there are in air with or without an aerosol.
pub(super) fn moments(is_hazy: bool) -> &'static [usize] {
    match is_hazy {
        true => ALL,
        false => OF_MOLECULES,
    }
}

/// Heights of a table.
pub(super) const HEIGHTS: usize = 18;

/// Zenith angles of the Sun, degrees: crowded where night falls. Below the last it is night.
#[rustfmt::skip]
const SUNS_DEG: [f64; 40] = [
    0.0, 12.0, 20.0, 27.0, 33.0, 39.0, 44.0, 49.0, 54.0, 58.0, 62.0, 66.0, 69.5, 73.0, 76.0, 78.5, 81.0, 83.0, 84.5, 86.0,
    87.0, 88.0, 88.7, 89.3, 90.0, 90.7, 91.4, 92.1, 92.8, 93.6, 94.4, 95.3, 96.3, 97.4, 98.6, 100.0, 102.0, 105.0, 109.0, 114.0,
];

/// The band that determines how light falls off between two places of the table.
const LEADING_BAND: usize = BANDS / 2;

/// The functions that light is multiplied by in its moments, for a direction with vertical part `z` and part `x` towards the
/// Sun's side: by the addition theorem their products sum, degree by degree, to Legendre's polynomial of the angle between
/// two directions, odd functions of the third part left out as light is the same on both sides of the Sun.
pub(super) fn basis(x: f64, z: f64) -> [f64; MOMENTS] {
    // x² − y², of a unit vector.
    let square = 2.0 * x * x + z * z - 1.0;
    [
        1.0,
        z,
        x,
        0.5 * (3.0 * z * z - 1.0),
        3.0_f64.sqrt() * x * z,
        0.5 * 3.0_f64.sqrt() * square,
        0.5 * z * (5.0 * z * z - 3.0),
        0.25 * 6.0_f64.sqrt() * x * (5.0 * z * z - 1.0),
        0.5 * 15.0_f64.sqrt() * z * square,
        // x³ − 3xy² = x(4x² − 3(1 − z²))
        0.25 * 10.0_f64.sqrt() * x * (4.0 * x * x - 3.0 * (1.0 - z * z)),
    ]
}

/// Components of a direction of light at a point, as [`basis`] needs them. `up` is the point's unit vector.
pub(super) fn parts(direction: DVec3, up: DVec3, sun: DVec3) -> (f64, f64) {
    let (z, mu) = (direction.dot(up), sun.dot(up));
    let across = ((1.0 - mu) * (1.0 + mu)).max(1e-12).sqrt();
    // With the Sun in the zenith the azimuth is undefined, and its factor is zero.
    (((direction.dot(sun) - z * mu) / across).clamp(-1.0, 1.0), z)
}

/// Heights and Sun cosines of tables.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    /// Thickness of the air, equatorial radii.
    thickness: f64,
    /// Cosines, falling.
    pub suns: Vec<f64>,
}

/// A place between four of a grid's.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corners {
    at: [usize; 4],
    weights: [f64; 4],
}

impl Grid {
    /// The grid of all Suns for an air of this thickness, in equatorial radii.
    pub fn new(thickness: f64) -> Self {
        Self {
            thickness,
            suns: SUNS_DEG.iter().map(|deg| deg.to_radians().cos()).collect(),
        }
    }

    /// A grid for light that comes from all sides alike.
    pub fn without_sun(thickness: f64) -> Self {
        Self {
            thickness,
            suns: vec![1.0],
        }
    }

    /// The height of a row, equatorial radii.
    pub fn height(&self, row: usize) -> f64 {
        self.thickness * (row as f64 / (HEIGHTS - 1) as f64).powi(2)
    }

    /// The Sun before a cosine, the one after it, and the second one's weight; `None` by night.
    fn between(&self, mu: f64) -> Option<(usize, usize, f64)> {
        let last = self.suns.len() - 1;
        if last == 0 {
            return Some((0, 0, 0.0));
        }
        let after = self.suns.partition_point(|sun| *sun >= mu);
        if after > last {
            return None;
        }
        let after = after.max(1);
        let (from, to) = (self.suns[after - 1], self.suns[after]);
        Some((
            after - 1,
            after,
            ((from - mu) / (from - to)).clamp(0.0, 1.0),
        ))
    }

    /// The places about a height, equatorial radii, and a Sun; `None` by night.
    pub fn corners(&self, height: f64, mu: f64) -> Option<Corners> {
        let (before, after, part) = self.between(mu)?;
        let row = (height / self.thickness).clamp(0.0, 1.0).sqrt() * (HEIGHTS - 1) as f64;
        let low = (row as usize).min(HEIGHTS - 2);
        let rise = row - low as f64;
        let columns = self.suns.len();
        let at = |row: usize, column: usize| row * columns + column;
        Some(Corners {
            at: [
                at(low, before),
                at(low, after),
                at(low + 1, before),
                at(low + 1, after),
            ],
            weights: [
                (1.0 - rise) * (1.0 - part),
                (1.0 - rise) * part,
                rise * (1.0 - part),
                rise * part,
            ],
        })
    }
}

/// Spectra at a grid's Suns.
#[derive(Clone, Debug)]
pub(super) struct BySun {
    grid: Grid,
    values: Vec<Spectrum>,
}

impl BySun {
    /// Computes them on all cores.
    pub fn fill(grid: &Grid, value: impl Fn(f64) -> Spectrum + Sync) -> Self {
        Self {
            values: grid.suns.par_iter().map(|sun| value(*sun)).collect(),
            grid: grid.clone(),
        }
    }

    /// The spectrum for a zenith cosine of the Sun; zero by night.
    pub fn at(&self, mu: f64) -> Spectrum {
        let Some((before, after, part)) = self.grid.between(mu) else {
            return [0.0; BANDS];
        };
        let (from, to) = (&self.values[before], &self.values[after]);
        std::array::from_fn(|i| between(&[from[i], to[i]], &[1.0 - part, part]))
    }
}

/// The mean of values that fall off by orders of magnitude: geometric, arithmetic where one is nothing.
fn between(values: &[f64], weights: &[f64]) -> f64 {
    let pairs = || {
        values
            .iter()
            .zip(weights)
            .filter(|(_, weight)| **weight > 0.0)
    };
    match pairs().all(|(value, _)| *value > 0.0) {
        true => pairs()
            .map(|(value, weight)| weight * value.ln())
            .sum::<f64>()
            .exp(),
        false => pairs().map(|(value, weight)| weight * value).sum(),
    }
}

/// Moments of light at a grid's places.
#[derive(Clone, Debug)]
pub(super) struct Field {
    /// Rows of heights from the ground, each with all Suns.
    pub values: Vec<[Spectrum; MOMENTS]>,
    /// Logarithms of the total light in the leading band.
    logs: Vec<f64>,
}

impl Field {
    /// Of all places: rows of heights from the ground, each with all Suns.
    pub fn new(values: Vec<[Spectrum; MOMENTS]>) -> Self {
        // A value that is not positive becomes −∞ or NaN, which `corrected` skips.
        let logs = values
            .iter()
            .map(|moments| moments[0][LEADING_BAND].ln())
            .collect();
        Self { values, logs }
    }

    /// A field without light.
    pub fn none(grid: &Grid) -> Self {
        Self::new(vec![[[0.0; BANDS]; MOMENTS]; HEIGHTS * grid.suns.len()])
    }

    /// Weights of the corners that make the light between them their geometric mean where it falls off steeply.
    fn corrected(&self, corners: &Corners) -> [f64; 4] {
        let (mut log, mut mean) = (0.0, 0.0);
        for (at, weight) in corners.at.iter().zip(corners.weights) {
            if weight > 0.0 {
                log += weight * self.logs[*at];
                mean += weight * self.values[*at][0][LEADING_BAND];
            }
        }
        let factor = log.exp() / mean;
        match factor.is_finite() {
            true => corners.weights.map(|weight| weight * factor),
            false => corners.weights,
        }
    }

    /// Adds to `light` what the light here is scattered to in a direction with these values of [`basis`], per path.
    ///
    /// `kernels` are coefficients of scattering by degree.
    pub fn add_source(
        &self,
        corners: &Corners,
        basis: &[f64; MOMENTS],
        kernels: &[Spectrum; 4],
        moments: &[usize],
        light: &mut Spectrum,
    ) {
        let weights = self.corrected(corners);
        let [a, b, c, d] = corners.at.map(|at| &self.values[at]);
        for moment in moments {
            let kernel = &kernels[DEGREE[*moment]];
            let weights = weights.map(|weight| weight * basis[*moment]);
            let (a, b, c, d) = (&a[*moment], &b[*moment], &c[*moment], &d[*moment]);
            for i in 0..BANDS {
                let value =
                    weights[0] * a[i] + weights[1] * b[i] + weights[2] * c[i] + weights[3] * d[i];
                light[i] += value * kernel[i];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_of_the_basis_are_legendres_polynomials() {
        // Summed over both sides of the Sun, for each degree.
        let at = |polar: f64, azimuth: f64| {
            DVec3::new(
                polar.sin() * azimuth.cos(),
                polar.sin() * azimuth.sin(),
                polar.cos(),
            )
        };
        let (a, b) = (at(0.7, 0.4), at(2.0, 1.9));
        let mirrored = DVec3::new(b.x, -b.y, b.z);
        let legendre = |n: usize, t: f64| {
            [
                1.0,
                t,
                0.5 * (3.0 * t * t - 1.0),
                0.5 * t * (5.0 * t * t - 3.0),
            ][n]
        };
        let (of_a, of_b) = (basis(a.x, a.z), basis(b.x, b.z));
        for degree in 0..4 {
            let sum: f64 = (0..MOMENTS)
                .filter(|i| DEGREE[*i] == degree)
                .map(|i| of_a[i] * of_b[i])
                .sum();
            let mean = 0.5 * (legendre(degree, a.dot(b)) + legendre(degree, a.dot(mirrored)));
            assert!((sum - mean).abs() < 1e-12, "{degree}: {sum} {mean}");
        }
    }

    #[test]
    fn grids_find_their_places() {
        let grid = Grid::new(0.0157);
        let corners = grid.corners(0.0, 1.0).expect("day");
        assert!((corners.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert_eq!(corners.at[0], 0);
        assert!(grid.corners(0.001, -0.5).is_none());
        let suns = BySun::fill(&grid, |mu| [(10.0 * mu).exp(); BANDS]);
        for mu in [1.0, 0.93, 0.2, 0.0, -0.13] {
            let found = suns.at(mu)[3];
            assert!(
                (found / (10.0 * mu).exp() - 1.0).abs() < 1e-9,
                "{mu}: {found}"
            );
        }
        assert_eq!(suns.at(-0.6), [0.0; BANDS]);
    }
}
