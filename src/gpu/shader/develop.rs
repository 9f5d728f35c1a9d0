//! Variants of the shader that develops exposed light.

use super::variant::{SWITCH, ShaderVariant, TargetColor};

/// How light is read, and what is shown of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct DevelopVariant {
    /// What the target stores.
    pub target: TargetColor,
    /// The target is larger: light is blended by a sampler.
    pub sampled: bool,
}

impl ShaderVariant for DevelopVariant {
    const ENTRY: &'static str = "develop.wgsl";

    fn all() -> Vec<Self> {
        let shown = TargetColor::all().into_iter();
        let shown = shown.filter(|target| target.tone().is_some());
        shown
            .flat_map(|target| SWITCH.map(|sampled| Self { target, sampled }))
            .collect()
    }

    fn conditions(&self) -> Vec<(&'static str, bool)> {
        let mut conditions = vec![("sampled", self.sampled)];
        conditions.extend(self.target.conditions());
        conditions
    }
}
