// A finished image drawn over a larger target: bilinear between the centres of its texels, in linear light.
import common/whole_target.wgsl;
@if(!sampled && display) import common/color.wgsl;

// | group | binding | what        | when    |
// |-------|---------|-------------|---------|
// | 0     | 0       | the picture | always  |
// | 0     | 1       | its sampler | sampled |
@group(0) @binding(0) var picture: texture_2d<f32>;
@if(sampled) @group(0) @binding(1) var picture_sampler: sampler;

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    return blended(in.uv);
}

// Four texels blended by the hardware, or here. Display values in a format without hardware decoding (`display`) are decoded before and encoded
// after.
@if(sampled)
fn blended(uv: vec2f) -> vec4f {
    return textureSampleLevel(picture, picture_sampler, uv, 0.0);
}
@else
fn blended(uv: vec2f) -> vec4f {
    let size = vec2i(textureDimensions(picture));
    // Relative to the centre of the first texel.
    let place = clamp(uv * vec2f(size) - 0.5, vec2f(0.0), vec2f(size - 1));
    let low = vec2i(place);
    let high = min(low + 1, size - 1);
    let part = place - vec2f(low);
    let upper = mix(texel(low), texel(vec2i(high.x, low.y)), part.x);
    let lower = mix(texel(vec2i(low.x, high.y)), texel(high), part.x);
    let light = mix(upper, lower, part.y);
    @if(display) return vec4f(encode_srgb(light.rgb), light.a);
    @else return light;
}

@if(!sampled)
fn texel(at: vec2i) -> vec4f {
    let value = textureLoad(picture, at, 0);
    @if(display) return vec4f(decode_srgb(value.rgb), value.a);
    @else return value;
}
