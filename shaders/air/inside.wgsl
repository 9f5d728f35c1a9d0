// A ray that starts in the air: marched in steps. Coefficients are those of src/air/model.rs.
import rust::{AEROSOL_ASYMMETRY, AEROSOL_EXTINCTION, AEROSOL_SCALE_HEIGHT_M, AEROSOL_SCATTERING, AIR_RADIUS_M, LUMINANCE};
import rust::{MOLECULE_SCALE_HEIGHT_M, MOLECULE_SCATTERING, OZONE_ABSORPTION, OZONE_CENTER_M, OZONE_HALF_WIDTH_M};

// `start` and lengths as in the billboard frame, from the centre.
fn scattered(pass_: Pass) -> vec4f {
    let start = vec3f(0.0, 0.0, -air.eye_distance);
    let d = pass_.direction;
    let half_top = sqrt(max((air.top - pass_.q) * (air.top + pass_.q), 0.0));
    var length_ = max(pass_.along + half_top, 0.0);
    if pass_.along > 0.0 && pass_.q < 1.0 {
        // Distance to the ground, h(L + 1)/(along + √(1 − q²)): no difference of large numbers.
        length_ = air.eye_height * (air.eye_distance + 1.0)
            / (pass_.along + sqrt((1.0 - pass_.q) * (1.0 + pass_.q)));
    }
    const MARCH_STEPS: i32 = 24;
    let nu = dot(d, air.sun);
    let g = AEROSOL_ASYMMETRY;
    let phase_molecules = 3.0 / (16.0 * PI) * (1.0 + nu * nu);
    let phase_aerosol = 3.0 / (8.0 * PI) * (1.0 - g * g) / (2.0 + g * g) * (1.0 + nu * nu)
        / pow(max(1.0 + g * g - 2.0 * g * nu, 1e-5), 1.5);
    var light = vec3f(0.0);
    var through = vec3f(1.0);
    var begin = 0.0;
    for (var i = 0; i < MARCH_STEPS; i++) {
        let s = f32(i + 1) / f32(MARCH_STEPS);
        let to = length_ * s * s;
        let step = to - begin;
        let t = 0.5 * (begin + to);
        begin = to;
        let p = start + d * t;
        let r = length(p);
        // h from L² − 1 + 2t·(e·d) + t², each term small near the ground.
        let height = max((air.eye_height * (air.eye_distance + 1.0) - 2.0 * t * pass_.along + t * t) / (r + 1.0), 0.0);
        let mu_s = dot(p, air.sun) / r;
        let h = height * AIR_RADIUS_M;
        let molecules = MOLECULE_SCATTERING * (AIR_RADIUS_M * exp(-h / MOLECULE_SCALE_HEIGHT_M));
        let aerosol = AEROSOL_SCATTERING * (AIR_RADIUS_M * exp(-h / AEROSOL_SCALE_HEIGHT_M));
        let ozone = OZONE_ABSORPTION * (AIR_RADIUS_M * max(1.0 - abs(h - OZONE_CENTER_M) / OZONE_HALF_WIDTH_M, 0.0));
        let extinction = molecules + vec3f(aerosol * AEROSOL_EXTINCTION) + ozone;
        let source = to_sun(height, r, mu_s) * (molecules * phase_molecules + aerosol * phase_aerosol)
            + multiple(height, mu_s) * (molecules + aerosol);
        let fade = exp(-extinction * step);
        light += through * source * (1.0 - fade) / max(extinction, vec3f(1e-9));
        through *= fade;
    }
    return vec4f(light * PI, 1.0 - dot(through, LUMINANCE));
}

fn height_coordinate(height: f32) -> f32 {
    return sqrt(clamp(height / (air.top - 1.0), 0.0, 1.0));
}

fn to_sun(height: f32, r: f32, mu_s: f32) -> vec3f {
    let horizon = -sqrt(height * (r + 1.0)) / r;
    let x = sqrt(max((mu_s - horizon) / (1.0 - horizon), 0.0));
    let size = vec2f(textureDimensions(transmittance_table));
    let at = vec2f(table_coordinate(x, size.x), table_coordinate(height_coordinate(height), size.y));
    return select(vec3f(0.0), textureSampleLevel(transmittance_table, table_sampler, at, 0.0).rgb, mu_s >= horizon);
}

fn multiple(height: f32, mu_s: f32) -> vec3f {
    let size = vec2f(textureDimensions(multiple_table));
    let at = vec2f(table_coordinate(0.5 + 0.5 * mu_s, size.x), table_coordinate(height_coordinate(height), size.y));
    return textureSampleLevel(multiple_table, table_sampler, at, 0.0).rgb;
}
