// Synthetic detail of clouds and land below the maps' texel size: a tile of the fine structure of a cloud map and one of eroded terrain, each at two
// scales. It is fixed to the ground. The tiles' mip levels let each scale fade in as pixels become small enough to show it.
//
// A tile covers the six sides of a cube around the Earth and repeats on each of them. Sides do not match along the cube's edges: there the
// structures fade out.
import earth/shading/uneven.wgsl;
import rust::{BLENDED_LEVELS, DETAIL_MEAN, DETAIL_STEP, EMPTY_LEVEL, LAST_CODE, PI};
@if(coarse_scale) import rust::CLOUD_SLOPE_STEP;
@if(fine_scale) import rust::FINE_TILES;

@group(0) @binding(13) var cloud_tile: texture_2d<f32>;
@group(0) @binding(14) var detail_sampler: sampler;

// Number of tiles of the coarse scale along an edge of the cube, 10 000 km. Their texels are 0.8 km.
@if(coarse_scale) const COARSE_TILES: f32 = 12.0;
// Strength of the fine scale, relative to the coarse one.
@if(fine_scale) const FINE_STRENGTH: f32 = 0.6;
// Rotation of the cube of the fine scale, so that the two never repeat together: by 48° about (1, 2, 3).
@if(fine_scale) const FINE_TURN: mat3x3f = mat3x3f(
    vec3f(0.692764, 0.643108, -0.326327), vec3f(-0.548574, 0.763665, 0.340415), vec3f(0.468128, -0.056813, 0.881832));
// Wavelength of the tile's middle scale, texels.
const MIDDLE_WAVE: f32 = 12.0;
// Pixels as large as a map's texel show no detail, those of this fraction all of it.
const LEAST_PIXEL: f32 = 0.4;
// Distance from an edge of the cube over which structures fade out, texels.
const EDGE_TEXELS: f32 = 10.0;
// The tile's variance at a mip level falls from 1 to 0 between levels 0 and EMPTY_LEVEL, that of smoothed values between these two. A test measures
// it.
const SOFT_LEVELS: vec2f = vec2f(-2.7, 4.0);

// Structures at a place, their values smoothed over four pixels, and the change of the latter along the ground, per equatorial radius.
struct Flanked {
    made: Detail,
    soft: Detail,
    change: vec3f,
}

// At a normal of the ellipsoid, for a map with texels of this size, in pixels of that size, equatorial radii. Scales shown by the map or smaller
// than a pixel are left out; scales that no pixel of a frame can show, from the shader (src/plan/detail_scales.rs).
@if(coarse_scale)
fn structure(up: vec3f, texel: f32, pixel: f32) -> Detail {
    let shown = shown_detail(texel, pixel);
    if shown == 0.0 { return Detail(0.0, 0.0); }
    return scaled(shown, with_finer(structure_of_size(up, COARSE_TILES, texel, pixel), up, texel, pixel));
}
@else
fn structure(up: vec3f, texel: f32, pixel: f32) -> Detail {
    return Detail(0.0, 0.0);
}

@if(coarse_scale)
fn flanked_structure(up: vec3f, texel: f32, pixel: f32) -> Flanked {
    var out: Flanked;
    let shown = shown_detail(texel, pixel);
    if shown == 0.0 { return out; }
    let scale = scale_at(COARSE_TILES, texel, pixel);
    let place = place_on_tile(up, scale);
    let read = sample_clouds(place, scale);
    out.made = scaled(shown, with_finer(value_of(read.r, scale), up, texel, pixel));
    out.soft = scaled(shown, soft_of(read, scale));
    out.change = shown * change_of(read, scale, place.side, CLOUD_SLOPE_STEP);
    return out;
}
@else
fn flanked_structure(up: vec3f, texel: f32, pixel: f32) -> Flanked {
    return Flanked(Detail(0.0, 0.0), Detail(0.0, 0.0), vec3f(0.0));
}

// Only the larger scale, smoothed.
@if(coarse_scale)
fn soft_structure(up: vec3f, texel: f32, pixel: f32) -> Detail {
    let shown = shown_detail(texel, pixel);
    if shown == 0.0 { return Detail(0.0, 0.0); }
    let scale = scale_at(COARSE_TILES, texel, pixel);
    return scaled(shown, soft_of(sample_clouds(place_on_tile(up, scale), scale), scale));
}
@else
fn soft_structure(up: vec3f, texel: f32, pixel: f32) -> Detail {
    return Detail(0.0, 0.0);
}

fn structure_of_size(up: vec3f, tiles: f32, texel: f32, pixel: f32) -> Detail {
    let scale = scale_at(tiles, texel, pixel);
    return value_of(sample_clouds(place_on_tile(up, scale), scale).r, scale);
}

// With the finer scale, where pixels are small enough to show it.
@if(fine_scale)
fn with_finer(coarse: Detail, up: vec3f, texel: f32, pixel: f32) -> Detail {
    let scale = scale_at(FINE_TILES, texel, pixel);
    if scale.level >= EMPTY_LEVEL { return coarse; }
    let fine = value_of(sample_clouds(place_on_tile(FINE_TURN * up, scale), scale).r, scale);
    return plus(coarse, FINE_STRENGTH, fine);
}
@else
fn with_finer(coarse: Detail, up: vec3f, texel: f32, pixel: f32) -> Detail {
    return coarse;
}

