//! The window's surface: colour in sRGB, its samples and depth, and pictures read from it.

use super::picture::supported_samples;
use super::window::WindowError;
use crate::gpu::{FrameTargets, GpuContext, PictureError};
use image::RgbaImage;
use wgpu::TextureFormat::{Bgra8Unorm, Bgra8UnormSrgb, Rgba8Unorm, Rgba8UnormSrgb};

/// A configured surface and what is drawn with it.
pub struct WindowSurface {
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    /// The sRGB format that the surface's pictures are seen as.
    format: wgpu::TextureFormat,
    samples: u32,
    limit: u32,
    attachments: Attachments,
}

/// Textures of the surface's size.
struct Attachments {
    multisampled: Option<wgpu::TextureView>,
    depth: wgpu::TextureView,
}

impl WindowSurface {
    /// Configures the surface for a window of `size` pixels.
    pub fn new(
        gpu: &GpuContext,
        surface: wgpu::Surface<'static>,
        size: (u32, u32),
        wanted_samples: u32,
    ) -> Result<Self, WindowError> {
        let capabilities = surface.get_capabilities(&gpu.adapter);
        let (stored, format) = choose_formats(&gpu.adapter, &capabilities.formats)?;
        let samples = supported_samples(&gpu.adapter, format, wanted_samples);
        let limit = gpu.device.limits().max_texture_dimension_2d;
        let (width, height) = (size.0.clamp(1, limit), size.1.clamp(1, limit));
        let mut config = surface
            .get_default_config(&gpu.adapter, width, height)
            .ok_or(WindowError::NoFormat {
                present: Vec::new(),
            })?;
        config.format = stored;
        config.present_mode = wgpu::PresentMode::AutoVsync;
        config.view_formats = if stored == format {
            vec![]
        } else {
            vec![format]
        };
        surface.configure(&gpu.device, &config);
        Ok(Self {
            attachments: Attachments::new(&gpu.device, (width, height), format, samples),
            surface,
            config,
            format,
            samples,
            limit,
        })
    }

    /// The format that is drawn to.
    pub fn format(&self) -> wgpu::TextureFormat {
        self.format
    }

    /// Samples a pixel.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Width and height, pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.config.width, self.config.height)
    }

    /// Follows the window to another size. A size of zero (a minimised window) changes nothing.
    pub fn resize(&mut self, device: &wgpu::Device, size: (u32, u32)) {
        let (width, height) = (size.0.min(self.limit), size.1.min(self.limit));
        if width == 0 || height == 0 || (width, height) == self.size() {
            return;
        }
        (self.config.width, self.config.height) = (width, height);
        self.attachments = Attachments::new(device, (width, height), self.format, self.samples);
        self.configure(device);
    }

    /// Configures the surface anew, as it asks for when it is outdated.
    pub fn configure(&self, device: &wgpu::Device) {
        self.surface.configure(device, &self.config);
    }

    /// Takes another surface in place of one that was lost.
    pub fn replace(&mut self, device: &wgpu::Device, surface: wgpu::Surface<'static>) {
        self.surface = surface;
        self.configure(device);
    }

    /// The texture of the next frame, or why there is none.
    pub fn acquire(&self) -> wgpu::CurrentSurfaceTexture {
        self.surface.get_current_texture()
    }

    /// The view of a texture of this surface (or of [`Self::capture_texture`]) that is drawn to.
    pub fn view_of(&self, texture: &wgpu::Texture) -> wgpu::TextureView {
        texture.create_view(&wgpu::TextureViewDescriptor {
            label: Some("terrella window view"),
            format: Some(self.format),
            ..Default::default()
        })
    }

    /// Begins the Earth's pass on a view: black space, depth infinitely far.
    pub fn begin_pass<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        view: &wgpu::TextureView,
    ) -> wgpu::RenderPass<'e> {
        let (view, resolve_target, store) = match &self.attachments.multisampled {
            Some(samples) => (samples, Some(view), wgpu::StoreOp::Discard),
            None => (view, None, wgpu::StoreOp::Store),
        };
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("terrella window"),
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
                view: &self.attachments.depth,
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

    /// A texture like the surface's that can be read: not every surface can.
    pub fn capture_texture(&self, device: &wgpu::Device) -> wgpu::Texture {
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
        texture(
            device,
            "terrella capture",
            self.size(),
            self.format,
            1,
            usage,
        )
    }
}

