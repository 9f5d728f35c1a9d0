//! From places to pixels: where on screen a place is, and what of the screen a ball may cover.

use crate::earth::ball_bounds;
use glam::{DMat4, DVec3, DVec4};
use terrella_frames::Ellipsoid;

/// The eye of a frame and its projection.
pub(super) struct EyeProjection<'e> {
    pub itrf_m: DVec3,
    pub clip_from_eye: DMat4,
    /// Of the viewport, pixels.
    pub size: (u32, u32),
    pub ellipsoid: &'e Ellipsoid,
}

impl EyeProjection<'_> {
    /// A place in clip space.
    pub fn clip(&self, place_itrf_m: DVec3) -> DVec4 {
        self.clip_from_eye * (place_itrf_m - self.itrf_m).extend(1.0)
    }

    /// How many pixels an angle of one radian is long in the middle of the picture.
    pub fn pixels_per_radian(&self) -> f64 {
        // A rotation changes no length: the ratio is the cotangent of half the field of view, in any unit of the host.
        let [up, depth] = [1, 3].map(|row| self.clip_from_eye.row(row).truncate().length());
        0.5 * f64::from(self.size.1) * up / depth
    }

    /// Whether all of a ball lies on ground that faces away: p·e < 1 in scaled space.
    pub fn faces_away(&self, center_itrf_m: DVec3, radius_m: f64) -> bool {
        let scale = self.ellipsoid.scaled_from_itrf();
        let eye_scaled = scale * self.itrf_m;
        let facing = (scale * center_itrf_m).dot(eye_scaled);
        let reach = radius_m / self.ellipsoid.polar_radius_m * eye_scaled.length();
        facing + reach < 1.0
    }

    /// Pixels from the viewport's upper left corner; `None` outside the picture.
    pub fn pixel(&self, place_itrf_m: DVec3) -> Option<[f32; 2]> {
        let clip = self.clip(place_itrf_m);
        let ndc = clip.truncate() / clip.w;
        let is_inside = clip.w > 0.0 && ndc.x.abs() <= 1.0 && ndc.y.abs() <= 1.0;
        let (width, height) = (f64::from(self.size.0), f64::from(self.size.1));
        is_inside.then_some([
            (0.5 * (ndc.x + 1.0) * width) as f32,
            (0.5 * (1.0 - ndc.y) * height) as f32,
        ])
    }

    /// The part of the screen that a ball may cover: least x and y, greatest x and y; `None` where it covers none.
    pub fn bounds(&self, center_itrf_m: DVec3, radius_m: f64) -> Option<[f32; 4]> {
        ball_bounds(&self.clip_from_eye, center_itrf_m - self.itrf_m, radius_m)
    }
}
