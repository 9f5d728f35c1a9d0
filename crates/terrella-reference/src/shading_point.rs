//! Properties of a ground point that its light depends on.

use glam::{DVec2, DVec3};

/// A place on the ground and where it is seen from.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShadingPoint {
    /// Outward normal of the ellipsoid, a unit vector in ITRF axes.
    pub up: DVec3,
    /// Towards the eye, a unit vector.
    pub to_eye: DVec3,
    /// Rise of terrain to the east and to the north, metres per metre.
    pub slope: Option<DVec2>,
}
