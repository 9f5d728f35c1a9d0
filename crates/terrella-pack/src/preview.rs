//! A contact sheet of a pack: one look shows whether its maps are the right way round and its levels show one place.

use image::{Rgb, RgbImage};
use std::sync::Arc;
use terrella_ground::globe::{Block, ROWS};
use terrella_imagery::pack::{Pack, PackError, PackTiles, decode_tile, inner_texels};
use terrella_imagery::tile::{MapLayer, Storage, TileError, TileFormat, TileKey, TileSource};
use terrella_imagery::{EarthLayers, LayerImage, TexelFormat};

/// Height of a row's pictures, pixels. The map is twice as wide, a block as wide as high.
const ROW_HEIGHT: u32 = 320;

/// Between and around pictures, pixels.
const MARGIN: u32 = 12;

/// How many times steeper than stored slopes are shown.
const SHOWN_STEEPER: f32 = 4.0;

const BACKGROUND: Rgb<u8> = Rgb([24, 24, 28]);

/// Colour of a missing tile.
const ABSENT: Rgb<u8> = Rgb([48, 48, 54]);

/// Colour of a bad tile.
const BAD: Rgb<u8> = Rgb([255, 0, 255]);

/// Italy, Greece and the coast of Africa: land, sea, mountains and city lights.
const SAMPLE: Block = Block { column: 8, row: 2 };

/// A contact sheet, and its bad tiles.
///
/// A row for each map, in the manifest's order. From left to right: the coarsest level of the whole map, with a frame around the selected block;
/// then that block, from 0° to 22.5° E and 22.5° to 45° N, at every level, the finest first. A level without the block, or a part of it, is a grey
/// square, a bad tile a magenta one. Clouds, lights and water are shown as grey, slopes as the colours of a normal map, four times steeper than
/// stored, as most terrain is nearly flat.
///
/// `storage` is the displayed one; by default the pack's first.
///
/// # Errors
/// A storage that the pack does not have, or a block of the coarsest level that no level has.
pub fn preview(
    pack: Arc<Pack>,
    storage: Option<Storage>,
) -> Result<(RgbImage, Vec<TileError>), PackError> {
    let manifest = pack.manifest();
    let storage = storage
        .or(manifest.storages.first().copied())
        .unwrap_or(Storage::Plain);
    let layers: Vec<MapLayer> = manifest.layers.iter().map(|entry| entry.layer).collect();
    let tiles = PackTiles::new(pack, storage, true, &layers)?;
    let (maps, mut errors) = tiles.coarsest_maps()?;

    let rows = tiles.layers().len() as u32;
    let most_levels = tiles
        .layers()
        .iter()
        .map(|layout| layout.levels.len())
        .max();
    let columns = 2 + most_levels.unwrap_or(0) as u32;
    let mut sheet = RgbImage::from_pixel(
        columns * ROW_HEIGHT + columns * MARGIN,
        rows * (ROW_HEIGHT + MARGIN) + MARGIN,
        BACKGROUND,
    );
    for (row, layout) in (0..).zip(tiles.layers()) {
        let top = MARGIN + row * (ROW_HEIGHT + MARGIN);
        if let Some(map) = map_of(&maps, layout.layer) {
            let size = (map.width, map.height);
            let texels = &map.levels[0];
            draw(
                &mut sheet,
                (MARGIN, top),
                (2 * ROW_HEIGHT, ROW_HEIGHT),
                size,
                texels,
                map.format,
            );
            frame_sample(&mut sheet, (MARGIN, top));
        }
        for (level, entry) in (0..).zip(&layout.levels) {
            let left = 2 * (ROW_HEIGHT + MARGIN) + u32::from(level) * (ROW_HEIGHT + MARGIN);
            let parts = entry.shape.parts;
            // 2, 4, 8 and 16 divide the height.
            let side = ROW_HEIGHT / parts;
            for part in 0..entry.shape.tiles_of_block() {
                let key = TileKey {
                    part,
                    ..TileKey::whole(layout.layer, level, SAMPLE.index() as u8)
                };
                let part = u32::from(part);
                let place = (left + part % parts * side, top + part / parts * side);
                if !entry.present.contains(key.block, key.part) {
                    fill(&mut sheet, place, side, ABSENT);
                    continue;
                }
                match tiles.read_stored(key, &|| false) {
                    Ok(tile) => {
                        let pixels = tile.shape.pixels;
                        let tile = decode_tile(tile);
                        let format = match tile.format {
                            TileFormat::Rgba8Srgb => TexelFormat::Rgba8Srgb,
                            TileFormat::Rg8Snorm => TexelFormat::Rg8Snorm,
                            _ => TexelFormat::R8Unorm,
                        };
                        let texels = inner_texels(&tile, pixels);
                        let size = (pixels, pixels);
                        draw(&mut sheet, place, (side, side), size, &texels, format);
                    }
                    Err(error) => {
                        fill(&mut sheet, place, side, BAD);
                        // The coarsest maps have named their own already.
                        if usize::from(level) + 1 < layout.levels.len() {
                            errors.push(error);
                        }
                    }
                }
            }
        }
    }
    Ok((sheet, errors))
}

