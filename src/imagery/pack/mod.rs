//! Imagery packs: maps larger than memory, cut into tiles.

mod manifest;

pub use manifest::{
    FORMAT_VERSION, LayerEntry, LevelEntry, MANIFEST_FILE, Manifest, TileFile, tile_path,
};
