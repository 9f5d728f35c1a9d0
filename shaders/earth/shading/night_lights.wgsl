// City lights: they go on at dusk, and the brightest stand out.
import rust::{LAMPS_FULL_SIN, LAMPS_OUT_SIN, NIGHT_LIGHTS};

const LAMP_COLOR: vec3f = vec3f(1.0, 0.72, 0.38);
const LAMP_LIGHT: f32 = 0.6;

fn city_light(at: SurfacePoint, mu_s: f32) -> vec3f {
    let is_on = 1.0 - smoothstep(LAMPS_FULL_SIN, LAMPS_OUT_SIN, mu_s);
    let glow = sample_map(light_map, light_sampler, NIGHT_LIGHTS, at).r * is_on;
    return LAMP_LIGHT * glow * glow * LAMP_COLOR;
}
