//! The uniform structs of the shaders. `tests/model/shaders` compares every offset with the one naga reflects.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};
use terrella_frames::{Ellipsoid, MOON_RADIUS_M, MoonShadow};

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
    /// What light is multiplied by before an 8-bit target shows it.
    pub exposure: f32,
    /// The ray's change to the next pixel down.
    pub pixel_down: Vec3,
    /// Light of the Moon as a part of the Sun's, times how much brighter the night is drawn.
    pub moon_light: f32,
    /// Unit vector to the Moon, ITRF axes.
    pub moon_itrf: Vec3,
    /// How much of the clouds the eye sees before the ground: 1 above them, 0 below.
    pub clouds_before: f32,
    /// Of the Moon; read where it reaches what is in view.
    pub shadow: MoonShadowUniforms,
    /// Radiance of the brightest city lights, a white sheet that faces the Sun in space being 1.
    pub lamp_light: f32,
    /// Fills the row.
    pub padding: [f32; 3],
}

/// `MoonShadow` of `shaders/common/moon_shadow.wgsl`. ITRF axes, equatorial radii.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct MoonShadowUniforms {
    /// The Moon's centre from the Earth's.
    pub moon: Vec3,
    pub radius: f32,
    /// From the Sun through the Moon, unit.
    pub axis: Vec3,
    /// Distance of Sun and Moon in radii of the Sun.
    pub spread: f32,
}

impl MoonShadowUniforms {
    /// What shaders read of a shadow; all zero without one.
    pub(crate) fn new(shadow: Option<&MoonShadow>, ellipsoid: &Ellipsoid) -> Self {
        let Some(shadow) = shadow else {
            return Self::zeroed();
        };
        let radius_m = ellipsoid.equatorial_radius_m;
        Self {
            moon: (shadow.moon_itrf_m() / radius_m).as_vec3(),
            radius: (MOON_RADIUS_M / radius_m) as f32,
            axis: shadow.axis().as_vec3(),
            spread: shadow.spread() as f32,
        }
    }
}

/// `AirUniforms` of `shaders/common/air/uniforms.wgsl`. Lengths are equatorial radii of scaled space.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct AirUniforms {
    /// First axis of the billboard, across, scaled space.
    pub across_x: Vec3,
    /// Distance of the eye from the centre, at least 1.
    pub eye_distance: f32,
    /// Second axis, across.
    pub across_y: Vec3,
    /// `eye_distance` − 1, without cancellation.
    pub eye_height: f32,
    /// Third axis, to the Earth's centre.
    pub toward_center: Vec3,
    /// What light is multiplied by before an 8-bit target shows it.
    pub exposure: f32,
    /// Unit vector to the Sun, ITRF axes.
    pub sun: Vec3,
    /// a/b.
    pub polar_stretch: f32,
    /// Horizontally towards the Sun at the eye, of length 1, scaled space.
    pub sun_level: Vec3,
    /// Cosine of the Sun's zenith angle at the eye.
    pub eye_sun: f32,
    /// The part of light going up from the ground that the air sends back.
    pub sky_albedo: Vec3,
    /// Sine of the angle at the eye between the Earth's centre and the limb.
    pub limb_sin: f32,
    /// Scattering by molecules at the ground, per equatorial radius.
    pub molecules: Vec3,
    /// Cosine of that angle.
    pub limb_cos: f32,
    /// Absorption by ozone where it is densest, per equatorial radius.
    pub ozone: Vec3,
    /// Fills the row.
    pub padding_e: f32,
    /// Scattering by aerosol at the ground, per equatorial radius.
    pub aerosol_scattering: Vec3,
    /// Cosine of the Moon's zenith angle at the eye.
    pub eye_moon: f32,
    /// Scattering and absorption by aerosol at the ground, per equatorial radius.
    pub aerosol_extinction: Vec3,
    /// As in [`FrameUniforms`].
    pub moon_light: f32,
    /// Unit vector to the Moon, ITRF axes.
    pub moon: Vec3,
    /// Fills the row.
    pub padding_a: f32,
    /// Horizontally towards the Moon at the eye, of length 1, scaled space.
    pub moon_level: Vec3,
    /// Fills the row.
    pub padding_b: f32,
    /// Of the optical depth between an eye in the air and the ground, the part that is before the clouds; between an eye below them and
    /// space likewise.
    pub before_clouds: Vec3,
    /// Fills the row.
    pub padding_c: f32,
    /// The part of light going up from the clouds that the air above them sends back.
    pub sky_albedo_of_clouds: Vec3,
    /// Fills the row.
    pub padding_d: f32,
    /// As in [`FrameUniforms`].
    pub shadow: MoonShadowUniforms,
}
