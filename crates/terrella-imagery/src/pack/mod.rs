//! Imagery packs: maps larger than memory, cut into tiles.
//!
//! # The format, versions 1 and 2
//!
//! A pack is a folder. Reading it needs only a TOML reader, a KTX2 reader and BLAKE3:
//!
//! ```text
//! earth/
//!     pack.toml                                    the manifest
//!     tiles/<storage>/<layer>/<pixels>/r<row>c<column>.ktx2
//!     tiles/plain/day/1350/r3c12.ktx2              for example
//!     tiles/plain/day/5400/r13c51.ktx2             a part of the same block
//! ```
//!
//! While a pack is being built there is a `build.journal` and no `pack.toml`: the manifest is written last, so a folder that has one is complete.
//! Nothing else in the folder is read.
//!
//! ## Blocks
//!
//! Maps are equirectangular and of the whole Earth: north row first, left edge at 180° W, twice as wide as high. Each
//! is cut into 16 columns × 8 rows of blocks of 22.5°: column 0 begins at 180° W, row 0 at the north pole. Lists of
//! blocks run row by row. At a level with n texels a block's side the map is W = 16 n texels wide and H = 8 n high, and
//! the centre of texel (i, j), counted from 0, lies at longitude −180° + (i + ½)·360°/W, latitude 90° − (j + ½)·180°/H.
//!
//! ## Levels
//!
//! A map has 1 to 8 levels (10 in version 2), the finest first, with strictly decreasing n from 16 to 8184. The last, coarsest one has at most 256
//! and all 128 blocks; in the others any block may be missing, and the next coarser tile is drawn there.
//!
//! In version 2 levels may be cut further, so that no tile exceeds the texture size limit and a part of a block can be read alone. Each block is
//! cut into q × q *parts* of p texels a side, n = q p, where q is 2, 4, 8 or 16 and p the n of the finest uncut level, at most 2040. So n is up to
//! 32 640. Cut levels come first. Their files are named by row and column among all 8 q rows and 16 q columns of parts. Any part may be missing. A
//! block that has parts has a tile at the finest uncut level, which is not the coarsest.
//!
//! Packs without parts and elevation data, and with at most 8 levels, are written as version 1.
//!
//! ## Tiles
//!
//! A tile has the n × n texels of its block, or the p × p of its part, and a border of neighbouring texels, so that filtering finds the same texels
//! on both sides of an edge. The border is 4 texels on the west and north. On the east and south it is wide enough to make the side s = n + 8 (p +
//! 8), rounded up to a multiple of 8. Columns continue across the date line. Beyond a pole row −1 − k is row k of the opposite meridian, column i +
//! W/2; beyond the south pole likewise.
//!
//! Each tile is a separate KTX2 file with four mip levels of sides s, s/2, s/4 and s/8, in one of two storages:
//!
//! | layer | what | `plain` | `bc` |
//! |---|---|---|---|
//! | `day` | colour, sRGB; alpha is 255 | `R8G8B8A8_SRGB` (43) | `BC7_SRGB_BLOCK` (146) |
//! | `clouds` | cover, 0…1 | `R8_UNORM` (9) | `BC4_UNORM_BLOCK` (139) |
//! | `normals` | slopes dh/d east, dh/d north, exaggerated as the manifest says, −1…1 | `R8G8_SNORM` (17) | `BC5_SNORM_BLOCK` (142) |
//! | `night_lights` | intensity, 0…1 | `R8_UNORM` (9) | `BC4_UNORM_BLOCK` (139) |
//! | `water` | open water, 0…1, the coast where it is one half | `R8_UNORM` (9) | `BC4_UNORM_BLOCK` (139) |
//!
//! The KTX2 header has: type size 1, width = height = s, depth 0, layers 0, faces 1, levels 4, supercompression 2 (Zstandard), no global data. The
//! data format descriptor is the one basic block of that Vulkan format, BT.709 primaries, straight alpha, with the sizes of planes (or, as in
//! earlier revisions of KTX2, with zeros for them). `KTXorientation`, if present, is `rd`. Each mip level is compressed separately. A file has at
//! most 64 KiB more than its uncompressed texels.
//!
//! ## The manifest
//!
//! ```toml
//! format = 1                      # the version; readers reject later ones
//! name = "Blue Marble"            # at most 200 characters, as all texts without control characters
//! attribution = ["NASA"]          # at most 64 lines of 1000 characters
//! columns = 16                    # these four are always so
//! rows = 8
//! border = 4
//! mips = 4
//! storages = ["plain", "bc"]      # one or both, each once
//!
//! [[layer]]                       # 1 to 5, each once, `day` always
//! name = "normals"
//! source = "elevation.tif"        # what it was made from, at most 1000 characters
//! exaggeration = 4.0              # may be left out; `normals` only: above 0
//!
//! [[layer.level]]                 # the finest first
//! pixels = 750                    # n
//! side = 760                      # s
//!
//! [layer.level.plain]             # one such table for each storage
//! bytes = [12345, 0, …]           # 128: the length of each tile's file, 0 for no tile
//! checksums = ["0123…", "", …]    # 128: the first 16 bytes of its BLAKE3 as 32 hexadecimal digits, small; "" for none
//! ```
//!
//! For a cut level, with one table for each block with parts, at least one:
//!
//! ```toml
//! [[layer.level]]
//! pixels = 5400                   # n
//! side = 1360                     # s
//! parts = 4                       # q
//!
//! [[layer.level.plain.block]]
//! block = 60                      # 0 to 127, rising from table to table
//! bytes = [12345, 0, …]           # q × q, row by row from the block's north-west corner; not all 0
//! checksums = ["0123…", "", …]
//! ```
//!
//! Since version 2 there may be a table `heights`; `heights.rs` describes it and the folder of that name.
//!
//! A tile exists in all storages or in none. No other key is allowed, and the file has at most 32 MiB and 1 500 000 commas and lines. It has no
//! paths: those of tiles are built from the names above, so that no manifest can refer to files outside its folder.
//!
//! # Files
//!
//! | file | content |
//! |---|---|
//! | `manifest/` | `pack.toml`: read, with line and key in every message, and written |
//! | `container/` | a tile as KTX2: read and written |
//! | `file.rs` | a file that must match the manifest exactly |
//! | `open.rs` | a pack's folder |
//! | `heights/` | elevation data: format, index and tiles |
//! | `tiles.rs` | a pack as a source of tiles, each checked before it is used |
//! | `zstandard.rs` | compression, in C or in Rust |
//! | `decode.rs` | decompression of BC texels |
//! | `coarsest.rs` | the coarsest level as whole maps |
//! | `verify.rs` | every tile checked |
//! | `error.rs` | errors |

