// Develops the accumulated exposed light of all layers: tone curve, dithering, encoding. If the target is larger, light is first enlarged
// bilinearly.
//
// `DevelopVariant` in src/gpu/shader/develop.rs lists the legal combinations of conditions: sampled (the target is larger), measured (the tone
// curve is a measured response), balanced (there is a white balance), grained (there is grain), graded (one of both), and those of
// common/displayed.wgsl.
import common/whole_target.wgsl;
import common/displayed.wgsl;
@if(measured) import common/color.wgsl;
@if(measured) import rust::RESPONSE_SAMPLES;
@if(grained && !encode) import common/color.wgsl;
@if(grained) import rust::{GRAIN_BITS, GRAIN_INCREMENT, GRAIN_MULTIPLIER, GRAIN_SCALE, GRAIN_SHIFT};

// | group | binding | what                    | when     |
// |-------|---------|-------------------------|----------|
// | 0     | 0       | the light               | always   |
// | 0     | 1       | its sampler             | sampled  |
// | 0     | 2       | the measured response   | measured |
// | 0     | 3       | white balance and grain | graded   |
@group(0) @binding(0) var light: texture_2d<f32>;
@if(sampled) @group(0) @binding(1) var light_sampler: sampler;
@if(measured) @group(0) @binding(2) var<uniform> response: ResponseSamples;
@if(graded) @group(0) @binding(3) var<uniform> grade: GradeUniforms;

// Brightness of red, green and blue at irradiances evenly spaced over 0…1.
@if(measured)
struct ResponseSamples {
    samples: array<vec4f, RESPONSE_SAMPLES>,
}

// `GradeUniforms` in src/gpu/develop.rs.
@if(graded)
struct GradeUniforms {
    // Columns of the matrix of the white balance.
    balance_x: vec3f,
    // Strength in display values at mid-scale, times 4.
    grain: f32,
    balance_y: vec3f,
    grain_size_px: f32,
    balance_z: vec3f,
    grain_seed: u32,
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    @if(sampled) let exposed = textureSampleLevel(light, light_sampler, in.uv, 0.0);
    @else let exposed = textureLoad(light, vec2i(in.clip.xy), 0);
    var toned = exposed.rgb;
    @if(balanced) toned = max(mat3x3f(grade.balance_x, grade.balance_y, grade.balance_z) * toned, vec3f(0.0));
    @if(measured) toned = responded(toned);
    var shown = displayed(toned, 1.0, in.clip.xy);
    @if(grained && encode) shown = grained(shown, in.clip.xy);
    @if(grained && !encode) shown = decode_srgb(grained(encode_srgb(shown), in.clip.xy));
    return vec4f(shown, exposed.a);
}

// `Response::shown` in crates/terrella-ground/src/light/response.rs.
@if(measured)
fn responded(light: vec3f) -> vec3f {
    let at = clamp(light, vec3f(0.0), vec3f(1.0)) * f32(RESPONSE_SAMPLES - 1u);
    let low = min(vec3u(at), vec3u(RESPONSE_SAMPLES - 2u));
    let high = low + vec3u(1u);
    let a = vec3f(response.samples[low.r].r, response.samples[low.g].g, response.samples[low.b].b);
    let b = vec3f(response.samples[high.r].r, response.samples[high.g].g, response.samples[high.b].b);
    return decode_srgb(mix(a, b, at - vec3f(low)));
}

// `Grain::grained` in crates/terrella-ground/src/light/grain.rs.
@if(grained)
fn grained(value: vec3f, pixel: vec2f) -> vec3f {
    let c = clamp(value, vec3f(0.0), vec3f(1.0));
    return c + grade.grain * grain_noise(pixel) * c * (1.0 - c);
}

// `Grain::noise`.
@if(grained)
fn grain_noise(pixel: vec2f) -> f32 {
    let at = pixel / grade.grain_size_px - 0.5;
    let cell = floor(at);
    let part = at - cell;
    var sum = 0.0;
    var squares = 0.0;
    for (var n = 0u; n < 4u; n++) {
        let next = vec2u(n & 1u, n >> 1u);
        let weights = select(1.0 - part, part, next == vec2u(1u));
        let weight = weights.x * weights.y;
        sum += weight * grain(vec2u(vec2i(cell)) + next);
        squares += weight * weight;
    }
    return GRAIN_SCALE * sum * inverseSqrt(squares);
}

// `grain`.
@if(grained)
fn grain(cell: vec2u) -> f32 {
    var v = vec3u(cell, grade.grain_seed) * GRAIN_MULTIPLIER + GRAIN_INCREMENT;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> vec3u(GRAIN_SHIFT);
    v.x += v.y * v.z;
    return f32(v.x >> (32u - GRAIN_BITS)) / f32(1u << GRAIN_BITS) - 0.5;
}
