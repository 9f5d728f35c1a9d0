// Synthetic detail of clouds and land below the maps' texel size: a tile of the fine structure of a cloud map, at two scales. It is fixed to the
// ground. Its mip levels let each scale fade in as pixels become small enough to show it.
//
// The tile covers the six sides of a cube around the Earth, a whole number of times each, and its border is made so that neither tiles nor sides
// have seams (crates/terrella-imagery/src/detail_tile.rs).
import earth/shading/uneven.wgsl;
import rust::{DETAIL_MEAN, DETAIL_STEP, LAST_CODE, PI};

@group(0) @binding(13) var detail_tile: texture_2d<f32>;
@group(0) @binding(14) var detail_sampler: sampler;

// Number of tiles along an edge of the cube, 10 000 km: even, so that an edge ends with a tile. Their texels are 0.8 km and 49 m.
const COARSE_TILES: f32 = 12.0;
const FINE_TILES: f32 = 198.0;
// Strength of the fine scale, relative to the coarse one.
const FINE_STRENGTH: f32 = 0.6;
// Rotation of the cube of the fine scale, so that the two never repeat together: by 48° about (1, 2, 3).
const FINE_TURN: mat3x3f = mat3x3f(
    vec3f(0.692764, 0.643108, -0.326327), vec3f(-0.548574, 0.763665, 0.340415), vec3f(0.468128, -0.056813, 0.881832));
// Wavelength of the tile's middle scale, texels.
const MIDDLE_WAVE: f32 = 12.0;
// Pixels as large as a map's texel show no detail, those of this fraction all of it.
const LEAST_PIXEL: f32 = 0.4;

// At a normal of the ellipsoid, for a map with texels of this size, in pixels of that size, equatorial radii. Scales shown by the map or smaller
// than a pixel are left out.
fn structure(up: vec3f, texel: f32, pixel: f32) -> Detail {
    let coarse = structure_of_size(up, COARSE_TILES, texel, pixel);
    let fine = structure_of_size(FINE_TURN * up, FINE_TILES, texel, pixel);
    let value = coarse.value + FINE_STRENGTH * fine.value;
    let variance = coarse.variance + FINE_STRENGTH * FINE_STRENGTH * fine.variance;
    return faded(Detail(value, variance), texel, pixel);
}

// Only the larger scale, smoothed.
fn soft_structure(up: vec3f, texel: f32, pixel: f32) -> Detail {
    return faded(structure_of_size(up, COARSE_TILES, texel, 4.0 * pixel), texel, pixel);
}

fn faded(made: Detail, texel: f32, pixel: f32) -> Detail {
    let shown = 1.0 - smoothstep(LEAST_PIXEL, 1.0, pixel / texel);
    return Detail(shown * made.value, shown * shown * made.variance);
}

fn structure_of_size(up: vec3f, tiles: f32, texel: f32, pixel: f32) -> Detail {
    let own_texel = 0.5 * PI / (tiles * f32(textureDimensions(detail_tile).x));
    let level = max(log2(pixel / own_texel), 0.0);
    let byte = LAST_CODE * textureSampleLevel(detail_tile, detail_sampler, 0.5 * tiles * on_cube(up), level).r;
    let weight = 1.0 - smoothstep(1.5, 6.0, MIDDLE_WAVE * own_texel / texel);
    // Fraction of the tile's variance at coarser mip levels; a test measures it.
    let variance = 1.0 - smoothstep(0.0, 6.3, level);
    return Detail(weight * DETAIL_STEP * (byte - DETAIL_MEAN), weight * weight * variance);
}

// Coordinates of a direction on the sides of a cube, −1…1 each, in steps of nearly equal angles: (4/π)·atan by its first terms, exact at the edges.
fn on_cube(direction: vec3f) -> vec2f {
    let size = abs(direction);
    var at = direction.xy / size.z;
    if size.x >= max(size.y, size.z) {
        at = direction.yz / size.x;
    } else if size.y >= size.z {
        at = direction.xz / size.y;
    }
    let square = at * at;
    return at * (1.2732 + square * (-0.3902 + 0.117 * square));
}
