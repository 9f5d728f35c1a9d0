// Tracks of satellites: lines of constant width on screen, marks of constant size, polygons, and the ground that a sensor sees.
//
// `TracksVariant` in src/gpu/shader/tracks.rs lists the legal combinations of conditions: lines, marks, polygons or fills; air, inside (of it);
// at_vertices, with lines and air: the air before them is computed at their vertices; those of common/displayed.wgsl.
//
// Drawn after all of the Earth, each pixel through the air in front of it. Occlusion by the globe is tested with each pixel's own ray, not with the
// mesh.

import common/ray.wgsl;
@if(lines) import tracks/lines.wgsl;
@if(marks) import tracks/marks.wgsl;
@if(polygons) import tracks/polygons.wgsl;
@if(fills) import tracks/fills.wgsl;
@if(air) import common/air.wgsl;
@if(air) import common/displayed.wgsl;

// | group | binding | what                     | when   |
// |-------|---------|--------------------------|--------|
// | 0     | 0       | frame                    | always |
// | 0     | 1 …     | common/air.wgsl          | air    |

// Mirrored by `TrackUniforms` in src/gpu/tracks.rs.
struct TrackUniforms {
    frame: FrameUniforms,
    // Width and height of the viewport, pixels.
    size_px: vec2f,
    // Upper boundary of the air, scaled space.
    air_top: f32,
    padding: f32,
}

@group(0) @binding(0) var<uniform> track: TrackUniforms;

fn ray_of(pixel: vec2f) -> Ray {
    return ray_through(track.frame, pixel);
}

// Metres to scaled space.
fn scaled(metres: vec3f) -> vec3f {
    return metres * vec3f(1.0, 1.0, track.frame.polar_stretch) / track.frame.radius_m;
}

// Fraction of a pixel where `inside` is positive, from its change from pixel to pixel.
fn covered(inside: f32, change: f32) -> f32 {
    return saturate(inside / max(change, 1e-12) + 0.5);
}

// Visibility of an element at `from_eye`. Above the ground: hidden if the ray meets the ellipsoid before it, that is, if the ray's distance from
// the centre is below 1 and the element is beyond its nearest point, which is in front of the eye. On the ground: hidden if the ground faces away,
// p·e < 1, at the element's own position, because adjacent rays may miss the globe.
@if(!at_vertices)
fn in_sight(ray: Ray, from_eye: vec3f, flags: u32) -> f32 {
    let globe = covered(1.0 - ray.q, fwidth(ray.q));
    let faces = ground_in_sight(facing_eye(from_eye));
    let is_behind = ray.along > 0.0 && dot(from_eye, ray.direction) > ray.along;
    let before = select(1.0, 1.0 - globe, is_behind);
    return select(before, faces, (flags & ON_GROUND) != 0u);
}

// How much the ground at `from_eye` faces the eye: negative beyond the horizon.
fn facing_eye(from_eye: vec3f) -> f32 {
    return dot(from_eye, track.frame.eye_scaled) + track.frame.above;
}

// Visibility of the ground, from a number with the sign of `facing_eye`.
fn ground_in_sight(facing: f32) -> f32 {
    return covered(facing, fwidth(facing));
}

// Visible colour of an element, premultiplied.
@if(!at_vertices)
fn seen_color(color: vec4f, ray: Ray, from_eye: vec3f) -> vec4f {
    @if(air) return through_air(color, ray, from_eye);
    @else return color;
}

// Through the air: beyond its near boundary a track is dimmed and veiled like everything that its pixel's ray meets there. For premultiplied
// display values or light, as the target stores them.
@if(air && !at_vertices)
fn through_air(color: vec4f, ray: Ray, from_eye: vec3f) -> vec4f {
    let before = air_on(ray);
    let seen = before.through * color.rgb + stored(before.shown, ray.pixel) * color.a;
    return vec4f(select(color.rgb, seen, is_beyond_air(ray, from_eye)), color.a);
}

// Transmittance of the air on a ray, and its tone-mapped light.
@if(air)
struct AirOn {
    through: vec3f,
    shown: vec3f,
}

@if(air)
fn air_on(ray: Ray) -> AirOn {
    let pass_ = pass_by(ray.direction, ray.q, ray.along);
    // Where the ray meets the ground or passes nearest to the centre.
    let up = normal_at(track.frame.eye_scaled + max(ray.along - pass_.mu, 0.0) * ray.direction);
    return AirOn(left_through(pass_), toned(gathered(pass_, up, map_uv(up)).rgb, air.exposure));
}

// Without air on the ray, nothing is beyond it.
@if(air && !at_vertices)
fn is_beyond_air(ray: Ray, from_eye: vec3f) -> bool {
    let half_chord = sqrt(max((track.air_top - ray.q) * (track.air_top + ray.q), 0.0));
    return ray.q < track.air_top && dot(from_eye, ray.direction) > ray.along - half_chord;
}

// Bits of flags.
import rust::ON_GROUND;
@if(lines) import rust::FROM_PREVIOUS;
@if(lines) import rust::UNCASED;

// Elements on the ground are tested at a depth nearer by this fraction of their distance, and by at least this many metres. The mesh, whose facets
// touch the ellipsoid at their corners, then hides neither them, nor chords that are below it, nor, for an eye that looks along the ground, the
// nearer half of their width. Marks are wider than lines.
@if(marks) const LIFT: f32 = 0.5;
@if(!marks && !fills) const LIFT: f32 = 0.1;
@if(!fills) const LIFT_M: f32 = 500.0;

// A clip position, moved towards the eye for elements on the ground: the position on screen is kept.
@if(!fills)
fn lifted(clip: vec4f, from_eye_m: vec3f, flags: u32) -> vec4f {
    let on_ground = clamp(LIFT_M / max(length(from_eye_m), 1.0), LIFT, 0.9);
    let lift = select(0.0, on_ground, (flags & ON_GROUND) != 0u);
    return clip * (1.0 - lift) + track.frame.clip_from_eye[3] * lift;
}

// Its depth.
@if(!fills && !polygons)
fn depth_of(clip: vec4f, from_eye_m: vec3f, flags: u32) -> f32 {
    let at = lifted(clip, from_eye_m, flags);
    return at.z / at.w;
}

// Outside every viewport: nothing is drawn.
@if(!fills && !polygons) const NOWHERE: vec4f = vec4f(2.0, 2.0, 2.0, 1.0);
// Width of the dark outline that separates a line from bright ground, pixels, and its opacity.
@if(!fills && !polygons) const CASING_PX: f32 = 1.0;
@if(!fills && !polygons) const CASING: f32 = 0.5;

// Light of a partly covered pixel, from that of a fully covered and of a half covered one: a later tone curve does not map half of a light to half
// of its display value. The parabola through zero, half and full coverage.
@if(!fills)
fn light_of_part(color: vec3f, half_color: vec3f, part: f32) -> vec3f {
    return max(part * (4.0 * half_color - color + part * (2.0 * color - 4.0 * half_color)), vec3f(0.0));
}

// A line or mark whose edge is `inside_px` away, over its outline of this opacity; premultiplied.
@if(!fills && !polygons)
fn cased(color: vec4f, half_color: vec3f, inside_px: f32, casing: f32, seen: f32) -> vec4f {
    let core = saturate(inside_px + 0.5);
    let cover = saturate(inside_px + CASING_PX + 0.5);
    let light = light_of_part(color.rgb, half_color, core * seen);
    return vec4f(color.a * light, color.a * seen * (core + (cover - core) * casing));
}
