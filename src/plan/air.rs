//! The air of a frame.

use super::{AuroraUniforms, GlowUniforms};
use glam::DVec3;
use terrella_ground::air::Billboard;

/// Side of the air's upper boundary that the eye is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AirSide {
    /// Above it: shaders sample tables for rays from space.
    Outside,
    /// Inside the air: shaders sample the sky view, an image of the air in each direction, which `AirViewVariant` draws.
    Inside,
}

impl AirSide {
    /// Both sides.
    pub const ALL: [Self; 2] = [Self::Outside, Self::Inside];

    /// No air, and both sides of the air.
    pub const OR_NONE: [Option<Self>; 3] = [None, Some(Self::Outside), Some(Self::Inside)];

    /// The sides that are drawn, with or without air.
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
    /// The ellipsoid's normal at the eye.
    pub eye_up: DVec3,
    /// Uniforms of airglow; `None` if it is not drawn or not in sight.
    pub glow: Option<GlowUniforms>,
    /// Uniforms of the aurora; `None` if it is not drawn or not in sight.
    pub aurora: Option<AuroraUniforms>,
}

impl AirPlan {
    /// The side that the eye is on.
    pub fn side(&self) -> AirSide {
        match self.ring.is_inside() {
            true => AirSide::Inside,
            false => AirSide::Outside,
        }
    }
}
