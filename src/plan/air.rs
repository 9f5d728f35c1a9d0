//! The air of a frame.

use super::{AuroraUniforms, GlowUniforms};
use glam::DVec3;
use terrella_ground::air::Billboard;

/// Where the eye is that looks through the air.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AirSide {
    /// Above its upper boundary: shaders look into tables of rays that come from space.
    Outside,
    /// In it: shaders look into a picture of what the eye sees in each direction, which `AirViewVariant` draws.
    Inside,
}

impl AirSide {
    /// Both sides.
    pub const ALL: [Self; 2] = [Self::Outside, Self::Inside];

    /// No air, and the air on both sides.
    pub const OR_NONE: [Option<Self>; 3] = [None, Some(Self::Outside), Some(Self::Inside)];

    /// Those that something is drawn from, in air or without.
    pub(crate) fn of_air(has_air: bool) -> &'static [Option<Self>] {
        match has_air {
            true => &Self::OR_NONE[1..],
            false => &Self::OR_NONE[..1],
        }
    }
}

/// How the air of a frame is drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AirPlan {
    pub ring: Billboard,
    /// The normal of the ellipsoid at the eye.
    pub eye_up: DVec3,
    /// What shaders read of its own light; `None` where none is drawn, or none is in sight.
    pub glow: Option<GlowUniforms>,
    /// The same of the aurora.
    pub aurora: Option<AuroraUniforms>,
}

impl AirPlan {
    /// Where the eye is.
    pub fn side(&self) -> AirSide {
        match self.ring.is_inside() {
            true => AirSide::Inside,
            false => AirSide::Outside,
        }
    }
}
