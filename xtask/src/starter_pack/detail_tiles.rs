//! The file of the tiles of synthetic detail: clouds above terrain.

use super::map::Map;
use super::{cloud_tile, land_tile};
use anyhow::Result;
use image::ExtendedColorType;
use image::codecs::jpeg::JpegEncoder;

/// Standard deviations per byte step from 128. `DETAIL_STEP` in the shaders.
const STEP: f64 = 3.2 / 127.0;
/// Web pages load the file before their first image.
const JPEG_QUALITY: u8 = 62;

/// Generates the tiles from the mended source of the cloud map: a grey JPEG with mean 128.
pub fn make(clouds: &Map) -> Result<Vec<u8>> {
    let [clouds, land] = [cloud_tile::make(clouds), land_tile::make()];
    let rows = clouds.height + land.height;
    let byte = |value: &f64| ((value / STEP + 128.0).clamp(1.0, 255.0) + 0.5).min(255.0) as u8;
    let tiles: Vec<u8> = clouds.values.iter().chain(&land.values).map(byte).collect();
    let mut jpeg = Vec::new();
    JpegEncoder::new_with_quality(&mut jpeg, JPEG_QUALITY).encode(
        &tiles,
        clouds.width as u32,
        rows as u32,
        ExtendedColorType::L8,
    )?;
    Ok(jpeg)
}
