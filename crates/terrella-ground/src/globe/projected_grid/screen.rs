//! The plane that the grid is ruled on: the image, extended on all sides to directions behind the eye.

use crate::globe::culling::Frustum;
use glam::{DMat4, DVec2, DVec3};
use std::f64::consts::PI;

/// Rays through an image of any perspective projection whose centre is the eye.
///
/// Coordinates are those of clip space, x/w and y/w: the image is −1…1. Ground beside or behind the eye is not in the image, but it may
/// rise into it. Outside the circle about the image's corners, a step therefore turns the ray by as much as in the middle, up to straight
/// back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScreenPlane {
    /// Unit vector along which w grows, ITRF axes.
    pub forward: DVec3,
    /// Ray through (0, 0), with component 1 along `forward`.
    pub middle: DVec3,
    /// Change of the ray with x, perpendicular to `forward`.
    pub right: DVec3,
    /// Change of the ray with y.
    pub up: DVec3,
    /// Distance of the farthest corner from the point straight ahead.
    pub corner: f64,
    /// atan [`Self::corner`].
    pub corner_rad: f64,
    /// Solid angle of a unit of the plane's area straight ahead, steradians.
    pub area: f64,
    /// Whether the image is mirrored.
    pub mirrored: bool,
    /// (x, y) of clip space from a ray with component 1 along `forward`.
    rows: [DVec3; 2],
    frustum: Frustum,
}

impl ScreenPlane {
    /// The plane of a matrix from eye-relative ITRF metres to clip space; `None` if the matrix has no centre or is not finite.
    ///
    /// Depth is not used. The ray of (x, y) is in the planes x_clip = x w and y_clip = y w. Their normals are r_x − x r_w and r_y − y r_w
    /// with r the matrix' rows. Their cross product is r_x × r_y + x (r_y × r_w) + y (r_w × r_x), and w along it is the determinant of the
    /// three.
    pub fn new(clip_from_eye: &DMat4) -> Option<Self> {
        let row = |k: usize| clip_from_eye.row(k).truncate();
        let (x, y, w) = (row(0), row(1), row(3));
        let slope = w.length();
        let determinant = x.cross(y).dot(w);
        let scale = slope / determinant;
        let forward = w / slope;
        let middle = x.cross(y) * scale;
        let right = y.cross(w) * scale;
        let up = w.cross(x) * scale;
        let usable = forward.is_finite() && (middle + right + up).is_finite();
        if !usable || right.length() == 0.0 || up.length() == 0.0 {
            return None;
        }
        let ahead = middle - forward;
        let corner = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)]
            .map(|(x, y)| (ahead + right * x + up * y).length())
            .into_iter()
            .fold(0.0, f64::max);
        Some(Self {
            forward,
            middle,
            right,
            up,
            area: right.cross(up).length(),
            corner,
            corner_rad: corner.atan(),
            // Axes with x to the right, y upwards and w ahead are left-handed.
            mirrored: determinant > 0.0,
            rows: [x, y].map(|row| row / slope),
            frustum: Frustum::new(clip_from_eye).without_depth(),
        })
    }

    /// Unit direction of a point of the plane, ITRF axes.
    pub fn direction(&self, at: DVec2) -> DVec3 {
        self.ray(at).0
    }

    /// [`Self::direction`], and the solid angle of a unit of the plane's area there, steradians.
    pub fn ray(&self, at: DVec2) -> (DVec3, f64) {
        let aside = self.middle - self.forward + self.right * at.x + self.up * at.y;
        let square = aside.length_squared();
        if square <= self.corner * self.corner {
            let part = 1.0 / (1.0 + square);
            let root = part.sqrt();
            return ((self.forward + aside) * root, self.area * part * root);
        }
        let q = square.sqrt();
        let angle = (self.corner_rad + q - self.corner).min(PI);
        let (sin, cos) = angle.sin_cos();
        // Beside and behind the eye rows converge; a sample there covers no less than at the side.
        let part = if angle < 0.5 * PI { sin } else { 1.0 } / q;
        (self.forward * cos + aside * (sin / q), self.area * part)
    }

    /// The point of the plane with this direction; the inverse of [`Self::direction`].
    pub fn place_of(&self, direction: DVec3) -> DVec2 {
        let ahead = self.forward.dot(direction);
        let aside = direction - self.forward * ahead;
        let sin = aside.length();
        let angle = sin.atan2(ahead);
        let q = if angle <= self.corner_rad {
            sin / ahead
        } else {
            self.corner + angle - self.corner_rad
        };
        let aside = if sin > 0.0 {
            aside / sin
        } else {
            self.right.normalize()
        };
        let [x, y] = self.rows;
        let ray = self.forward + aside * q;
        DVec2::new(x.dot(ray), y.dot(ray))
    }

    /// Inward unit normals of planes through the eye that bound the image: its four sides, and the plane across the view, which the sides
    /// of a narrow image hardly determine.
    pub fn sides(&self) -> [DVec3; 5] {
        let [left, right, bottom, top] = self.frustum.side_normals();
        [self.forward, right, left, top, bottom]
    }
}
