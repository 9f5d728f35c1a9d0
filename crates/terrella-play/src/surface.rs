//! The window's surface: colour in sRGB, its samples and depth.

use super::error::{PlayError, WindowError};
use terrella::internals::gpu::{GpuContext, ScaledTarget, color_texture};
use terrella::internals::offscreen::supported_samples;
use terrella::{EarthError, EarthOptions, Quality};
use wgpu::TextureFormat::{Bgra8Unorm, Bgra8UnormSrgb, Rgba8Unorm, Rgba8UnormSrgb};

/// A configured surface and its render targets.
pub struct WindowSurface {
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    /// The sRGB format that the surface's pictures are seen as.
    format: wgpu::TextureFormat,
    /// Part of width and height that is drawn.
    scale: f64,
    limit: u32,
    target: ScaledTarget,
}

impl WindowSurface {
    /// Configures the surface for a window of `size` pixels, and has the options draw to it.
    pub fn new(
        gpu: &GpuContext,
        surface: wgpu::Surface<'static>,
        size: (u32, u32),
        options: &mut EarthOptions,
    ) -> Result<Self, PlayError> {
        let capabilities = surface.get_capabilities(&gpu.adapter);
        let (stored, format) = choose_formats(&gpu.adapter, &capabilities.formats)?;
        options.develop_after_pass(format);
        options.samples = supported_samples(&gpu.adapter, options.color_format, options.samples);
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
            target: {
                let (size, pass) = ((width, height), options.pass_format());
                let target = ScaledTarget::of_pass(&gpu.device, &pass, format, size, size);
                target.map_err(EarthError::from)?
            },
            surface,
            config,
            format,
            scale: 1.0,
            limit,
        })
    }

    /// Format of the displayed image.
    pub fn format(&self) -> wgpu::TextureFormat {
        self.format
    }

    /// Samples a pixel.
    pub fn samples(&self) -> u32 {
        self.target.samples()
    }

    /// `wanted` samples a pixel if the adapter does so many, else 1.
    pub fn supported_samples(&self, gpu: &GpuContext, wanted: u32) -> u32 {
        supported_samples(&gpu.adapter, self.target.drawn_format(), wanted)
    }

    /// Draws from now on with the samples and at the scale of a quality, of which the adapter must do the samples.
    pub fn set_quality(&mut self, device: &wgpu::Device, quality: &Quality) {
        self.scale = quality.scale;
        self.set_target(device, quality.drawn_size(self.size()), quality.samples);
    }

    /// Uses passes with these options from now on, with the same formats.
    ///
    /// # Errors
    /// An invalid shader file. It is then unchanged.
    pub fn set_pass(
        &mut self,
        device: &wgpu::Device,
        options: &EarthOptions,
    ) -> Result<(), PlayError> {
        let (size, drawn_size, pass) = (self.size(), self.drawn_size(), options.pass_format());
        let target = ScaledTarget::of_pass(device, &pass, self.format, size, drawn_size);
        self.target = target.map_err(EarthError::from)?;
        Ok(())
    }

    /// Shows from now on what this target has, which was made for passes of the same formats.
    pub fn adopt(&mut self, device: &wgpu::Device, target: ScaledTarget) {
        let (drawn_size, samples) = (self.drawn_size(), target.samples());
        self.target = target;
        // The window may have another size by now.
        self.set_target(device, drawn_size, samples);
    }

    /// What is drawn to.
    pub fn target(&self) -> &ScaledTarget {
        &self.target
    }

    fn set_target(&mut self, device: &wgpu::Device, drawn_size: (u32, u32), samples: u32) {
        let set = self.target.set(device, self.size(), drawn_size, samples);
        if let Err(error) = set {
            // A fault of the program that its tests would have found.
            tracing::warn!("the window keeps its last image: {error}");
        }
    }

    /// Width and height, pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.config.width, self.config.height)
    }

    /// Width and height that are drawn before they are enlarged to [`Self::size`], pixels.
    pub fn drawn_size(&self) -> (u32, u32) {
        self.target.drawn_size()
    }

    /// Follows the window to another size. A size of zero (a minimised window) changes nothing.
    pub fn resize(&mut self, device: &wgpu::Device, size: (u32, u32)) {
        let (width, height) = (size.0.min(self.limit), size.1.min(self.limit));
        if width == 0 || height == 0 || (width, height) == self.size() {
            return;
        }
        (self.config.width, self.config.height) = (width, height);
        let drawn_size = Quality::drawn_size_at(self.scale, (width, height));
        self.set_target(device, drawn_size, self.samples());
        self.configure(device);
    }

    /// Configures the surface again, as required when it is outdated.
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

    /// A texture like the surface's that can be read: not every surface can.
    pub fn capture_texture(&self, device: &wgpu::Device) -> wgpu::Texture {
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
        color_texture(
            device,
            "terrella capture",
            self.size(),
            self.format,
            1,
            usage,
        )
    }
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
