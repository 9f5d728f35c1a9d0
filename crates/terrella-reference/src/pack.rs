//! Whole maps from a pack's finest levels, as far as memory allows.

use super::maps::{FullMap, FullMaps};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use terrella_imagery::TexelFormat;
use terrella_imagery::tile::{
    LayerLayout, TILE_BORDER, Tile, TileError, TileFormat, TileKey, TileSource,
};

/// Size limit of the maps assembled from a pack's tiles, bytes.
pub const MAX_MAP_BYTES: u64 = 1 << 30;

/// Maps of a pack, and where they are coarser than the pack is.
pub struct PackMaps {
    pub maps: FullMaps,
    /// Names of the layers for which a finer level did not fit, and the width used, texels.
    pub coarser: Vec<(&'static str, u32)>,
}

/// Assembles the tiles of each layer, at the finest levels that take at most `limit` bytes together. If a level has no tile of a block, the next
/// coarser one is enlarged, bilinearly in stored values.
///
/// # Errors
/// A tile that cannot be read: a true image has no stand-ins. [`TileError::Cancelled`] after `cancelled`.
pub fn whole_maps(
    source: &dyn TileSource,
    limit: u64,
    cancelled: &(dyn Fn() -> bool + Sync),
) -> Result<PackMaps, TileError> {
    let layouts = source.layers();
    let levels = chosen_levels(layouts, limit);
    let mut found = PackMaps {
        maps: FullMaps::default(),
        coarser: Vec::new(),
    };
    for (layout, level) in layouts.iter().zip(levels) {
        let map = whole_map(source, layout, level, cancelled)?;
        if level > 0 {
            found.coarser.push((layout.layer.name(), map.width));
        }
        found.maps.layers[layout.layer.index()] = Some(map);
    }
    Ok(found)
}

/// For each layer the finest level, made coarser where all together are larger than `limit`: the largest first, as long as
/// there is a coarser one.
fn chosen_levels(layouts: &[LayerLayout], limit: u64) -> Vec<usize> {
    let bytes = |place: usize, level: usize| {
        let shape = layouts[place].levels[level].shape;
        let texels = u64::from(shape.map_width()) * u64::from(shape.map_height());
        texels * u64::from(layouts[place].format.decoded().unit_bytes())
    };
    let mut levels = vec![0; layouts.len()];
    loop {
        let sum: u64 = levels.iter().enumerate().map(|(i, n)| bytes(i, *n)).sum();
        let next = (0..layouts.len())
            .filter(|place| levels[*place] + 1 < layouts[*place].levels.len())
            .max_by_key(|place| bytes(*place, levels[*place]));
        match next {
            Some(place) if sum > limit => levels[place] += 1,
            _ => return levels,
        }
    }
}

fn whole_map(
    source: &dyn TileSource,
    layout: &LayerLayout,
    level: usize,
    cancelled: &(dyn Fn() -> bool + Sync),
) -> Result<FullMap, TileError> {
    let shape = layout.levels[level].shape;
    let format = match layout.format.decoded() {
        TileFormat::Rgba8Srgb => TexelFormat::Rgba8Srgb,
        TileFormat::Rg8Snorm => TexelFormat::Rg8Snorm,
        _ => TexelFormat::R8Unorm,
    };
    let (width, height) = (shape.map_width(), shape.map_height());
    let row_bytes = width as usize * format.texel_bytes();
    let mut texels = vec![0; row_bytes * height as usize];
    let pixels = shape.pixels as usize;
    let failed = AtomicBool::new(false);
    // One strip of tiles after another to a thread: no two write to the same row.
    let strips = texels.par_chunks_mut(row_bytes * pixels).enumerate();
    strips.try_for_each(|(row, strip)| {
        for column in 0..shape.tile_columns() as usize {
            let stop = || cancelled() || failed.load(Ordering::Relaxed);
            let place = (row as u32, column as u32);
            let found = read(source, layout, level, place, &stop).inspect_err(|_| {
                failed.store(true, Ordering::Relaxed);
            })?;
            let own = pixels * format.texel_bytes();
            for (y, line) in strip.chunks_exact_mut(row_bytes).enumerate() {
                let line = &mut line[column * own..(column + 1) * own];
                copy_row(&found, y, pixels, line);
            }
        }
        Ok(())
    })?;
    Ok(FullMap {
        width,
        height,
        format,
        texels,
    })
}

/// A tile and which part of it is wanted.
struct Found {
    tile: Tile,
    /// Parts along its side, and the row and column of the one that is wanted.
    parts: u32,
    row: u32,
    column: u32,
}

/// The content in a row and column of tiles of this level, from its own tile or that of the next coarser level that has one; the coarsest has all.
fn read(
    source: &dyn TileSource,
    layout: &LayerLayout,
    level: usize,
    (row, column): (u32, u32),
    cancelled: &dyn Fn() -> bool,
) -> Result<Found, TileError> {
    if cancelled() {
        return Err(TileError::Cancelled);
    }
    let finest = layout.levels[level].shape.parts;
    // The tile for a position at a level: parts of a block, of which the finer level has as many or more.
    let at = |level: usize| {
        let parts = layout.levels[level].shape.parts;
        let of_tile = finest / parts;
        let (own_row, own_column) = (row / of_tile, column / of_tile);
        let block = own_row / parts * terrella_ground::globe::COLUMNS + own_column / parts;
        let part = own_row % parts * parts + own_column % parts;
        // 0…127, and below 256.
        (block as u8, part as u16, of_tile)
    };
    let has = |level: &usize| {
        let (block, part, _) = at(*level);
        layout.levels[*level].present.contains(block, part)
    };
    let last = layout.levels.len() - 1;
    let level = (level..last).find(has).unwrap_or(last);
    let (block, part, parts) = at(level);
    let key = TileKey {
        part,
        // Fewer than 256.
        ..TileKey::whole(layout.layer, level as u8, block)
    };
    Ok(Found {
        tile: source.read(key, cancelled)?,
        parts,
        row: row % parts,
        column: column % parts,
    })
}

/// Row `y` of `pixels` rows of the content found, from a tile with as many texels there or fewer.
fn copy_row(found: &Found, y: usize, pixels: usize, line: &mut [u8]) {
    let tile = &found.tile;
    let texel_bytes = tile.format.unit_bytes() as usize;
    let (own, border) = (tile.shape.pixels as usize, TILE_BORDER as usize);
    let tile_row = tile.shape.side() as usize * texel_bytes;
    let texels = tile.mip(0);
    if own == pixels && found.parts == 1 {
        let start = (y + border) * tile_row + border * texel_bytes;
        line.copy_from_slice(&texels[start..start + line.len()]);
        return;
    }
    // Place of a texel's centre on the coarser tile; its border holds what is beyond an edge.
    let place = |at: usize, part: u32| {
        let along = (part as usize * pixels + at) as f64 + 0.5;
        let all = pixels as f64 * f64::from(found.parts);
        let at = along * own as f64 / all - 0.5 + border as f64;
        (at as usize, at.fract())
    };
    let is_signed = tile.format == TileFormat::Rg8Snorm;
    let value = |byte: u8| {
        if is_signed {
            f64::from(byte as i8)
        } else {
            f64::from(byte)
        }
    };
    let (row, down) = place(y, found.row);
    for (x, texel) in line.chunks_exact_mut(texel_bytes).enumerate() {
        let (column, across) = place(x, found.column);
        for (channel, byte) in texel.iter_mut().enumerate() {
            let at = |row: usize, column: usize| {
                value(texels[row * tile_row + column * texel_bytes + channel])
            };
            let along =
                |row: usize| at(row, column) * (1.0 - across) + at(row, column + 1) * across;
            let mixed = along(row) * (1.0 - down) + along(row + 1) * down;
            *byte = if is_signed {
                mixed.round() as i8 as u8
            } else {
                mixed.round() as u8
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrella_imagery::tile::{BlockSet, LevelLayout, MapLayer, TileShape};

    /// A pack of tiles whose texels encode block and position. Its finest level has no block 5.
    struct Made {
        layouts: Vec<LayerLayout>,
    }

    impl Made {
        fn new() -> Self {
            let level = |pixels, blocks| {
                LevelLayout::of_blocks(TileShape::new(pixels).expect("in range"), blocks)
            };
            let all = BlockSet::ALL;
            let most = BlockSet(all.0 & !(1 << 5));
            let layout = |layer: MapLayer, format, levels| LayerLayout {
                layer,
                format,
                levels,
            };
            Self {
                layouts: vec![
                    layout(
                        MapLayer::Day,
                        TileFormat::Rgba8Srgb,
                        vec![level(40, most), level(20, all)],
                    ),
                    layout(
                        MapLayer::Normals,
                        TileFormat::Rg8Snorm,
                        vec![level(16, all)],
                    ),
                ],
            }
        }
    }

    /// A value that rises by 1 a texel of a block of 20, −0.5 at its west edge's outside.
    fn ramp(at: f64, pixels: f64) -> f64 {
        (at + 0.5) * 20.0 / pixels + 20.0
    }

    impl TileSource for Made {
        fn layers(&self) -> &[LayerLayout] {
            &self.layouts
        }

        fn read(&self, key: TileKey, cancelled: &dyn Fn() -> bool) -> Result<Tile, TileError> {
            if cancelled() {
                return Err(TileError::Cancelled);
            }
            let layout = self.layouts.iter().find(|l| l.layer == key.layer);
            let layout = layout.ok_or(TileError::Absent(key))?;
            let level = &layout.levels[usize::from(key.level)];
            if !level.present.contains(key.block, key.part) {
                return Err(TileError::Absent(key));
            }
            let (side, pixels) = (level.shape.side() as usize, f64::from(level.shape.pixels));
            let mut texels = Vec::new();
            for y in 0..side {
                for x in 0..side {
                    let [x, y] = [x, y].map(|at| ramp(at as f64 - 4.0, pixels).max(0.0) as u8);
                    match layout.format {
                        TileFormat::Rg8Snorm => texels.extend([0_u8.wrapping_sub(x), y]),
                        _ => texels.extend([x, y, key.block, 255]),
                    }
                }
            }
            let bytes = level.shape.bytes(layout.format);
            texels.resize(bytes, 0);
            Ok(Tile {
                format: layout.format,
                shape: level.shape,
                texels,
            })
        }
    }

    #[test]
    fn tiles_are_put_together_at_their_places() {
        let found = whole_maps(&Made::new(), u64::MAX, &|| false).expect("maps");
        assert!(found.coarser.is_empty());
        let day = found.maps.layers[0].as_ref().expect("a day map");
        assert_eq!((day.width, day.height), (640, 320));
        for (x, y) in [(0, 0), (639, 0), (45, 81), (600, 319), (210, 3), (239, 39)] {
            let texel = &day.texels[4 * (y * 640 + x)..][..4];
            let (column, row) = (x / 40, y / 40);
            let block = row * 16 + column;
            let at = |at: usize| ramp((at % 40) as f64, 40.0);
            // Block 5 is enlarged from tiles of 20: the same ramp to a rounding.
            for (value, exact) in [(texel[0], at(x)), (texel[1], at(y))] {
                assert!(
                    (f64::from(value) - exact).abs() <= 1.3,
                    "{x} {y}: {texel:?} {exact}"
                );
            }
            assert_eq!((texel[2], texel[3]), (block as u8, 255));
        }
        let slopes = found.maps.layers[2].as_ref().expect("slopes");
        assert_eq!(slopes.texels[2 * 3] as i8, -(ramp(3.0, 16.0) as i8));
        assert!(found.maps.check().is_ok());
    }

    /// A map of the position only: a cut level without half of block 5's parts, over a level of whole blocks.
    struct Cut(Vec<LayerLayout>);

    impl TileSource for Cut {
        fn layers(&self) -> &[LayerLayout] {
            &self.0
        }

        fn read(&self, key: TileKey, _: &dyn Fn() -> bool) -> Result<Tile, TileError> {
            let layout = &self.0[0];
            let level = &layout.levels[usize::from(key.level)];
            if !level.present.contains(key.block, key.part) {
                return Err(TileError::Absent(key));
            }
            let parts = level.shape.parts;
            let part = u32::from(key.part);
            let first = [part % parts, part / parts].map(|part| f64::from(part * 20) - 4.0);
            let all = f64::from(level.shape.block_pixels());
            let side = level.shape.side();
            let mut texels = Vec::new();
            for (y, x) in (0..side).flat_map(|y| (0..side).map(move |x| (y, x))) {
                let [x, y] = [first[0] + f64::from(x), first[1] + f64::from(y)]
                    .map(|at| ((at + 0.5) / all * 120.0 + 60.0) as u8);
                texels.extend([x, y, key.block, 255]);
            }
            texels.resize(level.shape.bytes(layout.format), 0);
            Ok(Tile {
                format: layout.format,
                shape: level.shape,
                texels,
            })
        }
    }

    #[test]
    fn parts_are_put_together_and_those_that_lack_come_from_the_block() {
        let whole = TileShape::new(20).expect("in range");
        let cut = TileShape::cut(20, 4).expect("in range");
        let mut sparse = LevelLayout::of_blocks(cut, BlockSet(0b100_0000));
        for part in (0..16).step_by(2) {
            sparse.present.insert(5, part);
        }
        let made = Cut(vec![LayerLayout {
            layer: MapLayer::Day,
            format: TileFormat::Rgba8Srgb,
            levels: vec![sparse, LevelLayout::of_blocks(whole, BlockSet::ALL)],
        }]);
        let found = whole_maps(&made, u64::MAX, &|| false).expect("maps");
        let day = found.maps.layers[0].as_ref().expect("a day map");
        assert_eq!((day.width, day.height), (1280, 640));
        for (n, texel) in day.texels.chunks_exact(4).enumerate() {
            let (x, y) = (n % 1280, n / 1280);
            let block = (y / 80 * 16 + x / 80) as u8;
            assert_eq!(texel[2], block, "{x} {y}");
            for (value, at) in [(texel[0], x % 80), (texel[1], y % 80)] {
                let exact = (at as f64 + 0.5) / 80.0 * 120.0 + 60.0;
                assert!(
                    (f64::from(value) - exact).abs() <= 1.3,
                    "{x} {y}: {value} {exact}"
                );
            }
        }
    }

    #[test]
    fn memory_decides_the_levels() {
        let made = Made::new();
        let day_bytes = 4 * 640 * 320;
        let slope_bytes = 2 * 256 * 128;
        assert_eq!(
            chosen_levels(&made.layouts, day_bytes + slope_bytes),
            [0, 0]
        );
        assert_eq!(
            chosen_levels(&made.layouts, day_bytes + slope_bytes - 1),
            [1, 0]
        );
        assert_eq!(chosen_levels(&made.layouts, 0), [1, 0]);
        let found = whole_maps(&made, day_bytes, &|| false).expect("maps");
        assert_eq!(found.coarser, [("day", 320)]);
    }

    #[test]
    fn reading_can_be_stopped() {
        let stopped = whole_maps(&Made::new(), u64::MAX, &|| true);
        assert!(matches!(stopped, Err(TileError::Cancelled)));
    }
}
