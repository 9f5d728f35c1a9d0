// A finished picture drawn over a larger target: bilinear between the middles of its texels, in light. Formats that hold display
// values without the hardware knowing (`display`) are decoded before and encoded after.
@if(display) import common/color.wgsl;

// | group | binding | what        | when   |
// |-------|---------|-------------|--------|
// | 0     | 0       | the picture | always |
@group(0) @binding(0) var picture: texture_2d<f32>;

struct Varying {
    @builtin(position) clip: vec4f,
    // Of the picture, 0…1 from its upper left corner.
    @location(0) uv: vec2f,
}

// One triangle over the whole target.
@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Varying {
    let uv = vec2f(f32(index & 1u), f32(index >> 1u)) * 2.0;
    return Varying(vec4f(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y, 0.5, 1.0), uv);
}

fn texel(at: vec2i) -> vec4f {
    let value = textureLoad(picture, at, 0);
    @if(display) return vec4f(decode_srgb(value.rgb), value.a);
    @if(!display) return value;
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    let size = vec2i(textureDimensions(picture));
    // From the middle of the first texel.
    let place = clamp(in.uv * vec2f(size) - 0.5, vec2f(0.0), vec2f(size - 1));
    let low = vec2i(place);
    let high = min(low + 1, size - 1);
    let part = place - vec2f(low);
    let upper = mix(texel(low), texel(vec2i(high.x, low.y)), part.x);
    let lower = mix(texel(vec2i(low.x, high.y)), texel(high), part.x);
    let light = mix(upper, lower, part.y);
    @if(display) return vec4f(encode_srgb(light.rgb), light.a);
    @if(!display) return light;
}
