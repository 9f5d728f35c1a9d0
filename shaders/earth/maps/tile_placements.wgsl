// Where each block's texels lie. Mirrored by the buffer of src/gpu/tiles.rs.
import rust::{BLOCK_COUNT, MAP_LAYERS};
@if(parts) import rust::PART_CELL_WORDS;

struct Tiles {
    // For each block and each map of it, in the order of the bindings of group 1: texture coordinates of the block's centre,
    // and their change per whole map. One array: WebGL 2 has no arrays of arrays.
    placements: array<vec4f, MAP_LAYERS * BLOCK_COUNT>,
    // A bit for each block that has tiles.
    @if(per_block_tiles) tiled: vec4u,
    @if(parts && !per_block_tiles) unused: vec4u,
    // What cells of blocks with parts are drawn with, 16 bits each: layer of the array, and above that how often the block is halved.
    @if(parts) cells: array<vec4u, PART_CELL_WORDS>,
}
