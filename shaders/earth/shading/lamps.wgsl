// When lamps are lit.
import rust::{LAMPS_FULL_SIN, LAMPS_OUT_SIN};

// Fraction of city lights that is on at this sine of the Sun's elevation: they switch on at dusk.
fn lamps_on(mu_s: f32) -> f32 {
    return 1.0 - smoothstep(LAMPS_FULL_SIN, LAMPS_OUT_SIN, mu_s);
}
