//! The diffraction of a lens's aperture: the spikes about the Sun.
//!
//! The Fraunhofer pattern of an aperture is the Fourier transform of its autocorrelation, the optical transfer function (Goodman, Introduction
//! to Fourier Optics, 6.3). Far from the core only small lags matter, so only these are transformed, at fine steps. The result is the pattern
//! averaged over a few widths of its speckle, out to a thousand of them. Lengths on the sensor are in λN, wavelength times f-number. Lags are
//! in diameters of the aperture: the circle through its corners.

use std::f64::consts::{PI, TAU};
use std::ops::RangeInclusive;

/// Pixels along a side of the pattern, and pixel size in λN.
const SIDE: usize = 512;
const PIXEL: f64 = 4.0;
/// Standard deviation of the window on lags. It averages the pattern over 1.4 pixels.
const WINDOW: f64 = 1.0 / 36.0;
/// Within this many pixels the pattern is the blurred core. It is replaced by the values at this distance.
const CORE_PX: f64 = 6.0;
/// Number of sampled points on the Sun's disc, and their distance from its centre in radii.
pub const SUN_PLACES: u32 = 6;
pub const SUN_PLACE: f64 = 0.7;
/// Diameter of a dust speck, in diameters of the aperture.
const SPECK: f64 = 1.0 / 100.0;
/// Step of lags. It is also the standard deviation of the blur of the aperture's edges. At a distance of ρ sides of the pattern, spikes
/// therefore fade by exp(−2π²ρ²). None is aliased from outside.
const LAG: f64 = 1.0 / (SIDE as f64 * PIXEL);

/// The aperture of a lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aperture {
    /// Number of blades; they form a regular polygon.
    pub blades: u32,
    /// Focal length over diameter.
    pub f_number: f64,
    /// Fraction of the aperture covered by dust specks. They diffract a corona around the source.
    pub dust: f64,
}

/// Diffraction pattern of an aperture.
#[derive(Clone, Debug, PartialEq)]
pub struct DiffractionPattern {
    aperture: Aperture,
    /// Mip levels: energy per unit area times the squared distance from the core. This is independent of the unit of length.
    levels: Vec<Vec<f32>>,
    /// Mean of the first level around the core, by distance in pixels.
    profile: Vec<f64>,
}

impl Aperture {
    /// Range of [`Self::blades`].
    pub const BLADES: RangeInclusive<i64> = 3..=18;
    /// Range of [`Self::f_number`].
    pub const F_NUMBERS: RangeInclusive<f64> = 1.0..=64.0;
    /// Range of [`Self::dust`]: more would be an unrealistic veil.
    pub const DUSTS: RangeInclusive<f64> = 0.0..=0.005;
    /// Wavelengths of red, green and blue, nanometres.
    pub const WAVELENGTHS_NM: [f64; 3] = [610.0, 550.0, 455.0];
    /// Height of the sensor, which corresponds to the height of the image, millimetres: that of 35
    /// mm film.
    pub const SENSOR_HEIGHT_MM: f64 = 24.0;

    /// Size of an image pixel for this image height, as a fraction of the pattern's side in green
    /// light.
    pub fn pattern_sides_a_pixel(&self, height_px: f64) -> f64 {
        let side_mm = Self::WAVELENGTHS_NM[1] * 1e-6 * self.f_number * PIXEL * SIDE as f64;
        Self::SENSOR_HEIGHT_MM / (height_px * side_mm)
    }

    /// The optical transfer function at a lag: the overlap of the aperture with its shifted copy.
    fn transfer(&self, x: f64, y: f64) -> f64 {
        let count = f64::from(self.blades);
        let turn = TAU / count;
        let (apothem, (sin, cos)) = (0.5 * (PI / count).cos(), turn.sin_cos());
        // Each edge moves inwards by the shift of its copy.
        let moved = |edge: u32| {
            let (sin, cos) = (turn * (f64::from(edge) + 0.5)).sin_cos();
            blurred_ramp(x * cos + y * sin)
        };
        let length = 2.0 * 0.5 * (PI / count).sin();
        let areas = (0..self.blades).map(|edge| {
            let own = moved(edge);
            let beside = moved(edge + 1) + moved(edge + self.blades - 1);
            (length - (beside - 2.0 * own * cos) / sin).max(0.0) * (apothem - own).max(0.0)
        });
        let overlap = areas.sum::<f64>() / (count * length * apothem);
        // Specks are at random positions. They dim the aperture's own pattern and add that of
        // discs.
        let apart = (x.hypot(y) / SPECK).min(1.0);
        let disc = (apart.acos() - apart * (1.0 - apart * apart).sqrt()) * 2.0 / PI;
        (1.0 - self.dust) * overlap + self.dust * disc
    }
}

