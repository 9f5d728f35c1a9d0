//! From directions to pixels.

use crate::earth::{ItrfView, Viewport, ball_bounds};
use crate::gpu::{Disc, StarPoint};
use glam::{DMat3, DVec2, DVec3, Vec3, Vec4};
use terrella_frames::Ellipsoid;

/// Maps directions to pixels.
pub(super) struct Projection<'v> {
    view: &'v ItrfView,
    pub size: DVec2,
    pub origin: DVec2,
    /// Direction of the image centre, unit.
    pub axis: DVec3,
    /// Largest angle of a pixel from it.
    pub half_angle_rad: f64,
    /// Normal of the plane of the rays, with the area of a pixel in that plane as length.
    pixel_area: DVec3,
}

/// A disc, and its size on screen.
pub(super) struct PlacedDisc {
    pub disc: Disc,
    pub radius_px: f64,
    pub is_in_picture: bool,
}

impl<'v> Projection<'v> {
    pub fn new(view: &'v ItrfView, target: Viewport) -> Self {
        let size = DVec2::new(
            f64::from(target.size.0.max(1)),
            f64::from(target.size.1.max(1)),
        );
        let origin = DVec2::new(f64::from(target.origin.0), f64::from(target.origin.1));
        let rays = &view.rays;
        let ray = |x: f64, y: f64| {
            let at = origin + size * DVec2::new(x, y);
            (rays.corner + rays.right * at.x + rays.down * at.y).normalize_or_zero()
        };
        let axis = ray(0.5, 0.5);
        let corners = [ray(0.0, 0.0), ray(1.0, 0.0), ray(0.0, 1.0), ray(1.0, 1.0)];
        let half_angle_rad = corners.map(|corner| corner.angle_between(axis));
        Self {
            view,
            size,
            origin,
            axis,
            half_angle_rad: half_angle_rad.into_iter().fold(0.0, f64::max),
            pixel_area: rays.down.cross(rays.right),
        }
    }

    /// Position of a direction on screen, −1…1 in the image; `None` behind the eye.
    pub fn on_screen(&self, direction: DVec3) -> Option<DVec2> {
        let clip = self.view.clip_from_eye * direction.extend(0.0);
        (clip.w > 0.0).then(|| DVec2::new(clip.x, clip.y) / clip.w)
    }

    /// Angular size of a pixel in the middle of the image.
    pub fn pixel_rad(&self) -> f64 {
        self.view.pixel_rad()
    }

    /// A star in a direction; `None` outside the image.
    pub fn point(&self, direction: DVec3, light: Vec3) -> Option<StarPoint> {
        let at = self.on_screen(direction)?;
        let room = DVec2::ONE + 6.0 / self.size;
        if !at.abs().cmple(room).all() {
            return None;
        }
        // Solid angle of the pixel: its area in the plane of the rays, projected towards the eye, over its distance squared.
        let toward = self.pixel_area.dot(direction);
        let distance = self.pixel_area.dot(self.view.rays.corner) / toward;
        let solid_angle = (toward / (distance * distance)).abs();
        Some(StarPoint {
            at: at.as_vec2().to_array(),
            light: (light / solid_angle as f32).to_array(),
        })
    }

    /// Disc of a sphere, given its centre relative to the eye.
    pub fn disc(&self, center_m: DVec3, radius_m: f64, depth: f32) -> PlacedDisc {
        let axes = disc_axes(center_m);
        let rays = &self.view.rays;
        let row = |axis: DVec3| {
            let [right, down, corner] =
                [rays.right, rays.down, rays.corner].map(|ray| ray.dot(axis));
            DVec3::new(right, down, corner).as_vec3()
        };
        let distance = center_m.length() / radius_m;
        let bounds = ball_bounds(&self.view.clip_from_eye, center_m, radius_m * 1.01);
        let bounds = bounds.map(|bounds| self.with_room(bounds));
        PlacedDisc {
            disc: Disc {
                pixel_x: row(axes.x_axis),
                pixel_y: row(axes.y_axis),
                pixel_z: row(axes.z_axis),
                distance: distance as f32,
                depth,
                covers: 0.0,
                bounds: bounds.map_or(Vec4::ZERO, Vec4::from),
            },
            radius_px: 1.0 / (distance * self.view.pixel_rad()),
            is_in_picture: bounds.is_some(),
        }
    }

    /// Bounds with a margin of two pixels on every side, for the antialiased edge.
    fn with_room(&self, [left, low, right, high]: [f32; 4]) -> [f32; 4] {
        let room = (4.0 / self.size).as_vec2();
        [left - room.x, low - room.y, right + room.x, high + room.y]
    }

    pub fn depth(&self, center_m: DVec3) -> f32 {
        let clip = self.view.clip_from_eye * center_m.extend(1.0);
        (clip.z / clip.w).clamp(0.0, 1.0) as f32
    }

    /// Whether the ellipsoid hides a direction, computed in scaled space as in the shaders.
    pub fn is_behind(&self, ellipsoid: &Ellipsoid, direction: DVec3) -> bool {
        let scale = ellipsoid.scaled_from_itrf();
        let (eye, ray) = (
            scale * self.view.eye_itrf_m,
            (scale * direction).normalize(),
        );
        eye.dot(ray) < 0.0 && eye.cross(ray).length_squared() < 1.0
    }
}

/// Axes of a sphere's disc: z from the eye to its centre.
pub(super) fn disc_axes(center_m: DVec3) -> DMat3 {
    let z = center_m.normalize_or(DVec3::Z);
    let x = z.any_orthonormal_vector();
    DMat3::from_cols(x, z.cross(x), z)
}
