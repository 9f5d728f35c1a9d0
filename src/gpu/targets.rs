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
    /// The resolved picture.
    picture: wgpu::Texture,
    picture_view: wgpu::TextureView,
    /// What is drawn into where there are several samples a pixel.
    multisampled: Option<wgpu::TextureView>,
    depth: wgpu::TextureView,
    read_back: wgpu::Buffer,
}

impl FrameTargets {
    /// Colour format of the picture.
    pub const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
    /// Depth format.
    pub const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

    /// Makes the textures. `samples` is 1 or 4; `size` is within the device's limits and not zero.
    pub fn new(device: &wgpu::Device, size: (u32, u32), samples: u32) -> Self {
        let texture = |label, format, samples, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d {
                    width: size.0,
                    height: size.1,
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count: samples,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            })
        };
        let target = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let picture = texture(
            "terrella picture",
            Self::COLOR,
            1,
            target | wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::TEXTURE_BINDING,
        );
        let view = super::view;
        Self {
            size,
            picture_view: view(&picture),
            picture,
            multisampled: (samples > 1)
                .then(|| view(&texture("terrella samples", Self::COLOR, samples, target))),
            depth: view(&texture("terrella depth", Self::DEPTH, samples, target)),
            read_back: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("terrella read back"),
                size: u64::from(padded_row(size.0)) * u64::from(size.1),
                usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
                mapped_at_creation: false,
            }),
        }
    }

    /// Width and height, pixels.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// The picture, for showing it elsewhere.
    pub fn picture_view(&self) -> &wgpu::TextureView {
        &self.picture_view
    }

    /// Begins a pass that clears colour to black (space) and depth to 0 (infinitely far, reversed Z).
    pub fn begin_pass<'e>(&self, encoder: &'e mut wgpu::CommandEncoder) -> wgpu::RenderPass<'e> {
        let (view, resolve_target, store) = match &self.multisampled {
            Some(samples) => (samples, Some(&self.picture_view), wgpu::StoreOp::Discard),
            None => (&self.picture_view, None, wgpu::StoreOp::Store),
        };
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("terrella pass"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        })
    }

    /// Reads the picture back, sRGB RGBA8 rows without padding. Waits for the device.
    pub fn read_back(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<image::RgbaImage, PictureError> {
        let failed = |what: &dyn std::fmt::Display| PictureError::ReadBack(what.to_string());
        let (width, height) = self.size;
        let padded = padded_row(width);
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("terrella read back"),
        });
        encoder.copy_texture_to_buffer(
            self.picture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &self.read_back,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(padded),
                    rows_per_image: Some(height),
                },
            },
            self.picture.size(),
        );
        queue.submit([encoder.finish()]);
        let (sender, receiver) = std::sync::mpsc::channel();
        self.read_back
            .map_async(wgpu::MapMode::Read, .., move |result| {
                // The receiver lives until the end of this function; if it is gone nobody waits.
                let _ = sender.send(result);
            });
        device
            .poll(wgpu::PollType::wait_indefinitely())
            .map_err(|e| failed(&e))?;
        receiver
            .recv()
            .map_err(|e| failed(&e))?
            .map_err(|e| failed(&e))?;
        let mapped = self
            .read_back
            .get_mapped_range(..)
            .map_err(|e| failed(&e))?;
        let row = 4 * width as usize;
        let mut pixels = Vec::with_capacity(row * height as usize);
        for line in mapped.chunks_exact(padded as usize) {
            pixels.extend_from_slice(&line[..row]);
        }
        drop(mapped);
        self.read_back.unmap();
        image::RgbaImage::from_raw(width, height, pixels).ok_or_else(|| failed(&"short read"))
    }
}

/// Bytes of a row in a copy buffer.
fn padded_row(width: u32) -> u32 {
    (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}
