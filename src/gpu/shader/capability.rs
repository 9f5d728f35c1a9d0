//! What shaders need of a device beyond what every device has.

/// A capability that WebGL 2, the least of all devices, lacks and some shaders need. `terrella doctor` names it for each adapter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ShaderCapability {
    /// Storage buffers in the fragment stage: nodes of contours that rays are cast at.
    StorageBuffers,
}

impl ShaderCapability {
    pub const ALL: [Self; 1] = [Self::StorageBuffers];

    /// Whether a device of these limits has it.
    pub fn is_met(self, limits: &wgpu::Limits) -> bool {
        match self {
            Self::StorageBuffers => limits.max_storage_buffers_per_shader_stage > 0,
        }
    }

    /// What it is, in the words of graphics APIs.
    pub fn name(self) -> &'static str {
        match self {
            Self::StorageBuffers => "storage buffers in fragment shaders",
        }
    }

    /// What is drawn by it, as messages name it.
    pub fn serves(self) -> &'static str {
        match self {
            Self::StorageBuffers => "contours by casting rays",
        }
    }

    /// What is done without it.
    pub fn fallback(self) -> &'static str {
        match self {
            Self::StorageBuffers => "contours are drawn as patches",
        }
    }
}
