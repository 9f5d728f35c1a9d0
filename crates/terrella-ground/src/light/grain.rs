//! Film grain: noise of display values that preserves their mean.

use std::ops::RangeInclusive;

/// Film grain: noise added to encoded display values before rounding, the same in all channels.
///
/// It depends only on pixel, seed and frame number: an image is the same in each run and on each device. A value c, 0…1, gets noise with a standard
/// deviation of 4·strength·c(1 − c). Black and white have no noise, nothing is clipped, and the mean is preserved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grain {
    /// Standard deviation at mid-scale, as a fraction of the scale. With 0 the shader omits it.
    pub strength: f64,
    /// Distance between grains, pixels of the final image.
    pub size_px: f64,
    /// Selects the pattern.
    pub seed: u32,
}

/// Multiplier and increment of the hash for grains: `pcg3d` of Jarzynski and Olano 2020, "Hash Functions for GPU Rendering", J. Comput. Graph.
/// Tech. 9(3).
pub const GRAIN_MULTIPLIER: u32 = 1_664_525;
pub const GRAIN_INCREMENT: u32 = 1_013_904_223;
/// Bits of its shift.
pub const GRAIN_SHIFT: u32 = 16;
/// Bits of a hash that are used; single precision can hold them.
pub const GRAIN_BITS: u32 = 24;
/// √12, the reciprocal of the standard deviation of a uniform distribution over −½…½.
pub const GRAIN_SCALE: f64 = 3.464_101_615_137_754_6;

impl Grain {
    /// Range of [`Self::strength`]. With more, values could leave 0…1, because noise reaches 2√3 standard deviations and 1/(4 ·
    /// 2√3) = 0.072.
    pub const STRENGTHS: RangeInclusive<f64> = 0.0..=0.07;
    /// Range of [`Self::size_px`].
    pub const SIZES_PX: RangeInclusive<f64> = 1.0..=16.0;
    /// Default size, pixels.
    pub const USUAL_SIZE_PX: f64 = 1.5;
    /// No grain.
    pub const NONE: Self = Self {
        strength: 0.0,
        size_px: Self::USUAL_SIZE_PX,
        seed: 0,
    };

    /// Start value of the hash for a frame's grains.
    pub fn frame_seed(&self, frame: u32) -> u32 {
        // The factor is odd, so frames of one seed all differ.
        self.seed.wrapping_add(frame.wrapping_mul(GRAIN_MULTIPLIER))
    }

    /// Noise at the centre of a pixel, with mean 0 and standard deviation 1, for a seed from [`Self::frame_seed`]. Grains are on a lattice of
    /// [`Self::size_px`] and interpolated between its points.
    pub fn noise(&self, (x, y): (u32, u32), frame_seed: u32) -> f32 {
        let size_px = self.size_px as f32;
        let at = [x, y].map(|pixel| (pixel as f32 + 0.5) / size_px - 0.5);
        let [cell_x, cell_y] = at.map(f32::floor);
        let [part_x, part_y] = [at[0] - cell_x, at[1] - cell_y];
        let (mut sum, mut squares) = (0.0, 0.0);
        for (next_x, next_y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let along = |part: f32, next| if next == 0 { 1.0 - part } else { part };
            let weight = along(part_x, next_x) * along(part_y, next_y);
            let cell = [cell_x as i32 + next_x, cell_y as i32 + next_y];
            sum += weight * grain(cell, frame_seed);
            squares += weight * weight;
        }
        GRAIN_SCALE as f32 * sum / squares.sqrt()
    }

    /// Adds this noise to an encoded display value, 0…1.
    pub fn grained(&self, value: f64, noise: f32) -> f64 {
        let c = value.clamp(0.0, 1.0);
        c + 4.0 * self.strength * f64::from(noise) * c * (1.0 - c)
    }
}

impl Default for Grain {
    fn default() -> Self {
        Self::NONE
    }
}

