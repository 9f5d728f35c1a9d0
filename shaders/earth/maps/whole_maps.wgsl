// Maps of the whole Earth.

// A change of texture coordinates, as far as a map of so many texels can follow it.
fn map_shift(layer: u32, at: SurfacePoint, texels: vec2f, shift: vec2f) -> vec2f {
    return shift;
}

// Texels of a map of so many, from west to east and north to south, as if they covered the whole Earth.
fn map_texels(layer: u32, at: SurfacePoint, texels: vec2f) -> vec2f {
    return texels;
}

fn sample_map(map: texture_2d<f32>, filtering: sampler, layer: u32, at: SurfacePoint) -> vec4f {
    return textureSampleGrad(map, filtering, at.center_uv + at.uv, at.uv_dx, at.uv_dy);
}
