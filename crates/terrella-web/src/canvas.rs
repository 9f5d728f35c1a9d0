//! The canvas for wgpu: device, surface, and intermediate render target.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use terrella::{Bloom, EarthOptions, ScaledTarget, ShaderError, Tone, wgpu};

/// Why nothing can be drawn on a canvas.
#[derive(Debug, thiserror::Error)]
pub enum CanvasError {
    /// The canvas cannot be drawn to by this backend.
    #[error("the canvas gives no context: {0}; take a new canvas, one that has no context yet")]
    Surface(#[from] wgpu::CreateSurfaceError),
    /// The browser has no adapter.
    #[error(
        "the browser has no graphics adapter for this page: {0}; turn hardware acceleration on in its settings"
    )]
    Adapter(#[from] wgpu::RequestAdapterError),
    /// The browser gives no device.
    #[error("the browser gives no graphics device: {0}; reload the page")]
    Device(#[from] wgpu::RequestDeviceError),
    /// The adapter cannot show what it draws.
    #[error("the graphics adapter cannot draw to a canvas")]
    NoFormat,
    /// A shader is invalid.
    #[error(transparent)]
    Shader(#[from] ShaderError),
    /// The frame cannot be had just now.
    #[error("the canvas gives no frame ({0}); reload the page if it stays so")]
    Frame(&'static str),
}

/// Least pixels drawn for each of the canvas, along either axis.
const LEAST_SCALE: f64 = 0.25;

/// Errors of the device since the page last asked.
#[derive(Clone, Default)]
pub struct Faults(Arc<Mutex<Vec<String>>>);

/// Prefix of the error of a lost device.
pub const LOST: &str = "lost: ";
/// Most faults that are kept: those after the first follow from it.
const MOST_FAULTS: usize = 16;

impl Faults {
    fn of(device: &wgpu::Device) -> Self {
        let faults = Self::default();
        let heard = faults.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            heard.note(error.to_string());
        }));
        let heard = faults.clone();
        device.set_device_lost_callback(move |reason, message| {
            heard.note(format!("{LOST}{message} ({reason:?})"));
        });
        faults
    }

    fn note(&self, fault: String) {
        let mut noted = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if noted.len() < MOST_FAULTS {
            noted.push(fault);
        }
    }

    /// Hands them over.
    pub fn take(&self) -> Vec<String> {
        let mut noted = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        std::mem::take(&mut noted)
    }
}

/// Work that was submitted to the device.
pub struct Submitted(Arc<AtomicBool>);

impl Submitted {
    /// Whether the device has done it. WebGL2 knows only after the page's current task has ended.
    pub fn is_done(&self, device: &wgpu::Device) -> bool {
        // A failure is a lost device, which does nothing more.
        device.poll(wgpu::PollType::Poll).is_err() || self.0.load(Ordering::Relaxed)
    }
}

/// A canvas that is drawn to.
pub struct Canvas {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub faults: Faults,
    /// Backend and name of the adapter, for the page to show.
    pub adapter: String,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    /// sRGB: WebGPU's canvas itself has no such format, and is seen through a view that has.
    format: wgpu::TextureFormat,
    target: ScaledTarget,
    /// Pixels drawn for each of the canvas, along either axis.
    scale: f64,
    /// Whether layers are added up as light and developed after the pass, as in native pictures.
    is_developing: bool,
}

