//! Maps of the Earth as texels in memory: reading, checking, mip levels. Knows nothing of the GPU.

use std::path::PathBuf;

/// How a texel is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TexelFormat {
    /// Four bytes, colour in sRGB encoding, alpha unused (255).
    Rgba8Srgb,
    /// One byte, 0…1: cloud cover, light intensity.
    R8Unorm,
    /// Two signed bytes, −1…1: slope east and slope north.
    Rg8Snorm,
}

impl TexelFormat {
    /// Bytes of one texel.
    pub fn texel_bytes(self) -> usize {
        match self {
            Self::Rgba8Srgb => 4,
            Self::R8Unorm => 1,
            Self::Rg8Snorm => 2,
        }
    }
}

/// One equirectangular map with its mip levels: north row first, left edge at 180° W.
#[derive(Clone, Debug)]
pub struct LayerImage {
    /// Width of level 0, texels.
    pub width: u32,
    /// Height of level 0, texels.
    pub height: u32,
    /// How texels are stored.
    pub format: TexelFormat,
    /// Level 0 first, each row-major and tightly packed; level n is max(1, width >> n) × max(1, height >> n).
    pub levels: Vec<Vec<u8>>,
}

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
}

/// What can be wrong with a map.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageryError {
    /// No starter pack in any of the places looked at.
    #[error("no textures found; looked in {}", looked.iter().map(|p| p.display().to_string()).collect::<Vec<_>>().join(", "))]
    NotFound {
        /// The folders looked at.
        looked: Vec<PathBuf>,
    },
}
