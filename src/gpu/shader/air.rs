//! Variants of the shaders of the air.

use super::variant::{SWITCH, ShaderVariant, TargetColor};
use crate::plan::AirSide;

/// Variant of the halo's shader.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct AirVariant {
    /// Side of the air that the eye is on.
    pub side: AirSide,
    /// Whether moonlight is scattered too.
    pub moonlight: bool,
    /// Whether the Moon is in front of the Sun.
    pub eclipse: bool,
    /// What the target stores.
    pub target: TargetColor,
}

impl ShaderVariant for AirVariant {
    const ENTRY: &'static str = "air.wgsl";

    fn all() -> Vec<Self> {
        let mut all = Vec::new();
        for side in AirSide::ALL {
            for moonlight in SWITCH {
                for eclipse in SWITCH.into_iter().filter(|on| !on || !moonlight) {
                    all.extend(TargetColor::all().into_iter().map(|target| Self {
                        side,
                        moonlight,
                        eclipse,
                        target,
                    }));
                }
            }
        }
        all
    }

    fn conditions(&self) -> Vec<(&'static str, bool)> {
        let mut conditions = vec![
            ("inside", self.side == AirSide::Inside),
            ("moonlight", self.moonlight),
            ("eclipse", self.eclipse),
        ];
        conditions.extend(self.target.conditions());
        conditions
    }
}

/// Variant of the shader of airglow and aurora.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct GlowVariant {
    /// Side of the air that the eye is on.
    pub side: AirSide,
    /// Whether the airglow is drawn.
    pub airglow: bool,
    /// Whether the aurora is drawn.
    pub aurora: bool,
    /// What the target stores.
    pub target: TargetColor,
}

impl ShaderVariant for GlowVariant {
    const ENTRY: &'static str = "glow.wgsl";

    fn all() -> Vec<Self> {
        let mut all = Vec::new();
        for side in AirSide::ALL {
            for (airglow, aurora) in [(true, false), (true, true), (false, true)] {
                all.extend(TargetColor::USUAL.map(|target| Self {
                    side,
                    airglow,
                    aurora,
                    target,
                }));
            }
        }
        all
    }

    fn conditions(&self) -> Vec<(&'static str, bool)> {
        let mut conditions = vec![
            ("inside", self.side == AirSide::Inside),
            // It reads only light through the air, not light scattered in it.
            ("moonlight", false),
            ("airglow", self.airglow),
            ("aurora", self.aurora),
        ];
        conditions.extend(self.target.conditions());
        conditions
    }
}

/// The shader of the sky view for an eye in the air.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct AirViewVariant {
    /// Whether it also draws the view under the Moon, in rows below those under the Sun.
    pub moonlight: bool,
}

impl ShaderVariant for AirViewVariant {
    const ENTRY: &'static str = "air_view.wgsl";

    fn all() -> Vec<Self> {
        SWITCH.map(|moonlight| Self { moonlight }).to_vec()
    }

    fn conditions(&self) -> Vec<(&'static str, bool)> {
        vec![("moonlight", self.moonlight)]
    }
}
