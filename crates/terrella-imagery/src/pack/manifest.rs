//! Manifest of a pack: `pack.toml`.

#[cfg(test)]
mod cut_tests;
mod fields;
mod heights;
mod levels;
mod read;
#[cfg(test)]
mod tests;
mod write;

pub use crate::pack::file::TileFile;
use crate::pack::heights::HeightsEntry;
use crate::tile::{MapLayer, Storage, TileKey, TileShape};
use std::path::PathBuf;
use terrella_ground::globe::Block;
pub use write::quoted;

/// Name of the manifest in the pack's folder.
pub const MANIFEST_FILE: &str = "pack.toml";

/// Latest version of the format: the one of packs that need it. Earlier ones are read as well.
pub const FORMAT_VERSION: u32 = 2;

/// Most levels of a map in version 1.
const MAX_LEVELS_1: usize = 8;

/// Most characters of a pack's name.
pub const MAX_NAME_CHARS: usize = 200;

/// Most lines of attribution.
pub const MAX_ATTRIBUTION_LINES: usize = 64;

/// Limit of characters in a line of attribution and in a map's source.
pub const MAX_TEXT_CHARS: usize = 1000;

/// The manifest of a pack.
#[derive(Clone, Debug, PartialEq)]
pub struct Manifest {
    /// Name of the pack; this and all texts on one line each, without control characters.
    pub name: String,
    /// Whose data it is, a line each.
    pub attribution: Vec<String>,
    /// How tiles are kept, each kind once; at least one.
    pub storages: Vec<Storage>,
    /// The maps, in the order of [`MapLayer::index`], each once; the day map always.
    pub layers: Vec<LayerEntry>,
    /// Heights of the ground, if it has any.
    pub heights: Option<HeightsEntry>,
}

/// One map of a manifest.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerEntry {
    /// Which map.
    pub layer: MapLayer,
    /// Its source: file name and size.
    pub source: String,
    /// Normals only: how many times steeper than the truth the slopes are.
    pub exaggeration: Option<f64>,
    /// The levels, the finest first.
    pub levels: Vec<LevelEntry>,
}

/// One level of a map.
#[derive(Clone, Debug, PartialEq)]
pub struct LevelEntry {
    /// Size of its tiles.
    pub shape: TileShape,
    /// For each of the manifest's storages, in order, the tiles of each of the 128 blocks, consecutively; `None` for a missing one. A tile exists
    /// in all storages or in none.
    pub tiles: Vec<Vec<Option<TileFile>>>,
}

impl LevelEntry {
    /// Block and part of each place in the lists of [`Self::tiles`].
    pub fn places(&self) -> impl Iterator<Item = (Block, u16)> + use<> {
        let parts = self.shape.tiles_of_block();
        Block::all().flat_map(move |block| (0..parts).map(move |part| (block, part)))
    }

    /// The file of a part of a block, by their numbers, in the storage of this place in the manifest's list.
    pub fn file(&self, storage: usize, block: u8, part: u16) -> Option<TileFile> {
        let of_block = self.shape.tiles_of_block();
        if part >= of_block {
            return None;
        }
        let at = usize::from(block) * usize::from(of_block) + usize::from(part);
        *self.tiles.get(storage)?.get(at)?
    }
}

/// Path of a tile below the pack's folder: `tiles/plain/day/1350/r3c12.ktx2`, rows and columns counted over all tiles of the level. Paths are built
/// from names that this program knows and never read from a manifest.
pub fn tile_path(
    storage: Storage,
    layer: MapLayer,
    shape: TileShape,
    block: Block,
    part: u16,
) -> PathBuf {
    let part = u32::from(part);
    let row = block.row * shape.parts + part / shape.parts;
    let column = block.column * shape.parts + part % shape.parts;
    PathBuf::from(format!(
        "tiles/{}/{}/{}/r{row}c{column}.ktx2",
        storage.name(),
        layer.name(),
        shape.block_pixels()
    ))
}

impl Manifest {
    /// The entry of a map.
    pub fn layer(&self, layer: MapLayer) -> Option<&LayerEntry> {
        self.layers.iter().find(|entry| entry.layer == layer)
    }

    /// Shape and file of a tile in one storage.
    pub fn tile(&self, storage: Storage, key: TileKey) -> Option<(TileShape, TileFile)> {
        let place = self.storages.iter().position(|kept| *kept == storage)?;
        let level = self.layer(key.layer)?.levels.get(usize::from(key.level))?;
        let file = level.file(place, key.block, key.part);
        file.map(|file| (level.shape, file))
    }

    /// The required version of the format: 1, or 2 with elevation data, levels that are cut into parts or more than 8 levels.
    pub fn format(&self) -> u32 {
        let needs_2 = |entry: &LayerEntry| {
            entry.levels.len() > MAX_LEVELS_1
                || entry.levels.iter().any(|level| level.shape.parts > 1)
        };
        if self.heights.is_some() || self.layers.iter().any(needs_2) {
            2
        } else {
            1
        }
    }
}
