// Geometry of a line of sight relative to the Earth, and coordinates of the air's tables: the mapping of crates/terrella-ground/src/air/tables,
// whose tables end on texel centres.
import common/map_uv.wgsl;
import rust::{LOWEST_SUN, SUN_SPACING};

// Lengths are equatorial radii, directions those of scaled space.
struct Pass {
    // Unit vector.
    direction: vec3f,
    // Distance of the ray's line from the centre.
    q: f32,
    // Distance along the ray to the point nearest to the centre; negative if that is behind.
    along: f32,
    // Where it meets the ground, or at that nearest point: cosine of the angle between the descending ray and the vertical.
    mu: f32,
}

fn pass_by(direction: vec3f, q: f32, along: f32) -> Pass {
    let meets = along > 0.0 && q < 1.0;
    return Pass(direction, q, along, select(0.0, sqrt(max((1.0 - q) * (1.0 + q), 0.0)), meets));
}

fn meets_ground(pass_: Pass) -> bool {
    return pass_.along > 0.0 && pass_.q < 1.0;
}

// Outward normal of the ellipsoid at a point of scaled space, and unit direction of a ray of scaled space, ITRF axes.
fn normal_at(place: vec3f) -> vec3f {
    return normalize(place * vec3f(1.0, 1.0, air.polar_stretch));
}

fn itrf_direction(direction: vec3f) -> vec3f {
    return normalize(direction / vec3f(1.0, 1.0, air.polar_stretch));
}

fn table_coordinate(at: f32, texels: f32) -> f32 {
    return (clamp(at, 0.0, 1.0) * (texels - 1.0) + 0.5) / texels;
}

fn inverse_sinh(x: f32) -> f32 {
    let size = abs(x);
    return sign(x) * log(size + sqrt(size * size + 1.0));
}

// 0…1 for a Sun cosine, dense near the terminator.
fn sun_coordinate(mu_s: f32) -> f32 {
    let low = inverse_sinh(LOWEST_SUN / SUN_SPACING);
    let high = inverse_sinh(1.0 / SUN_SPACING);
    return (inverse_sinh(mu_s / SUN_SPACING) - low) / (high - low);
}
