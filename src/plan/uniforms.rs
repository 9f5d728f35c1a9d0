//! The uniform structs of the shaders. `tests/model/shaders` compares every offset with the one naga reflects.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};
use terrella_frames::{Ellipsoid, MOON_RADIUS_M, MoonShadow};

/// `FrameUniforms` of `shaders/common/frame.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct FrameUniforms {
    /// Transform from eye-relative ITRF metres to clip space.
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
    /// Increment of the ray to the next pixel right.
    pub pixel_right: Vec3,
    /// Exposure factor of light on 8-bit targets.
    pub exposure: f32,
    /// Increment of the ray to the next pixel down.
    pub pixel_down: Vec3,
    /// Moonlight as a fraction of sunlight, times its gain.
    pub moon_light: f32,
    /// Unit vector to the Moon, ITRF axes.
    pub moon_itrf: Vec3,
    /// Fraction of the clouds that is in front of the ground: 1 for an eye above them, 0 below.
    pub clouds_before: f32,
    /// The Moon's shadow; read only if it reaches the view.
    pub shadow: MoonShadowUniforms,
    /// Radiance of the brightest city lights, relative to a white sheet that faces the Sun in space.
    pub lamp_light: f32,
    /// Fraction of the clouds that rises above the edge of the ground.
    pub clouds_at_limb: f32,
    /// Half the thickness of the clouds for an eye within them, equatorial radii.
    pub clouds_reach: f32,
    /// Fraction of them that is drawn around the eye.
    pub clouds_around: f32,
}

/// `MoonShadow` of `shaders/common/moon_shadow.wgsl`. ITRF axes, equatorial radii.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct MoonShadowUniforms {
    /// From the Earth's centre to the Moon's.
    pub moon: Vec3,
    pub radius: f32,
    /// From the Sun through the Moon, unit.
    pub axis: Vec3,
    /// Distance between Sun and Moon, in radii of the Sun.
    pub spread: f32,
}

impl MoonShadowUniforms {
    /// Uniforms of a shadow; all zero without one.
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
    /// Second axis, across, perpendicular to the first.
    pub across_y: Vec3,
    /// `eye_distance` − 1, without cancellation.
    pub eye_height: f32,
    /// Third axis, to the Earth's centre.
    pub toward_center: Vec3,
    /// Exposure factor of light on 8-bit targets.
    pub exposure: f32,
    /// Unit vector to the Sun, ITRF axes.
    pub sun: Vec3,
    /// a/b.
    pub polar_stretch: f32,
    /// Horizontal direction to the Sun at the eye, of length 1, scaled space.
    pub sun_level: Vec3,
    /// Cosine of the Sun's zenith angle at the eye.
    pub eye_sun: f32,
    /// Fraction of upward light from the ground that the air scatters back.
    pub sky_albedo: Vec3,
    /// Sine of the angle at the eye between the Earth's centre and the limb.
    pub limb_sin: f32,
    /// Scattering by molecules at the ground, per equatorial radius.
    pub molecules: Vec3,
    /// Cosine of that angle.
    pub limb_cos: f32,
    /// Maximum absorption by ozone, per equatorial radius.
    pub ozone: Vec3,
    /// Pads the row.
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
    /// Pads the row.
    pub padding_a: f32,
    /// Horizontal direction to the Moon at the eye, of length 1, scaled space.
    pub moon_level: Vec3,
    /// Pads the row.
    pub padding_b: f32,
    /// Fraction of the optical depth between an eye in the air and the ground that is in front of the clouds; for an eye below them, between the
    /// eye and space.
    pub before_clouds: Vec3,
    /// Pads the row.
    pub padding_c: f32,
    /// Fraction of upward light from the clouds that the air above them scatters back.
    pub sky_albedo_of_clouds: Vec3,
    /// Pads the row.
    pub padding_d: f32,
    /// As in [`FrameUniforms`].
    pub shadow: MoonShadowUniforms,
}