/// A number in −½…½ for a lattice point.
fn grain([x, y]: [i32; 2], seed: u32) -> f32 {
    let mixed = |v: u32| {
        v.wrapping_mul(GRAIN_MULTIPLIER)
            .wrapping_add(GRAIN_INCREMENT)
    };
    let mut v = [x as u32, y as u32, seed].map(mixed);
    let stir = |v: &mut [u32; 3]| {
        for (to, a, b) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
            v[to] = v[to].wrapping_add(v[a].wrapping_mul(v[b]));
        }
    };
    stir(&mut v);
    v = v.map(|v| v ^ (v >> GRAIN_SHIFT));
    stir(&mut v);
    (v[0] >> (u32::BITS - GRAIN_BITS)) as f32 / (1_u32 << GRAIN_BITS) as f32 - 0.5
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: u32 = 256;

    fn field(grain: &Grain, frame: u32) -> Vec<f32> {
        let seed = grain.frame_seed(frame);
        let pixels = (0..SIDE * SIDE).map(|n| (n % SIDE, n / SIDE));
        pixels.map(|pixel| grain.noise(pixel, seed)).collect()
    }

    fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
        let count = values.len() as f64;
        values.sum::<f64>() / count
    }

    #[test]
    fn noise_has_mean_0_and_deviation_1() {
        for size_px in [1.0, 1.5, 2.0, 4.0] {
            let grain = Grain {
                size_px,
                ..Grain::NONE
            };
            let field = field(&grain, 3);
            let found = mean(field.iter().map(|n| f64::from(*n)));
            let square = mean(field.iter().map(|n| f64::from(*n).powi(2)));
            // 65 536 pixels, with size² per grain.
            assert!(found.abs() < 4.0 * size_px / 256.0, "{size_px}: {found}");
            assert!((square - 1.0).abs() < 0.05, "{size_px}: {square}");
        }
    }

    /// Neighbours are similar within a grain and independent beyond it.
    #[test]
    fn grains_are_as_large_as_they_are_chosen() {
        let alike = |size_px: f64, apart: usize| {
            let grain = Grain {
                size_px,
                ..Grain::NONE
            };
            let field = field(&grain, 0);
            let rows = field.chunks_exact(SIDE as usize);
            let products =
                rows.flat_map(|row| row.iter().zip(&row[apart..]).map(|(a, b)| f64::from(a * b)));
            let products: Vec<_> = products.collect();
            mean(products.into_iter())
        };
        assert!(alike(1.0, 1).abs() < 0.02);
        assert!(alike(4.0, 1) > 0.8 && alike(4.0, 8).abs() < 0.06);
        assert!(alike(2.0, 1) > 0.3 && alike(2.0, 1) < alike(4.0, 1));
    }

    #[test]
    fn values_keep_their_mean_and_their_range() {
        let grain = Grain {
            strength: *Grain::STRENGTHS.end(),
            ..Grain::NONE
        };
        let field = field(&grain, 1);
        for value in [0.0, 0.004, 0.1, 0.5, 0.93, 1.0] {
            let grained = field.iter().map(|noise| grain.grained(value, *noise));
            let grained: Vec<_> = grained.collect();
            assert!(grained.iter().all(|value| (0.0..=1.0).contains(value)));
            let off = mean(grained.iter().copied()) - value;
            assert!(off.abs() < 0.07 * 4.0 * 1.5 / 256.0, "{value}: {off}");
        }
        let middle = field.iter().map(|noise| grain.grained(0.5, *noise) - 0.5);
        let deviation = mean(middle.map(|off| off * off)).sqrt();
        assert!((deviation - 0.07).abs() < 0.002, "{deviation}");
    }

    #[test]
    fn frames_and_seeds_differ_and_runs_do_not() {
        let grain = Grain::NONE;
        let other = Grain { seed: 1, ..grain };
        assert_eq!(field(&grain, 5), field(&grain, 5));
        let alike = |a: &[f32], b: &[f32]| mean(a.iter().zip(b).map(|(a, b)| f64::from(a * b)));
        let first = field(&grain, 5);
        for different in [field(&grain, 6), field(&grain, u32::MAX), field(&other, 5)] {
            assert!(alike(&first, &different).abs() < 0.03);
        }
    }
}
