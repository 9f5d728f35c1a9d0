// The Moon in front of the Sun. Mirrored by `MoonShadowUniforms` in src/gpu/uniforms.rs. ITRF axes, equatorial radii.
struct MoonShadow {
    // From the Earth's centre to the Moon's, and its radius.
    moon: vec3f,
    radius: f32,
    // From the Sun through the Moon, unit.
    axis: vec3f,
    // Distance between Sun and Moon, in radii of the Sun.
    spread: f32,
}
