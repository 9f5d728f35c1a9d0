//! Images of captions: files, limits, sizes.

use super::error::PlayError;
use crate::scene::{CaptionContent, Scene};
use egui::{Color32, ColorImage};
use std::io::Cursor;
use std::path::{Path, PathBuf};
use terrella_files as files;

/// Largest file of an image, bytes, and its largest side, pixels.
const MAX_IMAGE_BYTES: u64 = 16 << 20;
const MAX_IMAGE_PX: u32 = 4096;

/// Checks the images of a scene's captions.
///
/// # Errors
/// A file that is no PNG, or too large.
pub(super) fn check_images(scene: &Scene) -> Result<(), PlayError> {
    for caption in &scene.captions {
        if let CaptionContent::Image { file, .. } = &caption.content {
            read_image(file)?;
        }
    }
    Ok(())
}

/// The files of a scene's captions.
pub(super) fn caption_files(scene: &Scene) -> Vec<PathBuf> {
    let images = scene
        .captions
        .iter()
        .filter_map(|caption| match &caption.content {
            CaptionContent::Image { file, .. } => Some(file.clone()),
            CaptionContent::Text { .. } => None,
        });
    images.collect()
}

pub(super) fn read_image(file: &Path) -> Result<image::RgbaImage, PlayError> {
    let wrong = |why: String| PlayError::CaptionImage {
        file: file.to_owned(),
        why,
    };
    let bytes = files::read(file, MAX_IMAGE_BYTES).map_err(|error| wrong(error.to_string()))?;
    let bytes = bytes.ok_or_else(|| wrong(format!("it has more than {MAX_IMAGE_BYTES} bytes")))?;
    let mut reader = image::ImageReader::with_format(Cursor::new(bytes), image::ImageFormat::Png);
    let mut limits = image::Limits::no_limits();
    limits.max_image_width = Some(MAX_IMAGE_PX);
    limits.max_image_height = Some(MAX_IMAGE_PX);
    // 16 bits in each of four channels, and as much again to decode.
    limits.max_alloc = Some(2 * 8 * u64::from(MAX_IMAGE_PX).pow(2));
    reader.limits(limits);
    let image = reader.decode().map_err(|error| wrong(error.to_string()))?;
    Ok(image.to_rgba8())
}

/// An image of this width, with colours multiplied by alpha, as they are to be filtered.
pub(super) fn scaled(mut image: image::RgbaImage, width_px: Option<f64>) -> ColorImage {
    for pixel in image.pixels_mut() {
        let [red, green, blue, alpha] = pixel.0;
        pixel.0 = Color32::from_rgba_unmultiplied(red, green, blue, alpha).to_array();
    }
    let (width, height) = image.dimensions();
    // Both ranges have been checked.
    let new_width = width_px.map_or(width, |width| width.round() as u32).max(1);
    let new_height = f64::from(height) * f64::from(new_width) / f64::from(width.max(1));
    let new_height = (new_height.round() as u32).clamp(1, MAX_IMAGE_PX);
    if (new_width, new_height) != (width, height) {
        let filter = image::imageops::FilterType::CatmullRom;
        image = image::imageops::resize(&image, new_width, new_height, filter);
    }
    let size = [new_width as usize, new_height as usize];
    ColorImage::from_rgba_premultiplied(size, image.as_raw())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_are_scaled_and_corrupt_ones_are_named() {
        let image = image::RgbaImage::from_pixel(40, 20, image::Rgba([255, 128, 0, 128]));
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("logo.png");
        image.save(&path).expect("written");
        let read = read_image(&path).expect("a PNG");
        assert_eq!(scaled(read.clone(), None).size, [40, 20]);
        let small = scaled(read, Some(10.0));
        assert_eq!(small.size, [10, 5]);
        // Colours are premultiplied by alpha, in egui's gamma space.
        let [red, _, blue, alpha] = small.pixels[0].to_array();
        assert!(alpha == 128 && blue == 0 && (120..=195).contains(&red));
        let bytes = std::fs::read(&path).expect("read");
        std::fs::write(&path, &bytes[..bytes.len() / 2]).expect("written");
        let said = read_image(&path).expect_err("half of it").to_string();
        assert!(
            said.contains("[caption] image: ") && said.contains("logo.png"),
            "{said}"
        );
        std::fs::write(&path, b"GIF89a").expect("written");
        assert!(read_image(&path).is_err());
        image::RgbaImage::new(4097, 1).save(&path).expect("written");
        let said = read_image(&path).expect_err("too wide").to_string();
        assert!(said.contains("4096"), "{said}");
    }
}
