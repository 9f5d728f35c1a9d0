//! Output of the renderer: linear light, and the ground fraction of each pixel.

use super::maps::srgb_from_linear;
use image::{Rgba, RgbaImage};

/// A picture in linear light, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferencePicture {
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// Linear light of each pixel, red, green and blue, 0…1 of the display's white.
    ///
    /// The light of each ray, ground and air together, is tone-mapped, and the pixel is the mean of its rays: the limit of a multisampled sRGB
    /// target with ever more samples.
    pub linear: Vec<[f32; 3]>,
    /// Fraction of each pixel's rays that meet the ground, 0…1.
    pub ground: Vec<f32>,
}

impl ReferencePicture {
    /// The picture in sRGB encoding, rounded to the nearest of 255 steps, opaque.
    pub fn to_rgba8(&self) -> RgbaImage {
        let width = self.width.max(1) as usize;
        RgbaImage::from_fn(self.width, self.height, |x, y| {
            let at = y as usize * width + x as usize;
            let light = self.linear.get(at).copied().unwrap_or_default();
            let [red, green, blue] = light.map(|light| {
                let shown = srgb_from_linear(f64::from(light).clamp(0.0, 1.0));
                (shown * 255.0).round() as u8
            });
            Rgba([red, green, blue, 255])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::maps::linear_from_srgb;
    use super::*;

    #[test]
    fn every_display_value_comes_back() {
        let linear = (0..=255)
            .map(|code| [linear_from_srgb(f64::from(code) / 255.0) as f32; 3])
            .collect();
        let picture = ReferencePicture {
            width: 16,
            height: 16,
            linear,
            ground: vec![0.0; 256],
        };
        for (code, pixel) in (0..=255_u8).zip(picture.to_rgba8().pixels()) {
            assert_eq!(pixel.0, [code, code, code, 255]);
        }
    }
}
