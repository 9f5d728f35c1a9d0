// Airglow and aurora, added to everything behind them: the ground, the halo, stars.
//
// `GlowVariant` in src/gpu/shader/air.rs lists the legal combinations of conditions: inside (the eye is in the air below), airglow, aurora, and
// those of common/displayed.wgsl.
//
// On 8-bit targets displayed colours are added instead of light.
import common/air.wgsl;
import common/displayed.wgsl;
@if(!inside) import rust::AIR_TOP;
import rust::{GLOW_DAY_SIN, GLOW_NIGHT_SIN, PI};
@if(shown) import rust::LUMINANCE;
@if(exposed) import rust::LUMINANCE;
@if(airglow) import common/air/airglow.wgsl;
@if(airglow) import rust::AIRGLOW_HEIGHTS;
@if(aurora) import common/air/aurora.wgsl;

// | group | binding | what                     | when             |
// |-------|---------|--------------------------|------------------|
// | 0     | 0       | this                     | always           |
// | 0     | 1 …     | common/air.wgsl          | always           |
// | 0     | 3       | common/air/aurora.wgsl   | aurora           |

// Mirrored by `GlowUniforms` in src/plan/glow.rs.
struct GlowUniforms {
    // The ray through the image's upper left corner, to the plane one metre in front of the eye; the billboard's axes in scaled space.
    corner: vec3f,
    // Depth at which it is drawn.
    depth: f32,
    // Increments to the upper right corner, and to the lower left one.
    across: vec3f,
    // Brightness of the night relative to the true one.
    gain: f32,
    down: vec3f,
    // L² − 1 of the eye's distance L from the centre, without cancellation.
    above: f32,
    // The fractions of the airglow's layers below the eye.
    beneath: vec3f,
    padding_b: f32,
    // Bounds of the glow on screen: least x and y, greatest x and y, −1…1.
    bounds: vec4f,
}

@group(0) @binding(0) var<uniform> glow: GlowUniforms;

struct Varying {
    @builtin(position) clip: vec4f,
    // Relative to the eye, the billboard's axes.
    @location(0) ray: vec3f,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Varying {
    let x = select(glow.bounds.x, glow.bounds.z, (index & 1u) != 0u);
    let y = select(glow.bounds.y, glow.bounds.w, (index & 2u) != 0u);
    let ray = glow.corner + (0.5 + 0.5 * x) * glow.across + (0.5 - 0.5 * y) * glow.down;
    return Varying(vec4f(x, y, glow.depth, 1.0), ray);
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    let d = normalize(in.ray);
    let ray = glow_ray(d);
    @if(airglow) let pixel = fwidth(ray.height);
    @if(aurora) let angle = length(fwidth(d));
    let far = left_of_glow(ray.pass_);
    var light = vec3f(0.0);
    @if(airglow) light += airglow(ray, pixel, far);
    @if(aurora) light += aurora(ray, angle, far);
    light = as_photographed(light);
    // Another dither pattern than that of the background, and none where there is no light.
    let shown = displayed(glow.gain * light, air.exposure, in.clip.yx + 0.5);
    return vec4f(select(vec3f(0.0), shown, max(light.r, light.g) > 0.0), 0.0);
}

// A camera's sensors overlap, so that it records no line as pure as it is: white is mixed in until the darkest channel has a fixed part of the brightest. The
// luminance is kept. Measured light is not changed.
@if(!shown && !exposed)
fn as_photographed(light: vec3f) -> vec3f {
    return light;
}
@else
fn as_photographed(light: vec3f) -> vec3f {
    let most = max(light.r, max(light.g, light.b));
    let least = min(light.r, min(light.g, light.b));
    let grey = dot(light, LUMINANCE);
    let pale = 0.3;
    let lacks = pale * most - least;
    // What the darkest channel gains on the brightest by white.
    let gain = grey - least + pale * (most - grey);
    return mix(light, vec3f(grey), saturate(lacks / max(gain, 1e-30)));
}

struct GlowRay {
    pass_: Pass,
    // q − 1, accurate to some tens of metres near the Earth.
    height: f32,
}

// `d`: unit vector in the billboard's axes.
fn glow_ray(d: vec3f) -> GlowRay {
    let along = air.eye_distance * d.z;
    let q = air.eye_distance * length(d.xy);
    let direction = d.x * air.across_x + d.y * air.across_y + d.z * air.toward_center;
    // q² + along² = L². From far away squares of distances are large, and q itself is accurate to one part in 10⁷.
    let height = select(q - 1.0, (glow.above - along * along) / (1.0 + q), air.eye_distance < 2.0);
    return GlowRay(pass_by(direction, q, along), height);
}

// The eye in scaled space.
fn glow_eye() -> vec3f {
    return -air.eye_distance * air.toward_center;
}

// Transmittance of the air for light from beyond it.
fn left_of_glow(pass_: Pass) -> vec3f {
    // Light from behind the ground is invisible.
    @if(!inside) let meets_air = pass_.along > 0.0 && pass_.q < AIR_TOP;
    @else let meets_air = true;
    if meets_ground(pass_) || !meets_air {
        return vec3f(1.0);
    }
    return left_through(pass_);
}

// Fraction of the glow that is not outshone by twilight, where a ray crosses its middle: before the point nearest to the Earth if `side` is −1,
// beyond it if it is 1.
@if(airglow)
fn glow_at_night(ray: GlowRay, side: f32) -> f32 {
    return is_night(glow_place(ray, ray.pass_.along + side * half_chord(ray, AIRGLOW_HEIGHTS.y)));
}

// Half of the chord of a ray within a sphere of this height; 0 if it passes outside.
fn half_chord(ray: GlowRay, height: f32) -> f32 {
    return sqrt(max((height - ray.height) * (2.0 + height + ray.height), 0.0));
}

fn glow_place(ray: GlowRay, along: f32) -> vec3f {
    return glow_eye() + max(along, 0.0) * ray.pass_.direction;
}

fn is_night(scaled: vec3f) -> f32 {
    return 1.0 - smoothstep(GLOW_NIGHT_SIN, GLOW_DAY_SIN, dot(normal_at(scaled), air.sun));
}
