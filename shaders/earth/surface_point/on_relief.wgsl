// A point of ground with relief, found along the pixel's ray by whoever imports this.

// `along`: its distance in lengths of the ray.
fn point_on_relief(in: Varying, ray: vec3f, along: f32, height_m: f32, slope: vec2f) -> SurfacePoint {
    let radii = along / frame.radius_m;
    let p = frame.eye_scaled + radii * (ray * vec3f(1.0, 1.0, frame.polar_stretch));
    // The normal through a point at height h: z over ρ by the parallel radii of the figure h higher,
    //   q(a + h)/(q² a + h) in scaled space, q = b/a, where N is taken as a.
    let q = 1.0 / frame.polar_stretch;
    let lift = height_m / frame.radius_m;
    let up = normalize(p * vec3f(1.0, 1.0, q * (1.0 + lift) / (q * q + lift)));
    var out = point_on_ray(in, ray, radii, up);
    out.slope = slope;
    out.along = along;
    out.height_m = height_m;
    return out;
}

// Longitude and latitude of a normal from the centre: a patch may be wider than a block.
fn longitude_latitude(in: Varying, up: vec3f, across: f32) -> vec2f {
    let y = in.center_lon.x * up.y - in.center_lon.y * up.x;
    let longitude = atan2(y, dot(in.center_lon, up.xy));
    let latitude = atan2(
        in.center_lat.x * up.z - in.center_lat.y * across,
        in.center_lat.x * across + in.center_lat.y * up.z,
    );
    return vec2f(longitude, latitude);
}
