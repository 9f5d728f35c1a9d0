// Sampling of maps at a point of the ground: maps of the whole Earth, or a block's tiles with whole maps as fallback.
//
// With parts, blocks may be cut. The placement of such a block is: its first cell, how often it is halved for a cell, and, negative, the border's
// fraction of a tile's side, and the part's own fraction.
import rust::PI;
@if(tiles) import rust::{MAP_LAYERS, TILE_BORDER};
@if(tiles && relief) import rust::WHOLE_MAP;
@if(parts && tiles) import rust::{BLOCK_COLUMNS, BLOCK_ROWS, PART_INDEX_BITS};

@if(tiles && !parts)
fn map_placement(layer: u32, at: SurfacePoint) -> vec4f {
    @if(relief) if at.block >= WHOLE_MAP { return vec4f(at.center_uv, 1.0, 1.0); }
    return tiles.placements[at.block * MAP_LAYERS + layer];
}

@if(parts)
struct MapPlacement {
    // Texture coordinates of the block's centre, and their scale.
    uv: vec4f,
    array_layer: u32,
}

@if(parts && !tiles)
fn map_placement(layer: u32, at: SurfacePoint) -> MapPlacement {
    return MapPlacement(vec4f(at.center_uv, 1.0, 1.0), 0u);
}

@if(parts && tiles)
fn map_placement(layer: u32, at: SurfacePoint) -> MapPlacement {
    @if(relief) if at.block >= WHOLE_MAP { return MapPlacement(vec4f(at.center_uv, 1.0, 1.0), 0u); }
    let of_block = tiles.placements[at.block * MAP_LAYERS + layer];
    if of_block.z >= 0.0 {
        return MapPlacement(of_block, 0u);
    }
    let blocks = vec2f(f32(BLOCK_COLUMNS), f32(BLOCK_ROWS));
    let depth = u32(of_block.y);
    let side = f32(1u << depth);
    let cell = vec2u(clamp(floor((at.uv * blocks + 0.5) * side), vec2f(0.0), vec2f(side - 1.0)));
    let index = u32(of_block.x) + (cell.y << depth) + cell.x;
    let code = (tiles.cells[index >> 3u][(index >> 1u) & 3u] >> ((index & 1u) * 16u)) & 0xffffu;
    let part_depth = code >> PART_INDEX_BITS;
    let corner = vec2f(cell >> vec2u(depth - part_depth));
    let parts = f32(1u << part_depth);
    let center = of_block.w * (0.5 * parts - corner) - of_block.z;
    return MapPlacement(
        vec4f(center, of_block.w * parts * blocks),
        code & ((1u << PART_INDEX_BITS) - 1u),
    );
}

// A shift of texture coordinates, clamped to a map of this size: a tile ends at its border.
fn map_shift(layer: u32, at: SurfacePoint, texels: vec2f, shift: vec2f) -> vec2f {
    @if(!tiles) return shift;
    @if(tiles) let moved = abs(shift * map_texels(layer, at, texels));
    @if(tiles) return shift * min(f32(TILE_BORDER - 1u) / max(max(moved.x, moved.y), 1e-6), 1.0);
}

// Size of a map in texels, from west to east and north to south, as if it covered the whole Earth.
fn map_texels(layer: u32, at: SurfacePoint, texels: vec2f) -> vec2f {
    @if(!tiles) return texels;
    @if(tiles && !parts) return texels * map_placement(layer, at).zw;
    @if(parts) return texels * map_placement(layer, at).uv.zw;
}

// Size of a texel from north to south in a map of this size, equatorial radii.
fn texel_radii(layer: u32, at: SurfacePoint, texels: vec2u) -> f32 {
    return PI / map_texels(layer, at, vec2f(texels)).y;
}

@if(parts)
fn sample_map(map: texture_2d_array<f32>, filtering: sampler, layer: u32, at: SurfacePoint) -> vec4f {
    let placement = map_placement(layer, at);
    let scale = placement.uv.zw;
    let uv = placement.uv.xy + at.uv * scale;
    return textureSampleGrad(map, filtering, uv, placement.array_layer, at.uv_dx * scale, at.uv_dy * scale);
}
@else
fn sample_map(map: texture_2d<f32>, filtering: sampler, layer: u32, at: SurfacePoint) -> vec4f {
    @if(!tiles) return textureSampleGrad(map, filtering, at.center_uv + at.uv, at.uv_dx, at.uv_dy);
    @if(tiles) let placement = map_placement(layer, at);
    @if(tiles) let uv = placement.xy + at.uv * placement.zw;
    @if(tiles) return textureSampleGrad(map, filtering, uv, at.uv_dx * placement.zw, at.uv_dy * placement.zw);
}