impl DiffractionPattern {
    /// Computes the pattern, once for all images of a lens.
    pub fn new(aperture: Aperture) -> Self {
        // Positions on both sides of 0, starting with 0.
        let place = |n: usize| match n < SIDE / 2 {
            true => n as f64,
            false => n as f64 - SIDE as f64,
        };
        let mut grid: Vec<[f64; 2]> = Vec::with_capacity(SIDE * SIDE);
        for y in 0..SIDE {
            for x in 0..SIDE {
                let (x, y) = (place(x) * LAG, place(y) * LAG);
                let window = (-0.5 * (x * x + y * y) / (WINDOW * WINDOW)).exp();
                grid.push([aperture.transfer(x, y) * window, 0.0]);
            }
        }
        transform_rows(&mut grid);
        transpose(&mut grid);
        transform_rows(&mut grid);
        // Moves the core to the middle, to a corner of four pixels as closely as possible.
        let mut first = vec![0.0; SIDE * SIDE];
        for (index, [energy, _]) in grid.iter().enumerate() {
            let (x, y) = (place(index % SIDE), place(index / SIDE));
            // The transform of a real aperture's autocorrelation is real and not negative, except for
            // rounding.
            let flat = energy.max(0.0) * LAG * LAG * (x.hypot(y) * PIXEL).powi(2);
            let column = (x + (SIDE / 2) as f64) as usize;
            let row = (y + (SIDE / 2) as f64) as usize;
            first[row * SIDE + column] = flat as f32;
        }
        without_core(&mut first);
        let profile = profile(&first);
        let mut levels = vec![first];
        while let Some(finer) = levels.last().filter(|level| level.len() > 64) {
            levels.push(halved(finer));
        }
        Self {
            aperture,
            levels,
            profile,
        }
    }

    /// The aperture of the pattern.
    pub fn aperture(&self) -> &Aperture {
        &self.aperture
    }

    /// Pixels along a side of the first level.
    pub const SIDE_PX: u32 = SIDE as u32;
    /// Scale from positions in green light to positions in the patterns of red, green and blue.
    pub const SCALES: [f64; 3] = {
        let [red, green, blue] = Aperture::WAVELENGTHS_NM;
        [green / red, 1.0, green / blue]
    };
    /// Additional fading of each band, so that spikes have no coloured ends: exp(−this·ρ²). ρ is the distance in sides of green light's
    /// pattern.
    pub const FADING: [f64; 3] = {
        let [red, green, blue] = Self::SCALES;
        let most = blue * blue;
        let factor = 2.0 * PI * PI;
        [
            factor * (most - red * red),
            factor * (most - green * green),
            0.0,
        ]
    };

    /// Mip levels, rows from the top. Values are energy per unit area, for light of 1, times the squared distance from the core. The core is
    /// half a pixel from the upper left corner of the pixel just below the middle.
    pub fn levels(&self) -> &[Vec<f32>] {
        &self.levels
    }

    /// Fraction of the Sun's light that is diffracted, for a solar radius in pixels of the pattern. In green light it is all
    /// that `shaders/celestial/glare.wgsl` draws.
    pub fn diffracted(&self, radius_px: f64) -> f64 {
        let about = SUN_PLACE * radius_px;
        let last = self.profile.len() - 1;
        let at = |distance: f64| self.profile.get(distance.round() as usize).unwrap_or(&0.0);
        // ∫ 2πr W/max(r, R)² dr, where W is the mean over points of the disc.
        let rings = (0..last).map(|ring| {
            let r = ring as f64 + 0.5;
            let turns = (0..SUN_PLACES).map(|n| (f64::from(n) + 0.5) * PI / f64::from(SUN_PLACES));
            let places =
                turns.map(|turn| at((r * r + about * about + 2.0 * r * about * turn.cos()).sqrt()));
            let mean = places.sum::<f64>() / f64::from(SUN_PLACES);
            let sides = r / SIDE as f64;
            let fading = (-Self::FADING[1] * sides * sides).exp();
            TAU * r * fading * mean / r.max(radius_px).powi(2)
        });
        rings.sum()
    }
}

