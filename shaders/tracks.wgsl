// Tracks of satellites: lines of constant width on screen, marks of constant size, and the ground that a sensor sees.
//
// Features (see src/gpu/shader.rs): marks, fill (neither: lines), encode.
//
// Drawn twice with two uniform buffers: what lies beyond the near boundary of the air before the air is drawn, so that it
// blends over it, and what lies this side of it after. The globe hides by each pixel's own ray, not by the mesh.

#import common/frame.wgsl
#import common/color.wgsl

// | group | binding | what               | when   |
// |-------|---------|--------------------|--------|
// | 0     | 0       | frame and the side | always |

// Mirrored by `TrackFrame` in src/gpu/tracks.rs.
struct TrackFrame {
    frame: Frame,
    // Width and height of the viewport, pixels.
    size_px: vec2f,
    // Upper boundary of the air, scaled space.
    air_top: f32,
    // 1: what lies beyond the air's near boundary; −1: what lies before it.
    side: f32,
}

@group(0) @binding(0) var<uniform> track: TrackFrame;

// A pixel's ray in scaled space: its unit direction, the distance of its line from the centre, and how far along it the
// point nearest the centre is.
struct Ray {
    direction: vec3f,
    q: f32,
    along: f32,
}

fn ray_of(pixel: vec2f) -> Ray {
    let ray = track.frame.corner_ray + pixel.x * track.frame.pixel_right + pixel.y * track.frame.pixel_down;
    var out: Ray;
    out.direction = normalize(ray * vec3f(1.0, 1.0, track.frame.polar_stretch));
    out.q = length(cross(track.frame.eye_scaled, out.direction));
    out.along = -dot(track.frame.eye_scaled, out.direction);
    return out;
}

// Metres to scaled space.
fn scaled(metres: vec3f) -> vec3f {
    return metres * vec3f(1.0, 1.0, track.frame.polar_stretch) / track.frame.radius_m;
}

// How much of a pixel lies where `inside` is above 0, by its change from pixel to pixel.
fn covered(inside: f32, change: f32) -> f32 {
    return saturate(inside / max(change, 1e-12) + 0.5);
}

// What part of a pixel's light comes from a thing at `from_eye`. Above the ground: none where the ray has met the
// ellipsoid before it, that is, where it passes nearer than 1 and the thing lies beyond its nearest point, which lies
// before the eye. On the ground:
// none where the ground faces away, p·e < 1; by the thing's own place, because rays beside it may miss the globe.
fn in_sight(ray: Ray, from_eye: vec3f, flags: u32) -> f32 {
    let globe = covered(1.0 - ray.q, fwidth(ray.q));
    let facing = dot(from_eye, track.frame.eye_scaled) + track.frame.above;
    let faces = covered(facing, fwidth(facing));
    let is_behind = ray.along > 0.0 && dot(from_eye, ray.direction) > ray.along;
    let before = select(1.0, 1.0 - globe, is_behind);
    return select(before, faces, (flags & ON_GROUND) != 0u);
}

// Whether a thing lies on the side of the air's near boundary that is drawn now. A ray that meets no air has none beyond.
fn is_on_side(ray: Ray, from_eye: vec3f) -> bool {
    let half_chord = sqrt(max((track.air_top - ray.q) * (track.air_top + ray.q), 0.0));
    let is_beyond = ray.q < track.air_top && dot(from_eye, ray.direction) > ray.along - half_chord;
    return is_beyond == (track.side > 0.0);
}

// Display values as given, or in linear light.
fn target_color(display: vec3f) -> vec3f {
#if encode
    return display;
#else
    return decode_srgb(display);
#endif
}

// Bits of flags.
const FROM_PREVIOUS: u32 = 1;
const ON_GROUND: u32 = 2;

// What lies on the ground is tested against depths this part of its distance nearer, and at least so many metres, so that
// the mesh, whose facets meet the ellipsoid at their corners, does not hide it, nor chords that lie below it, nor, where the
// eye looks along the ground, the nearer half of its width. Marks are wider than lines.
#if marks
const LIFT: f32 = 0.5;
#else
const LIFT: f32 = 0.1;
#endif
const LIFT_M: f32 = 500.0;

// Depth of a clip position, lifted where it lies on the ground.
fn depth_of(clip: vec4f, from_eye_m: vec3f, flags: u32) -> f32 {
    let on_ground = clamp(LIFT_M / max(length(from_eye_m), 1.0), LIFT, 0.9);
    let lift = select(0.0, on_ground, (flags & ON_GROUND) != 0u);
    let at = clip * (1.0 - lift) + track.frame.clip_from_eye[3] * lift;
    return at.z / at.w;
}

// Outside of every viewport: nothing is drawn.
const NOWHERE: vec4f = vec4f(2.0, 2.0, 2.0, 1.0);
// Width of the dark edge that sets a line off from bright ground, pixels, and its opacity.
const CASING_PX: f32 = 1.0;
const CASING: f32 = 0.5;

// A line or mark whose edge is `inside_px` away, over its casing; premultiplied.
fn cased(color: vec4f, inside_px: f32, seen: f32) -> vec4f {
    let core = saturate(inside_px + 0.5);
    let cover = saturate(inside_px + CASING_PX + 0.5);
    let alpha = color.a * seen;
    return vec4f(color.rgb * (alpha * core), alpha * (core + (cover - core) * CASING));
}

