// The Moon before the Sun. Mirrored by `MoonShadowUniforms` in src/gpu/uniforms.rs. ITRF axes, equatorial radii.
struct MoonShadow {
    // The Moon's centre from the Earth's, and its radius.
    moon: vec3f,
    radius: f32,
    // From the Sun through the Moon, unit.
    axis: vec3f,
    // Distance of Sun and Moon in radii of the Sun.
    spread: f32,
}
