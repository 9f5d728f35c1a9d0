// Maps of the whole Earth.

// A change of texture coordinates, as far as a map of so many texels can follow it.
fn map_shift(layer: u32, at: SurfacePoint, texels: vec2f, shift: vec2f) -> vec2f {
    return shift;
}

fn sample_map(map: texture_2d<f32>, filtering: sampler, layer: u32, at: SurfacePoint) -> vec4f {
    return textureSampleGrad(map, filtering, at.center_uv + at.uv, at.uv_dx, at.uv_dy);
}
