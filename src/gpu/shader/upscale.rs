//! Variants of the shader that draws a picture over a larger target.

use super::variant::ShaderVariant;

/// How the shader of an enlarged picture reads its texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum UpscaleVariant {
    /// Through a sampler that blends them: formats that the hardware filters and, where they are sRGB, decodes.
    Sampled,
    /// One by one: formats that are not filtered.
    Loaded,
    /// The same of display values that the hardware neither decodes nor encodes.
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
