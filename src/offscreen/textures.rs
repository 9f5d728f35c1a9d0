//! Render targets of images in memory.

use super::error::OffscreenError;
use super::limits;
use crate::EarthError;
use crate::gpu::{FrameTargets, GpuContext, PassFormat, PassPart, ScaledTarget};

/// The image, and the intermediate texture if light is developed after the pass or the resolution is reduced.
pub struct PictureTextures {
    picture: FrameTargets,
    between: Option<ScaledTarget>,
}

impl PictureTextures {
    /// For layers of this pass rendered at `drawn_size`, and an image of `format` and `size`.
    ///
    /// # Errors
    /// An image that takes more than [`super::MAX_PICTURE_MIB`], or that the device has no memory for.
    pub fn new(
        gpu: &GpuContext,
        pass: &PassFormat,
        format: wgpu::TextureFormat,
        size: (u32, u32),
        drawn_size: (u32, u32),
    ) -> Result<Self, OffscreenError> {
        limits::check_memory(size, pass)?;
        let made = limits::made(gpu, size, || {
            let device = &gpu.device;
            let between = ScaledTarget::of_pass(device, pass, format, size, drawn_size)?;
            let between = Some(between).filter(ScaledTarget::has_texture);
            // Only the texture that layers are rendered to is multisampled.
            let samples = if between.is_some() { 1 } else { pass.samples };
            Ok(Self {
                picture: FrameTargets::with_color(device, format, size, samples),
                between,
            })
        })?;
        Ok(made.map_err(EarthError::Shader)?)
    }

    /// Clears passes to transparent space from now on: alpha is the opacity over the background.
    pub fn make_space_transparent(&mut self) {
        match &mut self.between {
            Some(between) => between.make_space_transparent(),
            None => self.picture.make_space_transparent(),
        }
    }

    /// Width and height of the image, pixels.
    pub fn size(&self) -> (u32, u32) {
        self.picture.size()
    }

    /// Rendered width and height, pixels.
    pub fn drawn_size(&self) -> (u32, u32) {
        let between = self.between.as_ref();
        between.map_or(self.size(), ScaledTarget::drawn_size)
    }

    /// The image, for reading.
    pub fn picture(&self) -> &FrameTargets {
        &self.picture
    }

    /// Begins the pass of all layers: space, depth infinitely far.
    pub fn begin_pass<'e>(&self, encoder: &'e mut wgpu::CommandEncoder) -> wgpu::RenderPass<'e> {
        self.begin_part(encoder, PassPart::default(), None)
    }

    /// Begins a part of that pass, as [`FrameTargets::begin_part`].
    pub fn begin_part<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        part: PassPart,
        times: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) -> wgpu::RenderPass<'e> {
        match &self.between {
            Some(between) => between.begin_part(encoder, self.picture.picture_view(), part, times),
            None => self.picture.begin_part(encoder, part, times),
        }
    }

    /// Whether another pass follows, which makes the image from the intermediate texture.
    pub fn has_last_pass(&self) -> bool {
        self.between.is_some()
    }

    /// Selects the film grain of a frame for images from now on.
    pub fn set_frame(&self, queue: &wgpu::Queue, frame: u32) {
        if let Some(between) = &self.between {
            between.set_frame(queue, frame);
        }
    }

    /// Makes the image from the content of that pass.
    pub fn finish(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        times: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        if let Some(between) = &self.between {
            between.finish(encoder, self.picture.picture_view(), times);
        }
    }
}
