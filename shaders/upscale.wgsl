// A finished picture drawn over a larger target: bilinear between the middles of its texels, in light.
@if(sampled) import upscale/sampled.wgsl;
@if(!sampled) import upscale/loaded.wgsl;

// | group | binding | what        | when    |
// |-------|---------|-------------|---------|
// | 0     | 0       | the picture | always  |
// | 0     | 1       | its sampler | sampled |
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

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    return blended(in.uv);
}
