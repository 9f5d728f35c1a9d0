//! Maps of the Earth as texels in memory: finding, reading, checking, mip levels, slopes. Independent of the GPU.
//!
//! | file | content |
//! |---|---|
//! | `texel.rs` | how texels are stored |
//! | `layer.rs` | a map in memory with its mip levels, and all maps of an Earth |
//! | `between.rs` | blends of two maps |
//! | `albedo.rs` | mean albedo of neighbourhoods, for the air over them |
//! | `ground_kinds.rs` | cells with only land or only open sea |
//! | `detail_tiles.rs` | synthetic detail |
//! | `cities.rs`, `cities/` | city lights as points |
//! | `load.rs` | a folder of maps read from disk |
//! | `grey.rs` | maps of one byte a texel |
//! | `map_file.rs` | one map file, opened with limits before every allocation |
//! | `map_bands.rs` | rows of a map collected into bands |
//! | `map_rows.rs` | maps passed to a host row by row while they are read |
//! | `decode.rs` | PNG and JPEG files |
//! | `picture.rs` | images that are not maps |
//! | `jpeg/` | check that a JPEG is complete |
//! | `colour.rs` | colour metadata and orientation of files |
//! | `find.rs` | search for the starter pack |
//! | `slopes.rs` | terrain slopes from elevations, and those of cloud tops |
//! | `season.rs` | snow and sea ice by month, painted into the maps |
//! | `sea.rs` | separation of land and sea in the day map, with a water map |
//! | `mips.rs`, `srgb.rs` | smaller levels, averaged in linear light |
//! | `summary.rs` | properties of a map without its texels |
//! | `tile.rs` | tiles of a pack: names, sizes, formats |
//! | `residency.rs` | interface between streaming and drawing |
//! | `pack/` | packs on disk, with the feature `packs` |
//! | `stream/` | tiles streamed into memory: requested, loaded, resident and drawn; with that feature too |
//! | `error.rs` | errors |

// docs.rs shows the required feature of each item.
#![cfg_attr(docsrs, feature(doc_cfg))]

mod albedo;
mod between;
mod cities;
pub mod colour;
mod decode;
mod detail_tiles;
mod error;
mod find;
mod grey;
mod ground_kinds;
pub mod jpeg;
mod layer;
mod load;
mod map_bands;
mod map_file;
mod map_folder;
mod map_rows;
mod mips;
mod open_water;
#[cfg(feature = "packs")]
pub mod pack;
mod picture;
pub mod residency;
mod sea;
mod season;
pub mod slopes;
pub mod srgb;
#[cfg(feature = "tiles")]
pub mod stream;
mod summary;
mod texel;
pub mod tile;

pub use albedo::{CLOUD_ALBEDO, MapAlbedo, NEIGHBOURHOODS, NeighbourhoodAlbedo};
pub use cities::{
    CITY_CELLS, CityCell, CityLight, CityLights, FINENESSES, LAMP_COLOR, LAMP_GLOW, LEAST_LIGHT,
    MAX_PLACES, PLACES_FILE, Place, PlacesError, read_places,
};
pub use detail_tiles::{
    CLOUD_SLOPE_STEP, DETAIL_MEAN, DETAIL_STEP, DETAIL_TILE_SIDE, DetailTilesError,
    LAND_SLOPE_STEP, detail_tiles, supply_detail_tiles,
};
pub use error::ImageryError;
pub use find::{TEXTURES_VARIABLE, find_textures};
pub use grey::load_grey_map;
pub use ground_kinds::{CELLS_AROUND, GroundKind, GroundKinds, MOST_PIXEL_M, MapGroundKinds};
pub use layer::{EarthLayers, LayerImage};
pub use load::{
    DamagedLayer, LayerSelection, load_color_map, load_color_map_in, load_day_map, load_layers,
    load_layers_to, load_seasonal_layers, load_whole_layers,
};
pub use load::{colour_note, day_file};
pub use map_bands::MapBands;
pub use map_file::MAX_FILE_BYTES;
pub use map_folder::MapFolder;
pub use map_rows::{KeptInMemory, MapRows, MapSink};
pub use open_water::{MAX_WATER_COLUMNS, open_water};
pub use picture::{RgbaPicture, decode_rgba};
pub use sea::FLOOR_SEEN_M;
pub use season::{SEASONS_FILE, Season};
pub use slopes::{
    ELEVATION_OFFSET_M, POLE_FADE_DEG, SLOPE_EXAGGERATION, SlopeMap, slopes_from_clouds,
    slopes_from_elevation,
};
pub use summary::{MapSummary, MapSummaryRows};
pub use texel::{MAX_HEIGHT, MIN_HEIGHT, TexelFormat};
