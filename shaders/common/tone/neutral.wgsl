// Khronos PBR Neutral (2024), its highlights alone. `Tone::Neutral` in crates/terrella-ground/src/light/tone.rs says why.
import rust::{TONE_NEUTRAL_DESATURATION, TONE_NEUTRAL_START};

fn neutral(light: vec3f) -> vec3f {
    let peak = max(light.r, max(light.g, light.b));
    if peak <= TONE_NEUTRAL_START {
        return light;
    }
    let room = 1.0 - TONE_NEUTRAL_START;
    let shown_peak = 1.0 - room * room / (peak + room - TONE_NEUTRAL_START);
    let white = 1.0 - 1.0 / (TONE_NEUTRAL_DESATURATION * (peak - shown_peak) + 1.0);
    return mix(light * (shown_peak / peak), vec3f(shown_peak), white);
}
