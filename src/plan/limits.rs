//! Limits of a device.

/// The limits of a device that determine how terrain is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DeviceLimits {
    /// Longest side of a texture, texels.
    pub texture_side: u32,
    /// Largest uniform binding, bytes.
    pub uniform_bytes: u64,
    /// Largest storage buffer for fragment shaders, bytes; 0 if they cannot read any.
    pub storage_bytes: u64,
    /// Bindings in a bind group.
    pub bindings: u32,
}
