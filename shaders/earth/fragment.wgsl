// The fragment stage of the Earth: a picture, the place of each pixel, or all that is known of it.
@if(picture && sunlit) import common/displayed.wgsl;
@if(picture && decode) import common/color.wgsl;
@if(truth) import rust::{TRUTH_LAND, TRUTH_SUNLIT};
@if(truth) import earth/blocks.wgsl;
@if(truth && clouds) import earth/shading/cloud_cover.wgsl;
@if(truth && water) import earth/shading/open_water.wgsl;

// What a pixel gets. Its depth is the mesh's, or where rays are cast that of the ground that the ray met, not of the prism that it was
// looked for in.
@if(!truth)
struct Drawn {
    @location(0) color: vec4f,
    @if(depth) @builtin(frag_depth) depth: f32,
}

@if(!truth)
fn drawn(color: vec4f, at: SurfacePoint) -> Drawn {
    @if(depth) return Drawn(color, depth_of(at));
    @else return Drawn(color);
}

// How deep a point of the ground lies, reversed.
@if(depth)
fn depth_of(at: SurfacePoint) -> f32 {
    let clip = frame.clip_from_eye * vec4f(-at.to_eye * at.along, 1.0);
    return saturate(clip.z / max(clip.w, 1e-6));
}

// The picture: what the surface looks like there, as the target stores it.
@if(picture)
@fragment
fn fragment(in: Varying) -> Drawn {
    var at = surface_point(in);
    @if(interpolated) at.air = air_between_vertices(in);
    @if(per_block_tiles) if drawn_block(at) != in.block { discard; }
    @if(per_block_tiles) at = in_block(at);
    var color = shade(at);
    @if(sunlit) color = displayed(color, frame.exposure, in.clip.xy);
    @if(decode) color = decode_srgb(color);
    @if(paper && air) color = paper_through_air(color, at, in.clip.xy);
    return drawn(vec4f(color, 1.0), at);
}

// In place of colour, for measuring: the texture coordinates that maps would be read with, from the block's centre, and
// that centre. Kept apart, they are rounded as little as the samplers' are. The target is cleared to 0; no centre is 0.
// With relief: how many of its rays long the pixel's way to the ground is, in the last number, and 1 in the others.
@if(geolocation)
@fragment
fn fragment(in: Varying) -> Drawn {
    let at = surface_point(in);
    @if(per_block_tiles) if drawn_block(at) != in.block { discard; }
    @if(relief) return drawn(vec4f(1.0, 1.0, 1.0, at.along), at);
    @else return drawn(vec4f(at.uv, at.center_uv), at);
}

// In place of colour: what is where the pixel looks, in three targets that are cleared to 0. `TruthTexel` in
// src/gpu/truth_targets.rs says what they hold.
@if(truth)
struct Drawn {
    // Texture coordinates from the centre of the block that the place lies in; its range and height, metres.
    @location(0) place: vec4f,
    // That block's index + 1, and flags.
    @location(1) marks: u32,
    // Rise of the ground to the east and to the north, share of land, cloud cover before it.
    @location(2) ground: vec4f,
    @if(depth) @builtin(frag_depth) depth: f32,
}

@if(truth)
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
    @if(clouds) let cover = frame.clouds_before * cover_at(at, lifted_before(at));
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
