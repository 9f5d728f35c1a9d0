// A point of terrain on the pixel's ray.
@if(cast) import earth/surface_point/contour_tree.wgsl;

// Intersection of the ray with the contours of the page whose prism is drawn; the pixel is discarded if there is none.
@if(cast)
fn surface_point(in: Varying) -> SurfacePoint {
    let ray = pixel_ray(in.clip.xy);
    let ray_length = length(ray);
    let in_page = ContourRay(in.eye_from_origin_m, 1e30, ray / ray_length, in.ray.y, in.ray.x, in.ray.z);
    let hit = contour_cast(in_page, in.root);
    if hit.node == NO_NODE {
        discard;
    }
    let along = hit.t / ray_length;
    let radii = along / frame.radius_m;
    let scaled = ray * vec3f(1.0, 1.0, frame.polar_stretch);
    // |p|² − 1 without cancellation.
    let above = frame.above + radii * (2.0 * dot(frame.eye_scaled, scaled) + radii * dot(scaled, scaled));
    let height_m = frame.radius_m * above / (1.0 + sqrt(max(1.0 + above, 0.0)));
    let slope = contour_slope(hit.node, in_page.start + hit.t * in_page.towards);
    return point_on_relief(in, ray, along, height_m, slope);
}

// At the drawn mesh.
@else
fn surface_point(in: Varying) -> SurfacePoint {
    let ray = pixel_ray(in.clip.xy);
    // The mesh's interpolated position, projected onto the pixel's ray, so that interpolation errors only act along the ray.
    let along = dot(in.from_eye_m, ray) / dot(ray, ray);
    return point_on_relief(in, ray, along, in.height_m, in.slope);
}

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

// Longitude and latitude of a normal relative to the centre: a patch may be wider than a block.
fn longitude_latitude(in: Varying, up: vec3f, across: f32) -> vec2f {
    let y = in.center_lon.x * up.y - in.center_lon.y * up.x;
    let longitude = atan2(y, dot(in.center_lon, up.xy));
    let latitude = atan2(
        in.center_lat.x * up.z - in.center_lat.y * across,
        in.center_lat.x * across + in.center_lat.y * up.z,
    );
    return vec2f(longitude, latitude);
}
