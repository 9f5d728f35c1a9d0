// Mirrored by `AirUniforms` in src/gpu/uniforms.rs. Lengths are equatorial radii of scaled space.
import common/moon_shadow.wgsl;

struct AirUniforms {
    // Axes of the billboard in scaled space: two across, one from the eye to the Earth's centre.
    across_x: vec3f,
    // Distance of the eye from the centre, ≥ 1.
    eye_distance: f32,
    across_y: vec3f,
    // Height of the eye above the surface, without cancellation.
    eye_height: f32,
    toward_center: vec3f,
    // Exposure factor: the value of a white sheet that faces the Sun in space.
    exposure: f32,
    // Unit vector to the Sun, ITRF axes.
    sun: vec3f,
    // a/b.
    polar_stretch: f32,
    // Horizontal direction to the Sun at the eye, of length 1, scaled space.
    sun_level: vec3f,
    // Cosine of the Sun's zenith angle at the eye.
    eye_sun: f32,
    // Fraction of upward light from the ground that the air scatters back.
    sky_albedo: vec3f,
    // Sine and cosine of the angle at the eye between the Earth's centre and the limb.
    limb_sin: f32,
    // Scattering by molecules at the ground, maximum absorption by ozone, scattering and extinction by aerosol at the ground; per equatorial
    // radius.
    molecules: vec3f,
    limb_cos: f32,
    ozone: vec3f,
    padding_e: f32,
    aerosol_scattering: vec3f,
    // Cosine of the Moon's zenith angle at the eye.
    eye_moon: f32,
    aerosol_extinction: vec3f,
    // As in the frame's uniforms.
    moon_light: f32,
    moon: vec3f,
    padding_a: f32,
    // Horizontal direction to the Moon at the eye, as for the Sun.
    moon_level: vec3f,
    padding_b: f32,
    // Fraction of the optical depth between an eye in the air and the ground that is in front of the clouds; for an eye below them, between the eye
    // and space.
    before_clouds: vec3f,
    padding_c: f32,
    // Fraction of upward light from the clouds that the air above them scatters back.
    sky_albedo_of_clouds: vec3f,
    padding_d: f32,
    shadow: MoonShadow,
}
