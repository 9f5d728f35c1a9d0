// Intersection of the pixel's ray with the exact ellipsoid.

fn surface_point(in: Varying) -> SurfacePoint {
    let ray = pixel_ray(in.clip.xy);
    let to_scaled = vec3f(1.0, 1.0, frame.polar_stretch);
    let scaled = ray * to_scaled;
    let d = normalize(scaled);
    // |e + t d| = 1 with c = |e|² − 1: t = c / (−e·d + √(1 − |e × d|²)). Lagrange's identity instead of b² − c.
    let across_ray = cross(frame.eye_scaled, d);
    let root = sqrt(max(1.0 - dot(across_ray, across_ray), 0.0));
    let t = max(frame.above / max(root - dot(frame.eye_scaled, d), 1e-9), 0.0);
    let p = frame.eye_scaled + t * d;
    return point_on_ray(in, ray, t / length(scaled), normalize(p * to_scaled));
}

// Longitude and latitude of a normal relative to the block's centre: at most 11.25° inside the block, and more where a coarse mesh covers pixels at
// the limb that show the next block. By half angles, tan(φ/2) = sin φ/(1 + cos φ).
fn longitude_latitude(in: Varying, up: vec3f, across: f32) -> vec2f {
    let y = in.center_lon.x * up.y - in.center_lon.y * up.x;
    let x = max(dot(in.center_lon, up.xy), 1e-7);
    let beside = x + across;
    let longitude = atan_near(clamp(y, -0.6 * beside, 0.6 * beside), beside);
    let latitude = atan_near(
        in.center_lat.x * up.z - in.center_lat.y * across,
        in.center_lat.x * across + in.center_lat.y * up.z + 1.0,
    );
    return 2.0 * vec2f(longitude, latitude);
}

// atan(y/x) for |y/x| ≤ 0.6: error below 1e-4, and below 1e-7 up to a quarter.
fn atan_near(y: f32, x: f32) -> f32 {
    let t = y / x;
    let s = t * t;
    return t * (1.0 + s * (-0.33333333 + s * (0.2 + s * (-0.14285714 + s * (0.11111111 - s * 0.09090909)))));
}
