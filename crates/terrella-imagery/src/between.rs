//! Blends of two maps.

use super::layer::LayerImage;
use super::srgb::{LINEAR_FROM_SRGB, SrgbEncoder};
use super::texel::TexelFormat;

impl LayerImage {
    /// Blend of two maps of the same size and format: `weight` 0 is `from`, 1 is `to`. Colours are mixed in linear light. `None` if size or format
    /// differ.
    pub fn between(from: &Self, to: &Self, weight: f32) -> Option<Self> {
        if (from.width, from.height, from.format) != (to.width, to.height, to.format) {
            return None;
        }
        let weight = if weight > 0.0 { weight.min(1.0) } else { 0.0 };
        let mix = |a: f32, b: f32| a + weight * (b - a);
        let plain = |a: u8, b: u8| mix(f32::from(a), f32::from(b)).round() as u8;
        let encoder = SrgbEncoder::new();
        let color = |a: u8, b: u8| {
            let [a, b] = [a, b].map(|code| LINEAR_FROM_SRGB[usize::from(code)]);
            encoder.code(mix(a, b))
        };
        let pairs = from.levels.first()?.iter().zip(to.levels.first()?);
        let (width, height) = (from.width, from.height);
        let made = match from.format {
            TexelFormat::Rgba8Srgb => {
                let texels = pairs.enumerate().map(|(at, (a, b))| match at % 4 {
                    3 => plain(*a, *b),
                    _ => color(*a, *b),
                });
                Self::from_rgba8(width, height, texels.collect())
            }
            TexelFormat::R8Unorm => {
                let texels = pairs.map(|(a, b)| plain(*a, *b));
                Self::from_r8(width, height, texels.collect())
            }
            TexelFormat::Rg8Snorm => {
                let signed = |a: u8, b: u8| {
                    let [a, b] = [a, b].map(|byte| f32::from(byte.cast_signed()));
                    (mix(a, b).round() as i8).cast_unsigned()
                };
                let texels = pairs.map(|(a, b)| signed(*a, *b));
                Self::from_slopes(width, height, texels.collect())
            }
        };
        made.ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_are_what_eyes_and_numbers_say() {
        let color = |code: [u8; 4]| LayerImage::from_rgba8(2, 1, code.repeat(2)).expect("a map");
        let (black, white) = (color([0, 0, 0, 100]), color([255, 255, 255, 200]));
        let half = LayerImage::between(&black, &white, 0.5).expect("alike");
        // Half the light of white is 188 of 255; alpha is no light.
        assert_eq!(half.levels[0][..4], [188, 188, 188, 150]);
        for (weight, whole) in [
            (0.0, &black),
            (1.0, &white),
            (f32::NAN, &black),
            (7.0, &white),
        ] {
            assert_eq!(
                LayerImage::between(&black, &white, weight).as_ref(),
                Some(whole)
            );
        }
        let grey = |code: u8| LayerImage::from_r8(2, 1, vec![code; 2]).expect("a map");
        let half = LayerImage::between(&grey(10), &grey(21), 0.5).expect("alike");
        assert_eq!(half.levels[0], [16, 16]);
        let slopes =
            |east: i8| LayerImage::from_slopes(1, 1, vec![east.cast_unsigned(), 0]).expect("a map");
        let half = LayerImage::between(&slopes(-100), &slopes(50), 0.5).expect("alike");
        assert_eq!(half.levels[0][0].cast_signed(), -25);
        assert!(LayerImage::between(&grey(1), &color([1; 4]), 0.5).is_none());
        let small = LayerImage::from_r8(1, 1, vec![1]).expect("a map");
        assert!(LayerImage::between(&grey(1), &small, 0.5).is_none());
    }
}
