//! What a picture in memory is drawn to.

use super::error::OffscreenError;
use super::limits;
use crate::EarthError;
use crate::gpu::{FrameTargets, GpuContext, PassFormat, PassPart, ScaledTarget};

/// The picture, and where layers are developed after the pass, or drawn smaller, the texture that they are drawn to before it.
pub struct PictureTextures {
    picture: FrameTargets,
    between: Option<ScaledTarget>,
}

impl PictureTextures {
    /// For layers of this pass drawn at `drawn_size`, and a picture of `format` and `size`.
    ///
    /// # Errors
    /// A picture that takes more than [`super::MAX_PICTURE_MIB`], or for which the device has no room.
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
            // Samples are those of the texture that is drawn to.
            let samples = if between.is_some() { 1 } else { pass.samples };
            Ok(Self {
                picture: FrameTargets::with_color(device, format, size, samples),
                between,
            })
        })?;
        Ok(made.map_err(EarthError::Shader)?)
    }

    /// Clears passes from now on to space that hides nothing: alpha is how much of what is behind is hidden.
    pub fn make_space_transparent(&mut self) {
        match &mut self.between {
            Some(between) => between.make_space_transparent(),
            None => self.picture.make_space_transparent(),
        }
    }

    /// Width and height of the picture, pixels.
    pub fn size(&self) -> (u32, u32) {
        self.picture.size()
    }

    /// Width and height that are drawn, pixels.
    pub fn drawn_size(&self) -> (u32, u32) {
        let between = self.between.as_ref();
        between.map_or(self.size(), ScaledTarget::drawn_size)
    }

    /// The picture, to be read.
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

    /// Whether a pass comes after that one, which makes the picture of what it drew.
    pub fn has_last_pass(&self) -> bool {
        self.between.is_some()
    }

    /// Has the pictures made from now on show the grain of a frame of a film.
    pub fn set_frame(&self, queue: &wgpu::Queue, frame: u32) {
        if let Some(between) = &self.between {
            between.set_frame(queue, frame);
        }
    }

    /// Makes the picture of what that pass drew.
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
