//! An adapter and device for programs without their own. A host that has a device does not need this.

#[cfg(feature = "offscreen")]
use super::PictureError;
use super::faults::{GpuFault, GpuFaults};
use super::{ShaderCapability, relief};
use crate::plan::DeviceLimits;

/// Why no device could be opened.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ContextError {
    /// No adapter at all.
    #[error(
        "no graphics adapter found; install a graphics driver, or the software one: \
         on Debian and Ubuntu `apt-get install mesa-vulkan-drivers`, on Fedora `dnf install mesa-vulkan-drivers`"
    )]
    NoAdapter,
    /// There are adapters, but none with that name.
    #[error("no graphics adapter's name contains \"{wanted}\"; there are: {}", present.join(", "))]
    NotNamed {
        /// Name that was requested.
        wanted: String,
        /// Names of the available adapters.
        present: Vec<String>,
    },
    /// The adapter rejected a device.
    #[error("cannot open a device on the adapter {adapter}: {source}")]
    NoDevice {
        /// The adapter's name.
        adapter: String,
        /// Error of the driver.
        source: wgpu::RequestDeviceError,
    },
    /// No surface could be made for the window.
    #[error("no drawing surface for the window: {0}")]
    NoSurface(#[from] wgpu::CreateSurfaceError),
}

/// How a device handles BC7, BC5 and BC4 textures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BcSupport {
    /// It cannot read them.
    None,
    /// It decodes them in software: ten times slower than uncompressed texels, or more.
    Slow,
    /// It reads them at least as fast as uncompressed texels.
    Fast,
}

/// An opened adapter with its device. Clones share it.
#[derive(Clone)]
pub struct GpuContext {
    /// The instance that surfaces are created from.
    pub instance: wgpu::Instance,
    pub adapter: wgpu::Adapter,
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    faults: GpuFaults,
    /// Held by each clone.
    #[cfg(feature = "offscreen")]
    clones: std::sync::Arc<()>,
}

impl GpuContext {
    /// Opens the best adapter, or the best of those whose name contains `wanted`, letter case aside.
    ///
    /// Discrete adapters come before integrated, virtual and software ones. OpenGL is considered only if Vulkan, Metal and Direct3D 12 offer no
    /// suitable adapter. The environment variable `WGPU_BACKEND` limits the choice.
    pub async fn open(wanted: Option<&str>) -> Result<Self, ContextError> {
        Self::open_with(wanted, wgpu::Features::empty()).await
    }

    /// As [`Self::open`], with those of the `optional` features that the adapter has. They are for measurements: drawing needs none of them, and
    /// they do not affect the choice of the adapter.
    pub async fn open_with(
        wanted: Option<&str>,
        optional: wgpu::Features,
    ) -> Result<Self, ContextError> {
        let backends = wgpu::Backends::from_env().unwrap_or(wgpu::Backends::all());
        let open =
            async |backends| Self::open_on(instance(backends, None), wanted, None, optional).await;
        match open(backends - wgpu::Backends::GL).await {
            Err(ContextError::NoAdapter | ContextError::NotNamed { .. })
                if backends.contains(wgpu::Backends::GL) =>
            {
                open(backends).await
            }
            other => other,
        }
    }

    /// As [`Self::open`], among adapters that can present to `window`. Also returns the surface to present on.
    pub async fn open_for_window(
        wanted: Option<&str>,
        display: Box<dyn wgpu::wgt::WgpuHasDisplayHandle>,
        window: impl Into<wgpu::SurfaceTarget<'static>>,
    ) -> Result<(Self, wgpu::Surface<'static>), ContextError> {
        let instance = instance(
            wgpu::Backends::from_env().unwrap_or(wgpu::Backends::all()),
            Some(display),
        );
        let surface = instance.create_surface(window)?;
        let none = wgpu::Features::empty();
        Ok((
            Self::open_on(instance, wanted, Some(&surface), none).await?,
            surface,
        ))
    }

