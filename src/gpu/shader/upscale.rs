//! Variants of the shader that draws an image over a larger target.

use super::variant::ShaderVariant;

/// How the upscaling shader reads texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum UpscaleVariant {
    /// With a filtering sampler: formats that the hardware can filter and, if they are sRGB, decodes.
    Sampled,
    /// One by one: formats that cannot be filtered.
    Loaded,
    /// One by one, as display values that the hardware neither decodes nor encodes.
    LoadedDisplay,
}

impl ShaderVariant for UpscaleVariant {
    const ENTRY: &'static str = "upscale.wgsl";

    fn all() -> Vec<Self> {
        vec![Self::Sampled, Self::Loaded, Self::LoadedDisplay]
    }

    fn conditions(&self) -> Vec<(&'static str, bool)> {
        vec![
            ("sampled", *self == Self::Sampled),
            ("display", *self == Self::LoadedDisplay),
        ]
    }
}
