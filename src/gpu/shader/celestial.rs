//! Variants of the shader of what is beyond the Earth.

use super::variant::{SWITCH, ShaderVariant, TargetColor};
use crate::plan::AirSide;

/// What a shader of stars, Sun and Moon is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct CelestialVariant {
    /// What it draws.
    pub kind: CelestialKind,
    /// What the target stores.
    pub target: TargetColor,
    /// The air before it, and where the eye is.
    pub air: Option<AirSide>,
    /// Of glare: with the diffraction pattern of an aperture.
    pub aperture: bool,
}

impl CelestialVariant {
    /// `has_map` where a texture is bound: of glare it is the pattern of an aperture.
    pub fn new(
        kind: CelestialKind,
        has_map: bool,
        target: TargetColor,
        air: Option<AirSide>,
    ) -> Self {
        Self {
            kind,
            target,
            air,
            aperture: has_map && kind == CelestialKind::Glare,
        }
    }
}

/// What is beyond the Earth, each with a shader of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum CelestialKind {
    /// The light of faint stars.
    MilkyWay,
    /// Stars, and Sun and Moon where they are as small.
    Stars,
    /// The Sun's disc.
    Sun,
    Moon,
    /// The Sun's light in the lens.
    Glare,
    /// Images of the aperture that reflections in the lens make of the Sun.
    Ghosts,
}

impl CelestialKind {
    /// All of them, in the order in which they are drawn.
    pub const ALL: [Self; 6] = [
        Self::MilkyWay,
        Self::Stars,
        Self::Sun,
        Self::Moon,
        Self::Glare,
        Self::Ghosts,
    ];

    /// As shaders and labels call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::MilkyWay => "milky_way",
            Self::Stars => "stars",
            Self::Sun => "sun",
            Self::Moon => "moon",
            Self::Glare => "glare",
            Self::Ghosts => "ghosts",
        }
    }
}

impl ShaderVariant for CelestialVariant {
    const ENTRY: &'static str = "celestial.wgsl";

    fn all() -> Vec<Self> {
        let mut all = Vec::new();
        for kind in CelestialKind::ALL {
            for air in AirSide::OR_NONE {
                for has_map in SWITCH {
                    let variants = TargetColor::USUAL.into_iter();
                    let variants = variants.map(|target| Self::new(kind, has_map, target, air));
                    // Others have a map always or never.
                    let is_own = !has_map || kind == CelestialKind::Glare;
                    all.extend(variants.filter(|_| is_own));
                }
            }
        }
        all
    }

    fn conditions(&self) -> Vec<(&'static str, bool)> {
        let mut conditions = vec![
            (
                "map",
                matches!(self.kind, CelestialKind::MilkyWay | CelestialKind::Moon) || self.aperture,
            ),
            ("aperture", self.aperture),
            ("air", self.air.is_some()),
            ("inside", self.air == Some(AirSide::Inside)),
            // Of light through the air, not of light in it.
            ("moonlight", false),
        ];
        conditions.extend(CelestialKind::ALL.map(|kind| (kind.name(), kind == self.kind)));
        conditions.extend(self.target.conditions());
        conditions
    }
}
