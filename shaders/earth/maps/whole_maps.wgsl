// Maps of the whole Earth.

fn sample_map(map: texture_2d<f32>, filtering: sampler, layer: u32, at: SurfacePoint) -> vec4f {
    return textureSampleGrad(map, filtering, at.center_uv + at.uv, at.uv_dx, at.uv_dy);
}
