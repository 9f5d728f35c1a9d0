// In place of colour: what is where the pixel looks, in three targets that are cleared to 0. `TruthTexel` in
// src/gpu/truth_targets.rs says what they hold.
import rust::{TRUTH_LAND, TRUTH_SUNLIT};
import earth/blocks.wgsl;
@if(clouds) import earth/shading/cloud_cover.wgsl;
@if(water) import earth/shading/open_water.wgsl;

struct Drawn {
    // Texture coordinates from the centre of the block that the place lies in; its range and height, metres.
    @location(0) place: vec4f,
    // That block's index + 1, and flags.
    @location(1) marks: u32,
    // Rise of the ground to the east and to the north, share of land, cloud cover before it.
    @location(2) ground: vec4f,
    @if(depth) @builtin(frag_depth) depth: f32,
}

@fragment
fn fragment(in: Varying) -> Drawn {
    var at = surface_point(in);
    @if(per_block_tiles) if drawn_block(at) != in.block { discard; }
    @if(per_block_tiles) at = in_block(at);
    let block = block_at(at.center_uv + at.uv);
    // The first difference is exact.
    var uv = (at.center_uv - block_center(block)) + at.uv;
    uv.x -= round(uv.x);
    @if(relief) let height_m = at.height_m;
    @else let height_m = 0.0;
    let normal = surface_normal(at);
    let slope = -vec2f(dot(normal, at.east), dot(normal, at.north)) / dot(normal, at.up);
    @if(water) let land = 1.0 - open_water(at);
    @else let land = 1.0;
    @if(clouds) let cover = cover_at(at, lifted_before(at));
    @else let cover = 0.0;
    var out: Drawn;
    out.place = vec4f(uv, at.range_m, height_m);
    out.marks = block + 1u;
    out.marks |= select(0u, TRUTH_LAND, land >= 0.5);
    out.marks |= select(0u, TRUTH_SUNLIT, dot(at.up, frame.sun_itrf) > 0.0);
    out.ground = vec4f(slope, land, cover);
    @if(depth) out.depth = depth_of(at);
    return out;
}
