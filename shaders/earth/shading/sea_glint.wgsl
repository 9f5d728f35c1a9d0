// Sunlight mirrored by the sea, per light that falls on a sheet facing the Sun. Cox and Munk 1954 (J. Opt. Soc. Am.
// 44, 838): slopes of the waves are Gaussian with mean square 0.003 + 0.00512 W, here for a wind of W = 7 m/s.
//   L/E = ρ(ω) p(β) / (4 cos θ cos⁴β),  p = exp(−tan²β/σ²)/(πσ²)
// with ρ of Fresnel. Where the eye looks along the sea, waves hide each other: cos θ is kept from 0.
import rust::{GLINT_ENDS_SIN, GLINT_FULL_SIN, PI, WATER};
import earth/shading/fresnel.wgsl;

const WAVE_SLOPE_SQUARED: f32 = 0.039;

fn glint(at: SurfacePoint) -> f32 {
    let to_eye = normalize(at.to_eye);
    let half_way = normalize(to_eye + frame.sun_itrf);
    let cos_beta = max(dot(half_way, at.up), 1e-3);
    let cos_squared = cos_beta * cos_beta;
    let tan_squared = (1.0 - cos_squared) / cos_squared;
    let slopes = exp(-tan_squared / WAVE_SLOPE_SQUARED) / (PI * WAVE_SLOPE_SQUARED);
    let seen = max(dot(to_eye, at.up), 0.15);
    // A white sheet that faces the Sun is L = E/π.
    return PI * fresnel(dot(half_way, to_eye)) * slopes / (4.0 * seen * cos_squared * cos_squared);
}

// The glint fades with the last sunlight; waves do not mirror a Sun that is below their own horizon.
fn sea_glint(at: SurfacePoint, light: Light, mu_s: f32) -> vec3f {
    let sea = sample_map(water_map, water_sampler, WATER, at).r;
    return sea * light.sun * glint(at) * smoothstep(GLINT_ENDS_SIN, GLINT_FULL_SIN, mu_s);
}
