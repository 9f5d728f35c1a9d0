// Resamples an image of light to half or twice its size. The scale is exactly 2:1 from the upper left corner, whatever the sizes, so that no light
// is lost.
//
// `BloomVariant` in src/gpu/shader/bloom.rs lists the legal combinations of conditions: coarser (half the size), and light (of the light itself).
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

// Weights 1, 3, 3, 1 along each axis, of light that is clamped texel by texel.
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

// Four filtered reads between texels have those weights for half the size.
@if(coarser && !light) const REACH: f32 = 0.75;

// For twice the size one read is enough: the image is smooth over some texels, as each level is blurred before the next is made.
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
