//! Colour and depth textures for programs without their own, and reading an image back.

use super::DepthBuffer;
#[cfg(feature = "offscreen")]
use super::read_back::each_row;
use super::read_back::{PictureError, read_rows};
use std::time::Duration;
use terrella_ground::half::float_of_half;

/// A colour texture (`Rgba8UnormSrgb` by default, multisampled on request) and a reversed-Z depth buffer of the same size.
pub struct FrameTargets {
    picture: wgpu::Texture,
    view: wgpu::TextureView,
    attachments: Attachments,
}

impl FrameTargets {
    /// Colour format of the image.
    pub const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
    pub const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
    /// The depth buffer of its passes.
    pub const REVERSED_DEPTH: DepthBuffer = DepthBuffer::ReversedZ(Self::DEPTH);

    /// Makes the textures. `samples` is 1 or 4; `size` is within the device's limits and not zero.
    pub fn new(device: &wgpu::Device, size: (u32, u32), samples: u32) -> Self {
        Self::with_color(device, Self::COLOR, size, samples)
    }

    /// As [`Self::new`], with another colour format, which the device must support with this sample count.
    pub fn with_color(
        device: &wgpu::Device,
        format: wgpu::TextureFormat,
        size: (u32, u32),
        samples: u32,
    ) -> Self {
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
        let picture = color_texture(device, "terrella picture", size, format, 1, usage);
        Self {
            view: super::view(&picture),
            picture,
            attachments: Attachments::new(device, size, format, samples),
        }
    }

    /// Clears passes to transparent space from now on: alpha is the opacity over the background.
    pub fn make_space_transparent(&mut self) {
        self.attachments.make_space_transparent();
    }

    /// Width and height, pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.picture.width(), self.picture.height())
    }

    /// The image, one sample a pixel: for passes over what is drawn.
    pub fn picture_view(&self) -> &wgpu::TextureView {
        &self.view
    }

    /// Begins a pass that clears colour to black (space) and depth to 0 (infinitely far, reversed Z).
    pub fn begin_pass<'e>(&self, encoder: &'e mut wgpu::CommandEncoder) -> wgpu::RenderPass<'e> {
        self.begin_part(encoder, PassPart::default(), None)
    }

    /// Begins a part of that pass, for a frame that is drawn in several passes to be timed separately. All content is stored and loaded between
    /// them, which costs memory bandwidth that a single pass does not need.
    pub fn begin_part<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        part: PassPart,
        times: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) -> wgpu::RenderPass<'e> {
        self.attachments
            .begin_part(encoder, &self.view, part, times)
    }

    /// Begins a pass that clears only colour and tests against the depth of other textures of this size, one sample a pixel, whose pass was not the
    /// last of its frame.
    #[cfg(feature = "offscreen")]
    pub fn begin_pass_behind<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        hiding: &Self,
    ) -> wgpu::RenderPass<'e> {
        let color = wgpu::RenderPassColorAttachment {
            view: &self.view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(self.attachments.space),
                store: wgpu::StoreOp::Store,
            },
        };
        let depth = wgpu::Operations {
            load: wgpu::LoadOp::Load,
            store: wgpu::StoreOp::Discard,
        };
        begin(encoder, color, (&hiding.attachments.depth, depth), None)
    }

    /// Reads light back from a colour format of 16-bit or 32-bit floats: four numbers a pixel (RGBA), rows without padding. Waits for the device.
    pub fn read_light(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<Vec<[f32; 4]>, PictureError> {
        match self.picture.format() {
            wgpu::TextureFormat::Rgba16Float => read_halves(device, queue, &self.picture, None),
            _ => read_floats(device, queue, &self.picture),
        }
    }

    /// The colour format.
    #[cfg(feature = "offscreen")]
    pub fn format(&self) -> wgpu::TextureFormat {
        self.picture.format()
    }

    /// Reads an image of 8 bits a channel back into a buffer: four bytes a pixel, rows without padding. Waits for the device.
    #[cfg(feature = "offscreen")]
    pub fn read_back_into(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        rgba: &mut [u8],
    ) -> Result<(), PictureError> {
        let lines = 0..self.picture.height();
        let mut rows = rgba.chunks_exact_mut(4 * self.picture.width() as usize);
        each_row(device, queue, &self.picture, 4, &lines, None, &mut |row| {
            if let Some(wanted) = rows.next() {
                wanted.copy_from_slice(row);
            }
        })
    }

    /// As [`Self::read_light`], into a buffer.
    #[cfg(feature = "offscreen")]
    pub fn read_light_into(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        light: &mut [f32],
    ) -> Result<(), PictureError> {
        let (lines, halves) = (0..self.picture.height(), wgpu::TextureFormat::Rgba16Float);
        let is_half = self.picture.format() == halves;
        let texel = if is_half { 8 } else { 16 };
        let mut rows = light.chunks_exact_mut(4 * self.picture.width() as usize);
        each_row(
            device,
            queue,
            &self.picture,
            texel,
            &lines,
            None,
            &mut |row| {
                let Some(wanted) = rows.next() else { return };
                if is_half {
                    let numbers = row.as_chunks::<2>().0.iter();
                    for (wanted, half) in wanted.iter_mut().zip(numbers) {
                        *wanted = float_of_half(u16::from_le_bytes(*half));
                    }
                } else {
                    let numbers = row.as_chunks::<4>().0.iter();
                    for (wanted, number) in wanted.iter_mut().zip(numbers) {
                        *wanted = f32::from_le_bytes(*number);
                    }
                }
            },
        )
    }

    /// Reads an image of 8 bits a channel back: four bytes a pixel (RGBA), rows without padding. Waits for the device.
    pub fn read_back(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<Vec<u8>, PictureError> {
        read_texture(device, queue, &self.picture)
    }
}

/// Which part of a frame a pass is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PassPart {
    /// Colour and depth are cleared before it.
    pub is_first: bool,
    /// Samples are resolved after it; samples and depth are discarded.
    pub is_last: bool,
}

