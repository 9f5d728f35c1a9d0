// The block sphere: a lattice of vertices on the ellipsoid.

struct BlockVertex {
    // Position relative to the eye, ITRF metres: subtracted in f64.
    @location(0) from_eye_m: vec3f,
}

@vertex
fn vertex(in: BlockVertex, reference: BlockInstance) -> Varying {
    var out = varying_of(reference);
    out.clip = frame.clip_from_eye * vec4f(in.from_eye_m, 1.0);
    @if(interpolated) out = with_air(out, in.from_eye_m);
    return out;
}

@if(interpolated)
fn with_air(vertex: Varying, from_eye_m: vec3f) -> Varying {
    let to_scaled = vec3f(1.0, 1.0, frame.polar_stretch);
    let place = frame.eye_scaled + from_eye_m * to_scaled / frame.radius_m;
    let radii = 1.0 / frame.radius_m;
    let at = air_at_vertex(point_on_ray(vertex, from_eye_m, radii, normalize(place * to_scaled)));
    var out = vertex;
    out.through = at.through;
    out.black = at.black;
    out.bounce = at.bounce;
    out.sun = at.sun;
    out.sky = at.sky;
    @if(clouds) out.sun_on_clouds = at.of_clouds.sun;
    @if(clouds) out.sky_on_clouds = at.of_clouds.sky;
    @if(clouds) out.through_to_clouds = at.of_clouds.through;
    @if(clouds) out.black_above_clouds = at.of_clouds.black;
    @if(clouds) out.bounce_above_clouds = at.of_clouds.bounce;
    return out;
}
