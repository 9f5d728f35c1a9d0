//! Comparison of images.

use crate::headless::Picture;
use bevy::render::render_resource::TextureFormat;

/// Number of differing channels and the greatest difference: for displayed colours in 1/255, for light as a fraction
/// of 1.
#[derive(Debug)]
pub struct Difference {
    pub channels: usize,
    pub greatest: f64,
    pub of: usize,
}

/// Red, green and blue of all pixels.
pub fn channels(picture: &Picture, format: TextureFormat) -> Vec<f64> {
    let texels = (picture.size.0 * picture.size.1) as usize;
    let values: Vec<f64> = match (format, picture.bytes.len() / texels) {
        (TextureFormat::Rgba16Float, 8) => {
            let halves = picture.bytes.as_chunks::<2>().0.iter();
            halves.map(|b| of_half(u16::from_le_bytes(*b))).collect()
        }
        (TextureFormat::Rgba16Float, 16) => {
            let floats = picture.bytes.as_chunks::<4>().0.iter();
            floats.map(|b| f64::from(f32::from_le_bytes(*b))).collect()
        }
        (_, 4) => picture.bytes.iter().map(|&b| f64::from(b)).collect(),
        (format, bytes) => panic!("{bytes} bytes a pixel of {format:?}"),
    };
    let pixels = values.as_chunks::<4>().0.iter();
    pixels.flat_map(|pixel| pixel[..3].to_vec()).collect()
}

/// Difference of two images of one format.
pub fn difference(a: &Picture, b: &Picture, format: TextureFormat) -> Difference {
    assert_eq!(a.size, b.size);
    let (a, b) = (channels(a, format), channels(b, format));
    let apart = a.iter().zip(&b).map(|(a, b)| (a - b).abs());
    let differing = apart.filter(|&apart| apart > 0.0);
    let (channels, greatest) =
        differing.fold((0, 0.0), |(n, most), apart| (n + 1, apart.max(most)));
    Difference {
        channels,
        greatest,
        of: a.len(),
    }
}

/// Compares images of one view by matrices in f32 and in f64. A colour between two steps may round either way.
#[track_caller]
pub fn assert_alike(found: &Difference, is_hdr: bool) {
    let step = if is_hdr { 5e-3 } else { 1.0 };
    assert!(found.greatest <= step, "{found:?}");
    assert!(found.channels * 50 < found.of, "{found:?}");
}

/// Fraction of lit pixels.
pub fn lit(picture: &Picture, format: TextureFormat) -> f64 {
    let channels = channels(picture, format);
    let pixels = channels.as_chunks::<3>().0;
    let is_lit = |pixel: &&[f64; 3]| match format {
        TextureFormat::Rgba16Float => pixel[2] > 0.02,
        _ => pixel[2] > 30.0,
    };
    pixels.iter().filter(is_lit).count() as f64 / pixels.len() as f64
}

/// The part of an image that starts at a pixel and has this size.
pub fn part(picture: &Picture, (x, y): (u32, u32), (width, height): (u32, u32)) -> Picture {
    let texel = picture.bytes.len() / (picture.size.0 * picture.size.1) as usize;
    let rows = picture.bytes.chunks_exact(texel * picture.size.0 as usize);
    let rows = rows.skip(y as usize).take(height as usize);
    let bytes = rows.flat_map(|row| &row[texel * x as usize..texel * (x + width) as usize]);
    Picture {
        size: (width, height),
        bytes: bytes.copied().collect(),
    }
}

/// The value of a finite IEEE half.
fn of_half(bits: u16) -> f64 {
    let sign = if bits >> 15 == 1 { -1.0 } else { 1.0 };
    let mantissa = f64::from(bits & 0x3ff);
    sign * match i32::from(bits >> 10 & 0x1f) {
        0 => mantissa * 2f64.powi(-24),
        exponent => (1024.0 + mantissa) * 2f64.powi(exponent - 25),
    }
}
