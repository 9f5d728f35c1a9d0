// When lamps are lit.
import rust::{LAMPS_FULL_SIN, LAMPS_OUT_SIN};

// How much of their light is on where the Sun's elevation has this sine: they go on at dusk.
fn lamps_on(mu_s: f32) -> f32 {
    return 1.0 - smoothstep(LAMPS_FULL_SIN, LAMPS_OUT_SIN, mu_s);
}
