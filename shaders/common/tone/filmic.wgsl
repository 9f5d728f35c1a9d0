// Narkowicz 2016, "ACES Filmic Tone Mapping Curve": x(ax + b)/(x(cx + d) + e). `Tone::Filmic` in crates/terrella-ground/src/light/tone.rs.
import rust::{TONE_FILMIC_A, TONE_FILMIC_B, TONE_FILMIC_C, TONE_FILMIC_D, TONE_FILMIC_E, TONE_FILMIC_SCALE};

fn filmic(light: vec3f) -> vec3f {
    // Beyond a thousand times white the curve is at its end, and squares could leave f32's range.
    let x = min(light, vec3f(1000.0)) * TONE_FILMIC_SCALE;
    return x * (TONE_FILMIC_A * x + TONE_FILMIC_B) / (x * (TONE_FILMIC_C * x + TONE_FILMIC_D) + TONE_FILMIC_E);
}
