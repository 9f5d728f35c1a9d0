//! The coarsest level of a pack as whole maps: what is drawn where there is nothing better.

use super::decode::decode_tile;
use super::error::PackError;
use super::tiles::PackTiles;
use crate::mips::{decode_row, encode};
use crate::tile::{
    LayerLayout, MAP_LAYERS, MapLayer, TILE_BORDER, Tile, TileError, TileFormat, TileKey,
    TileSource,
};
use crate::{EarthLayers, ImageryError, LayerImage, TexelFormat};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use terrella_ground::globe::{BLOCK_COUNT, Block, COLUMNS};

/// Number of reading threads. More would not be faster with the minimum of two cores.
const READERS: usize = 2;

/// The texels of one block at the coarsest level, without border, and the errors found.
struct BlockTexels {
    /// Place of the map among the source's layers.
    place: usize,
    block: u8,
    texels: Vec<u8>,
    errors: Vec<TileError>,
}

impl PackTiles {
    /// The coarsest level of each of its maps, assembled into whole maps of plain texels, for any storage.
    ///
    /// If a tile of that level is bad, the next finer whole-block tile that can be read is averaged down, by area and in linear light; levels that
    /// are cut into parts are not used. Bad tiles are returned beside the maps, in the order of maps and blocks.
    ///
    /// # Errors
    /// A block for which no uncut level can be read.
    pub fn coarsest_maps(&self) -> Result<(EarthLayers, Vec<TileError>), PackError> {
        let layouts = self.layers();
        let mut maps: Vec<_> = layouts.iter().map(CoarsestMap::new).collect();
        let mut errors = Vec::new();
        let next = AtomicUsize::new(0);
        let jobs = layouts.len() * BLOCK_COUNT as usize;
        std::thread::scope(|scope| {
            let (sender, receiver) = mpsc::sync_channel(8);
            for _ in 0..READERS {
                let (sender, next) = (sender.clone(), &next);
                scope.spawn(move || {
                    loop {
                        let job = next.fetch_add(1, Ordering::Relaxed);
                        // The receiver goes away at the first block that is lost.
                        if job >= jobs || sender.send(self.block_texels(job)).is_err() {
                            break;
                        }
                    }
                });
            }
            drop(sender);
            for read in receiver {
                let read = read?;
                maps[read.place].paste(read.block, &read.texels);
                let place = (read.place, read.block);
                errors.extend(read.errors.into_iter().map(|error| (place, error)));
            }
            Ok::<_, PackError>(())
        })?;
        // Independent of the order in which the threads found them.
        errors.sort_by_key(|(place, _)| *place);
        Ok((
            self.whole_maps(maps)?,
            errors.into_iter().map(|(_, error)| error).collect(),
        ))
    }

    /// The texels of a block of a map, both counted by `job`.
    fn block_texels(&self, job: usize) -> Result<BlockTexels, PackError> {
        let place = job / BLOCK_COUNT as usize;
        let block = (job % BLOCK_COUNT as usize) as u8;
        let layout = &self.layers()[place];
        let pixels = coarsest_pixels(layout);
        let mut errors = Vec::new();
        for level in (layout.cut_levels() as u8..layout.levels.len() as u8).rev() {
            let key = TileKey {
                layer: layout.layer,
                level,
                block,
                part: 0,
            };
            match self.read_stored(key, &|| false) {
                Ok(tile) => {
                    let texels = inner_texels(&decode_tile(tile), pixels);
                    return Ok(BlockTexels {
                        place,
                        block,
                        texels,
                        errors,
                    });
                }
                // A finer level may have no tile of a block.
                Err(TileError::Absent(_)) => {}
                Err(error) => errors.push(error),
            }
        }
        let key = TileKey {
            layer: layout.layer,
            level: layout.levels.len().saturating_sub(1) as u8,
            block,
            part: 0,
        };
        Err(PackError::BlockLost {
            path: self.pack.dir().into(),
            block: key,
            source: errors.into_iter().next().unwrap_or(TileError::Absent(key)),
        })
    }

    /// Maps from their texels, mip levels and all, on a thread for the day map and one for the others.
    fn whole_maps(&self, maps: Vec<CoarsestMap>) -> Result<EarthLayers, PackError> {
        let mut maps = maps.into_iter();
        let image = |map: CoarsestMap| {
            let layer = map.layout.layer;
            map.finish().map_err(|source| self.no_map(layer, source))
        };
        // The day map is always there and the first.
        let day = maps.next();
        let (day, others) = std::thread::scope(|scope| {
            let others = scope.spawn(|| {
                let mut images: [Option<LayerImage>; MAP_LAYERS] = Default::default();
                for map in maps {
                    let place = map.layout.layer.index();
                    images[place] = Some(image(map)?);
                }
                Ok(images)
            });
            let day = day.map(image);
            let others = others
                .join()
                .unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            (day, others)
        });
        let [_, clouds, normals, night_lights, water] = others?;
        let no_day = || PackError::NoLayer {
            path: self.pack.dir().into(),
            layer: MapLayer::Day,
        };
        Ok(EarthLayers {
            day: day.ok_or_else(no_day)??,
            clouds,
            normals,
            night_lights,
            water,
        })
    }

    fn no_map(&self, layer: MapLayer, source: ImageryError) -> PackError {
        PackError::Map {
            path: self.pack.dir().into(),
            layer,
            source,
        }
    }
}

/// A whole map of a pack's coarsest level, assembled from its tiles.
pub struct CoarsestMap {
    layout: LayerLayout,
    texels: Vec<u8>,
}

