//! Device capabilities that shaders need beyond the minimum of every device.

/// A capability that some shaders need and that WebGL 2, the most limited device, lacks. `terrella doctor` names it for each adapter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ShaderCapability {
    /// Storage buffers in the fragment stage: the nodes of contours for ray casting.
    StorageBuffers,
}

impl ShaderCapability {
    pub const ALL: [Self; 1] = [Self::StorageBuffers];

    /// Whether a device with these limits has it.
    pub fn is_met(self, limits: &wgpu::Limits) -> bool {
        match self {
            Self::StorageBuffers => limits.max_storage_buffers_per_shader_stage > 0,
        }
    }

    /// Its name in graphics APIs.
    pub fn name(self) -> &'static str {
        match self {
            Self::StorageBuffers => "storage buffers in fragment shaders",
        }
    }

    /// The feature that depends on it, as messages name it.
    pub fn serves(self) -> &'static str {
        match self {
            Self::StorageBuffers => "contours by casting rays",
        }
    }

    /// What happens without it.
    pub fn fallback(self) -> &'static str {
        match self {
            Self::StorageBuffers => "contours are drawn as patches",
        }
    }
}
