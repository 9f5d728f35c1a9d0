// Four texels blended here. Display values that the hardware does not know as such (`display`) are decoded before and encoded after.
@if(display) import common/color.wgsl;

fn texel(at: vec2i) -> vec4f {
    let value = textureLoad(picture, at, 0);
    @if(display) return vec4f(decode_srgb(value.rgb), value.a);
    @if(!display) return value;
}

fn blended(uv: vec2f) -> vec4f {
    let size = vec2i(textureDimensions(picture));
    // From the middle of the first texel.
    let place = clamp(uv * vec2f(size) - 0.5, vec2f(0.0), vec2f(size - 1));
    let low = vec2i(place);
    let high = min(low + 1, size - 1);
    let part = place - vec2f(low);
    let upper = mix(texel(low), texel(vec2i(high.x, low.y)), part.x);
    let lower = mix(texel(vec2i(low.x, high.y)), texel(high), part.x);
    let light = mix(upper, lower, part.y);
    @if(display) return vec4f(encode_srgb(light.rgb), light.a);
    @if(!display) return light;
}