/// Replaces pixels near the core by those in the same direction at [`CORE_PX`].
fn without_core(first: &mut [f32]) {
    let middle = (SIDE / 2) as i32;
    let reach = CORE_PX as i32;
    for y in -reach..=reach {
        for x in -reach..=reach {
            let distance = f64::from(x).hypot(f64::from(y));
            if distance >= CORE_PX {
                continue;
            }
            let scale = CORE_PX / distance.max(1e-9);
            let moved = |place: i32| middle + (f64::from(place) * scale).round() as i32;
            let index = |x: i32, y: i32| y as usize * SIDE + x as usize;
            // The core itself has no direction.
            let from = match (x, y) {
                (0, 0) => index(middle, middle + reach),
                _ => index(moved(x), moved(y)),
            };
            first[index(middle + x, middle + y)] = first[from];
        }
    }
}

/// Mean at each integer distance from the core, pixels.
fn profile(first: &[f32]) -> Vec<f64> {
    let middle = (SIDE / 2) as f64;
    let mut sums = vec![(0.0, 0.0); SIDE / 2];
    for (index, value) in first.iter().enumerate() {
        let (x, y) = ((index % SIDE) as f64, (index / SIDE) as f64);
        let distance = (x - middle).hypot(y - middle).round() as usize;
        if let Some((sum, count)) = sums.get_mut(distance) {
            *sum += f64::from(*value);
            *count += 1.0;
        }
    }
    sums.into_iter().map(|(sum, count)| sum / count).collect()
}

/// max(0, u) blurred by a Gaussian of [`LAG`]: u Φ(u/σ) + σ φ(u/σ).
fn blurred_ramp(u: f64) -> f64 {
    let z = (u / LAG).abs();
    // 1 − Φ, within 1e-7 (Abramowitz and Stegun 26.2.17).
    let t = 1.0 / (1.0 + 0.231_641_9 * z);
    let series = t
        * (0.319_381_53
            + t * (-0.356_563_782
                + t * (1.781_477_937 + t * (-1.821_255_978 + t * 1.330_274_429))));
    let density = (-0.5 * z * z).exp() / TAU.sqrt();
    u.max(0.0) + LAG * density * (1.0 - z * series)
}

/// The next mip level, half as large.
fn halved(finer: &[f32]) -> Vec<f32> {
    let side = finer.len().isqrt();
    let half = side / 2;
    let at = |x: usize, y: usize| finer[y * side + x];
    let mean = |index: usize| {
        let (x, y) = (2 * (index % half), 2 * (index / half));
        0.25 * (at(x, y) + at(x + 1, y) + at(x, y + 1) + at(x + 1, y + 1))
    };
    (0..half * half).map(mean).collect()
}

fn transpose(grid: &mut [[f64; 2]]) {
    for y in 0..SIDE {
        for x in 0..y {
            grid.swap(y * SIDE + x, x * SIDE + y);
        }
    }
}

