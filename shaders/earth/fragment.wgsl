// The fragment stage of the Earth: the shaded image, geolocation, or ground truth.
@if(picture && sunlit) import common/displayed.wgsl;
@if(picture && decode) import common/color.wgsl;
@if(truth) import rust::{TRUTH_LAND, TRUTH_SUNLIT};
@if(truth) import earth/blocks.wgsl;
@if(truth && clouds) import earth/shading/cloud_cover.wgsl;
@if(truth && water) import earth/shading/open_water.wgsl;

// Output of a pixel. Its depth is the mesh's; for cast rays that of the ground that the ray met, not of the prism.
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

// Reversed depth of a point on the ground.
@if(depth)
fn depth_of(at: SurfacePoint) -> f32 {
    let clip = frame.clip_from_eye * vec4f(-at.to_eye * at.along, 1.0);
    return saturate(clip.z / max(clip.w, 1e-6));
}

// The shaded image, as the target stores it.
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

// Instead of colour, for measurements: the texture coordinates for sampling maps, relative to the block's centre, and that centre. Stored
// separately, they are rounded as little as the samplers' are. The target is cleared to 0; no centre is 0. With terrain: the distance to the ground
// in lengths of the pixel's ray, in the last number, and 1 in the others.
@if(geolocation)
@fragment
fn fragment(in: Varying) -> Drawn {
    let at = surface_point(in);
    @if(per_block_tiles) if drawn_block(at) != in.block { discard; }
    @if(relief) return drawn(vec4f(1.0, 1.0, 1.0, at.along), at);
    @else return drawn(vec4f(at.uv, at.center_uv), at);
}

// Instead of colour: ground truth of the pixel, in three targets that are cleared to 0. `TruthTexel` in src/gpu/truth_targets.rs describes them.
@if(truth)
struct Drawn {
    // Texture coordinates relative to the centre of the place's block; its distance and elevation, metres.
    @location(0) place: vec4f,
    // That block's index + 1, and flags.
    @location(1) marks: u32,
    // Slope of the ground to the east and to the north, land fraction, cloud cover in front of it.
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
