// Four texels blended by the hardware.
@group(0) @binding(1) var picture_sampler: sampler;

fn blended(uv: vec2f) -> vec4f {
    return textureSampleLevel(picture, picture_sampler, uv, 0.0);
}
