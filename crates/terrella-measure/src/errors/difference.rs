//! Colours of an image compared with those of the true one.

use crate::SortedSample;
use image::{RgbImage, RgbaImage};
use terrella_reference::ReferencePicture;

/// How far the colours of two pictures of one size are apart.
#[derive(Clone, Debug)]
pub struct Difference {
    /// Mean over the pixels of FLIP (Andersson and others 2020), which is what an eye sees at 67 pixels a degree: 0 where
    /// it sees no difference, 1 at most.
    pub flip_mean: f64,
    /// The value of FLIP that 99 of a hundred pixels do not exceed.
    pub flip_p99: f64,
    /// Root mean square error over pixels and channels in linear light; the target's white is 1, and brighter values are clamped to it.
    pub rmse_linear: f64,
    /// FLIP of each pixel in false colours: black for zero, yellow for the maximum.
    pub map: RgbImage,
}

impl Difference {
    /// Compares a picture (sRGB, 8 bits) with the true one.
    ///
    /// # Panics
    /// If their sizes differ.
    pub fn between(picture: &RgbaImage, reference: &ReferencePicture) -> Self {
        let (width, height) = picture.dimensions();
        let size = (reference.width, reference.height);
        assert_eq!((width, height), size, "pictures of one size");
        let flip = flip(&rgb(picture), &rgb(&reference.to_rgba8()), size);
        let values = SortedSample::new(flip.to_vec().into_iter().map(f64::from).collect());
        let map = flip.apply_color_lut(&nv_flip::magma_lut()).to_vec();
        Self {
            flip_mean: values.mean(),
            flip_p99: values.quantile(0.99),
            rmse_linear: rmse_linear(picture, &reference.linear),
            map: RgbImage::from_raw(width, height, map).expect("FLIP keeps the size"),
        }
    }
}

/// Mean FLIP of two pictures of one size, as [`Difference::flip_mean`].
///
/// # Panics
/// If their sizes differ.
pub fn flip_mean(picture: &RgbaImage, reference: &RgbaImage) -> f64 {
    assert_eq!(
        picture.dimensions(),
        reference.dimensions(),
        "pictures of one size"
    );
    let values = flip(&rgb(picture), &rgb(reference), picture.dimensions()).to_vec();
    values.iter().map(|value| f64::from(*value)).sum::<f64>() / values.len().max(1) as f64
}

/// FLIP of each pixel, of red, green and blue, 8 bits.
fn flip(picture: &[u8], reference: &[u8], (width, height): (u32, u32)) -> nv_flip::FlipImageFloat {
    nv_flip::flip(
        nv_flip::FlipImageRgb8::with_data(width, height, reference),
        nv_flip::FlipImageRgb8::with_data(width, height, picture),
        nv_flip::DEFAULT_PIXELS_PER_DEGREE,
    )
}

fn rgb(picture: &RgbaImage) -> Vec<u8> {
    picture.pixels().flat_map(|p| [p[0], p[1], p[2]]).collect()
}

fn rmse_linear(picture: &RgbaImage, linear: &[[f32; 3]]) -> f64 {
    let light: Vec<f64> = (0..=255_u8).map(linear_of).collect();
    let squares = picture.pixels().zip(linear).map(|(pixel, truth)| {
        let channel = |k: usize| {
            let difference = light[usize::from(pixel[k])] - f64::from(truth[k]).clamp(0.0, 1.0);
            difference * difference
        };
        channel(0) + channel(1) + channel(2)
    });
    (squares.sum::<f64>() / (3 * linear.len().max(1)) as f64).sqrt()
}

/// Linear light of an sRGB value (IEC 61966-2-1).
fn linear_of(value: u8) -> f64 {
    let v = f64::from(value) / 255.0;
    if v <= 0.04045 {
        v / 12.92
    } else {
        ((v + 0.055) / 1.055).powf(2.4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reference(linear: Vec<[f32; 3]>) -> ReferencePicture {
        ReferencePicture {
            width: 16,
            height: 8,
            ground: vec![1.0; linear.len()],
            linear,
        }
    }

    #[test]
    fn equal_pictures_differ_by_nothing_and_unequal_ones_by_what_they_do() {
        let grey = linear_of(128) as f32;
        let truth = reference(vec![[grey, 1.5, 0.0]; 128]);
        let same = RgbaImage::from_pixel(16, 8, image::Rgba([128, 255, 0, 255]));
        let none = Difference::between(&same, &truth);
        assert!(none.rmse_linear < 1e-7 && none.flip_mean < 1e-6);
        assert_eq!(none.map.dimensions(), (16, 8));
        // One channel of three is off by 0.5: √(0.25/3).
        let half = reference(vec![[grey, 1.0, 0.5]; 128]);
        let found = Difference::between(&same, &half);
        assert!((found.rmse_linear - (0.25_f64 / 3.0).sqrt()).abs() < 1e-7);
        assert!(found.flip_mean > 0.1 && found.flip_p99 >= found.flip_mean);
    }
}
