//! Variants of the shader that draws a picture over a larger target.

use super::variant::{SWITCH, ShaderVariant};

/// What the shader of an enlarged picture is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct UpscaleVariant {
    /// Whether the formats hold display values that the hardware neither decodes nor encodes.
    pub display: bool,
}

impl ShaderVariant for UpscaleVariant {
    const ENTRY: &'static str = "upscale.wgsl";

    fn all() -> Vec<Self> {
        SWITCH.map(|display| Self { display }).to_vec()
    }

    fn conditions(&self) -> Vec<(&'static str, bool)> {
        vec![("display", self.display)]
    }
}