    async fn open_on(
        instance: wgpu::Instance,
        wanted: Option<&str>,
        surface: Option<&wgpu::Surface<'static>>,
        optional: wgpu::Features,
    ) -> Result<Self, ContextError> {
        let mut adapters = ranked(&instance).await;
        if adapters.is_empty() {
            return Err(ContextError::NoAdapter);
        }
        if let Some(wanted) = wanted {
            let present = adapters.iter().map(|a| describe(&a.get_info())).collect();
            let lower = wanted.to_lowercase();
            adapters.retain(|a| a.get_info().name.to_lowercase().contains(&lower));
            if adapters.is_empty() {
                return Err(ContextError::NotNamed {
                    wanted: wanted.to_owned(),
                    present,
                });
            }
        }
        let adapter = adapters
            .into_iter()
            .find(|adapter| surface.is_none_or(|surface| adapter.is_surface_supported(surface)))
            .ok_or(ContextError::NoAdapter)?;
        // All limits of the adapter, and the one optional feature that drawing uses.
        let optional = optional | wgpu::Features::TEXTURE_COMPRESSION_BC;
        let (device, queue) = adapter
            .request_device(&wgpu::DeviceDescriptor {
                label: Some("terrella device"),
                required_features: adapter.features() & optional,
                required_limits: adapter.limits(),
                ..Default::default()
            })
            .await
            .map_err(|source| ContextError::NoDevice {
                adapter: adapter.get_info().name,
                source,
            })?;
        Ok(Self {
            faults: GpuFaults::of(&device),
            #[cfg(feature = "offscreen")]
            clones: Default::default(),
            instance,
            adapter,
            device,
            queue,
        })
    }

    /// Checks that no error has occurred on the device since the last call.
    ///
    /// # Errors
    /// The first error outside error scopes. A lost device is reported by every call.
    pub fn check(&self) -> Result<(), GpuFault> {
        self.faults.take().map_or(Ok(()), Err)
    }

    /// Whether the device can be used: it is not lost.
    #[cfg(feature = "offscreen")]
    pub(crate) fn is_usable(&self) -> bool {
        !self.faults.is_lost()
    }

    /// Whether there is another clone.
    #[cfg(feature = "offscreen")]
    pub(crate) fn has_clones(&self) -> bool {
        std::sync::Arc::strong_count(&self.clones) > 1
    }

    /// Returns what was read back, or the device's error if one occurred before.
    #[cfg(feature = "offscreen")]
    pub fn checked<T>(&self, read: Result<T, PictureError>) -> Result<T, PictureError> {
        self.check()?;
        read
    }

    /// How the device handles compressed textures.
    pub fn bc_support(&self) -> BcSupport {
        let has_bc = self.device.features();
        match has_bc.contains(wgpu::Features::TEXTURE_COMPRESSION_BC) {
            true if self.is_software() => BcSupport::Slow,
            true => BcSupport::Fast,
            false => BcSupport::None,
        }
    }

    /// Features requested for a device with float targets, if the adapter has them.
    pub const FLOAT_TARGET: wgpu::Features = wgpu::Features::FLOAT32_BLENDABLE;

    /// Format that light is rendered to: 32-bit floats if the device can blend them, which requires [`Self::FLOAT_TARGET`] at creation, else 16-bit
    /// floats.
    pub fn float_format(&self) -> wgpu::TextureFormat {
        match self.device.features().contains(Self::FLOAT_TARGET) {
            true => wgpu::TextureFormat::Rgba32Float,
            false => wgpu::TextureFormat::Rgba16Float,
        }
    }

    /// Whether rendering is done by the CPU: anisotropic filtering and large targets are then expensive.
    pub fn is_software(&self) -> bool {
        self.adapter.get_info().device_type == wgpu::DeviceType::Cpu
    }
}

/// An adapter as `terrella doctor` shows it.
#[derive(Clone, Debug)]
pub struct AdapterReport {
    /// Name as the driver gives it.
    pub name: String,
    /// vulkan, gl, metal, dx12.
    pub backend: String,
    /// Discrete, integrated, virtual, CPU or other.
    pub kind: String,
    /// Driver and its version.
    pub driver: String,
    /// Supported features, one per line.
    pub can: Vec<String>,
    /// Features that will be dropped and why, one per line.
    pub dropped: Vec<String>,
    /// Whether a run without options would choose this adapter.
    pub chosen: bool,
}

/// All adapters present, best first.
pub async fn adapter_reports() -> Vec<AdapterReport> {
    let instance =
        wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let mut reports: Vec<_> = ranked(&instance).await.iter().map(report).collect();
    if let Some(best) = reports.first_mut() {
        best.chosen = true;
    }
    reports
}

fn instance(
    backends: wgpu::Backends,
    display: Option<Box<dyn wgpu::wgt::WgpuHasDisplayHandle>>,
) -> wgpu::Instance {
    let descriptor = match display {
        Some(display) => wgpu::InstanceDescriptor::new_with_display_handle_from_env(display),
        None => wgpu::InstanceDescriptor::new_without_display_handle_from_env(),
    };
    wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends,
        ..descriptor
    })
}

