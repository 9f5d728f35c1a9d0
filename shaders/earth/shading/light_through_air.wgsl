// The light of Sun and sky on the ground under the air.
import rust::SUNLIGHT_SIZE;
import earth/shading/air_before.wgsl;

// Sunlight that arrives and the sky's light on level ground, with what goes to and fro between the ground and the air.
fn light_at(at: SurfacePoint, mu_s: f32) -> Light {
    let sun = sunlight(mu_s, OF_GROUND);
    // (direct + sky)/(1 − A s) is direct + sky + (direct + sky)·A s/(1 − A s).
    let again = sent_up(at.center_uv + at.uv) * air.sky_albedo;
    return Light(sun, sunlight(mu_s, OF_SKY) * (1.0 + again) + sun * max(mu_s, 0.0) * again);
}

// Rows of the table: transmittance of the Sun's light to the ground, the sky's light on black ground, transmittance to the clouds.
const OF_GROUND: f32 = 0.5 / 3.0;
const OF_SKY: f32 = 1.5 / 3.0;
@if(clouds) const OF_CLOUDS: f32 = 2.5 / 3.0;

fn sunlight(mu: f32, row: f32) -> vec3f {
    let at = vec2f(table_coordinate(sun_coordinate(mu), SUNLIGHT_SIZE.x), row);
    return textureSampleLevel(sunlight_table, table_sampler, at, 0.0).rgb;
}
