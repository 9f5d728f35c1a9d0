// A picture of light at half its size, or at twice. What stands in the one is 2:1 in the other, from the upper left corner, whatever their
// sizes: of light none is lost on the way.
//
// `BloomVariant` in src/gpu/shader/bloom.rs says which conditions hold together: coarser (half the size), and light (of the light itself).
import common/whole_target.wgsl;
@if(light) import rust::BRIGHTEST_SCATTERED;

// | group | binding | what        |
// |-------|---------|-------------|
// | 0     | 0       | the picture |
// | 0     | 1       | its sampler, but for light |
@group(0) @binding(0) var picture: texture_2d<f32>;
@if(!light) @group(0) @binding(1) var picture_sampler: sampler;

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    return vec4f(blended(in.clip.xy), 1.0);
}

// 1, 3, 3, 1 along each axis, of light that is cut off texel by texel.
@if(light)
fn blended(pixel: vec2f) -> vec3f {
    let first = 2 * vec2i(pixel) - 1;
    let weights = vec4f(1.0, 3.0, 3.0, 1.0) / 8.0;
    var sum = vec3f(0.0);
    for (var row = 0; row < 4; row++) {
        for (var column = 0; column < 4; column++) {
            let texel = clamp(first + vec2i(column, row), vec2i(0), vec2i(textureDimensions(picture)) - 1);
            let light = min(textureLoad(picture, texel, 0).rgb, vec3f(BRIGHTEST_SCATTERED));
            sum += weights[row] * weights[column] * light;
        }
    }
    return sum;
}

// Four reads between texels, which the sampler blends, have those weights for half the size.
@if(coarser && !light) const REACH: f32 = 0.75;

// For twice the size one read is enough: what stands there is smooth over some texels, as each level is blurred before the next is made.
@if(!coarser)
fn blended(pixel: vec2f) -> vec3f {
    return read(0.5 * pixel);
}

@if(coarser && !light)
fn blended(pixel: vec2f) -> vec3f {
    let middle = 2.0 * pixel;
    let upper = read(middle - REACH) + read(middle + vec2f(REACH, -REACH));
    let lower = read(middle + vec2f(-REACH, REACH)) + read(middle + REACH);
    return 0.25 * (upper + lower);
}

@if(!light)
fn read(texel: vec2f) -> vec3f {
    return textureSampleLevel(picture, picture_sampler, texel / vec2f(textureDimensions(picture)), 0.0).rgb;
}
