//! A view that terrain surfaces use for culling and for choosing levels of detail.

use super::{Containment, Frustum, GroundShell, Horizon};
use crate::globe::surface::GroundView;
use crate::height::HeightRange;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};
use terrella_frames::Ellipsoid;

/// A ball that contains a piece of ground and the terrain drawn for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundBound {
    /// Centre of the ball, ITRF metres.
    pub center_itrf_m: DVec3,
    pub radius_m: f64,
    /// Upper bound of the ground's height above the ellipsoid, metres.
    pub high_m: f64,
}

/// A cone that contains the normals of all faces in a bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalCone {
    /// A unit vector, or zero where the half-angle is π.
    pub axis: DVec3,
    /// Largest angle between a normal and the axis, radians.
    pub half_angle_rad: f64,
}

impl NormalCone {
    /// The cone of faces with any orientation.
    pub const ALL: Self = Self {
        axis: DVec3::ZERO,
        half_angle_rad: PI,
    };
}

/// Visibility of a bound in a view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoundVisibility {
    /// The whole bound is inside the frustum.
    Inside,
    /// A part of the bound may be inside.
    Intersecting,
    /// Not visible, but visible if the eye turned to it.
    OutsideFrustum,
    /// Not visible, even if the eye turned to it.
    BehindHorizon,
}

impl BoundVisibility {
    /// Whether any part may be visible.
    pub fn is_visible(self) -> bool {
        matches!(self, Self::Inside | Self::Intersecting)
    }
}

/// A view that surfaces use for culling and for choosing levels of detail.
#[derive(Clone, Copy, Debug)]
pub struct CullingContext {
    pub eye_itrf_m: DVec3,
    /// Angle of a pixel in the middle of the image, radians.
    pub pixel_rad: f64,
    /// Height above the ellipsoid, metres.
    eye_height_m: f64,
    frustum: Frustum,
    horizon: Horizon,
}

impl CullingContext {
    /// A view of ground between these heights. No drawn terrain may be lower, or the horizon would hide ground that is visible over it.
    pub fn new(view: &GroundView, ellipsoid: &Ellipsoid, drawn: HeightRange) -> Self {
        let shell = GroundShell::new(ellipsoid, drawn);
        Self {
            eye_itrf_m: view.eye_itrf_m,
            pixel_rad: view.pixel_rad,
            eye_height_m: ellipsoid.geodetic_from_itrf(view.eye_itrf_m).height_m,
            frustum: Frustum::new(&view.clip_from_eye),
            horizon: Horizon::new(ellipsoid, view.eye_itrf_m, shell),
        }
    }

    /// The same for geometry that is not clipped by depth: only the frustum's four sides count.
    pub fn without_depth(self) -> Self {
        Self {
            frustum: self.frustum.without_depth(),
            ..self
        }
    }

    /// Distance from the eye to a bound, metres; negative or zero from inside. It is the larger of the distance to the ball and the eye's
    /// height above the highest ground. A large ball may contain an eye that is kilometres above its ground.
    pub fn distance_m(&self, bound: &GroundBound) -> f64 {
        let center_m = bound.center_itrf_m.distance(self.eye_itrf_m);
        (center_m - bound.radius_m).max(self.eye_height_m - bound.high_m)
    }

    /// Whether a bound is behind the horizon.
    pub fn is_behind_horizon(&self, bound: &GroundBound) -> bool {
        let (center_itrf_m, radius_m) = (bound.center_itrf_m, bound.radius_m);
        self.horizon
            .hides_ball(center_itrf_m, radius_m, bound.high_m)
    }

    /// Visibility of a bound.
    pub fn visibility(&self, bound: &GroundBound) -> BoundVisibility {
        let (center_itrf_m, radius_m) = (bound.center_itrf_m, bound.radius_m);
        if self.is_behind_horizon(bound) {
            return BoundVisibility::BehindHorizon;
        }
        match self
            .frustum
            .classify_ball(center_itrf_m - self.eye_itrf_m, radius_m)
        {
            Containment::Inside => BoundVisibility::Inside,
            Containment::Intersecting => BoundVisibility::Intersecting,
            Containment::Outside => BoundVisibility::OutsideFrustum,
        }
    }

    /// Whether every face in a bound faces away from the eye.
    pub fn is_backfacing(&self, bound: &GroundBound, normals: &NormalCone) -> bool {
        let to_eye = self.eye_itrf_m - bound.center_itrf_m;
        let distance_m = to_eye.length();
        if distance_m <= bound.radius_m {
            return false;
        }
        let angle = (to_eye.dot(normals.axis) / distance_m)
            .clamp(-1.0, 1.0)
            .acos();
        // normal · (eye − point) < 0, for the least tilted normal and the most favourable point.
        let slack = normals.half_angle_rad + (bound.radius_m / distance_m).asin();
        angle - slack > FRAC_PI_2 + 1e-6
    }
}
