// Effect of the air in front of a point of the ground on its light.
import common/air.wgsl;
@if(eclipse) import common/air/eclipsed.wgsl;
@if(relief) import rust::AIR_SCALE_HEIGHT_M;
@if(relief && inside) import rust::AIR_RADIUS_M;

// Transmittance for the ground's light, and added light.
struct AirBefore {
    through: vec3f,
    light: vec3f,
}

// The air in front of the smooth ground is known, and that in front of terrain is a fraction of it. `mu_s` is the cosine of the Sun's zenith angle
// there.
@if(relief)
fn air_before(at: SurfacePoint, mu_s: f32) -> AirBefore {
    return air_before_relief(at, air_before_smooth_ground(at, mu_s));
}
@else
fn air_before(at: SurfacePoint, mu_s: f32) -> AirBefore {
    return air_before_smooth_ground(at, mu_s);
}

// For an eye in the air, terrain may be nearer than the smooth ground, or exist where the smooth ground does not.
@if(relief && inside)
fn air_before_relief(at: SurfacePoint, smooth_: AirBefore) -> AirBefore {
    let to_ground = -at.to_eye * vec3f(1.0, 1.0, air.polar_stretch);
    let part = part_before(at, normalize(to_ground), length(to_ground));
    return thinned(smooth_, vec3f(part));
}

// For an eye outside it, there is less air above a higher elevation, with the same profile.
@if(relief && !inside)
fn air_before_relief(at: SurfacePoint, smooth_: AirBefore) -> AirBefore {
    return thinned(smooth_, vec3f(exp(-at.height_m / AIR_SCALE_HEIGHT_M)));
}

// For an eye in the air: by the ray's direction.
@if(inside)
fn air_before_smooth_ground(at: SurfacePoint, mu_s: f32) -> AirBefore {
    let direction = normalize(-at.to_eye * vec3f(1.0, 1.0, air.polar_stretch));
    // For a mountain above the limb, the air in front of the limb.
    @if(relief) let column = ground_view_column(max(tangent_below_limb(direction), 0.0));
    @else let column = view_column(direction);
    return AirBefore(through_seen(column), seen(column, direction, at.center_uv + at.uv).rgb);
}

// For an eye outside the air: interpolated from the vertices, …
@if(interpolated)
fn air_before_smooth_ground(at: SurfacePoint, mu_s: f32) -> AirBefore {
    let light = at.air.black + sent_up(at.center_uv + at.uv) * at.air.bounce;
    return AirBefore(at.air.through, light);
}

// … or by the ray's zenith angle at the point.
@if(!inside && !interpolated)
fn air_before_smooth_ground(at: SurfacePoint, mu_s: f32) -> AirBefore {
    let ray = -normalize(at.to_eye);
    let mu = clamp(-dot(ray, at.up), 0.0, 1.0);
    let x = ground_coordinate(mu);
    let uv = at.center_uv + at.uv;
    @if(night) var light = vec3f(0.0);
    @else var light = scattered(x, mu, ray, air.sun, mu_s, uv).rgb;
    @if(moonlight) light += air.moon_light * scattered(x, mu, ray, air.moon, dot(at.up, air.moon), uv).rgb;
    return AirBefore(through_at(x), light);
}

// The air in front of terrain or clouds, as a fraction of that in front of the smooth ground: `part` of the optical depth, and light as if its
// source were constant along the path.
fn thinned(air_: AirBefore, part: vec3f) -> AirBefore {
    let through = pow(max(air_.through, vec3f(1e-6)), part);
    return AirBefore(through, air_.light * (1.0 - through) / max(1.0 - air_.through, vec3f(1e-6)));
}

// Fraction of sunlight that the Moon leaves for scattering in the air in front of a point of the ground.
@if(eclipse)
fn sun_on_air_before(at: SurfacePoint) -> vec3f {
    let stretch = vec3f(1.0, 1.0, air.polar_stretch);
    let ground = place_over(at.up, 0.0, air.polar_stretch) * stretch;
    let to_eye = normalize(at.to_eye);
    let reach = length(ground + air.eye_distance * air.toward_center);
    return sun_on_rising_air(ground, normalize(to_eye * stretch), max(dot(to_eye, at.up), 0.0), reach);
}

// Near the ground the limb is near, and a small part of the air there is not representative of the air in front of a distant mountain.
@if(relief && inside)
const MOST_PARTS: f32 = 50.0;

// Fraction of the air between an eye inside it and the smooth ground, or the limb, that is in front of a point of the terrain. An exponential
// profile suffices, since only the ratio matters.
@if(relief && inside)
fn part_before(at: SurfacePoint, direction: vec3f, ray_length: f32) -> f32 {
    let along = air.eye_distance * dot(direction, air.toward_center);
    let q = air.eye_distance * length(cross(direction, air.toward_center));
    let rise = air.eye_height * (air.eye_distance + 1.0);
    let to_limb = air.eye_distance * air.limb_cos;
    // h(L + 1)/(along + √(1 − q²)), at most to the limb.
    let to_smooth = min(rise / max(along + sqrt(max((1.0 - q) * (1.0 + q), 0.0)), 1e-9), to_limb);
    let whole = air_along(select(to_limb, to_smooth, along > 0.0), along);
    return min(air_along(at.along * ray_length / AIR_RADIUS_M, along) / max(whole, 1e-9), MOST_PARTS);
}

// Air along the first `length_` of a ray, in ground densities times radii: two intervals with linearly varying height.
@if(relief && inside)
fn air_along(length_: f32, along: f32) -> f32 {
    let middle = height_along(0.5 * length_, along);
    let end = height_along(length_, along);
    return 0.5 * length_ * (mean_density(height_along(0.0, along), middle) + mean_density(middle, end));
}

// In scale heights.
@if(relief && inside)
fn height_along(t: f32, along: f32) -> f32 {
    let rise = air.eye_height * (air.eye_distance + 1.0) - 2.0 * t * along + t * t;
    let r = sqrt(max(1.0 + rise, 0.0));
    return max(rise, -1e-3) / (r + 1.0) * (AIR_RADIUS_M / AIR_SCALE_HEIGHT_M);
}

@if(relief && inside)
fn mean_density(a: f32, b: f32) -> f32 {
    let difference = b - a;
    let of_ends = 0.5 * (exp(-a) + exp(-b));
    return select((exp(-a) - exp(-b)) / difference, of_ends, abs(difference) < 1e-2);
}
