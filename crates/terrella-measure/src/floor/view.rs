//! Position of the eye, and of the Earth's edge on screen.

use glam::{DVec3, Vec3};
use terrella::EyeView;
use terrella::frames::Ellipsoid;

/// Number of corners of the disc, three times a power of two: its edge is within 6e-4 of its radius inside the limb.
pub const CORNERS: u32 = 96;

/// The shader's `View`.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub struct FloorView {
    /// Takes eye-relative ITRF metres to clip space.
    clip_from_eye: [[f32; 4]; 4],
    /// The eye in scaled space, (x/a, y/a, z/b).
    eye_scaled: Vec3,
    /// |eye|² − 1 there.
    above: f32,
    /// The ray through the target's corner, and its change to the next pixel right and down, ITRF axes.
    corner_ray: Vec3,
    /// a/b.
    polar_stretch: f32,
    pixel_right: Vec3,
    padding_0: f32,
    pixel_down: Vec3,
    padding_1: f32,
    /// Centre of the limb and two half axes of it, eye-relative ITRF metres.
    limb_center: Vec3,
    padding_2: f32,
    limb_across: Vec3,
    padding_3: f32,
    limb_beside: Vec3,
    padding_4: f32,
    /// Unit vector to the Sun, ITRF axes.
    sun_itrf: Vec3,
    padding_5: f32,
}

impl FloorView {
    /// `None` for an eye that is not above the ground.
    pub fn new(
        ellipsoid: &Ellipsoid,
        view: &EyeView,
        sun_itrf: DVec3,
        size: (u32, u32),
    ) -> Option<Self> {
        let (eye_itrf_m, clip_from_eye) = view.to_itrf();
        let (a, b) = (ellipsoid.equatorial_radius_m, ellipsoid.polar_radius_m);
        let radii = DVec3::new(a, a, b);
        let eye = eye_itrf_m / radii;
        let distance = eye.length();
        // |e|² − 1; the eyes of measurements are metres above the ground and more.
        let above = (distance - 1.0) * (distance + 1.0);
        if above <= 0.0 || !above.is_finite() {
            return None;
        }
        // In scaled space the limb is the circle of the unit sphere in the plane p·e = 1.
        let toward = eye / distance;
        let (across, beside) = toward.any_orthonormal_pair();
        let wide = above.sqrt() / distance;
        let rays = view.pixel_rays(size.into());
        let metres = |scaled: DVec3| (scaled * radii).as_vec3();
        Some(Self {
            clip_from_eye: clip_from_eye.as_mat4().to_cols_array_2d(),
            eye_scaled: eye.as_vec3(),
            above: above as f32,
            corner_ray: rays.corner.as_vec3(),
            polar_stretch: (a / b) as f32,
            pixel_right: rays.right.as_vec3(),
            padding_0: 0.0,
            pixel_down: rays.down.as_vec3(),
            padding_1: 0.0,
            limb_center: metres(-toward * (above / distance)),
            padding_2: 0.0,
            limb_across: metres(across * wide),
            padding_3: 0.0,
            limb_beside: metres(beside * wide),
            padding_4: 0.0,
            sun_itrf: sun_itrf.as_vec3(),
            padding_5: 0.0,
        })
    }
}