fn shown_detail(texel: f32, pixel: f32) -> f32 {
    return 1.0 - smoothstep(LEAST_PIXEL, 1.0, pixel / texel);
}

// How the tile is read at one scale, in pixels of one size.
struct Scale {
    tiles: f32,
    level: f32,
    // Strength below the map's own structures.
    weight: f32,
}

fn scale_at(tiles: f32, texel: f32, pixel: f32) -> Scale {
    let own_texel = 0.25 * PI / texels_per_side(tiles);
    let exact = max(log2(pixel / own_texel), 0.0);
    let level = floor(exact) + saturate((fract(exact) - 0.5) / BLENDED_LEVELS + 0.5);
    return Scale(tiles, level, 1.0 - smoothstep(1.5, 6.0, MIDDLE_WAVE * own_texel / texel));
}

// Along half an edge of the cube: per unit of `on_cube`.
fn texels_per_side(tiles: f32) -> f32 {
    return 0.5 * tiles * f32(textureDimensions(cloud_tile).x);
}

fn sample_clouds(place: TilePlace, scale: Scale) -> vec4f {
    return shown_at(place, textureSampleLevel(cloud_tile, detail_sampler, place.uv, scale.level));
}

struct TilePlace {
    side: OnSide,
    uv: vec2f,
    // 0 at an edge of the cube, 1 away from it.
    shown: f32,
}

fn place_on_tile(up: vec3f, scale: Scale) -> TilePlace {
    let sides = sides(up);
    let side = on_side(up, sides);
    let from_edge = edge_distance(sides) * texels_per_side(scale.tiles);
    return TilePlace(side, 0.5 * scale.tiles * on_cube(side), smoothstep(0.0, EDGE_TEXELS, from_edge));
}

fn shown_at(place: TilePlace, read: vec4f) -> vec4f {
    return mix(vec4f(DETAIL_MEAN / LAST_CODE), read, place.shown);
}

// Of a channel that is not smoothed.
fn value_of(channel: f32, scale: Scale) -> Detail {
    return detail_of(channel, scale.weight, 1.0 - smoothstep(0.0, EMPTY_LEVEL, scale.level));
}

fn soft_of(read: vec4f, scale: Scale) -> Detail {
    return detail_of(read.g, scale.weight, 1.0 - smoothstep(SOFT_LEVELS.x, SOFT_LEVELS.y, scale.level));
}

// The change of the value of `value_of` for land and of `soft_of` for clouds.
fn change_of(read: vec4f, scale: Scale, side: OnSide, slope_step: f32) -> vec3f {
    let per_texel = scale.weight * DETAIL_STEP * slope_step * (LAST_CODE * read.ba - DETAIL_MEAN);
    return along_ground(side, per_texel * texels_per_side(scale.tiles) * exp2(-scale.level));
}

// Of a channel of the tile.
fn detail_of(channel: f32, weight: f32, variance: f32) -> Detail {
    return Detail(weight * DETAIL_STEP * (LAST_CODE * channel - DETAIL_MEAN), weight * weight * variance);
}

// Absolute values of a direction's components, by which a side of the cube is chosen. They are uneven, so that sides meet along ragged lines and not
// along great circles, which would be seen: within some 30 km, in zigzags 150 and 35 km long.
fn sides(direction: vec3f) -> vec3f {
    let aside = 0.0025 * zigzag(dot(direction, vec3f(31.0, 37.0, 43.0))) + 0.0008 * zigzag(dot(direction, vec3f(157.0, -163.0, 193.0)));
    return abs(direction) + vec3f(aside, 0.0, -aside);
}

fn zigzag(x: f32) -> f32 {
    return 4.0 * abs(fract(x) - 0.5) - 1.0;
}

// A direction on a side of the cube: its components along the side, divided by the one away from it, and that component with its axis. Axes are taken
// in turn, so that no side shows the reflection of the one beside it.
struct OnSide {
    at: vec2f,
    away: f32,
    axis: u32,
}

fn on_side(direction: vec3f, sides: vec3f) -> OnSide {
    if sides.x >= max(sides.y, sides.z) { return OnSide(direction.yz / direction.x, direction.x, 0u); }
    if sides.y >= sides.z { return OnSide(direction.zx / direction.y, direction.y, 1u); }
    return OnSide(direction.xy / direction.z, direction.z, 2u);
}

// Coordinates on a side, −1…1 each, in steps of nearly equal angles: (4/π)·atan by its first terms, exact at the edges.
fn on_cube(side: OnSide) -> vec2f {
    let square = side.at * side.at;
    return side.at * (1.2732 + square * (-0.3902 + 0.117 * square));
}

// Distance from the nearest edge of the side in the same coordinates, near the edge: within a fifth.
fn edge_distance(sides: vec3f) -> f32 {
    let most = max(sides.x, max(sides.y, sides.z));
    let least = min(sides.x, min(sides.y, sides.z));
    return 2.0 * most + least - (sides.x + sides.y + sides.z);
}

// Gradient on the unit sphere of a quantity that changes this much along the coordinates of `on_cube`.
fn along_ground(side: OnSide, change: vec2f) -> vec3f {
    let square = side.at * side.at;
    let steeper = change * (1.2732 + square * (-1.1706 + 0.585 * square));
    let along = vec3f(steeper, -dot(side.at, steeper)) / side.away;
    return select(select(along, along.yzx, side.axis == 1u), along.zxy, side.axis == 0u);
}
