//! The view frustum as clip planes.

use super::horizon::GroundShell;
use super::rect::ScaledRect;
use glam::{DMat4, DVec3, DVec4};
use terrella_frames::Ellipsoid;

/// How much of a bound is inside a volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Containment {
    /// The whole bound.
    Inside,
    /// Possibly a part.
    Intersecting,
    /// No part of the bound.
    Outside,
}

/// The view frustum: six planes (normal, offset) with unit normals, in the space that the matrix transforms from. A point is inside where
/// n·x + w ≥ 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frustum {
    /// Left, right, bottom, top, then the two depth planes.
    planes: [DVec4; 6],
}

/// A plane at infinity: every bound is inside, however large.
const AT_INFINITY: DVec4 = DVec4::new(0.0, 0.0, 0.0, f64::INFINITY);

impl Frustum {
    /// The frustum of clip space −w ≤ x, y ≤ w, 0 ≤ z ≤ w: sums and differences of the matrix' rows (Gribb and Hartmann 2001).
    ///
    /// A plane at infinity clips nothing; most projections have one in depth. A plane that is not finite clips nothing either.
    pub fn new(clip_from_source: &DMat4) -> Self {
        let [x, y, z, w] = [0, 1, 2, 3].map(|i| clip_from_source.row(i));
        let planes = [w + x, w - x, w + y, w - y, z, w - z].map(|plane| {
            let length = plane.truncate().length();
            let unit = plane / length;
            match length > 0.0 && unit.is_finite() {
                true => unit,
                false => AT_INFINITY,
            }
        });
        Self { planes }
    }

    /// The four sides alone, for geometry that is not clipped by depth.
    pub fn without_depth(self) -> Self {
        let [left, right, bottom, top, ..] = self.planes;
        Self {
            planes: [left, right, bottom, top, AT_INFINITY, AT_INFINITY],
        }
    }

    /// Inward unit normals of the left, right, bottom and top side; zero for a side at infinity.
    pub fn side_normals(&self) -> [DVec3; 4] {
        let [left, right, bottom, top, ..] = self.planes;
        [left, right, bottom, top].map(DVec4::truncate)
    }

    /// How much of a ball is inside. Never [`Containment::Outside`] if a point of it is inside.
    pub fn classify_ball(&self, center: DVec3, radius: f64) -> Containment {
        let mut containment = Containment::Inside;
        for plane in &self.planes {
            let inside = plane.truncate().dot(center) + plane.w;
            if inside < -radius {
                return Containment::Outside;
            }
            if inside < radius {
                containment = Containment::Intersecting;
            }
        }
        containment
    }

    /// Whether a ball is wholly outside one of the planes.
    pub fn excludes_ball(&self, center: DVec3, radius: f64) -> bool {
        self.classify_ball(center, radius) == Containment::Outside
    }

    /// Converts a frustum in eye-relative coordinates to scaled space, from the Earth's centre.
    pub fn scaled(&self, ellipsoid: &Ellipsoid, eye_itrf_m: DVec3) -> ScaledFrustum {
        let itrf_from_scaled = ellipsoid.itrf_from_scaled();
        ScaledFrustum {
            planes: self.planes.map(|plane| {
                let normal = plane.truncate();
                (normal * itrf_from_scaled).extend(plane.w - normal.dot(eye_itrf_m))
            }),
        }
    }
}

/// A [`Frustum`] in scaled space, from the Earth's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScaledFrustum {
    planes: [DVec4; 6],
}

impl ScaledFrustum {
    /// Whether all ground of a shell with feet in the rectangle is outside one of the planes.
    pub fn excludes_rect(&self, rect: &ScaledRect, shell: &GroundShell) -> bool {
        self.planes.iter().any(|plane| {
            let normal = plane.truncate();
            let most = rect.max_dot(normal) + shell.lean * normal.length();
            (shell.lowest * most).max(shell.highest * most) + plane.w < 0.0
        })
    }
}
