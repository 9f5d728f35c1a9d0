//! Combines images and writes them as JPEG.

use anyhow::{Context, Result};
use image::codecs::jpeg::JpegEncoder;
use image::{RgbImage, imageops};
use std::path::Path;

/// JPEG quality of a full-size image, and of a small one in a table.
pub const WHOLE: u8 = 88;
pub const SMALL: u8 = 80;

/// Images of one size in a grid, row by row.
pub fn together(parts: &[RgbImage], columns: u32) -> RgbImage {
    let (width, height) = parts.first().map_or((0, 0), RgbImage::dimensions);
    let rows = (parts.len() as u32).div_ceil(columns);
    let mut sheet = RgbImage::new(columns * width, rows * height);
    for (n, part) in (0..).zip(parts) {
        let (x, y) = (n % columns * width, n / columns * height);
        imageops::replace(&mut sheet, part, x.into(), y.into());
    }
    sheet
}

/// Writes a JPEG, and creates its folder.
pub fn write(picture: &RgbImage, quality: u8, path: &Path) -> Result<()> {
    let mut jpeg = Vec::new();
    JpegEncoder::new_with_quality(&mut jpeg, quality).encode_image(picture)?;
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    }
    std::fs::write(path, jpeg).with_context(|| path.display().to_string())
}

pub fn read(path: &Path) -> Result<RgbImage> {
    let read = image::open(path).with_context(|| path.display().to_string())?;
    Ok(read.into_rgb8())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_stand_in_rows() {
        let part = |value| RgbImage::from_pixel(8, 5, image::Rgb([value; 3]));
        let sheet = together(&[part(1), part(2), part(3)], 2);
        assert_eq!(sheet.dimensions(), (16, 10));
        let at = |x: u32, y: u32| sheet.get_pixel(x * 8, y * 5).0[0];
        assert_eq!([at(0, 0), at(1, 0), at(0, 1), at(1, 1)], [1, 2, 3, 0]);
    }
}
