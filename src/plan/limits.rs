//! What a device allows.

/// What a device allows, as far as it decides in what form terrain is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DeviceLimits {
    /// Longest side of a texture, texels.
    pub texture_side: u32,
    /// Most bytes of uniforms in a binding.
    pub uniform_bytes: u64,
    /// Most bytes of a storage buffer that fragment shaders read; 0 where they read none.
    pub storage_bytes: u64,
    /// Bindings in a bind group.
    pub bindings: u32,
}
