//! Imagery packs: maps larger than memory, cut into tiles.

mod coarsest;
mod container;
mod decode;
mod error;
mod manifest;
mod open;
mod preview;
mod tiles;
mod verify;

pub use container::{MAX_OVERHEAD_BYTES, read_ktx2, write_ktx2};
pub use decode::decode_tile;
pub use error::{MAX_MANIFEST_BYTES, ManifestPlace, PackError};
pub use manifest::{
    FORMAT_VERSION, LayerEntry, LevelEntry, MANIFEST_FILE, MAX_ATTRIBUTION_LINES, MAX_NAME_CHARS,
    MAX_TEXT_CHARS, Manifest, TileFile, tile_path,
};
pub use open::{JOURNAL_FILE, Pack};
pub use preview::preview;
pub use tiles::PackTiles;
pub use verify::{BadTile, VerifyReport, verify};
