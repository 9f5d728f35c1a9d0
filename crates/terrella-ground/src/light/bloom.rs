//! How much light a lens scatters, and how far.

use std::ops::RangeInclusive;

/// Radii over which light is scattered, in parts of the picture's shorter side.
const RADII: RangeInclusive<f64> = 1.0 / 1024.0..=0.25;

/// Light scattered to an octave of radii falls with this power of the radius: to an area by 2 more, between the inverse squares of
/// large angles and the inverse cubes of small ones that lenses and eyes are measured to have (CIE 146:2002).
const FALL: f64 = 0.5;

/// What a lens does to exposed light before a tone curve shows it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bloom {
    /// The part of all light that the lens scatters to where it does not belong, from a thousandth to a quarter of the picture's shorter side
    /// away: halos about city lights, a veil beside what is bright. Good lenses have 0.01 to 0.05. With 0 there is no pass for it.
    pub strength: f64,
}

impl Bloom {
    /// Of [`Self::strength`].
    pub const STRENGTH: RangeInclusive<f64> = 0.0..=0.5;
    /// Brightest exposed light that is scattered. The Sun's disc is brighter: its light about it is drawn as glare, from beyond the picture's
    /// edge too.
    pub const BRIGHTEST_SCATTERED: f64 = 64.0;

    /// How a picture of this size, pixels, is scattered: the part of its own light that each picture, half as large as the one before, gives
    /// up for the next one's; the first is the light itself. Empty where nothing is scattered.
    ///
    /// Together they scatter the part [`Self::strength`] of all light, less what stays within a pixel.
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
            // Rounding must not make an octave of nothing.
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
        // The last picture has none that is coarser.
        let shares = std::iter::once(first).chain(rest);
        shares.take(weights.len()).collect()
    }

    /// Bytes of the textures that it takes for pictures of this size, pixels.
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

    /// What each level contributes, finest first.
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
            // Of the first octaves a part may be finer than all radii.
            let falls = parts[2..].windows(2).all(|pair| pair[1] < pair[0]);
            assert!(falls, "{size:?}: {parts:?}");
        }
    }

    #[test]
    fn a_radius_gets_as_much_at_every_size() {
        let (small, large) = (parts(0.1, (640, 360)), parts(0.1, (2560, 1440)));
        // Two octaves more are finer than the small picture's pixels.
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
