//! Rays of a view, their intersection with the ellipsoid, and the limb. All in f64.
//!
//! Everything is done in scaled space, (x/a, y/a, z/b), where the ellipsoid is the unit sphere.

use glam::{DMat3, DVec2, DVec3};
use terrella::EyeView;
use terrella::frames::Ellipsoid;

/// Intersection with the ellipsoid of the ray through a point of the image, ITRF metres; `None` if it misses, for an eye inside the ellipsoid, and
/// for a view that is not finite.
///
/// `at` is in pixels from the upper left corner, not rounded: the first pixel's centre is (0.5, 0.5). `size` is the image's width and height,
/// pixels. Near and far plane do not clip.
pub fn ground_point(
    view: &EyeView,
    figure: Ellipsoid,
    size: (u32, u32),
    at: DVec2,
) -> Option<DVec3> {
    let rays = Rays::new(view, size)?;
    let scale = figure.itrf_from_scaled();
    let direction = rays.at(at.x, at.y);
    let line = ScaledRay::new(rays.eye_m / scale, (direction / scale).try_normalize()?);
    let distance = line.ground()?;
    Some(line.point(distance) * scale)
}

/// Angle from `axis` to the limb in the direction of `across`, radians.
///
/// `eye_m` is the eye and `axis` a direction that meets the ellipsoid, both ITRF; `across` is orthogonalised to it. `None` for an eye inside, a
/// zero vector, and a limb at 90° or more.
///
/// The rays d that meet the ellipsoid fill the cone |d|² − |e × d|² ≥ 0 of scaled space; in the plane of `axis` and
/// `across` that is a quadratic equation for the angle's tangent.
pub fn limb_angle_rad(figure: Ellipsoid, eye_m: DVec3, axis: DVec3, across: DVec3) -> Option<f64> {
    let scale = figure.itrf_from_scaled();
    let axis = axis.try_normalize()?;
    let across = across.reject_from_normalized(axis).try_normalize()?;
    let eye = eye_m / scale;
    let (a, c) = (axis / scale, across / scale);
    let form = |u: DVec3, v: DVec3| u.dot(v) - eye.cross(u).dot(eye.cross(v));
    let (constant, half, square) = (form(a, a), form(a, c), form(c, c));
    if eye.length() <= 1.0 || constant < 0.0 || square >= 0.0 || eye.dot(a) >= 0.0 {
        return None;
    }
    let root = (half * half - constant * square).sqrt();
    // The positive root of constant + 2 half x + square x² = 0, of two forms the one that does not cancel.
    let tangent = if half > 0.0 {
        (half + root) / -square
    } else {
        constant / (root - half)
    };
    Some(tangent.atan())
}

/// The rays of a picture: direction = corner + x·right + y·down, ITRF axes, of any length.
#[derive(Clone, Copy, Debug)]
pub struct Rays {
    /// The eye, ITRF metres.
    pub eye_m: DVec3,
    corner: DVec3,
    /// Change to the next pixel.
    pub right: DVec3,
    /// Change to the next line.
    pub down: DVec3,
}

impl Rays {
    /// `None` if the view is not finite or shows nothing. The projection's centre is the eye.
    ///
    /// With the rows x, y, w of the projection the ray at (X, Y) of the clip square lies in the planes x − X w = 0 and
    /// y − Y w = 0, so it runs along their cross product, x×y − Y x×w − X w×y: linear in X and Y for every projection,
    /// off-centre and skewed ones too.
    pub fn new(view: &EyeView, size: (u32, u32)) -> Option<Self> {
        let (width, height) = (f64::from(size.0), f64::from(size.1));
        let [x, y, w] = [0, 1, 3].map(|row| view.clip_from_view.row(row).truncate());
        let ahead = x.cross(y);
        // In front of the eye w is positive.
        let sign = w.dot(ahead).signum();
        let itrf_from_view =
            view.itrf_from_world.matrix3 * DMat3::from_quat(view.view_from_world.inverse());
        let turned = |v: DVec3| itrf_from_view * (v * sign);
        let rays = Self {
            eye_m: view.itrf_from_world.transform_point3(view.eye_world),
            corner: turned(ahead - x.cross(w) + w.cross(y)),
            right: turned(w.cross(y) * (-2.0 / width)),
            down: turned(x.cross(w) * (2.0 / height)),
        };
        let vectors = [rays.eye_m, rays.corner, rays.right, rays.down];
        let is_finite = vectors.iter().all(|v| v.is_finite()) && view.clip_from_view.is_finite();
        (is_finite && w.dot(ahead) != 0.0).then_some(rays)
    }

    /// The ray at a place in pixels.
    pub fn at(&self, x: f64, y: f64) -> DVec3 {
        self.corner + self.right * x + self.down * y
    }
}

/// A ray in scaled space, with its point nearest to the centre.
#[derive(Clone, Copy, Debug)]
pub(super) struct ScaledRay {
    start: DVec3,
    /// Unit vector along it.
    pub direction: DVec3,
    /// Its distance from the centre.
    pub nearest: f64,
    /// Distance from the start to its nearest point; negative if that is behind.
    pub along: f64,
}

impl ScaledRay {
    /// From a point along a unit vector.
    pub fn new(start: DVec3, direction: DVec3) -> Self {
        Self {
            start,
            direction,
            // By the cross product: |start|² − along² would lose all digits for a distant start.
            nearest: start.cross(direction).length(),
            along: -start.dot(direction),
        }
    }

    /// The point at a distance from the start.
    pub fn point(&self, distance: f64) -> DVec3 {
        self.start + self.direction * distance
    }

    /// Distance from the start, outside or on the unit sphere, to where the line first meets it ahead.
    pub fn ground(&self) -> Option<f64> {
        let radius = self.start.length();
        let above = (radius - 1.0) * (radius + 1.0);
        if above < 0.0 || self.along <= 0.0 || self.nearest > 1.0 {
            return None;
        }
        // c/(−b + √(b² − c)) with b² − c = 1 − nearest²: a sum of positive numbers where the other form cancels.
        Some(above / (self.along + half_chord(1.0, self.nearest)))
    }
}

/// Half the length of a chord that passes a sphere's centre at `nearest`; 0 where it misses the sphere.
pub(super) fn half_chord(radius: f64, nearest: f64) -> f64 {
    ((radius - nearest) * (radius + nearest)).max(0.0).sqrt()
}