impl Attachments {
    fn new(
        device: &wgpu::Device,
        size: (u32, u32),
        format: wgpu::TextureFormat,
        samples: u32,
    ) -> Self {
        let view = |label, format| {
            let usage = wgpu::TextureUsages::RENDER_ATTACHMENT;
            texture(device, label, size, format, samples, usage)
                .create_view(&wgpu::TextureViewDescriptor::default())
        };
        Self {
            multisampled: (samples > 1).then(|| view("terrella window samples", format)),
            depth: view("terrella window depth", FrameTargets::DEPTH),
        }
    }
}

fn texture(
    device: &wgpu::Device,
    label: &str,
    (width, height): (u32, u32),
    format: wgpu::TextureFormat,
    samples: u32,
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
        sample_count: samples,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

/// The format that the surface stores and the sRGB one that it is drawn to as: the same, or two names of the same bits.
fn choose_formats(
    adapter: &wgpu::Adapter,
    present: &[wgpu::TextureFormat],
) -> Result<(wgpu::TextureFormat, wgpu::TextureFormat), WindowError> {
    let flags = adapter.get_downlevel_capabilities().flags;
    let reinterprets = flags.contains(wgpu::DownlevelFlags::SURFACE_VIEW_FORMATS);
    let srgb = [Bgra8UnormSrgb, Rgba8UnormSrgb].map(|format| (format, format));
    let linear = [(Bgra8Unorm, Bgra8UnormSrgb), (Rgba8Unorm, Rgba8UnormSrgb)];
    let linear = linear.into_iter().filter(|_| reinterprets);
    srgb.into_iter()
        .chain(linear)
        .find(|(stored, _)| present.contains(stored))
        .ok_or_else(|| WindowError::NoFormat {
            present: present.to_vec(),
        })
}

/// Reads an 8-bit sRGB texture, waiting for the device.
pub fn read_texture(gpu: &GpuContext, texture: &wgpu::Texture) -> Result<RgbaImage, PictureError> {
    let failed = |what: &dyn std::fmt::Display| PictureError::ReadBack(what.to_string());
    let (width, height) = (texture.width(), texture.height());
    let padded = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("terrella capture"),
        size: u64::from(padded) * u64::from(height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("terrella capture"),
        });
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(padded),
                rows_per_image: Some(height),
            },
        },
        texture.size(),
    );
    gpu.queue.submit([encoder.finish()]);
    let (sender, receiver) = std::sync::mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |result| {
        // The receiver lives until the end of this function; if it is gone nobody waits.
        let _ = sender.send(result);
    });
    gpu.device
        .poll(wgpu::PollType::wait_indefinitely())
        .map_err(|e| failed(&e))?;
    receiver
        .recv()
        .map_err(|e| failed(&e))?
        .map_err(|e| failed(&e))?;
    let mapped = buffer.get_mapped_range(..).map_err(|e| failed(&e))?;
    let row = 4 * width as usize;
    let mut pixels: Vec<u8> = Vec::with_capacity(row * height as usize);
    for line in mapped.chunks_exact(padded as usize) {
        pixels.extend_from_slice(&line[..row]);
    }
    drop(mapped);
    if matches!(texture.format(), Bgra8UnormSrgb | Bgra8Unorm) {
        for pixel in pixels.as_chunks_mut::<4>().0 {
            pixel.swap(0, 2);
        }
    }
    RgbaImage::from_raw(width, height, pixels).ok_or_else(|| failed(&"short read"))
}
