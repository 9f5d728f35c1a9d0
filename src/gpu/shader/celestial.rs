//! Variants of the shader of stars, Milky Way, Sun and Moon.

use super::variant::{SWITCH, ShaderVariant, TargetColor};
use crate::plan::AirSide;

/// Variant of the shader of celestial objects.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct CelestialVariant {
    /// What it draws.
    pub kind: CelestialKind,
    /// What the target stores.
    pub target: TargetColor,
    /// The side of the air that the eye is on; `None` without air.
    pub air: Option<AirSide>,
    /// For glare: with the diffraction pattern of an aperture.
    pub aperture: bool,
}

impl CelestialVariant {
    /// `has_map` if a texture is bound; for glare it is the diffraction pattern of an aperture.
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

/// A kind of celestial object, each with its own shader.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum CelestialKind {
    /// The light of unresolved stars.
    MilkyWay,
    /// Stars, and Sun and Moon when they are point-like.
    Stars,
    /// The Sun's disc.
    Sun,
    Moon,
    /// Glare of the Sun in the lens.
    Glare,
    /// Lens ghosts: images of the aperture by reflected sunlight.
    Ghosts,
}

impl CelestialKind {
    /// All kinds, in drawing order.
    pub const ALL: [Self; 6] = [
        Self::MilkyWay,
        Self::Stars,
        Self::Sun,
        Self::Moon,
        Self::Glare,
        Self::Ghosts,
    ];

    /// Its name in shaders and labels.
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
                    // Other kinds always or never have a map.
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
            // It reads only light through the air, not light scattered in it.
            ("moonlight", false),
        ];
        conditions.extend(CelestialKind::ALL.map(|kind| (kind.name(), kind == self.kind)));
        conditions.extend(self.target.conditions());
        conditions
    }
}
