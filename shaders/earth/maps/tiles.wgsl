// Tiles of a block, or whole maps in their place.
import rust::{MAP_LAYERS, TILE_BORDER};
@if(relief) import rust::WHOLE_MAP;

fn map_placement(layer: u32, at: SurfacePoint) -> vec4f {
    @if(relief) if at.block >= WHOLE_MAP { return vec4f(at.center_uv, 1.0, 1.0); }
    return tiles.placements[at.block * MAP_LAYERS + layer];
}

// A change of texture coordinates, as far as a map of so many texels can follow it: a tile ends at its border.
fn map_shift(layer: u32, at: SurfacePoint, texels: vec2f, shift: vec2f) -> vec2f {
    let moved = abs(shift * map_texels(layer, at, texels));
    return shift * min(f32(TILE_BORDER - 1u) / max(max(moved.x, moved.y), 1e-6), 1.0);
}

// Texels of a map of so many, from west to east and north to south, as if they covered the whole Earth.
fn map_texels(layer: u32, at: SurfacePoint, texels: vec2f) -> vec2f {
    return texels * map_placement(layer, at).zw;
}

fn sample_map(map: texture_2d<f32>, filtering: sampler, layer: u32, at: SurfacePoint) -> vec4f {
    let placement = map_placement(layer, at);
    let uv = placement.xy + at.uv * placement.zw;
    return textureSampleGrad(map, filtering, uv, at.uv_dx * placement.zw, at.uv_dy * placement.zw);
}
