//! Variants of the shader that develops exposed light.

use super::variant::{SWITCH, ShaderVariant, TargetColor};
use terrella_ground::light::Tone;

/// How light is read, and what is shown of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct DevelopVariant {
    /// What the target stores. Of a measured response it has the tone [`Tone::Linear`].
    pub target: TargetColor,
    /// The target is larger: light is blended by a sampler.
    pub sampled: bool,
    /// The tone curve is a measured response.
    pub measured: bool,
}

impl DevelopVariant {
    /// For a target of this kind.
    pub fn new(target: TargetColor, sampled: bool) -> Self {
        let measured = target.tone().and_then(Tone::response).is_some();
        let target = match target {
            TargetColor::Linear(_) if measured => TargetColor::Linear(Tone::Linear),
            TargetColor::Display(_) if measured => TargetColor::Display(Tone::Linear),
            other => other,
        };
        Self {
            target,
            sampled,
            measured,
        }
    }
}

impl ShaderVariant for DevelopVariant {
    const ENTRY: &'static str = "develop.wgsl";

    fn all() -> Vec<Self> {
        let shown = TargetColor::all().into_iter();
        let shown = shown.filter(|target| target.tone().is_some());
        let all = shown.flat_map(|target| SWITCH.map(|sampled| Self::new(target, sampled)));
        let all: Vec<_> = all.collect();
        let measured = all
            .iter()
            .filter(|variant| variant.target.tone() == Some(Tone::Linear));
        let measured = measured.map(|variant| Self {
            measured: true,
            ..*variant
        });
        all.iter().copied().chain(measured).collect()
    }

    fn conditions(&self) -> Vec<(&'static str, bool)> {
        let mut conditions = vec![("sampled", self.sampled), ("measured", self.measured)];
        conditions.extend(self.target.conditions());
        conditions
    }
}
