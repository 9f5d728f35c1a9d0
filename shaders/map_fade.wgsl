// Two maps blended into a third, level by level: the hardware selects the level of each that is as fine as the target.
import common/whole_target.wgsl;

// | group | binding | what                                    |
// |-------|---------|-----------------------------------------|
// | 0     | 0       | the map that is left                    |
// | 0     | 1       | the map that comes                      |
// | 0     | 2       | their sampler: repeats round the Earth  |
// | 0     | 3       | how much of the latter                  |
@group(0) @binding(0) var map_before: texture_2d<f32>;
@group(0) @binding(1) var map_after: texture_2d<f32>;
@group(0) @binding(2) var map_sampler: sampler;
@group(0) @binding(3) var<uniform> map_fade: MapFade;

struct MapFade {
    // 0…1, in x.
    weight: vec4f,
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    let before = textureSample(map_before, map_sampler, in.uv);
    let after = textureSample(map_after, map_sampler, in.uv);
    return mix(before, after, map_fade.weight.x);
}
