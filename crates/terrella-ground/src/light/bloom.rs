//! Amount and extent of light scattered by a lens.

use std::ops::RangeInclusive;

/// Radii of scattered light, as fractions of the image's shorter side.
const RADII: RangeInclusive<f64> = 1.0 / 1024.0..=0.25;

/// Light scattered per octave of radii falls with this power of the radius. Per area, add 2 to the power. This is between the
/// inverse square at large angles and the inverse cube at small angles measured for lenses and eyes (CIE 146:2002).
const FALL: f64 = 0.5;

/// Scattering of exposed light in a lens, before the tone curve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bloom {
    /// Fraction of all light that the lens scatters, to distances from a thousandth to a quarter of the image's shorter side. It draws halos
    /// around city lights and a veil beside bright objects. Good lenses have 0.01 to 0.05. With 0 the pass is omitted.
    pub strength: f64,
}

impl Bloom {
    /// Range of [`Self::strength`].
    pub const STRENGTH: RangeInclusive<f64> = 0.0..=0.5;
    /// Brightest exposed light that is scattered. The Sun's disc is brighter; its surrounding light is drawn as glare, also from outside the
    /// image.
    pub const BRIGHTEST_SCATTERED: f64 = 64.0;

    /// Shares of the downsampled images for an image of this size in pixels. Each image is half as large as the one before, starting with the light
    /// itself. Its share is the fraction of its light that the next image replaces. Empty without scattering.
    ///
    /// Together they scatter the fraction [`Self::strength`] of all light, minus the light that stays within a pixel.
    pub fn shares(&self, (width, height): (u32, u32)) -> Vec<f64> {
        let side = f64::from(width.min(height));
        let octave = std::f64::consts::SQRT_2;
        let (least, most) = (*RADII.start(), RADII.end() * octave);
        // ∫ r^−FALL d(ln r).
        let between = |low: f64, high: f64| match low < high {
            true => (low.powf(-FALL) - high.powf(-FALL)) / FALL,
            false => 0.0,
        };
        let radii = (1..).map(|level| 2_f64.powi(level) / side);
        let weights: Vec<_> = radii
            // Rounding must not create an empty octave.
            .take_while(|radius| radius / octave < most * (1.0 - 1e-9))
            .map(|radius| between((radius / octave).max(least), (radius * octave).min(most)))
            .collect();
        let all: f64 = weights.iter().sum();
        if self.strength * all <= 0.0 {
            return Vec::new();
        }
        let first = self.strength * all / between(least, most);
        let mut left = all;
        let rest = weights.iter().map(|weight| {
            let before = left;
            left -= weight;
            left / before
        });
        // The last image has no coarser one.
        let shares = std::iter::once(first).chain(rest);
        shares.take(weights.len()).collect()
    }

    /// Bytes of its textures for images of this size, pixels.
    pub fn texture_bytes(&self, (mut width, mut height): (u32, u32)) -> u64 {
        let levels = self.shares((width, height)).into_iter().map(|_| {
            (width, height) = (width.div_ceil(2), height.div_ceil(2));
            // Four channels of half floats.
            u64::from(width) * u64::from(height) * 8
        });
        levels.sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Contribution of each level, finest first.
    fn parts(strength: f64, size: (u32, u32)) -> Vec<f64> {
        let shares = Bloom { strength }.shares(size);
        let mut through = 1.0;
        let mut parts = Vec::new();
        for (index, share) in shares.iter().enumerate() {
            through *= share;
            let kept = 1.0 - shares.get(index + 1).copied().unwrap_or_default();
            parts.push(through * kept);
        }
        parts
    }

    #[test]
    fn all_that_is_scattered_arrives_and_falls_with_the_radius() {
        for size in [(640, 360), (1280, 720), (4096, 4096)] {
            let parts = parts(0.1, size);
            let sum: f64 = parts.iter().sum();
            assert!(sum < 0.1 + 1e-12 && sum > 0.04, "{size:?}: {sum}");
            // The first octaves may be partly finer than all radii.
            let falls = parts[2..].windows(2).all(|pair| pair[1] < pair[0]);
            assert!(falls, "{size:?}: {parts:?}");
        }
    }

    #[test]
    fn a_radius_gets_as_much_at_every_size() {
        let (small, large) = (parts(0.1, (640, 360)), parts(0.1, (2560, 1440)));
        // Two more octaves are finer than the small image's pixels.
        for (index, part) in small.iter().enumerate().skip(1) {
            let other = large[index + 2];
            assert!((part - other).abs() < 1e-12, "{index}: {part} and {other}");
        }
    }

    #[test]
    fn textures_are_a_third_of_the_light() {
        let bloom = Bloom { strength: 0.1 };
        let part = bloom.texture_bytes((1280, 720)) as f64 / (1280.0 * 720.0 * 8.0);
        assert!((part - 1.0 / 3.0).abs() < 0.01, "{part}");
        assert_eq!(Bloom::default().texture_bytes((1280, 720)), 0);
    }

    #[test]
    fn a_lens_without_scatter_and_a_picture_of_some_pixels_have_no_level() {
        assert!(parts(0.0, (640, 360)).is_empty());
        assert!(parts(0.1, (1, 1)).is_empty());
    }
}
