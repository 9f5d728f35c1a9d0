// Exposed light that all layers have added to becomes what is shown of it: tone curve, dithering, encoding. Where the target is larger, light
// is enlarged before that, bilinear.
//
// `DevelopVariant` in src/gpu/shader/develop.rs says which conditions hold together: sampled (the target is larger), and those of
// common/displayed.wgsl.
import common/whole_target.wgsl;
import common/displayed.wgsl;

// | group | binding | what        | when    |
// |-------|---------|-------------|---------|
// | 0     | 0       | the light   | always  |
// | 0     | 1       | its sampler | sampled |
@group(0) @binding(0) var light: texture_2d<f32>;
@if(sampled) @group(0) @binding(1) var light_sampler: sampler;

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    @if(sampled) let exposed = textureSampleLevel(light, light_sampler, in.uv, 0.0);
    @else let exposed = textureLoad(light, vec2i(in.clip.xy), 0);
    return vec4f(displayed(exposed.rgb, 1.0, in.clip.xy), exposed.a);
}