impl Canvas {
    /// Opens the device for a canvas that has no context yet.
    pub async fn open(
        canvas: web_sys::HtmlCanvasElement,
        samples: u32,
    ) -> Result<Self, CanvasError> {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        descriptor.backends = wgpu::Backends::BROWSER_WEBGPU | wgpu::Backends::GL;
        let instance = wgpu::Instance::new(descriptor);
        let size = (canvas.width().max(1), canvas.height().max(1));
        let surface = instance.create_surface(wgpu::SurfaceTarget::Canvas(canvas))?;
        let wanted = wgpu::RequestAdapterOptions {
            compatible_surface: Some(&surface),
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        let adapter = instance.request_adapter(&wanted).await?;
        let info = adapter.get_info();
        let limits = match info.backend {
            wgpu::Backend::Gl => wgpu::Limits::downlevel_webgl2_defaults(),
            _ => wgpu::Limits::default(),
        };
        let (device, queue) = adapter
            .request_device(&wgpu::DeviceDescriptor {
                label: Some("terrella"),
                required_features: adapter.features() & wgpu::Features::TEXTURE_COMPRESSION_BC,
                required_limits: limits.using_resolution(adapter.limits()),
                ..Default::default()
            })
            .await?;
        let faults = Faults::of(&device);
        let mut config = surface
            .get_default_config(&adapter, size.0, size.1)
            .ok_or(CanvasError::NoFormat)?;
        let formats = surface.get_capabilities(&adapter).formats;
        if let Some(encoded) = formats.iter().find(|format| format.is_srgb()) {
            config.format = *encoded;
        }
        let format = config.format.add_srgb_suffix();
        if format != config.format {
            config.view_formats = vec![format];
        }
        config.present_mode = wgpu::PresentMode::Fifo;
        surface.configure(&device, &config);
        let light = adapter.get_texture_format_features(ScaledTarget::LIGHT);
        let is_developing = light
            .allowed_usages
            .contains(wgpu::TextureUsages::RENDER_ATTACHMENT)
            && light
                .flags
                .contains(wgpu::TextureFormatFeatureFlags::BLENDABLE)
            && light.flags.sample_count_supported(samples);
        let target = match is_developing {
            true => {
                let tone = Tone::default();
                let bloom = Bloom::default();
                ScaledTarget::developing(&device, format, size, size, samples, tone, bloom)?
            }
            false => ScaledTarget::new(&device, format, size, size, samples)?,
        };
        Ok(Self {
            adapter: format!("{:?} {}", info.backend, info.name),
            device,
            queue,
            faults,
            surface,
            config,
            format,
            target,
            scale: 1.0,
            is_developing,
        })
    }

    /// All work submitted so far.
    pub fn submitted(&self) -> Submitted {
        let done = Arc::new(AtomicBool::new(false));
        let noted = done.clone();
        self.queue
            .on_submitted_work_done(move || noted.store(true, Ordering::Relaxed));
        Submitted(done)
    }

    /// Has an Earth drawn for the passes of [`Self::draw`].
    pub fn fit(&self, options: &mut EarthOptions) {
        options.samples = self.target.samples();
        match self.is_developing {
            true => options.develop_after_pass(self.format),
            false => options.color_format = self.format,
        }
    }

    /// Width and height, pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.config.width, self.config.height)
    }

    /// Resizes with the canvas, within the limits of the device.
    ///
    /// # Errors
    /// An invalid shader.
    pub fn resize(&mut self, width: u32, height: u32) -> Result<(), CanvasError> {
        let most = self.device.limits().max_texture_dimension_2d;
        let size = (width.clamp(1, most), height.clamp(1, most));
        if size == self.size() {
            return Ok(());
        }
        (self.config.width, self.config.height) = size;
        self.surface.configure(&self.device, &self.config);
        self.fit_target()
    }

    /// Draws so many pixels for each of the canvas, along either axis.
    ///
    /// # Errors
    /// An invalid shader.
    pub fn set_scale(&mut self, scale: f64) -> Result<(), CanvasError> {
        self.scale = scale.clamp(LEAST_SCALE, 1.0);
        self.fit_target()
    }

    fn fit_target(&mut self) -> Result<(), CanvasError> {
        let (width, height) = self.size();
        let scaled = |pixels: u32| ((f64::from(pixels) * self.scale).round() as u32).max(1);
        let drawn = (scaled(width), scaled(height));
        let samples = self.target.samples();
        self.target
            .set(&self.device, (width, height), drawn, samples)?;
        Ok(())
    }

    /// Width and height of what is drawn, pixels: those for `prepare`.
    pub fn drawn_size(&self) -> (u32, u32) {
        self.target.drawn_size()
    }

    /// Draws one frame over black.
    pub fn draw(&self, render: impl FnOnce(&mut wgpu::RenderPass<'_>)) -> Result<(), CanvasError> {
        use wgpu::CurrentSurfaceTexture as Current;
        let frame = match self.surface.get_current_texture() {
            Current::Success(frame) | Current::Suboptimal(frame) => frame,
            Current::Timeout => return Err(CanvasError::Frame("timeout")),
            Current::Occluded => return Err(CanvasError::Frame("occluded")),
            Current::Outdated => return Err(CanvasError::Frame("outdated")),
            Current::Lost => return Err(CanvasError::Frame("lost")),
            _ => return Err(CanvasError::Frame("invalid")),
        };
        let shown = frame.texture.create_view(&wgpu::TextureViewDescriptor {
            label: Some("terrella canvas"),
            format: Some(self.format),
            ..Default::default()
        });
        let mut encoder = self
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor {
                label: Some("terrella canvas"),
            });
        render(&mut self.target.begin_pass(&mut encoder, &shown));
        self.target.finish(&mut encoder, &shown, None);
        self.queue.submit([encoder.finish()]);
        self.queue.present(frame);
        Ok(())
    }
}
