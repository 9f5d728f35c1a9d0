// What the air does to the ground's light, by the table of src/air/tables.rs.
import rust::LUMINANCE;
import common/air_tables.wgsl;

fn light_at(mu_s: f32) -> Light {
    return Light(sunlight(mu_s, 0.25), sunlight(mu_s, 0.75));
}

// A row of the table: 0.25 is the transmittance of light that falls at this cosine, 0.75 the sky's light.
fn sunlight(mu: f32, row: f32) -> vec3f {
    let at = vec2f(table_coordinate(sun_coordinate(mu), f32(textureDimensions(sunlight_table).x)), row);
    return textureSampleLevel(sunlight_table, table_sampler, at, 0.0).rgb;
}

// What the air between leaves of the ground's light, colour by colour, over the one grey that the air's square dims it by.
// Light that goes up loses what light that comes down loses. Of an eye in the air only the part of it that lies below.
fn tint_of_air(at: SurfacePoint) -> vec3f {
    let through = sunlight(max(dot(normalize(at.to_eye), at.up), 0.0), 0.25);
    let grey = max(dot(through, LUMINANCE), 1e-4);
    return mix(vec3f(1.0), through / grey, frame.air_below);
}
