// Marks of constant size on screen: dots, and rings on the ground. `Mark` in src/gpu/tracks.rs.

struct MarkInstance {
    // Position relative to the eye, ITRF metres: subtracted in f64.
    @location(0) from_eye_m: vec3f,
    @location(1) flags: u32,
    @location(2) color: vec4f,
    @location(3) radius_px: f32,
    @location(4) half_color: vec4f,
}

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) at_px: vec2f,
    @location(1) @interpolate(flat) from_eye: vec3f,
    @location(2) @interpolate(flat) flags: u32,
    @location(3) @interpolate(flat) color: vec4f,
    @location(4) @interpolate(flat) radius_px: f32,
    @location(5) @interpolate(flat) half_color: vec3f,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32, in: MarkInstance) -> Varying {
    let clip = track.frame.clip_from_eye * vec4f(in.from_eye_m, 1.0);
    let corner = vec2f(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0;
    var out: Varying;
    out.at_px = corner * (in.radius_px + CASING_PX + 1.5);
    out.from_eye = scaled(in.from_eye_m);
    out.flags = in.flags;
    out.color = in.color;
    out.half_color = in.half_color.rgb;
    out.radius_px = in.radius_px;
    out.clip = NOWHERE;
    if clip.w > 1e-6 * length(in.from_eye_m) {
        out.clip = vec4f(clip.xy / clip.w + 2.0 * out.at_px / track.size_px, depth_of(clip, in.from_eye_m, in.flags), 1.0);
    }
    return out;
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    let ray = ray_of(in.clip.xy);
    // A mark on the ground is so small that it is hidden or visible as a whole.
    let seen = in_sight(ray, in.from_eye, in.flags);
    // A satellite is a dot; its sub-satellite point is a ring around a point.
    let r = length(in.at_px);
    var inside_px = in.radius_px - r;
    if (in.flags & ON_GROUND) != 0u {
        inside_px = max(0.9 - abs(r - in.radius_px), 1.2 - r);
    }
    return seen_color(cased(in.color, in.half_color, inside_px, CASING, seen), ray, in.from_eye);
}
