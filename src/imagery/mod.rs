//! Maps of the Earth as texels in memory: finding, reading, checking, mip levels, slopes. Knows nothing of the GPU.
//!
//! | file | what |
//! |---|---|
//! | `layer.rs` | a map in memory with its mip levels |
//! | `load.rs` | a folder of maps read from disk, with limits before every allocation |
//! | `find.rs` | where the starter pack is |
//! | `slopes.rs` | terrain slopes from elevations |
//! | `mips.rs`, `srgb.rs` | smaller levels, averaged in linear light |
//! | `tile.rs` | tiles of a pack: names, sizes, formats |
//! | `pack/` | packs on disk |
//! | `stream/` | tiles streamed into memory: what is wanted, loaded, resident and drawn |
//! | `build/` | packs built from large maps, with the feature `pack-build` |
//! | `error.rs` | what can be wrong |

#[cfg(feature = "pack-build")]
pub mod build;
mod error;
mod find;
mod layer;
mod load;
mod mips;
pub mod pack;
mod slopes;
mod srgb;
pub mod stream;
pub mod tile;

pub use error::ImageryError;
pub use find::{TEXTURES_VARIABLE, find_textures};
pub use layer::{LayerImage, TexelFormat};
pub use load::{LayerSelection, MAX_FILE_BYTES, MAX_HEIGHT, MIN_HEIGHT, load_layers};
pub use slopes::{
    ELEVATION_OFFSET_M, POLE_FADE_DEG, SLOPE_EXAGGERATION, SlopeMap, slopes_from_elevation,
};

use tile::MapLayer;

/// The maps that an Earth is drawn with. A layer that is `None` is not loaded, uploaded, bound or in the shader.
#[derive(Clone, Debug)]
pub struct EarthLayers {
    /// Surface colour by day, `Rgba8Srgb`.
    pub day: LayerImage,
    /// Cloud cover, `R8Unorm`.
    pub clouds: Option<LayerImage>,
    /// Terrain slopes (dh/d east, dh/d north), exaggerated as its maker states, `Rg8Snorm`.
    pub normals: Option<LayerImage>,
    /// City lights, `R8Unorm`.
    pub night_lights: Option<LayerImage>,
    /// Open water, `R8Unorm`: where the sea glints in sunlight.
    pub water: Option<LayerImage>,
}

impl EarthLayers {
    /// A map by its kind.
    pub fn get(&self, layer: MapLayer) -> Option<&LayerImage> {
        match layer {
            MapLayer::Day => Some(&self.day),
            MapLayer::Clouds => self.clouds.as_ref(),
            MapLayer::Normals => self.normals.as_ref(),
            MapLayer::NightLights => self.night_lights.as_ref(),
            MapLayer::Water => self.water.as_ref(),
        }
    }

    /// Bytes of all texels of all layers, mip levels included.
    pub fn texture_bytes(&self) -> u64 {
        MapLayer::ALL
            .into_iter()
            .filter_map(|layer| self.get(layer))
            .map(LayerImage::bytes)
            .sum()
    }
}
