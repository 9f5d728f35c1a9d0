//! Imagery packs: maps larger than memory, cut into tiles.

mod container;
mod error;
mod manifest;

pub use container::{MAX_OVERHEAD_BYTES, read_ktx2, write_ktx2};
pub use error::{MAX_MANIFEST_BYTES, ManifestPlace, PackError};
pub use manifest::{
    FORMAT_VERSION, LayerEntry, LevelEntry, MANIFEST_FILE, MAX_ATTRIBUTION_LINES, MAX_NAME_CHARS,
    MAX_TEXT_CHARS, Manifest, TileFile, tile_path,
};