fn map_of(maps: &EarthLayers, layer: MapLayer) -> Option<&LayerImage> {
    match layer {
        MapLayer::Day => Some(&maps.day),
        MapLayer::Clouds => maps.clouds.as_ref(),
        MapLayer::Normals => maps.normals.as_ref(),
        MapLayer::NightLights => maps.night_lights.as_ref(),
        MapLayer::Water => maps.water.as_ref(),
    }
}

/// Draws texels scaled to a width and height: each pixel is the mean of the texels it covers, as stored, or the texel that contains it.
fn draw(
    sheet: &mut RgbImage,
    (left, top): (u32, u32),
    (width, height): (u32, u32),
    (texels_wide, texels_high): (u32, u32),
    texels: &[u8],
    format: TexelFormat,
) {
    let texel_bytes = format.texel_bytes();
    let color = |x: u32, y: u32| {
        let at = (y as usize * texels_wide as usize + x as usize) * texel_bytes;
        shown(&texels[at..at + texel_bytes], format)
    };
    let span = |at: u32, of: u32, texels: u32| {
        let first = u64::from(at) * u64::from(texels) / u64::from(of);
        let end = (u64::from(at) + 1) * u64::from(texels) / u64::from(of);
        first as u32..(end as u32).max(first as u32 + 1)
    };
    for y in 0..height {
        for x in 0..width {
            let mut sums = [0_u32; 3];
            let mut count = 0;
            for texel_y in span(y, height, texels_high) {
                for texel_x in span(x, width, texels_wide) {
                    for (sum, value) in sums.iter_mut().zip(color(texel_x, texel_y)) {
                        *sum += u32::from(value);
                    }
                    count += 1;
                }
            }
            let mean = sums.map(|sum| ((sum + count / 2) / count) as u8);
            sheet.put_pixel(left + x, top + y, Rgb(mean));
        }
    }
}

/// The colour of a texel on the sheet.
fn shown(texel: &[u8], format: TexelFormat) -> [u8; 3] {
    match format {
        TexelFormat::Rgba8Srgb => [texel[0], texel[1], texel[2]],
        TexelFormat::R8Unorm => [texel[0]; 3],
        TexelFormat::Rg8Snorm => {
            // The normal leans away from the ascent.
            let [east, north] =
                [texel[0], texel[1]].map(|byte| f32::from(byte as i8) / 127.0 * SHOWN_STEEPER);
            let len = (east * east + north * north + 1.0).sqrt();
            [-east, -north, 1.0].map(|part| ((part / len * 0.5 + 0.5) * 255.0).round() as u8)
        }
    }
}

fn fill(sheet: &mut RgbImage, (left, top): (u32, u32), side: u32, color: Rgb<u8>) {
    for y in top..top + side {
        for x in left..left + side {
            sheet.put_pixel(x, y, color);
        }
    }
}

/// A thin frame round the sample block on the whole map.
fn frame_sample(sheet: &mut RgbImage, (left, top): (u32, u32)) {
    let side = ROW_HEIGHT / ROWS;
    let (left, top) = (left + SAMPLE.column * side, top + SAMPLE.row * side);
    for step in 0..side {
        for (x, y) in [(step, 0), (step, side - 1), (0, step), (side - 1, step)] {
            sheet.put_pixel(left + x, top + y, Rgb([255, 200, 60]));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_are_shown_as_normals() {
        let color = |east: i8, north: i8| shown(&[east as u8, north as u8], TexelFormat::Rg8Snorm);
        assert_eq!(color(0, 0), [128, 128, 255]);
        let [red, green, _] = color(40, 0);
        assert!(red < 60 && green == 128, "rising to the east leans west");
        let [red, green, blue] = color(0, -127);
        assert!(
            red == 128 && green > 245 && blue > 150,
            "rising to the south leans north"
        );
        assert_eq!(shown(&[7], TexelFormat::R8Unorm), [7; 3]);
        assert_eq!(shown(&[1, 2, 3, 255], TexelFormat::Rgba8Srgb), [1, 2, 3]);
    }
}
