//! Variants of the air's shader.

use super::variant::{SWITCH, ShaderVariant, TargetColor};

/// What the air's shader is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct AirVariant {
    /// Whether the eye is in the air: then the shader marches along the ray instead of reading the table of rays from outside.
    pub is_inside: bool,
    /// The depth that it writes, if the pass has depths.
    pub depth: AirDepth,
    /// What the target stores.
    pub target: TargetColor,
}

/// The depth that the air writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AirDepth {
    /// None: the pass has no depth buffer.
    None,
    /// Nearer is larger.
    ReversedZ,
    /// Nearer is smaller.
    StandardZ,
}

impl ShaderVariant for AirVariant {
    const ENTRY: &'static str = "air.wgsl";

    fn all() -> Vec<Self> {
        let mut all = Vec::new();
        for is_inside in SWITCH {
            for depth in [AirDepth::None, AirDepth::ReversedZ, AirDepth::StandardZ] {
                all.extend(TargetColor::ALL.map(|target| Self {
                    is_inside,
                    depth,
                    target,
                }));
            }
        }
        all
    }

    fn conditions(&self) -> Vec<(&'static str, bool)> {
        vec![
            ("inside", self.is_inside),
            ("depth", self.depth != AirDepth::None),
            ("standard_z", self.depth == AirDepth::StandardZ),
            ("encode", self.target == TargetColor::Display),
        ]
    }
}
