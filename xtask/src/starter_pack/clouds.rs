//! The cloud map and the mending of its polar caps.

use super::map::{Map, smooth_step};
use super::poles::PoleMend;
use anyhow::Result;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use std::path::Path;

/// The map's place below the folder of source data.
pub const SOURCE: &str = "imagery/clouds_alpha_gray_4096x2048.png";

/// Makes `clouds.png`: half the size, its cuts and its polar caps mended, and as cover.
pub fn make(data: &Path) -> Result<Vec<u8>> {
    let mut map = mended(Map::read(&data.join(SOURCE), 1)?.halved());
    // The source's mean is 0.14, which would make the Earth half as bright as it is: its values are about the squares of
    // cover. Roots have the mean 0.28, and the Earth its published albedo.
    for value in &mut map.values {
        *value = 255.0 * (*value / 255.0).max(0.0).sqrt();
    }
    let mut png = Vec::new();
    PngEncoder::new_with_quality(&mut png, CompressionType::Best, FilterType::Adaptive)
        .write_image(
            &map.to_bytes(),
            map.width as u32,
            map.height as u32,
            ExtendedColorType::L8,
        )?;
    Ok(png)
}

/// The map, at any size, without its cuts and with whole polar caps.
pub fn mended(mut map: Map) -> Map {
    // The map was put together from halves: there is a slight step at 0° as well as at 180°.
    let (middle, reach) = (map.width / 2, map.width * 12 / 2048);
    map.mend_step(0, reach);
    map.mend_step(middle, reach);
    mirror_north_cap(&mut map);
    PoleMend {
        from_deg: 14.0,
        full_deg: 4.0,
        grain_km: 45.0,
        cap_deg: 0.5,
    }
    .apply(&mut map);
    map
}

/// Puts the mirror image of the northern cap over the southern one, which is one white and one black sector with
/// streaks between them, all meeting at the pole.
///
/// Softening such sectors only turns streaks into rings. Real clouds mirrored at the equator turn the right way for
/// their hemisphere, and no eye sees both caps at once. The passage lies from 71° to 78° S; the turn in longitude is
/// the one at which both maps differ least there.
fn mirror_north_cap(map: &mut Map) {
    const TURN_DEG: f64 = 235.0;
    let (width, height) = (map.width, map.height);
    let turn = (TURN_DEG / 360.0 * width as f64) as usize;
    for y in height / 2..height {
        let latitude_deg = 90.0 - (y as f64 + 0.5) * 180.0 / height as f64;
        let share = smooth_step(-71.0, -78.0, latitude_deg) as f32;
        if share == 0.0 {
            continue;
        }
        let north = map.row_mut(height - 1 - y).to_vec();
        for (x, value) in map.row_mut(y).iter_mut().enumerate() {
            *value += share * (north[(x + width - turn) % width] - *value);
        }
    }
}
