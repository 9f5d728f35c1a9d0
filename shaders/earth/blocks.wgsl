// The block of a place, and the tiles that it is drawn with.
import rust::{BLOCK_COLUMNS, BLOCK_ROWS};
@if(per_block_tiles) import rust::{PER_BLOCK_TILES, WHOLE_MAP};

// The block that contains a place of the whole map.
fn block_at(whole_uv: vec2f) -> u32 {
    let row = min(u32(max(f32(BLOCK_ROWS) * whole_uv.y, 0.0)), BLOCK_ROWS - 1u);
    let column = min(u32(f32(BLOCK_COLUMNS) * fract(whole_uv.x)), BLOCK_COLUMNS - 1u);
    return BLOCK_COLUMNS * row + column;
}

// Texture coordinates of its centre.
fn block_center(block: u32) -> vec2f {
    let cell = vec2f(f32(block % BLOCK_COLUMNS), f32(block / BLOCK_COLUMNS));
    return (cell + 0.5) / vec2f(f32(BLOCK_COLUMNS), f32(BLOCK_ROWS));
}

// Triangles that span several blocks are drawn once with whole maps, and once for each block with tiles, whose index is added to PER_BLOCK_TILES.
// Exactly one of these draws keeps each pixel: here the block that contains a point, in the form that the draw must have, with that block's tiles,
// or with whole maps if there are none.
@if(per_block_tiles)
fn drawn_block(at: SurfacePoint) -> u32 {
    let block = block_at(at.center_uv + at.uv);
    let is_tiled = (tiles.tiled[block / 32u] >> (block % 32u)) & 1u;
    return select(WHOLE_MAP, PER_BLOCK_TILES + block, is_tiled == 1u);
}

// The same point relative to its own block's centre.
@if(per_block_tiles)
fn in_block(point: SurfacePoint) -> SurfacePoint {
    var at = point;
    if at.block >= WHOLE_MAP {
        return at;
    }
    at.block -= PER_BLOCK_TILES;
    let whole_uv = at.center_uv + at.uv;
    at.center_uv = block_center(at.block);
    at.uv = whole_uv - at.center_uv;
    at.uv.x -= round(at.uv.x);
    return at;
}
