// The ground that a sensor sees: inside a cone or a pyramid and visible from the satellite. `Fill` in src/gpu/tracks.rs.

struct FillInstance {
    // Bounds on screen: least and greatest x and y, −1…1.
    @location(0) bounds: vec4f,
    // Position of the satellite, scaled space, and the depth for the test against objects in front of the ground.
    @location(1) apex: vec3f,
    @location(2) depth: f32,
    // The boresight, unit, ITRF axes, and the tangent of the half angle.
    @location(3) axis: vec3f,
    @location(4) tangent: f32,
    @location(5) color: vec4f,
    // For a pyramid the axis across and the tangent of the half angle along it; 0 for a cone.
    @location(6) side: vec3f,
    @location(7) side_tangent: f32,
}

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat) apex: vec3f,
    @location(1) @interpolate(flat) axis: vec3f,
    @location(2) @interpolate(flat) tangent: f32,
    @location(3) @interpolate(flat) color: vec4f,
    @location(4) @interpolate(flat) side: vec3f,
    @location(5) @interpolate(flat) side_tangent: f32,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32, in: FillInstance) -> Varying {
    let at = vec2f(
        select(in.bounds.x, in.bounds.z, (index & 1u) != 0u),
        select(in.bounds.y, in.bounds.w, (index & 2u) != 0u),
    );
    var out: Varying;
    out.clip = vec4f(at, in.depth, 1.0);
    out.apex = in.apex;
    out.axis = in.axis;
    out.tangent = in.tangent;
    out.color = in.color;
    out.side = in.side;
    out.side_tangent = in.side_tangent;
    return out;
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    let ray = ray_of(in.clip.xy);
    // The ground: |e + t d| = 1, as in earth/surface_point/ray_on_ellipsoid.wgsl.
    let root = sqrt(max((1.0 - ray.q) * (1.0 + ray.q), 0.0));
    let t = track.frame.above / max(root + ray.along, 1e-9);
    let ground = track.frame.eye_scaled + t * ray.direction;
    // Inside the cone: |v × a| < v·a tan α, which is accurate for narrow cones too; inside the pyramid the same along both of its axes. Visible
    // from the satellite: p·s > 1.
    let v = (ground - in.apex) / vec3f(1.0, 1.0, track.frame.polar_stretch);
    let ahead = dot(v, in.axis);
    let in_cone = ahead * in.tangent - length(cross(v, in.axis));
    let along = ahead * in.tangent - abs(dot(v, cross(in.side, in.axis)));
    let aside = ahead * in.side_tangent - abs(dot(v, in.side));
    let in_field = select(in_cone, min(along, aside), in.side_tangent > 0.0);
    let above_horizon = dot(ground, in.apex) - 1.0;
    let inside = min(
        covered(in_field, fwidth(in_field)),
        covered(above_horizon, fwidth(above_horizon)),
    );
    let on_globe = select(0.0, covered(1.0 - ray.q, fwidth(ray.q)), ray.along > 0.0);
    let alpha = in.color.a * inside * on_globe;
    return seen_color(vec4f(in.color.rgb * alpha, alpha), ray, t * ray.direction);
}
