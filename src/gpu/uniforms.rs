//! The uniform structs of the shaders. `tests/model/shaders` compares every offset with the one naga reflects.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};

/// `FrameUniforms` of `shaders/common/frame.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct FrameUniforms {
    /// Takes eye-relative ITRF metres to clip space.
    pub clip_from_eye: Mat4,
    /// The eye in scaled space, (x/a, y/a, z/b).
    pub eye_scaled: Vec3,
    /// |`eye_scaled`|² − 1, computed without cancellation.
    pub above: f32,
    /// Unit vector to the Sun, ITRF axes.
    pub sun_itrf: Vec3,
    /// Equatorial radius a, metres.
    pub radius_m: f32,
    /// The ray through the corner at pixel (0, 0), to the plane one metre in front of the eye; ITRF axes.
    pub corner_ray: Vec3,
    /// a/b.
    pub polar_stretch: f32,
    /// The ray's change to the next pixel right.
    pub pixel_right: Vec3,
    /// What a white sheet that faces the Sun in space is drawn with.
    pub exposure: f32,
    /// The ray's change to the next pixel down.
    pub pixel_down: Vec3,
    /// Part of the air, by weight, that lies below the eye.
    pub air_below: f32,
}

/// `AirUniforms` of `shaders/air.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct AirUniforms {
    /// Takes billboard-frame vectors to clip space.
    pub clip_from_billboard: Mat4,
    /// Unit vector to the Sun, billboard frame.
    pub sun: Vec3,
    /// Distance of the eye from the centre, equatorial radii, at least 1.
    pub eye_distance: f32,
    /// Upper boundary of the air, equatorial radii.
    pub top: f32,
    /// `eye_distance` − 1, without cancellation.
    pub eye_height: f32,
    /// What a white sheet that faces the Sun in space is drawn with.
    pub exposure: f32,
    /// How far the air is drawn before its place, in depth: what the backend rounds depths by.
    pub depth_rounding: f32,
}