mod coarsest;
mod container;
mod decode;
mod error;
mod file;
mod heights;
mod manifest;
mod open;
mod tiles;
mod verify;
mod zstandard;

pub use coarsest::{CoarsestMap, inner_texels};
pub use container::{MAX_OVERHEAD_BYTES, read_ktx2, write_ktx2};
pub use decode::decode_tile;
pub use error::{MAX_MANIFEST_BYTES, MAX_MANIFEST_VALUES, ManifestPlace, PackError};
#[cfg(feature = "terrain")]
pub use heights::PackHeights;
pub use heights::{
    HEIGHT_INDEX_FILE, HEIGHTS_FOLDER, HeightIndex, HeightKind, HeightPlace, HeightRecord,
    HeightValues, HeightsEntry, MAX_HEIGHT_TILES, decode_heights, decode_index, encode_heights,
    encode_index,
};
pub use manifest::quoted;
pub use manifest::{
    FORMAT_VERSION, LayerEntry, LevelEntry, MANIFEST_FILE, MAX_ATTRIBUTION_LINES, MAX_NAME_CHARS,
    MAX_TEXT_CHARS, Manifest, TileFile, tile_path,
};
pub use open::{JOURNAL_FILE, Pack};
pub use tiles::PackTiles;
pub use verify::{BadTile, VerifyReport, verify};
