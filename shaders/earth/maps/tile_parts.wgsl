// Tiles of blocks that may be cut into parts, or whole maps in their place.
//
// A block's placement then is: its first cell, how often it is halved for a cell, and negative the part of a tile's side that is
// border, and the part that is its own.
import rust::{BLOCK_COLUMNS, BLOCK_ROWS, MAP_LAYERS, PART_INDEX_BITS, TILE_BORDER};
@if(relief) import rust::WHOLE_MAP;

struct MapPlacement {
    // Texture coordinates of the block's centre, and their change per whole map.
    uv: vec4f,
    array_layer: u32,
}

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
    let code = tiles.cells[index >> 3u][(index >> 1u) & 3u] >> ((index & 1u) * 16u) & 0xffffu;
    let part_depth = code >> PART_INDEX_BITS;
    let corner = vec2f(cell >> vec2u(depth - part_depth));
    let parts = f32(1u << part_depth);
    let center = of_block.w * (0.5 * parts - corner) - of_block.z;
    return MapPlacement(
        vec4f(center, of_block.w * parts * blocks),
        code & ((1u << PART_INDEX_BITS) - 1u),
    );
}

// A change of texture coordinates, as far as a map of so many texels can follow it: a tile ends at its border.
fn map_shift(layer: u32, at: SurfacePoint, texels: vec2f, shift: vec2f) -> vec2f {
    let moved = abs(shift * map_texels(layer, at, texels));
    return shift * min(f32(TILE_BORDER - 1u) / max(max(moved.x, moved.y), 1e-6), 1.0);
}

// Texels of a map of so many, from west to east and north to south, as if they covered the whole Earth.
fn map_texels(layer: u32, at: SurfacePoint, texels: vec2f) -> vec2f {
    return texels * map_placement(layer, at).uv.zw;
}

fn sample_map(map: texture_2d_array<f32>, filtering: sampler, layer: u32, at: SurfacePoint) -> vec4f {
    let placement = map_placement(layer, at);
    let scale = placement.uv.zw;
    let uv = placement.uv.xy + at.uv * scale;
    return textureSampleGrad(map, filtering, uv, placement.array_layer, at.uv_dx * scale, at.uv_dy * scale);
}
