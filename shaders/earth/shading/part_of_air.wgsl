// Of the air between an eye in it and the smooth ground, or the limb, the part that stands before a point of the relief.
import rust::AIR_RADIUS_M;

// Near the ground the limb is near, and what is a small part of the air there says little of the air before a far mountain.
const MOST_PARTS: f32 = 50.0;

fn part_before(at: SurfacePoint, direction: vec3f, ray_length: f32) -> f32 {
    let along = air.eye_distance * dot(direction, air.toward_center);
    let q = air.eye_distance * length(cross(direction, air.toward_center));
    let rise = air.eye_height * (air.eye_distance + 1.0);
    let to_limb = air.eye_distance * air.limb_cos;
    // h(L + 1)/(along + √(1 − q²)), as far as the limb at most.
    let to_smooth = min(rise / max(along + sqrt(max((1.0 - q) * (1.0 + q), 0.0)), 1e-9), to_limb);
    let whole = air_along(select(to_limb, to_smooth, along > 0.0), along);
    return min(air_along(at.along * ray_length / AIR_RADIUS_M, along) / max(whole, 1e-9), MOST_PARTS);
}

// Air on the first `length_` of a ray, in ground densities times radii: two stretches on which height is taken as even.
fn air_along(length_: f32, along: f32) -> f32 {
    let middle = height_along(0.5 * length_, along);
    let end = height_along(length_, along);
    return 0.5 * length_ * (mean_density(height_along(0.0, along), middle) + mean_density(middle, end));
}

// In scale heights.
fn height_along(t: f32, along: f32) -> f32 {
    let rise = air.eye_height * (air.eye_distance + 1.0) - 2.0 * t * along + t * t;
    let r = sqrt(max(1.0 + rise, 0.0));
    return max(rise, -1e-3) / (r + 1.0) * (AIR_RADIUS_M / AIR_SCALE_HEIGHT_M);
}

fn mean_density(a: f32, b: f32) -> f32 {
    let difference = b - a;
    let of_ends = 0.5 * (exp(-a) + exp(-b));
    return select((exp(-a) - exp(-b)) / difference, of_ends, abs(difference) < 1e-2);
}