#if marks
struct MarkInstance {
    // From the eye, ITRF metres: subtracted in f64.
    @location(0) from_eye_m: vec3f,
    @location(1) flags: u32,
    @location(2) color: vec4f,
    @location(3) radius_px: f32,
}

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) at_px: vec2f,
    @location(1) @interpolate(flat) from_eye: vec3f,
    @location(2) @interpolate(flat) flags: u32,
    @location(3) @interpolate(flat) color: vec4f,
    @location(4) @interpolate(flat) radius_px: f32,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32, in: MarkInstance) -> Varying {
    let clip = track.frame.clip_from_eye * vec4f(in.from_eye_m, 1.0);
    let corner = vec2f(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0;
    var out: Varying;
    out.at_px = corner * (in.radius_px + CASING_PX + 1.5);
    out.from_eye = scaled(in.from_eye_m);
    out.flags = in.flags;
    out.color = vec4f(target_color(in.color.rgb), in.color.a);
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
    // A mark is so small that it is hidden or seen as a whole where it lies on the ground.
    let seen = in_sight(ray, in.from_eye, in.flags);
    if !is_on_side(ray, in.from_eye) {
        discard;
    }
    // A satellite is a dot; its place on the ground a ring about a point.
    let r = length(in.at_px);
    var inside_px = in.radius_px - r;
    if (in.flags & ON_GROUND) != 0u {
        inside_px = max(0.9 - abs(r - in.radius_px), 1.2 - r);
    }
    return cased(in.color, inside_px, seen);
}
#else
#if fill
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
    out.color = vec4f(target_color(in.color.rgb), in.color.a);
    return out;
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    let ray = ray_of(in.clip.xy);
    // The ground: |e + t d| = 1, as in earth.wgsl.
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
    return vec4f(in.color.rgb * alpha, alpha);
}
#else
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
}

struct Varying {
    @builtin(position) clip: vec4f,
    // Everything is interpolated linearly on screen (w = 1, so that no backend needs to know how): places over w and 1/w.
    @location(0) from_eye_over_w: vec3f,
    @location(1) one_over_w: f32,
    @location(2) color: vec4f,
    @location(3) across_px: f32,
    @location(4) @interpolate(flat) half_width_px: f32,
    @location(5) @interpolate(flat) flags: u32,
}

fn clip_of(from_eye_m: vec3f) -> vec4f {
    return track.frame.clip_from_eye * vec4f(from_eye_m, 1.0);
}

// Segments are cut at planes this often as far out as the viewport's edges: numbers stay small, and no cut is seen.
const GUARD: f32 = 3.0;

// Cuts `span`, the part of a segment that is kept, where `a` and `b`, the distances of its ends from a plane, change sign.
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

// The part of a segment before the eye and near the viewport; empty where x ≥ y.
fn visible_span(a: vec4f, b: vec4f) -> vec2f {
    let near = 1e-6 * max(abs(a.w), abs(b.w));
    var span = cut(vec2f(0.0, 1.0), a.w - near, b.w - near);
    span = cut(span, GUARD * a.w - a.x, GUARD * b.w - b.x);
    span = cut(span, GUARD * a.w + a.x, GUARD * b.w + b.x);
    span = cut(span, GUARD * a.w - a.y, GUARD * b.w - b.y);
    return cut(span, GUARD * a.w + a.y, GUARD * b.w + b.y);
}

// Unit direction on screen from a to b, where at least one of them lies before the eye: the change of x/w, times w².
fn direction_px(a: vec4f, b: vec4f) -> vec2f {
    let v = (b.xy * a.w - a.xy * b.w) * track.size_px;
    let largest = max(abs(v.x), abs(v.y));
    // By the largest component first: squares of these products can leave f32's range.
    return select(vec2f(1.0, 0.0), normalize(v / max(largest, 1e-30)), largest > 0.0);
}

// The corner's way out from the line's middle, in half widths: along the bisector where the next segment goes on.
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
    var neighbour = along;
    if is_joined && is_end {
        neighbour = direction_px(b, clip_of(in.after_m));
    } else if is_joined {
        neighbour = direction_px(clip_of(in.before_m), a);
    }
    var out: Varying;
    out.half_width_px = in.half_width_px;
    out.flags = in.b_flags;
    out.across_px = side * (in.half_width_px + CASING_PX + 1.0);
    let color = mix(in.a_color, in.b_color, t);
    out.color = vec4f(target_color(color.rgb), color.a);
    out.clip = NOWHERE;
    if (in.b_flags & FROM_PREVIOUS) != 0u && span.x < span.y {
        let at = mix(a, b, t);
        let out_px = way_out(along, neighbour, is_joined) * out.across_px;
        let from_eye_m = mix(in.a_m, in.b_m, t);
        out.clip = vec4f(at.xy / at.w + 2.0 * out_px / track.size_px, depth_of(at, from_eye_m, in.b_flags), 1.0);
        out.one_over_w = 1.0 / at.w;
        out.from_eye_over_w = scaled(from_eye_m) / at.w;
    }
    return out;
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    let ray = ray_of(in.clip.xy);
    let from_eye = in.from_eye_over_w / in.one_over_w;
    let seen = in_sight(ray, from_eye, in.flags);
    if !is_on_side(ray, from_eye) {
        discard;
    }
    return cased(in.color, in.half_width_px - abs(in.across_px), seen);
}
#endif
#endif