impl CoarsestMap {
    /// Of no texels yet.
    pub fn new(layout: &LayerLayout) -> Self {
        Self {
            layout: layout.clone(),
            texels: vec![0; map_bytes(layout)],
        }
    }

    /// Adds a block from its tile, compressed or not, at the coarsest level, or at a finer uncut one, which is averaged down.
    pub fn add(&mut self, block: u8, tile: Tile) {
        let pixels = coarsest_pixels(&self.layout);
        self.paste(block, &inner_texels(&decode_tile(tile), pixels));
    }

    /// Copies a block's texels to their place.
    fn paste(&mut self, block: u8, texels: &[u8]) {
        let layout = &self.layout;
        let pixels = coarsest_pixels(layout) as usize;
        let row_bytes = pixels * texel_bytes(layout.format);
        let Block { column, row } = TileKey::whole(layout.layer, 0, block).block();
        let first_row = row as usize * pixels;
        for (y, texels) in texels.chunks_exact(row_bytes).enumerate() {
            let start = ((first_row + y) * COLUMNS as usize + column as usize) * row_bytes;
            self.texels[start..start + row_bytes].copy_from_slice(texels);
        }
    }

    /// The map with its mip levels.
    ///
    /// # Errors
    /// A layout without levels.
    pub fn finish(self) -> Result<LayerImage, ImageryError> {
        let map = self.layout.levels.last().map(|level| level.shape);
        let (width, height) = map.map_or((0, 0), |map| (map.map_width(), map.map_height()));
        match self.layout.format.decoded() {
            TileFormat::Rgba8Srgb => LayerImage::from_rgba8(width, height, self.texels),
            TileFormat::Rg8Snorm => LayerImage::from_slopes(width, height, self.texels),
            _ => LayerImage::from_r8(width, height, self.texels),
        }
    }
}

/// Texels of a block's side at a map's coarsest level.
fn coarsest_pixels(layout: &LayerLayout) -> u32 {
    layout.levels.last().map_or(0, |level| level.shape.pixels)
}

fn map_bytes(layout: &LayerLayout) -> usize {
    // At most 4096 × 2048 texels of four bytes.
    let block = coarsest_pixels(layout) as usize;
    block * block * BLOCK_COUNT as usize * texel_bytes(layout.format)
}

fn texel_bytes(format: TileFormat) -> usize {
    format.decoded().unit_bytes() as usize
}

/// The block's own texels of a plain tile, `pixels` a side: averaged down by area where the tile has more.
pub fn inner_texels(tile: &Tile, pixels: u32) -> Vec<u8> {
    let texel_bytes = tile.format.unit_bytes() as usize;
    let (own, border) = (tile.shape.pixels as usize, TILE_BORDER as usize);
    let row_bytes = tile.shape.side() as usize * texel_bytes;
    let rows = tile.mip(0).chunks_exact(row_bytes).skip(border).take(own);
    let rows = rows.map(|row| &row[border * texel_bytes..(border + own) * texel_bytes]);
    let format = match tile.format.decoded() {
        TileFormat::Rgba8Srgb => TexelFormat::Rgba8Srgb,
        TileFormat::Rg8Snorm => TexelFormat::Rg8Snorm,
        _ => TexelFormat::R8Unorm,
    };
    let pixels = pixels as usize;
    if own == pixels {
        return rows.collect::<Vec<_>>().concat();
    }
    let values = match format {
        TexelFormat::Rgba8Srgb => average::<4>(rows, own, pixels, format),
        TexelFormat::Rg8Snorm => average::<2>(rows, own, pixels, format),
        TexelFormat::R8Unorm => average::<1>(rows, own, pixels, format),
    };
    let mut bytes = Vec::with_capacity(values.len());
    encode(&values, format, &mut bytes);
    bytes
}

/// Means over the squares into which `to` × `to` texels divide an image of `from` × `from`, texels at their edges
/// counted in part.
fn average<'t, const CHANNELS: usize>(
    rows: impl Iterator<Item = &'t [u8]>,
    from: usize,
    to: usize,
    format: TexelFormat,
) -> Vec<f32> {
    let mut texels = vec![0.0; from * CHANNELS];
    let mut values = vec![0.0; to * to * CHANNELS];
    let mut line = vec![0.0; to * CHANNELS];
    for (y, row) in rows.enumerate() {
        decode_row(row, format, &mut texels);
        line.fill(0.0);
        for (x, texel) in texels.chunks_exact(CHANNELS).enumerate() {
            for (target, weight) in shares(x, from, to) {
                for (channel, value) in texel.iter().enumerate() {
                    line[target * CHANNELS + channel] += weight * value;
                }
            }
        }
        for (target, weight) in shares(y, from, to) {
            let sums = &mut values[target * to * CHANNELS..(target + 1) * to * CHANNELS];
            for (sum, value) in sums.iter_mut().zip(&line) {
                *sum += weight * value;
            }
        }
    }
    values
}

/// The targets, of `to` ≤ `from`, that texel `at` of `from` overlaps, and its weight in their means.
fn shares(at: usize, from: usize, to: usize) -> impl Iterator<Item = (usize, f32)> {
    // In units of a texel over `to`: texel `at` reaches from at·to to (at + 1)·to, target k from k·from to (k + 1)·from.
    let (start, end) = (at * to, (at + 1) * to);
    let first = start / from;
    (first..to.min(first + 2)).filter_map(move |target| {
        let covered = end
            .min((target + 1) * from)
            .saturating_sub(start.max(target * from));
        (covered > 0).then(|| (target, covered as f32 / from as f32))
    })
}
