//! Colour and depth textures for programs that have none, and reading a picture back.

/// Why a picture could not be read back.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The device was lost or the copy failed.
    #[error("the picture could not be read back from the device: {0}")]
    ReadBack(String),
}

/// A colour texture (`Rgba8UnormSrgb`, multisampled if asked) and a reversed-Z depth buffer of one size.
pub struct FrameTargets {
    size: (u32, u32),
}

impl FrameTargets {
    /// Colour format of the picture.
    pub const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
    /// Depth format.
    pub const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

    /// Makes the textures. `samples` is 1 or 4.
    pub fn new(_device: &wgpu::Device, size: (u32, u32), _samples: u32) -> Self {
        Self { size }
    }

    /// Width and height, pixels.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// Begins a pass that clears colour to black (space) and depth to 0 (infinitely far, reversed Z).
    pub fn begin_pass<'e>(&self, _encoder: &'e mut wgpu::CommandEncoder) -> wgpu::RenderPass<'e> {
        unreachable!()
    }

    /// Reads the picture back, sRGB RGBA8 rows without padding. Waits for the device.
    pub fn read_back(
        &self,
        _device: &wgpu::Device,
        _queue: &wgpu::Queue,
    ) -> Result<image::RgbaImage, PictureError> {
        unreachable!()
    }
}
