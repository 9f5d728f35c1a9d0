import rust::PI;

// Texture coordinates of an equirectangular map for a unit vector of its axes: longitude 180° W at the left edge, north at the top.
fn map_uv(up: vec3f) -> vec2f {
    return vec2f(0.5 + atan2(up.y, up.x) / (2.0 * PI), acos(clamp(up.z, -1.0, 1.0)) / PI);
}
