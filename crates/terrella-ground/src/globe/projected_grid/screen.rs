//! The plane that the grid is ruled on: the picture, continued on all sides as far as behind the eye.

use crate::globe::culling::Frustum;
use glam::{DMat4, DVec2, DVec3};
use std::f64::consts::PI;

/// Rays through a picture of any perspective projection whose centre is the eye.
///
/// Coordinates are those of clip space, x/w and y/w: the picture is −1…1. A picture cannot show what lies beside or behind
/// the eye, but ground there may stand up into it. So outside the circle about the picture's corners a step turns the
/// ray by as much as it does in the middle, up to straight back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScreenPlane {
    /// Unit vector along which w grows, ITRF axes.
    pub forward: DVec3,
    /// Ray through (0, 0), one ahead.
    pub middle: DVec3,
    /// Its change with x, across `forward`.
    pub right: DVec3,
    /// Its change with y.
    pub up: DVec3,
    /// Distance of the farthest corner from the point straight ahead, and its angle.
    pub corner: f64,
    /// atan [`Self::corner`].
    pub corner_rad: f64,
    /// Solid angle of a unit of the plane's area straight ahead, steradians.
    pub area: f64,
    /// Whether the picture is mirrored.
    pub mirrored: bool,
    /// (x, y) of clip space from a ray one ahead.
    rows: [DVec3; 2],
    frustum: Frustum,
}

impl ScreenPlane {
    /// Of the matrix from eye-relative ITRF metres to clip space; `None` where it has no centre or is not finite.
    ///
    /// Depth plays no part: the ray of (x, y) lies in the planes x_clip = x w and y_clip = y w, whose normals are
    /// r_x − x r_w and r_y − y r_w with r the matrix' rows. Their cross product is
    /// r_x × r_y + x (r_y × r_w) + y (r_w × r_x), and w along it is the determinant of the three.
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
            // x to the right, y upwards and w ahead are left-handed.
            mirrored: determinant > 0.0,
            rows: [x, y].map(|row| row / slope),
            frustum: Frustum::new(clip_from_eye).without_depth(),
        })
    }

    /// The unit direction of a place on the plane, ITRF axes.
    pub fn direction(&self, at: DVec2) -> DVec3 {
        self.ray(at).0
    }

    /// [`Self::direction`], and the solid angle that a unit of the plane's area has there, steradians.
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
        // Beside and behind the eye rows close up; a sample there stands for no less than at the side.
        let part = if angle < 0.5 * PI { sin } else { 1.0 } / q;
        (self.forward * cos + aside * (sin / q), self.area * part)
    }

    /// The place on the plane whose direction this is; the inverse of [`Self::direction`].
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

    /// Inward unit normals of planes through the eye that bound what the picture shows: its four sides, and the one
    /// across the view, which the sides of a narrow picture tell hardly.
    pub fn sides(&self) -> [DVec3; 5] {
        let [left, right, bottom, top] = self.frustum.side_normals();
        [self.forward, right, left, top, bottom]
    }
}