impl Default for PassPart {
    /// The only pass of its frame.
    fn default() -> Self {
        Self {
            is_first: true,
            is_last: true,
        }
    }
}

/// Attachments of a pass besides the shown texture: a multisampled texture if there are several samples a pixel, and depth.
pub struct Attachments {
    multisampled: Option<wgpu::TextureView>,
    depth: wgpu::TextureView,
    /// Clear colour.
    space: wgpu::Color,
}

impl Attachments {
    /// Attachments for a colour target of this size and format; depth is [`FrameTargets::DEPTH`], reversed.
    pub fn new(
        device: &wgpu::Device,
        size: (u32, u32),
        format: wgpu::TextureFormat,
        samples: u32,
    ) -> Self {
        let attachment = |label, format| {
            let usage = wgpu::TextureUsages::RENDER_ATTACHMENT;
            super::view(&color_texture(device, label, size, format, samples, usage))
        };
        Self {
            multisampled: (samples > 1).then(|| attachment("terrella samples", format)),
            depth: attachment("terrella depth", FrameTargets::DEPTH),
            space: wgpu::Color::BLACK,
        }
    }

    /// Clears passes to transparent space from now on.
    pub(super) fn make_space_transparent(&mut self) {
        self.space = wgpu::Color::TRANSPARENT;
    }

    /// Attachments of another size, format or sample count, with the same clear colour.
    pub(super) fn remade(
        &self,
        device: &wgpu::Device,
        size: (u32, u32),
        format: wgpu::TextureFormat,
        samples: u32,
    ) -> Self {
        Self {
            space: self.space,
            ..Self::new(device, size, format, samples)
        }
    }

    /// Begins a pass on `target`: black space, depth infinitely far.
    pub fn begin_pass<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
    ) -> wgpu::RenderPass<'e> {
        self.begin_part(encoder, target, PassPart::default(), None)
    }

    pub(super) fn begin_part<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        part: PassPart,
        times: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) -> wgpu::RenderPass<'e> {
        let kept = match part.is_last {
            true => wgpu::StoreOp::Discard,
            false => wgpu::StoreOp::Store,
        };
        let (view, resolve_target, store) = match &self.multisampled {
            Some(samples) => (samples, part.is_last.then_some(target), kept),
            None => (target, None, wgpu::StoreOp::Store),
        };
        let (color, depth) = match part.is_first {
            true => (wgpu::LoadOp::Clear(self.space), wgpu::LoadOp::Clear(0.0)),
            false => (wgpu::LoadOp::Load, wgpu::LoadOp::Load),
        };
        let color = wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target,
            ops: wgpu::Operations { load: color, store },
        };
        let depth = wgpu::Operations {
            load: depth,
            store: kept,
        };
        begin(encoder, color, (&self.depth, depth), times)
    }
}

fn begin<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    color: wgpu::RenderPassColorAttachment<'_>,
    (depth, depth_ops): (&wgpu::TextureView, wgpu::Operations<f32>),
    times: Option<wgpu::RenderPassTimestampWrites<'_>>,
) -> wgpu::RenderPass<'e> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("terrella pass"),
        color_attachments: &[Some(color)],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: depth,
            depth_ops: Some(depth_ops),
            stencil_ops: None,
        }),
        timestamp_writes: times,
        occlusion_query_set: None,
        multiview_mask: None,
    })
}

/// A texture of one level.
pub fn color_texture(
    device: &wgpu::Device,
    label: &str,
    (width, height): (u32, u32),
    format: wgpu::TextureFormat,
    sample_count: u32,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

/// Reads an 8-bit RGBA or BGRA texture (usage `COPY_SRC`) as rows of RGBA without padding. Waits for the device.
pub fn read_texture(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    texture: &wgpu::Texture,
) -> Result<Vec<u8>, PictureError> {
    let mut pixels = read_rows(device, queue, texture, 4, None)?;
    if matches!(
        texture.format(),
        wgpu::TextureFormat::Bgra8UnormSrgb | wgpu::TextureFormat::Bgra8Unorm
    ) {
        for pixel in pixels.as_chunks_mut::<4>().0 {
            pixel.swap(0, 2);
        }
    }
    Ok(pixels)
}

/// Reads an `Rgba16Float` texture (usage `COPY_SRC`), rows without padding. Waits for the device for at most `patience`.
pub fn read_halves(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    texture: &wgpu::Texture,
    patience: Option<Duration>,
) -> Result<Vec<[f32; 4]>, PictureError> {
    let bytes = read_rows(device, queue, texture, 8, patience)?;
    let halves = bytes.as_chunks::<2>().0.iter();
    let values: Vec<f32> = halves
        .map(|b| float_of_half(u16::from_le_bytes(*b)))
        .collect();
    Ok(values.as_chunks::<4>().0.to_vec())
}

/// Reads an `Rgba32Float` texture (usage `COPY_SRC`), rows without padding. Waits for the device.
pub fn read_floats(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    texture: &wgpu::Texture,
) -> Result<Vec<[f32; 4]>, PictureError> {
    let bytes = read_rows(device, queue, texture, size_of::<[f32; 4]>() as u32, None)?;
    let floats = bytes.as_chunks::<4>().0.iter();
    let floats: Vec<f32> = floats.map(|bytes| f32::from_le_bytes(*bytes)).collect();
    Ok(floats.as_chunks::<4>().0.to_vec())
}
