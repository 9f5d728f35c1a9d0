// A finished picture drawn over a larger target: bilinear between the middles of its texels, in light.
import common/whole_target.wgsl;
@if(sampled) import upscale/sampled.wgsl;
@if(!sampled) import upscale/loaded.wgsl;

// | group | binding | what        | when    |
// |-------|---------|-------------|---------|
// | 0     | 0       | the picture | always  |
// | 0     | 1       | its sampler | sampled |
@group(0) @binding(0) var picture: texture_2d<f32>;

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    return blended(in.uv);
}
