// From light to what the colour target stores, once and last: exposure, tone curve, dithering, encoding.
//
// `TargetColor` in src/gpu/shader/variant.rs says which conditions hold together: radiance (a float target, which gets the light
// itself), else camera, neutral, filmic or none of them (cut off at 1), and encode (the hardware does not encode).
import common/tone.wgsl;
@if(!radiance) import common/dither.wgsl;
@if(encode) import common/color.wgsl;

fn displayed(light: vec3f, exposure: f32, pixel: vec2f) -> vec3f {
    let shown = toned(light, exposure);
    @if(radiance) return shown;
    @if(encode) return encode_srgb(shown) + dither(pixel);
    @if(!radiance && !encode) return shown + dither(pixel) * linear_per_code(shown);
}

// The same, linear and without dithering.
fn toned(light: vec3f, exposure: f32) -> vec3f {
    @if(radiance) return light;
    @if(!radiance) var shown = light * exposure;
    @if(camera) shown = camera(shown);
    @if(neutral) shown = neutral(shown);
    @if(filmic) shown = filmic(shown);
    @if(!radiance) return shown;
}
