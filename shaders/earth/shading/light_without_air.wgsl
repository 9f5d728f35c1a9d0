import rust::SUN_RADIUS_RAD;

fn light_at(at: SurfacePoint, mu_s: f32) -> Light {
    return Light(light_of_disc(mu_s), vec3f(0.0));
}

// The Sun's disc sets gradually.
fn light_of_disc(above_horizon: f32) -> vec3f {
    return vec3f(smoothstep(-SUN_RADIUS_RAD, SUN_RADIUS_RAD, above_horizon));
}
