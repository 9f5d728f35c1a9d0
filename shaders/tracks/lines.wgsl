// Lines of constant width on screen. `LinePoint` in src/gpu/tracks.rs.

// One segment, from a to b, with the points before and after it.
struct Segment {
    @location(0) before_m: vec3f,
    @location(1) a_m: vec3f,
    @location(2) a_flags: u32,
    @location(3) a_color: vec4f,
    @location(4) b_m: vec3f,
    @location(5) b_flags: u32,
    @location(6) b_color: vec4f,
    @location(7) half_width_px: f32,
    @location(8) after_m: vec3f,
    @location(9) after_flags: u32,
    @location(10) a_half_color: vec4f,
    @location(11) b_half_color: vec4f,
}

struct Varying {
    @builtin(position) clip: vec4f,
    // Everything is interpolated linearly on screen (w = 1, independent of the backend): positions over w and 1/w.
    @if(!at_vertices) @location(0) from_eye_over_w: vec3f,
    @if(!at_vertices) @location(1) one_over_w: f32,
    // How much the ground faces the eye.
    @if(at_vertices) @location(0) facing_over_w: f32,
    @location(2) color: vec4f,
    @location(3) across_px: f32,
    @location(4) @interpolate(flat) half_width_px: f32,
    @location(5) @interpolate(flat) flags: u32,
    @location(6) half_color: vec3f,
    // The air before the ground: along the short segments of lines on the ground it is nearly linear.
    @if(at_vertices) @location(7) air_through: vec3f,
    @if(at_vertices) @location(8) air_encoded: vec3f,
}

fn clip_of(from_eye_m: vec3f) -> vec4f {
    return track.frame.clip_from_eye * vec4f(from_eye_m, 1.0);
}

// Distance beyond its edge at which a line without outline still covers a part of pixels, with a tenth for rounding.
const UNCASED_PX: f32 = 0.6;

// Segments are clipped at planes this many times as far out as the viewport's edges: numbers stay small, and cuts are invisible.
const GUARD: f32 = 3.0;

// Clips `span`, the kept part of a segment, where `a` and `b`, the distances of its ends from a plane, change sign.
fn cut(span: vec2f, a: f32, b: f32) -> vec2f {
    if a < 0.0 && b < 0.0 {
        return vec2f(1.0, 0.0);
    }
    let at = a / (a - b);
    return vec2f(
        select(span.x, max(span.x, at), a < 0.0),
        select(span.y, min(span.y, at), b < 0.0),
    );
}

// The part of a segment in front of the eye and near the viewport; empty if x ≥ y.
fn visible_span(a: vec4f, b: vec4f) -> vec2f {
    let near = 1e-6 * max(abs(a.w), abs(b.w));
    var span = cut(vec2f(0.0, 1.0), a.w - near, b.w - near);
    span = cut(span, GUARD * a.w - a.x, GUARD * b.w - b.x);
    span = cut(span, GUARD * a.w + a.x, GUARD * b.w + b.x);
    span = cut(span, GUARD * a.w - a.y, GUARD * b.w - b.y);
    return cut(span, GUARD * a.w + a.y, GUARD * b.w + b.y);
}

// Unit direction on screen from a to b, at least one of which is in front of the eye: the change of x/w, times w².
fn direction_px(a: vec4f, b: vec4f) -> vec2f {
    let v = (b.xy * a.w - a.xy * b.w) * track.size_px;
    let largest = max(abs(v.x), abs(v.y));
    // Scaled by the largest component first: squares of these products can leave f32's range.
    return select(vec2f(1.0, 0.0), normalize(v / max(largest, 1e-30)), largest > 0.0);
}

// Offset of a corner from the line's centre, in half widths: along the bisector if the next segment continues.
fn way_out(along: vec2f, neighbour: vec2f, is_joined: bool) -> vec2f {
    let normal = vec2f(-along.y, along.x);
    let sum = normal + vec2f(-neighbour.y, neighbour.x);
    let bisector = sum / max(length(sum), 1e-6);
    let cosine = dot(bisector, normal);
    return select(normal, bisector / max(cosine, 0.5), is_joined && cosine > 0.5);
}

@vertex
fn vertex(@builtin(vertex_index) index: u32, in: Segment) -> Varying {
    let a = clip_of(in.a_m);
    let b = clip_of(in.b_m);
    let span = visible_span(a, b);
    let along = direction_px(a, b);
    let is_end = index >= 2u;
    let side = f32(index & 1u) * 2.0 - 1.0;
    let t = select(span.x, span.y, is_end);
    let is_whole = select(t == 0.0, t == 1.0, is_end);
    let flags = select(in.a_flags, in.after_flags, is_end);
    let is_joined = is_whole && (flags & FROM_PREVIOUS) != 0u;
    let beyond = clip_of(select(in.before_m, in.after_m, is_end));
    let neighbour = direction_px(select(beyond, b, is_end), select(a, beyond, is_end));
    var out: Varying;
    out.half_width_px = in.half_width_px;
    out.flags = in.b_flags;
    out.across_px = side * (in.half_width_px + select(CASING_PX + 1.0, UNCASED_PX, (in.b_flags & UNCASED) != 0u));
    out.color = mix(in.a_color, in.b_color, t);
    out.half_color = mix(in.a_half_color.rgb, in.b_half_color.rgb, t);
    out.clip = NOWHERE;
    @if(at_vertices) let facing = vec2f(facing_eye(scaled(in.a_m)), facing_eye(scaled(in.b_m)));
    @if(at_vertices) let is_seen = max(facing.x, facing.y) > 0.0;
    @else let is_seen = true;
    if (in.b_flags & FROM_PREVIOUS) != 0u && span.x < span.y && is_seen {
        let at = mix(a, b, t);
        let out_px = way_out(along, neighbour, is_joined) * out.across_px;
        let from_eye_m = mix(in.a_m, in.b_m, t);
        out.clip = vec4f(at.xy / at.w + 2.0 * out_px / track.size_px, depth_of(at, from_eye_m, in.b_flags), 1.0);
        @if(!at_vertices) out.one_over_w = 1.0 / at.w;
        @if(!at_vertices) out.from_eye_over_w = scaled(from_eye_m) / at.w;
        @if(at_vertices) out.facing_over_w = mix(facing.x, facing.y, t) / at.w;
        @if(at_vertices) let before = air_on(ray_along(track.frame, scaled(from_eye_m), vec2f(0.0)));
        @if(at_vertices) out.air_through = before.through;
        @if(at_vertices) out.air_encoded = encoded(before.shown);
    }
    return out;
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    @if(!at_vertices) let from_eye = in.from_eye_over_w / in.one_over_w;
    @if(!at_vertices) let ray = ray_of(in.clip.xy);
    @if(!at_vertices) let seen = in_sight(ray, from_eye, in.flags);
    @if(at_vertices) let seen = ground_in_sight(in.facing_over_w);
    let casing = select(CASING, 0.0, (in.flags & UNCASED) != 0u);
    let color = cased(in.color, in.half_color, in.half_width_px - abs(in.across_px), casing, seen);
    @if(!at_vertices) return seen_color(color, ray, from_eye);
    @if(at_vertices) return vec4f(in.air_through * color.rgb + in.air_encoded * color.a, color.a);
}
