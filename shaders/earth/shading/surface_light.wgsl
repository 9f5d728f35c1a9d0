// What of the light on the surface can be chosen. Mirrored by `SurfaceLightUniforms` in src/gpu/uniforms.rs.
struct SurfaceLightUniforms {
    // Mean square slope of the sea's waves.
    wave_slope_squared: f32,
    // Part of the light that the sea's foam throws back.
    foam: f32,
    // Of the sky mirrored by waves: the power of 1 − cos θ, and what it is multiplied by.
    mirror_power: f32,
    mirror_scale: f32,
    // What the normal map's slopes are multiplied by.
    slope_gain: f32,
    // Height of the clouds, and how far the tops of thick ones rise over thin ones; equatorial radii.
    cloud_height: f32,
    cloud_relief: f32,
    // Sine of the Sun's depression at which it sets for the clouds.
    cloud_dip: f32,
    // Radiance of the brightest city lights.
    lamp_light: f32,
    padding_a: f32,
    padding_b: vec2f,
}
