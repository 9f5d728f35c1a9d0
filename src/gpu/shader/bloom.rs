//! Variants of the bloom shader.

use super::variant::ShaderVariant;

/// The step of the bloom.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum BloomVariant {
    /// Downsamples to half the size.
    Coarser,
    /// Downsamples the light itself, with its brightest values clamped.
    CoarserLight,
    /// Upsamples to twice the size.
    Finer,
}

impl ShaderVariant for BloomVariant {
    const ENTRY: &'static str = "bloom.wgsl";

    fn all() -> Vec<Self> {
        vec![Self::Coarser, Self::CoarserLight, Self::Finer]
    }

    fn conditions(&self) -> Vec<(&'static str, bool)> {
        vec![
            ("coarser", *self != Self::Finer),
            ("light", *self == Self::CoarserLight),
        ]
    }
}
