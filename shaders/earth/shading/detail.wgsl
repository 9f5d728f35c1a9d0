// Synthetic detail of coasts and towns below the maps' texel size. It is fixed to the ground. Each scale fades in as pixels become small enough to
// show it, unless the map itself shows that scale.
import earth/shading/uneven.wgsl;

// Octaves of value noise on a lattice in the space of the ellipsoid's normals: no seams, no poles. Spacing of the coarsest lattice, equatorial
// radii (64 km), ratio of the next one, and number of octaves: the last one's spacing is 105 m, where a normal in f32 is accurate to 1 m.
const COARSEST_DETAIL: f32 = 0.01;
const NEXT_SPACING: f32 = 0.4;
const DETAIL_OCTAVES: i32 = 8;
// Rotation of the lattice from one octave to the next, so that their planes are invisible: by 48° about (1, 2, 3).
const DETAIL_TURN: mat3x3f = mat3x3f(
    vec3f(0.692764, 0.643108, -0.326327), vec3f(-0.548574, 0.763665, 0.340415), vec3f(0.468128, -0.056813, 0.881832));
// Octaves of this spacing, in texels, are in the map, and those of this spacing, in pixels, are too small to show.
const MAPPED_TEXELS: f32 = 2.0;
const LEAST_SPACING: f32 = 1.2;
// Variance of one octave: (26/35)³/3.
const DETAIL_VARIANCE: f32 = 0.1367;

// Detail at a normal of the ellipsoid, for a map with texels of this size, in pixels of that size. An octave is `falloff` times as strong as the
// one before.
fn detail(up: vec3f, texel: f32, pixel: f32, falloff: f32) -> Detail {
    var out = Detail(0.0, 0.0);
    var spacing = COARSEST_DETAIL;
    var turned = up;
    var strength = 1.0;
    var i = 0;
    // Those that the map shows.
    for (; i < DETAIL_OCTAVES && spacing > MAPPED_TEXELS * texel; i++) {
        turned = DETAIL_TURN * turned;
        spacing *= NEXT_SPACING;
    }
    for (; i < DETAIL_OCTAVES && spacing > LEAST_SPACING * pixel; i++) {
        let weight = strength * shown(spacing, pixel) * (1.0 - smoothstep(0.8, MAPPED_TEXELS, spacing / texel));
        if weight > 0.0 {
            out.value += weight * value_noise(turned / spacing + f32(i) * 17.0);
            out.variance += weight * weight * DETAIL_VARIANCE;
            strength *= falloff;
        }
        turned = DETAIL_TURN * turned;
        spacing *= NEXT_SPACING;
    }
    return out;
}

// Visibility of an octave in pixels of this size.
fn shown(spacing: f32, pixel: f32) -> f32 {
    return smoothstep(LEAST_SPACING, 3.0, spacing / pixel);
}

// −1…1, smooth between the points of a lattice.
fn value_noise(at: vec3f) -> f32 {
    let f = at - floor(at);
    let w = f * f * (3.0 - 2.0 * f);
    // One number for each plane of the lattice: a corner's is mixed from its three.
    let planes = vec3u(0x9E3779B1u, 0x85EBCA77u, 0xC2B2AE3Du);
    let low = bitcast<vec3u>(vec3i(floor(at))) * planes;
    let high = low + planes;
    let south_west = corners(vec4u(low.x, high.x, low.x, high.x) ^ vec4u(low.y, low.y, high.y, high.y) ^ vec4u(low.z));
    let north_east = corners(vec4u(low.x, high.x, low.x, high.x) ^ vec4u(low.y, low.y, high.y, high.y) ^ vec4u(high.z));
    let face = mix(south_west, north_east, w.z);
    let edge = mix(face.xy, face.zw, w.y);
    return mix(edge.x, edge.y, w.x);
}

// −1…1, identical for the same corners on any machine.
fn corners(cells: vec4u) -> vec4f {
    let n = (cells ^ (cells >> vec4u(15u))) * 0x2C1B3C6Du;
    return vec4f(n >> vec4u(8u)) / 8388607.5 - 1.0;
}
