// Triangles of polygons on the ground. `Triangle` in src/gpu/tracks.rs.

struct TriangleInstance {
    // Corners relative to the eye, ITRF metres: subtracted in f64.
    @location(0) a_m: vec3f,
    // Bit i: the edge opposite to corner i is an edge of the polygon; bit 3 + i: corner i lies on a polygon edge of another triangle.
    @location(1) edges: u32,
    @location(2) b_m: vec3f,
    @location(3) c_m: vec3f,
    @location(4) color: vec4f,
    @location(5) half_color: vec4f,
}

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) from_eye: vec3f,
    // Barycentric coordinates.
    @location(1) weights: vec3f,
    @location(2) @interpolate(flat) edges: u32,
    @location(3) @interpolate(flat) color: vec4f,
    @location(4) @interpolate(flat) half_color: vec3f,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32, in: TriangleInstance) -> Varying {
    // The strip's second triangle is degenerate.
    let corner = min(index, 2u);
    let from_eye_m = select(select(in.c_m, in.b_m, corner == 1u), in.a_m, corner == 0u);
    var out: Varying;
    out.clip = lifted(track.frame.clip_from_eye * vec4f(from_eye_m, 1.0), from_eye_m, ON_GROUND);
    out.from_eye = scaled(from_eye_m);
    out.weights = vec3f(f32(corner == 0u), f32(corner == 1u), f32(corner == 2u));
    out.edges = in.edges;
    out.color = in.color;
    out.half_color = in.half_color.rgb;
    return out;
}

// Distance of the edge from a pixel relative to that of the line through the corner: between 1 and √2.
const CORNER: f32 = 1.2;

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    let ray = ray_of(in.clip.xy);
    // Distance to each edge in pixels. A neighbour across an edge of the polygon draws nothing, so the edge is antialiased inwards.
    let dx = dpdx(in.weights);
    let dy = dpdy(in.weights);
    let per_px = max(sqrt(dx * dx + dy * dy), vec3f(1e-12));
    let is_edge = (vec3u(in.edges) & vec3u(1u, 2u, 4u)) != vec3u(0u);
    let from_edge = select(vec3f(1.0), in.weights / per_px, is_edge);
    // At a corner the edge is roughly parallel to the opposite side, up to half a right angle off.
    let is_corner = (vec3u(in.edges) & vec3u(8u, 16u, 32u)) != vec3u(0u);
    let from_corner = select(vec3f(1.0), CORNER * (1.0 - in.weights) / per_px, is_corner);
    let px = min(from_edge, from_corner);
    let inside = saturate(min(px.x, min(px.y, px.z)));
    let part = inside * in_sight(ray, in.from_eye, ON_GROUND);
    let light = light_of_part(in.color.rgb, in.half_color, part);
    return seen_color(in.color.a * vec4f(light, part), ray, in.from_eye);
}
