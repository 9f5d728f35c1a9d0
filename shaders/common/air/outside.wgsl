// For an eye outside the air: samples the tables of rays from space.
import rust::{AIR_RAYS, AIR_TOP, PI, SCATTERING_SIZE};

// Coordinate of a ray in the tables: for rays that meet the ground by their zenith cosine there, for others by their height.
fn ray_coordinate(pass_: Pass) -> f32 {
    let over = quarter_of_rays(1.0, sqrt(max(pass_.q - 1.0, 0.0) / (AIR_TOP - 1.0)));
    return select(over, ground_coordinate(pass_.mu), meets_ground(pass_));
}

fn ground_coordinate(mu: f32) -> f32 {
    return quarter_of_rays(0.0, sqrt(mu));
}

// For a ray that meets the layer of clouds, by its zenith cosine there.
fn cloud_coordinate(mu: f32) -> f32 {
    return quarter_of_rays(2.0, sqrt(mu));
}

fn quarter_of_rays(quarter: f32, at: f32) -> f32 {
    return 0.25 * (quarter + table_coordinate(at, AIR_RAYS));
}

// `x` is the ray's coordinate, `mu` and `mu_s` are the cosines of its zenith angle and of the Sun's at the reference point; `ray` and `sun` are
// unit vectors, ITRF axes.
fn scattered(x: f32, mu: f32, ray: vec3f, sun: vec3f, mu_s: f32, uv: vec2f) -> vec4f {
    let parts = scattered_parts(x, mu, ray, sun, mu_s);
    return vec4f(parts.black.rgb + sent_up(uv) * parts.bounce, parts.black.a);
}

// Light over black ground, and the addition per unit of light from the ground.
struct Scattered {
    black: vec4f,
    bounce: vec3f,
}

fn scattered_parts(x: f32, mu: f32, ray: vec3f, sun: vec3f, mu_s: f32) -> Scattered {
    // Azimuth of the Sun relative to the ray's horizontal direction.
    let flat = sqrt(max((1.0 - mu * mu) * (1.0 - mu_s * mu_s), 1e-12));
    let cosine = clamp((dot(ray, sun) + mu * mu_s) / flat, -1.0, 1.0);
    let y = table_coordinate(sun_coordinate(mu_s), SCATTERING_SIZE.y);
    let azimuth = sqrt(acos(cosine) / PI);
    let at = vec3f(x, y, table_coordinate(azimuth, SCATTERING_SIZE.z));
    let black = textureSampleLevel(scattering_table, table_sampler, at, 0.0);
    let bounce = textureSampleLevel(bounce_table, table_sampler, at.xy, 0.0).rgb;
    return Scattered(vec4f(fourth_power(black.rgb), black.a), fourth_power(bounce));
}

fn through_at(x: f32) -> vec3f {
    return textureSampleLevel(through_table, table_sampler, vec2f(x, 0.5), 0.0).rgb;
}

fn gathered(pass_: Pass, up: vec3f, uv: vec2f) -> vec4f {
    let x = ray_coordinate(pass_);
    let ray = itrf_direction(pass_.direction);
    let sunlit = scattered(x, pass_.mu, ray, air.sun, clamp(dot(up, air.sun), -1.0, 1.0), uv);
    @if(moonlight) let moonlit = scattered(x, pass_.mu, ray, air.moon, clamp(dot(up, air.moon), -1.0, 1.0), uv);
    @if(moonlight) return vec4f(sunlit.rgb + air.moon_light * moonlit.rgb, sunlit.a);
    @else return sunlit;
}

fn left_through(pass_: Pass) -> vec3f {
    return through_at(ray_coordinate(pass_));
}
