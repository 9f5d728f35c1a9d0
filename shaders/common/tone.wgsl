// Tone curves: how exposed light is shown.
@if(camera) import rust::{LUMINANCE, TONE_CAMERA_HALF_RAISED, TONE_CAMERA_SATURATION, TONE_CAMERA_STRAIGHT, TONE_CAMERA_TOE, TONE_CAMERA_TOE_LEAST, TONE_CAMERA_WHITE};
@if(neutral) import rust::{TONE_NEUTRAL_DESATURATION, TONE_NEUTRAL_START};
@if(filmic) import rust::{TONE_FILMIC_A, TONE_FILMIC_B, TONE_FILMIC_C, TONE_FILMIC_D, TONE_FILMIC_E, TONE_FILMIC_SCALE};

// `Tone::Camera` in crates/terrella-ground/src/light/tone.rs.
@if(camera)
fn camera(light: vec3f) -> vec3f {
    // Beyond a thousand times white the curve is at its end, and squares could leave f32's range.
    let x = min(light, vec3f(1000.0));
    let cleared = x * (x + TONE_CAMERA_TOE_LEAST * TONE_CAMERA_TOE) / (x + TONE_CAMERA_TOE);
    let raised = cleared * (sqrt(cleared) + TONE_CAMERA_STRAIGHT);
    let shown = TONE_CAMERA_WHITE * raised / (raised + TONE_CAMERA_HALF_RAISED);
    return max(mix(vec3f(dot(shown, LUMINANCE)), shown, TONE_CAMERA_SATURATION), vec3f(0.0));
}

// Khronos PBR Neutral (2024), its highlights alone. `Tone::Neutral` in crates/terrella-ground/src/light/tone.rs says why.
@if(neutral)
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

// Narkowicz 2016, "ACES Filmic Tone Mapping Curve": x(ax + b)/(x(cx + d) + e). `Tone::Filmic` in crates/terrella-ground/src/light/tone.rs.
@if(filmic)
fn filmic(light: vec3f) -> vec3f {
    // Beyond a thousand times white the curve is at its end, and squares could leave f32's range.
    let x = min(light, vec3f(1000.0)) * TONE_FILMIC_SCALE;
    return x * (TONE_FILMIC_A * x + TONE_FILMIC_B) / (x * (TONE_FILMIC_C * x + TONE_FILMIC_D) + TONE_FILMIC_E);
}
