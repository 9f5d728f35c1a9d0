//! Tiles of maps that are functions, made on request.

use std::sync::atomic::{AtomicBool, Ordering};
use terrella_imagery::LayerImage;
use terrella_imagery::tile::{
    BlockSet, LayerLayout, LevelLayout, MapLayer, TILE_BORDER, TILE_MIPS, Tile, TileError,
    TileFormat, TileKey, TileSet, TileShape, TileSource,
};

/// A day map that is a function of latitude and longitude, degrees.
pub struct FunctionTiles<F> {
    layers: Vec<LayerLayout>,
    f: F,
    /// While set, no tile can be read.
    pub broken: AtomicBool,
}

impl<F: Fn(f64, f64) -> [u8; 3] + Send + Sync> FunctionTiles<F> {
    /// Levels of so many texels per block side, the finest first, all blocks present.
    pub fn new(pixels: &[u32], f: F) -> Self {
        let levels = pixels.iter().map(|pixels| {
            let shape = TileShape::new(*pixels).expect("a good size");
            LevelLayout::of_blocks(shape, BlockSet::ALL)
        });
        Self {
            layers: vec![LayerLayout {
                layer: MapLayer::Day,
                format: TileFormat::Rgba8Srgb,
                levels: levels.collect(),
            }],
            f,
            broken: AtomicBool::new(false),
        }
    }

    /// With levels before the finest that are cut into so many parts along a block's side, the finest first.
    pub fn cut(mut self, parts: &[u32]) -> Self {
        let levels = &mut self.layers[0].levels;
        let pixels = levels[0].shape.pixels;
        let cut = parts.iter().map(|parts| {
            let shape = TileShape::cut(pixels, *parts).expect("a good size");
            LevelLayout::of_blocks(shape, BlockSet::ALL)
        });
        let cut: Vec<_> = cut.collect();
        levels.splice(0..0, cut);
        self
    }

    /// Keeps a level's tile only if `keep` returns true for the block's index.
    pub fn keep(mut self, level: usize, keep: impl Fn(u8) -> bool) -> Self {
        let mut present = BlockSet::default();
        (0..128)
            .filter(|block| keep(*block))
            .for_each(|block| present.insert(block));
        let level = &mut self.layers[0].levels[level];
        level.present = TileSet::of_blocks(level.shape, present);
        self
    }

    pub fn compressed(mut self) -> Self {
        self.layers[0].format = TileFormat::Bc7Srgb;
        self
    }

    /// Says that they are of another map.
    pub fn of(mut self, layer: MapLayer) -> Self {
        self.layers[0].layer = layer;
        self
    }

    /// The whole map at a level's size.
    pub fn whole(&self, level: usize) -> LayerImage {
        super::map(self.layers[0].levels[level].shape.map_width(), &self.f)
    }
}

impl<F: Fn(f64, f64) -> [u8; 3] + Send + Sync> TileSource for FunctionTiles<F> {
    fn layers(&self) -> &[LayerLayout] {
        &self.layers
    }

    fn read(&self, key: TileKey, _: &dyn Fn() -> bool) -> Result<Tile, TileError> {
        if self.broken.load(Ordering::Relaxed) {
            return Err(TileError::Absent(key));
        }
        let shape = self.layers[0].levels[usize::from(key.level)].shape;
        let (width, height) = (i64::from(shape.map_width()), i64::from(shape.map_height()));
        let side = shape.side() as i64;
        let block = key.block();
        let first = |place: u32, part: u32| {
            i64::from((place * shape.parts + part) * shape.pixels) - i64::from(TILE_BORDER)
        };
        let part = u32::from(key.part);
        let west = first(block.column, part % shape.parts);
        let north = first(block.row, part / shape.parts);
        let mut texels = Vec::with_capacity(shape.bytes(TileFormat::Rgba8Srgb));
        for j in 0..side {
            for i in 0..side {
                let (mut x, mut y) = (west + i, north + j);
                // Over a pole: the same row on the opposite meridian.
                if y < 0 || y >= height {
                    y = if y < 0 { -1 - y } else { 2 * height - 1 - y };
                    x += width / 2;
                }
                let x = x.rem_euclid(width);
                let lat = 90.0 - (y as f64 + 0.5) * 180.0 / height as f64;
                let lon = -180.0 + (x as f64 + 0.5) * 360.0 / width as f64;
                texels.extend((self.f)(lat, lon));
                texels.push(255);
            }
        }
        let image = LayerImage::from_rgba8(side as u32, side as u32, texels).expect("a good map");
        let texels = image.levels[..TILE_MIPS as usize].concat();
        Ok(Tile {
            format: TileFormat::Rgba8Srgb,
            shape,
            texels,
        })
    }
}
