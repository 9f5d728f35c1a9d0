//! Variants of the shader that develops exposed light.

use super::variant::{SWITCH, ShaderVariant, TargetColor};
use terrella_ground::light::{Grade, Tone};

/// How light is read and developed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct DevelopVariant {
    /// Content of the target. For a measured response its tone is [`Tone::Linear`].
    pub target: TargetColor,
    /// The target is larger than the light texture, which a sampler filters.
    pub sampled: bool,
    /// The tone curve is a measured response.
    pub measured: bool,
    /// There is a white balance.
    pub balanced: bool,
    /// There is grain.
    pub grained: bool,
}

impl DevelopVariant {
    /// For a target of this kind.
    pub fn new(target: TargetColor, sampled: bool, grade: &Grade) -> Self {
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
            balanced: grade.white_balance.is_some(),
            grained: grade.grain.strength > 0.0,
        }
    }

    /// Whether it reads uniforms of its grade.
    pub fn is_graded(&self) -> bool {
        self.balanced || self.grained
    }
}

impl ShaderVariant for DevelopVariant {
    const ENTRY: &'static str = "develop.wgsl";

    fn all() -> Vec<Self> {
        let shown = TargetColor::all().into_iter();
        let shown = shown.filter(|target| target.tone().is_some());
        let all =
            shown.flat_map(|target| SWITCH.map(|sampled| Self::new(target, sampled, &Grade::NONE)));
        let all: Vec<_> = all.collect();
        // The rest of the text does not depend on the tone curve.
        let straight = all.iter();
        let straight = straight.filter(|variant| variant.target.tone() == Some(Tone::Linear));
        let more = straight.flat_map(|variant| {
            // One bit for each; the variant without any of them is already listed.
            (1..8).map(|bits| Self {
                measured: bits & 1 != 0,
                balanced: bits & 2 != 0,
                grained: bits & 4 != 0,
                ..*variant
            })
        });
        all.iter().copied().chain(more).collect()
    }

    fn conditions(&self) -> Vec<(&'static str, bool)> {
        let mut conditions = vec![
            ("sampled", self.sampled),
            ("measured", self.measured),
            ("balanced", self.balanced),
            ("grained", self.grained),
            ("graded", self.is_graded()),
        ];
        conditions.extend(self.target.conditions());
        conditions
    }
}