/// The discrete Fourier transform of each row: Cooley and Tukey 1965, in place.
fn transform_rows(grid: &mut [[f64; 2]]) {
    let bits = SIDE.trailing_zeros();
    let turns: Vec<_> = (0..SIDE / 2)
        .map(|n| (-TAU * n as f64 / SIDE as f64).sin_cos())
        .collect();
    for row in grid.chunks_exact_mut(SIDE) {
        for n in 0..SIDE {
            let reversed = n.reverse_bits() >> (usize::BITS - bits);
            if n < reversed {
                row.swap(n, reversed);
            }
        }
        let mut half = 1;
        while half < SIDE {
            for block in row.chunks_exact_mut(2 * half) {
                let (low, high) = block.split_at_mut(half);
                for (n, (a, b)) in low.iter_mut().zip(high).enumerate() {
                    let (sin, cos) = turns[n * (SIDE / 2 / half)];
                    let turned = [b[0] * cos - b[1] * sin, b[0] * sin + b[1] * cos];
                    *b = [a[0] - turned[0], a[1] - turned[1]];
                    *a = [a[0] + turned[0], a[1] + turned[1]];
                }
            }
            half *= 2;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pattern(blades: u32, dust: f64) -> DiffractionPattern {
        DiffractionPattern::new(Aperture {
            blades,
            f_number: 16.0,
            dust,
        })
    }

    /// Energy of pixels, by position relative to the core in λN.
    fn energies(pattern: &DiffractionPattern) -> impl Iterator<Item = (f64, f64, f64)> {
        let flat = pattern.levels[0].iter().enumerate();
        flat.filter_map(|(index, flat)| {
            let place = |n: usize| (n as f64 - (SIDE / 2) as f64) * PIXEL;
            let (x, y) = (place(index % SIDE), place(index / SIDE));
            let squared = x * x + y * y;
            let energy = f64::from(*flat) / squared * PIXEL * PIXEL;
            (squared > 0.0).then_some((x, y, energy))
        })
    }

    /// The pattern of a square with side a is a² sinc²(ax) sinc²(ay). On average, 1/(π² a |x|) of the light is beyond |x|.
    #[test]
    fn a_square_diffracts_by_its_formula() {
        let square = pattern(4, 0.0);
        let side = 0.5_f64.sqrt();
        for (near, far) in [(40.0, 80.0), (100.0, 400.0), (300.0, 600.0)] {
            // Its corners are on the axes, its spikes between them.
            let between = energies(&square).filter(|(x, y, _)| {
                let along = (x + y).abs() * side;
                (near..far).contains(&along) && (x - y).abs() * side < 200.0
            });
            let found: f64 = between.map(|(_, _, energy)| energy).sum();
            // ∫ exp(−2π²σ²x²)/x² dx by the midpoint rule, with σ = one step of lags.
            let steps = 2000;
            let step = (far - near) / f64::from(steps);
            let parts = (0..steps).map(|n| {
                let x = near + (f64::from(n) + 0.5) * step;
                (-2.0 * (PI * LAG * x).powi(2)).exp() / (x * x) * step
            });
            let formula = parts.sum::<f64>() / (PI * PI * side);
            // Light beyond |y| = 200 is missing.
            let formula = formula * (1.0 - 1.0 / (PI * PI * side * 200.0));
            let off = found / formula - 1.0;
            assert!(off.abs() < 0.02, "{near} to {far}: {found} {formula}");
        }
    }

    #[test]
    fn even_blades_have_as_many_spikes_and_odd_ones_twice_as_many() {
        for (blades, spikes) in [(4, 4), (6, 6), (5, 10), (7, 14), (8, 8)] {
            let pattern = pattern(blades, 0.0);
            // The lowest number of waves around the core in the light.
            let waves = |count: u32| {
                let ring =
                    energies(&pattern).filter(|(x, y, _)| (400.0..700.0).contains(&x.hypot(*y)));
                let sum = ring.fold([0.0, 0.0], |[a, b], (x, y, energy)| {
                    let (sin, cos) = (f64::from(count) * y.atan2(x)).sin_cos();
                    let flat = energy * (x * x + y * y);
                    [a + cos * flat, b + sin * flat]
                });
                sum[0].hypot(sum[1])
            };
            let waves: Vec<_> = (1..=16).map(waves).collect();
            let most = waves.iter().copied().fold(0.0, f64::max);
            let lowest = waves.iter().position(|wave| *wave > 0.5 * most);
            assert_eq!(lowest.map(|n| n + 1), Some(spikes), "{blades} blades");
        }
    }

    #[test]
    fn all_light_arrives() {
        let clean = pattern(6, 0.0);
        let dusty = pattern(6, 0.005);
        for pattern in [&clean, &dusty] {
            // Everything that the shader draws, pixel by pixel.
            let (radius, middle) = (20.0_f64, (SIDE / 2) as f64);
            let value = |x: f64, y: f64| {
                let [x, y] =
                    [x, y].map(|place| (place + middle).round().clamp(0.0, 511.0) as usize);
                f64::from(pattern.levels[0][y * SIDE + x])
            };
            let drawn = (0..SIDE * SIDE).map(|index| {
                let [x, y] = [index % SIDE, index / SIDE].map(|place| place as f64 - middle);
                let places = (0..SUN_PLACES).map(|n| {
                    let turn = (f64::from(n) + 0.5) * TAU / f64::from(SUN_PLACES);
                    let (sin, cos) = turn.sin_cos();
                    value(x + SUN_PLACE * radius * cos, y + SUN_PLACE * radius * sin)
                });
                let squared = x * x + y * y;
                let sides = squared / (SIDE * SIDE) as f64;
                let fading = (-DiffractionPattern::FADING[1] * sides).exp();
                fading * places.sum::<f64>() / f64::from(SUN_PLACES) / squared.max(radius * radius)
            });
            let (drawn, reported) = (drawn.sum::<f64>(), pattern.diffracted(radius));
            assert!((reported / drawn - 1.0).abs() < 0.05, "{reported} {drawn}");
        }
        // For a point source, a circle of this diameter has 2/(π² · 80) outside.
        assert!((0.5..3.0).contains(&(clean.diffracted(20.0) * PI * PI * 40.0)));
        // Dust adds at most the light that it covers, and less than half a percent of veil.
        let more = dusty.diffracted(20.0) - clean.diffracted(20.0);
        assert!((0.001..0.005).contains(&more), "{more}");
    }
}
