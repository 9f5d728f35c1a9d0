//! Variants of the shaders of the air.

use super::variant::{ShaderVariant, TargetColor};

/// Where the eye is that looks through the air.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AirSide {
    /// Above its upper boundary: shaders look into tables of rays that come from space.
    Outside,
    /// In it: shaders look into a picture of what the eye sees in each direction, which [`AirViewVariant`] draws.
    Inside,
}

impl AirSide {
    /// Both sides.
    pub const ALL: [Self; 2] = [Self::Outside, Self::Inside];

    /// No air, and the air on both sides.
    pub const OR_NONE: [Option<Self>; 3] = [None, Some(Self::Outside), Some(Self::Inside)];
}

/// What the halo's shader is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct AirVariant {
    /// Where the eye is.
    pub side: AirSide,
    /// What the target stores.
    pub target: TargetColor,
}

impl ShaderVariant for AirVariant {
    const ENTRY: &'static str = "air.wgsl";

    fn all() -> Vec<Self> {
        let of_side = |side| {
            TargetColor::all()
                .into_iter()
                .map(move |target| Self { side, target })
        };
        AirSide::ALL.into_iter().flat_map(of_side).collect()
    }

    fn conditions(&self) -> Vec<(&'static str, bool)> {
        let mut conditions = vec![("inside", self.side == AirSide::Inside)];
        conditions.extend(self.target.conditions());
        conditions
    }
}

/// The shader that draws what an eye in the air sees of it in each direction. There is one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct AirViewVariant;

impl ShaderVariant for AirViewVariant {
    const ENTRY: &'static str = "air_view.wgsl";

    fn all() -> Vec<Self> {
        vec![Self]
    }

    fn conditions(&self) -> Vec<(&'static str, bool)> {
        Vec::new()
    }
}
