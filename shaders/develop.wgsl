// Exposed light that all layers have added to becomes what is shown of it: tone curve, dithering, encoding. Where the target is larger, light
// is enlarged before that, bilinear.
//
// `DevelopVariant` in src/gpu/shader/develop.rs says which conditions hold together: sampled (the target is larger), measured (the tone curve
// is a measured response), and those of common/displayed.wgsl.
import common/whole_target.wgsl;
import common/displayed.wgsl;
@if(measured) import common/color.wgsl;
@if(measured) import rust::RESPONSE_SAMPLES;

// | group | binding | what                 | when     |
// |-------|---------|----------------------|----------|
// | 0     | 0       | the light            | always   |
// | 0     | 1       | its sampler          | sampled  |
// | 0     | 2       | the measured response | measured |
@group(0) @binding(0) var light: texture_2d<f32>;
@if(sampled) @group(0) @binding(1) var light_sampler: sampler;
@if(measured) @group(0) @binding(2) var<uniform> response: ResponseSamples;

// Brightness of red, green and blue at irradiances evenly spaced over 0…1.
@if(measured)
struct ResponseSamples {
    samples: array<vec4f, RESPONSE_SAMPLES>,
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    @if(sampled) let exposed = textureSampleLevel(light, light_sampler, in.uv, 0.0);
    @else let exposed = textureLoad(light, vec2i(in.clip.xy), 0);
    var toned = exposed.rgb;
    @if(measured) toned = responded(toned);
    return vec4f(displayed(toned, 1.0, in.clip.xy), exposed.a);
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
