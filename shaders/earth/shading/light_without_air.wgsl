import rust::SUN_RADIUS_RAD;

// The Sun's disc sets gradually.
fn light_at(at: SurfacePoint, mu_s: f32) -> Light {
    return Light(vec3f(smoothstep(-SUN_RADIUS_RAD, SUN_RADIUS_RAD, mu_s)), vec3f(0.0));
}
