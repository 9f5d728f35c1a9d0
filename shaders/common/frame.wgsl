// One frame's values, shared by all drawables. Mirrored by `FrameUniforms` in src/gpu/uniforms.rs; a test compares the offsets.
import common/moon_shadow.wgsl;

struct FrameUniforms {
    // Transform from eye-relative ITRF metres to clip space.
    clip_from_eye: mat4x4f,
    // The eye in scaled space, (x/a, y/a, z/b), and |eye|² − 1, computed without cancellation.
    eye_scaled: vec3f,
    above: f32,
    // Unit vector to the Sun, ITRF axes.
    sun_itrf: vec3f,
    // Equatorial radius a, metres.
    radius_m: f32,
    // The ray through the target's corner at pixel (0, 0), and its increments to the next pixel right and down; all end on the plane one metre in
    // front of the eye. ITRF axes.
    corner_ray: vec3f,
    // a/b.
    polar_stretch: f32,
    pixel_right: vec3f,
    // Exposure factor of light on 8-bit targets.
    exposure: f32,
    pixel_down: vec3f,
    // Moonlight as a fraction of sunlight, times its gain.
    moon_light: f32,
    // Unit vector to the Moon, ITRF axes.
    moon_itrf: vec3f,
    // Fraction of the clouds that is in front of the ground: 1 for an eye above them, 0 below.
    clouds_before: f32,
    shadow: MoonShadow,
    // Radiance of the brightest city lights.
    lamp_light: f32,
    // Fraction of the clouds that rises above the edge of the ground.
    clouds_at_limb: f32,
    // Half the thickness of the clouds for an eye within them, equatorial radii.
    clouds_reach: f32,
    // Fraction of them that is drawn around the eye.
    clouds_around: f32,
}
