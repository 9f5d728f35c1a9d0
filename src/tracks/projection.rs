//! Projection of positions to pixels, and the bounds of spheres on screen.

use crate::earth::ball_bounds;
use glam::{DMat4, DVec3, DVec4};
use terrella_frames::Ellipsoid;
use terrella_ground::globe::culling::{GroundShell, Horizon};

/// The eye of a frame and its projection.
pub(super) struct EyeProjection<'e> {
    pub itrf_m: DVec3,
    pub clip_from_eye: DMat4,
    /// Size of the viewport, pixels.
    pub size: (u32, u32),
    pub ellipsoid: &'e Ellipsoid,
    horizon: Horizon,
    pixels_per_radian: f64,
    /// Angular size of a pixel in the middle of the image, where it is largest; that of the larger side.
    pixel_rad: f64,
}

impl<'e> EyeProjection<'e> {
    pub fn new(
        itrf_m: DVec3,
        clip_from_eye: DMat4,
        size: (u32, u32),
        ellipsoid: &'e Ellipsoid,
    ) -> Self {
        // Rotations preserve lengths: the ratio is the cotangent of half the field of view, in any unit of the host.
        let [right, up, depth] = [0, 1, 3].map(|row| clip_from_eye.row(row).truncate().length());
        let pixels_per_radian = |side: u32, scale: f64| 0.5 * f64::from(side) * scale / depth;
        let (across, upwards) = (
            pixels_per_radian(size.0, right),
            pixels_per_radian(size.1, up),
        );
        Self {
            itrf_m,
            clip_from_eye,
            size,
            ellipsoid,
            horizon: Horizon::new(ellipsoid, itrf_m, GroundShell::SMOOTH),
            pixels_per_radian: upwards,
            pixel_rad: 1.0 / across.min(upwards),
        }
    }

    /// A position in clip space.
    #[inline]
    pub fn clip(&self, place_itrf_m: DVec3) -> DVec4 {
        self.clip_from_eye * (place_itrf_m - self.itrf_m).extend(1.0)
    }

    /// Length in pixels of an angle of one radian in the middle of the image.
    pub fn pixels_per_radian(&self) -> f64 {
        self.pixels_per_radian
    }

    /// Whether the globe hides a position; see [`is_hidden`](super::is_hidden).
    pub fn is_hidden(&self, place_itrf_m: DVec3) -> bool {
        self.horizon.hides_point(place_itrf_m)
    }

    /// Whether the globe hides all of a disc around a position that is no lower than 10 km.
    pub fn hides_disc(&self, place_itrf_m: DVec3, radius_px: f64) -> bool {
        self.horizon
            .hides_around(place_itrf_m, radius_px * self.pixel_rad)
    }

    /// Whether all of a sphere lies on ground that faces away: p·e < 1 in scaled space.
    pub fn faces_away(&self, center_itrf_m: DVec3, radius_m: f64) -> bool {
        let scale = self.ellipsoid.scaled_from_itrf();
        let eye_scaled = scale * self.itrf_m;
        let facing = (scale * center_itrf_m).dot(eye_scaled);
        let reach = radius_m / self.ellipsoid.polar_radius_m * eye_scaled.length();
        facing + reach < 1.0
    }

    /// Pixels from the viewport's upper left corner; `None` outside the image.
    pub fn pixel(&self, place_itrf_m: DVec3) -> Option<[f32; 2]> {
        self.pixel_near(place_itrf_m, 0.0)
    }

    /// As [`Self::pixel`], with a margin: `None` if it is more than this many pixels outside the image.
    #[inline]
    pub fn pixel_near(&self, place_itrf_m: DVec3, outside_px: f64) -> Option<[f32; 2]> {
        let clip = self.clip(place_itrf_m);
        let (width, height) = (f64::from(self.size.0), f64::from(self.size.1));
        let reach = |side: f64| clip.w * (1.0 + 2.0 * outside_px / side);
        let is_near = clip.w > 0.0 && clip.x.abs() <= reach(width) && clip.y.abs() <= reach(height);
        is_near.then(|| {
            let x = 0.5 * (clip.x / clip.w + 1.0) * width;
            let y = 0.5 * (1.0 - clip.y / clip.w) * height;
            [x as f32, y as f32]
        })
    }

    /// Whether a pixel is inside the image.
    pub fn is_inside(&self, [x, y]: [f32; 2]) -> bool {
        let (width, height) = (self.size.0 as f32, self.size.1 as f32);
        (0.0..=width).contains(&x) && (0.0..=height).contains(&y)
    }

    /// Bounds of a sphere on screen: least x and y, greatest x and y; `None` if it is off screen.
    pub fn bounds(&self, center_itrf_m: DVec3, radius_m: f64) -> Option<[f32; 4]> {
        ball_bounds(&self.clip_from_eye, center_itrf_m - self.itrf_m, radius_m)
    }
}
