//! How the texels of a map are stored, and how many a map may have.

/// Smallest height of a map file, texels.
pub const MIN_HEIGHT: u32 = 2;
/// Largest height of a map, texels; its width is at most twice that.
pub const MAX_HEIGHT: u32 = 16_384;

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
