// For an eye in the air: samples the sky view, which is drawn once a frame.
import common/air/view_spacing.wgsl;
import rust::{VIEW_ANGLES, VIEW_AZIMUTHS};

// Coordinates of a direction of scaled space: columns by the angle δ from the limb, first those below it, then those above, by tan(δ/2), which
// avoids the angle itself; rows by the azimuth φ from the Sun, as √sin(φ/2), and below those from the Moon if there is moonlight.
fn view_column(direction: vec3f) -> f32 {
    let below = tangent_below_limb(direction);
    let sky = 0.5 + 0.5 * table_coordinate(view_spacing(max(-below, 0.0) * limb_tangent()), 0.5 * VIEW_ANGLES);
    return select(sky, ground_view_column(max(below, 0.0)), below >= 0.0);
}

fn ground_view_column(below: f32) -> f32 {
    return 0.5 * table_coordinate(view_spacing(below / limb_tangent()), 0.5 * VIEW_ANGLES);
}

// tan(δ/2), positive below the limb.
fn tangent_below_limb(direction: vec3f) -> f32 {
    let cosine = dot(direction, air.toward_center);
    let sine = length(cross(direction, air.toward_center));
    let sin_below = air.limb_sin * cosine - air.limb_cos * sine;
    let cos_below = air.limb_cos * cosine + air.limb_sin * sine;
    return sin_below / max(1.0 + cos_below, 1e-6);
}

// The value straight down; straight up it is minus the inverse.
fn limb_tangent() -> f32 {
    return air.limb_sin / (1.0 + air.limb_cos);
}

// `light_level`: horizontal direction to the Sun or the Moon; its rows begin at `first`.
fn azimuth_coordinate(direction: vec3f, light_level: vec3f, first: f32) -> f32 {
    let level = direction - dot(direction, air.toward_center) * air.toward_center;
    let cosine = clamp(dot(level, light_level) / max(length(level), 1e-6), -1.0, 1.0);
    let row = first + sqrt(sqrt(0.5 - 0.5 * cosine)) * (VIEW_AZIMUTHS - 1.0);
    return (row + 0.5) / f32(textureDimensions(black_view).y);
}

// Light under Sun and Moon.
fn seen(column: f32, direction: vec3f, uv: vec2f) -> vec4f {
    let sunlit = seen_at(vec2f(column, azimuth_coordinate(direction, air.sun_level, 0.0)), uv);
    @if(moonlight) let moonlit = seen_at(vec2f(column, azimuth_coordinate(direction, air.moon_level, VIEW_AZIMUTHS)), uv);
    @if(moonlight) return vec4f(sunlit.rgb + air.moon_light * moonlit.rgb, sunlit.a);
    @else return sunlit;
}

fn seen_at(place: vec2f, uv: vec2f) -> vec4f {
    let black = textureSampleLevel(black_view, table_sampler, place, 0.0);
    let bounce = textureSampleLevel(bounce_view, table_sampler, place, 0.0).rgb;
    return vec4f(fourth_power(black.rgb) + sent_up(uv) * fourth_power(bounce), black.a);
}

// Transmittance, the same in all rows.
fn through_seen(column: f32) -> vec3f {
    return textureSampleLevel(through_view, table_sampler, vec2f(column, 0.0), 0.0).rgb;
}

fn gathered(pass_: Pass, up: vec3f, uv: vec2f) -> vec4f {
    return seen(view_column(pass_.direction), pass_.direction, uv);
}

fn left_through(pass_: Pass) -> vec3f {
    return through_seen(view_column(pass_.direction));
}
