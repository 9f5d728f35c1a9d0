//! Variants of the shader that scatters light.

use super::variant::ShaderVariant;

/// What is drawn of a picture of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum BloomVariant {
    /// Half its size.
    Coarser,
    /// The same of the light itself, whose brightest is cut off.
    CoarserLight,
    /// Twice its size.
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
