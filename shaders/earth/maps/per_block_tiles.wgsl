// Triangles that lie in several blocks: drawn once with whole maps, and once for each block that has tiles, whose index is
// added to PER_BLOCK_TILES. Each pixel is kept by one of these draws.
import rust::{PER_BLOCK_TILES, WHOLE_MAP};
import earth/maps/block_at.wgsl;

// The block that a point lies in, as it must be drawn: with that block's tiles, or with whole maps if there are none.
fn drawn_block(at: SurfacePoint) -> u32 {
    let block = block_at(at.center_uv + at.uv);
    let is_tiled = tiles.tiled[block / 32u] >> (block % 32u) & 1u;
    return select(WHOLE_MAP, PER_BLOCK_TILES + block, is_tiled == 1u);
}

// The same point from its own block's centre.
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
