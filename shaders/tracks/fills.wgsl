// The ground that a sensor sees: all of it inside a cone and in sight of the satellite. `Fill` in src/gpu/tracks.rs.

struct FillInstance {
    // Where on screen it can be: least and greatest x and y, −1…1.
    @location(0) bounds: vec4f,
    // The satellite, scaled space, and the depth that what stands before the ground must have.
    @location(1) apex: vec3f,
    @location(2) depth: f32,
    // Straight down, unit, ITRF axes, and the tangent of the cone's half angle.
    @location(3) down: vec3f,
    @location(4) tangent: f32,
    @location(5) color: vec4f,
}

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat) apex: vec3f,
    @location(1) @interpolate(flat) down: vec3f,
    @location(2) @interpolate(flat) tangent: f32,
    @location(3) @interpolate(flat) color: vec4f,
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
    out.down = in.down;
    out.tangent = in.tangent;
    out.color = in.color;
    return out;
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    let ray = ray_of(in.clip.xy);
    // The ground: |e + t d| = 1, as in earth/surface_point/ray_on_ellipsoid.wgsl.
    let root = sqrt(max((1.0 - ray.q) * (1.0 + ray.q), 0.0));
    let t = track.frame.above / max(root + ray.along, 1e-9);
    let ground = track.frame.eye_scaled + t * ray.direction;
    // In the cone: |v × down| < v·down tan α, which is good for narrow cones too. In sight of the satellite: p·s > 1.
    let v = (ground - in.apex) / vec3f(1.0, 1.0, track.frame.polar_stretch);
    let in_cone = dot(v, in.down) * in.tangent - length(cross(v, in.down));
    let above_horizon = dot(ground, in.apex) - 1.0;
    let inside = min(
        covered(in_cone, fwidth(in_cone)),
        covered(above_horizon, fwidth(above_horizon)),
    );
    let on_globe = select(0.0, covered(1.0 - ray.q, fwidth(ray.q)), ray.along > 0.0);
    let alpha = in.color.a * inside * on_globe;
    return seen_color(vec4f(in.color.rgb * alpha, alpha), ray, t * ray.direction);
}
