// What is the same for a whole block, patch or page. Mirrored by `BlockInstance` in src/gpu/lattice.rs.
struct BlockInstance {
    // The block's centre, or that of a patch in several blocks: (cos, sin) of longitude and of latitude, and its texture
    // coordinates.
    @location(1) center_lon: vec2f,
    @location(2) center_lat: vec2f,
    @location(3) center_uv: vec2f,
    @if(tiles) @location(4) block: u32,
}

fn varying_of(instance: BlockInstance) -> Varying {
    var out: Varying;
    out.center_lon = instance.center_lon;
    out.center_lat = instance.center_lat;
    out.center_uv = instance.center_uv;
    @if(tiles) out.block = instance.block;
    return out;
}