async fn ranked(instance: &wgpu::Instance) -> Vec<wgpu::Adapter> {
    let mut adapters = instance.enumerate_adapters(wgpu::Backends::all()).await;
    adapters.sort_by_key(|adapter| {
        let info = adapter.get_info();
        let kind = match info.device_type {
            wgpu::DeviceType::DiscreteGpu => 0,
            wgpu::DeviceType::IntegratedGpu => 1,
            wgpu::DeviceType::VirtualGpu => 2,
            wgpu::DeviceType::Cpu => 4,
            wgpu::DeviceType::Other => 3,
        };
        (kind, info.backend == wgpu::Backend::Gl)
    });
    adapters
}

/// The limits of a device that planning needs.
pub(crate) fn device_limits(limits: &wgpu::Limits) -> DeviceLimits {
    DeviceLimits {
        texture_side: limits.max_texture_dimension_2d,
        uniform_bytes: limits.max_uniform_buffer_binding_size,
        storage_bytes: match ShaderCapability::StorageBuffers.is_met(limits) {
            true => limits
                .max_storage_buffer_binding_size
                .min(limits.max_buffer_size),
            false => 0,
        },
        bindings: limits.max_bindings_per_bind_group,
    }
}

fn describe(info: &wgpu::AdapterInfo) -> String {
    format!("{} ({})", info.name, info.backend)
}

fn report(adapter: &wgpu::Adapter) -> AdapterReport {
    let info = adapter.get_info();
    let limits = adapter.limits();
    let software = info.device_type == wgpu::DeviceType::Cpu;
    let (mut can, mut dropped) = (Vec::new(), Vec::new());
    let side = limits.max_texture_dimension_2d;
    can.push(format!("maps and pictures up to {side} × {side} pixels"));
    if side < 4096 {
        dropped.push(format!(
            "the starter pack's 4096-pixel day map does not fit: the limit is {side}"
        ));
    }
    let samples = adapter
        .get_texture_format_features(super::FrameTargets::COLOR)
        .flags
        .supported_sample_counts()
        .into_iter()
        .filter(|n| {
            adapter
                .get_texture_format_features(super::FrameTargets::DEPTH)
                .flags
                .sample_count_supported(*n)
        })
        .collect::<Vec<_>>();
    if samples.contains(&4) {
        can.push("multisampling, 4 samples a pixel".into());
    } else {
        dropped.push(
            "multisampling: not supported for the picture's formats; edges are drawn with 1 sample"
                .into(),
        );
    }
    let table = adapter
        .get_texture_format_features(wgpu::TextureFormat::Rgba16Float)
        .flags;
    if table.contains(wgpu::TextureFormatFeatureFlags::FILTERABLE) {
        can.push("atmosphere (filtered half-float tables)".into());
    } else {
        dropped.push(
            "atmosphere: half-float textures cannot be filtered; set atmosphere = \"none\"".into(),
        );
    }
    let has_bc = adapter.features();
    match has_bc.contains(wgpu::Features::TEXTURE_COMPRESSION_BC) {
        true if software => dropped.push("compressed tiles: a software adapter unpacks every texel again; packs are read as plain texels".into()),
        true => can.push("compressed tiles (BC7, BC5, BC4)".into()),
        false => dropped.push("compressed tiles: not supported; packs are read as plain texels".into()),
    }
    for capability in ShaderCapability::ALL {
        let (serves, name) = (capability.serves(), capability.name());
        match capability.is_met(&limits) {
            true => can.push(format!("{serves} ({name})")),
            false => dropped.push(format!("{serves}: no {name}; {}", capability.fallback())),
        }
    }
    relief::report(&device_limits(&limits), &mut can, &mut dropped);
    match adapter.features().contains(super::GpuTimer::FEATURES) {
        true => can.push("times of its own passes (terrella bench)".into()),
        false => dropped.push("times of its own passes: terrella bench leaves gpu_ms empty".into()),
    }
    if software {
        dropped.push("anisotropic filtering: a software adapter pays for every sample; maps are filtered trilinearly".into());
    } else {
        can.push("anisotropic filtering, 8 samples".into());
    }
    AdapterReport {
        name: info.name.clone(),
        backend: info.backend.to_string(),
        kind: match info.device_type {
            wgpu::DeviceType::DiscreteGpu => "discrete",
            wgpu::DeviceType::IntegratedGpu => "integrated",
            wgpu::DeviceType::VirtualGpu => "virtual",
            wgpu::DeviceType::Cpu => "software",
            wgpu::DeviceType::Other => "other",
        }
        .into(),
        driver: format!("{} {}", info.driver, info.driver_info)
            .trim()
            .to_owned(),
        can,
        dropped,
        chosen: false,
    }
}
