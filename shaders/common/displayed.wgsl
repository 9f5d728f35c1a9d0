// Conversion from light to the value that the colour target stores: exposure, tone curve, dithering, encoding. It is the last step.
//
// `TargetColor` in src/gpu/shader/variant.rs lists the legal combinations of conditions. Float targets get the light itself, or exposed light if it
// is developed after the pass (exposed). All others get displayed colour: shown, with camera, neutral, filmic, agx or none of them (clamped at 1),
// and encode if the hardware does not encode.
@if(encode) import common/color.wgsl;
@if(exposed) import rust::BRIGHTEST_EXPOSED;
@if(shown) import rust::LAST_CODE;
@if(camera) import rust::{LUMINANCE, TONE_CAMERA_HALF_RAISED, TONE_CAMERA_HAZE, TONE_CAMERA_SATURATION, TONE_CAMERA_STRAIGHT, TONE_CAMERA_TOE, TONE_CAMERA_TOE_LEAST, TONE_CAMERA_WHITE};
@if(neutral) import rust::{TONE_NEUTRAL_DESATURATION, TONE_NEUTRAL_START};
@if(agx) import rust::{TONE_AGX_CONTRAST_HIGH, TONE_AGX_CONTRAST_LOW, TONE_AGX_CONTRAST_LEAST, TONE_AGX_DISPLAY_POWER, TONE_AGX_FROM_X, TONE_AGX_FROM_Y, TONE_AGX_FROM_Z, TONE_AGX_INSET_X, TONE_AGX_INSET_Y, TONE_AGX_INSET_Z, TONE_AGX_LEAST_LOG, TONE_AGX_MOST_LOG, TONE_AGX_OUTSET_X, TONE_AGX_OUTSET_Y, TONE_AGX_OUTSET_Z};
@if(filmic) import rust::{TONE_FILMIC_A, TONE_FILMIC_B, TONE_FILMIC_C, TONE_FILMIC_D, TONE_FILMIC_E, TONE_FILMIC_SCALE};

fn displayed(light: vec3f, exposure: f32, pixel: vec2f) -> vec3f {
    return stored(toned(light, exposure), pixel);
}

// As the target stores a tone-mapped value.
fn stored(shown: vec3f, pixel: vec2f) -> vec3f {
    @if(!shown) return shown;
    @if(encode) return encoded(shown) + dither(pixel);
    @if(shown && !encode) return shown + dither(pixel) * linear_per_code(shown);
}

// The same without dithering: for what is blended into dithered pixels.
fn encoded(shown: vec3f) -> vec3f {
    @if(encode) return encode_srgb(shown);
    @else return shown;
}

// The tone-mapped value, linear and without dithering.
fn toned(light: vec3f, exposure: f32) -> vec3f {
    @if(!shown && !exposed) return light;
    @if(exposed) return min(light * exposure, vec3f(BRIGHTEST_EXPOSED));
    @if(shown) var shown = light * exposure;
    @if(camera) shown = camera(shown);
    @if(neutral) shown = neutral(shown);
    @if(filmic) shown = filmic(shown);
    @if(agx) shown = agx(shown);
    @if(shown) return shown;
}

// `Tone::Camera` in crates/terrella-ground/src/light/tone.rs.
@if(camera)
fn camera(light: vec3f) -> vec3f {
    // Beyond a thousand times white the curve is saturated, and squares could leave f32's range.
    let x = min(light, vec3f(1000.0));
    // How much of the colour is that of haze.
    let other = max(x.r, x.g);
    let lack = (other - x.b) / max(x.b + other, 1e-30);
    let toe = mix(vec3f(TONE_CAMERA_TOE.r), TONE_CAMERA_TOE, 1.0 - smoothstep(0.0, TONE_CAMERA_HAZE, lack));
    let cleared = x * (x + TONE_CAMERA_TOE_LEAST * toe) / (x + toe);
    let raised = cleared * (sqrt(cleared) + TONE_CAMERA_STRAIGHT);
    let shown = TONE_CAMERA_WHITE * raised / (raised + TONE_CAMERA_HALF_RAISED);
    return max(mix(vec3f(dot(shown, LUMINANCE)), shown, TONE_CAMERA_SATURATION), vec3f(0.0));
}

// Khronos PBR Neutral (2024), only its highlights. `Tone::Neutral` in crates/terrella-ground/src/light/tone.rs explains why.
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
    // Beyond a thousand times white the curve is saturated, and squares could leave f32's range.
    let x = min(light, vec3f(1000.0)) * TONE_FILMIC_SCALE;
    return x * (TONE_FILMIC_A * x + TONE_FILMIC_B) / (x * (TONE_FILMIC_C * x + TONE_FILMIC_D) + TONE_FILMIC_E);
}

// `agx` in crates/terrella-ground/src/light/agx.rs.
@if(agx)
fn agx(light: vec3f) -> vec3f {
    let seen = mat3x3f(TONE_AGX_INSET_X, TONE_AGX_INSET_Y, TONE_AGX_INSET_Z) * light;
    let log_ = log2(max(seen, vec3f(1e-10)));
    let x = saturate((log_ - TONE_AGX_LEAST_LOG) / (TONE_AGX_MOST_LOG - TONE_AGX_LEAST_LOG));
    let high = (TONE_AGX_CONTRAST_HIGH.z * x + TONE_AGX_CONTRAST_HIGH.y) * x + TONE_AGX_CONTRAST_HIGH.x;
    let low = (TONE_AGX_CONTRAST_LOW.z * x + TONE_AGX_CONTRAST_LOW.y) * x + TONE_AGX_CONTRAST_LOW.x;
    let curved = (high * x * x * x + low) * x + TONE_AGX_CONTRAST_LEAST;
    let outset = mat3x3f(TONE_AGX_OUTSET_X, TONE_AGX_OUTSET_Y, TONE_AGX_OUTSET_Z) * curved;
    let shown = pow(max(outset, vec3f(0.0)), vec3f(TONE_AGX_DISPLAY_POWER));
    return saturate(mat3x3f(TONE_AGX_FROM_X, TONE_AGX_FROM_Y, TONE_AGX_FROM_Z) * shown);
}

// Noise of at most half a step of 8 bits, constant for a pixel in all frames. Gradients too dark for 8 bits are represented by the density of
// pixels at the next step, with the correct mean.
//
// Interleaved gradient noise (Jimenez 2014, "Next Generation Post Processing in Call of Duty"): uniformly distributed over any small neighbourhood.
@if(shown)
fn dither(pixel: vec2f) -> f32 {
    return (fract(52.9829189 * fract(dot(pixel, vec2f(0.06711056, 0.00583715)))) - 0.5) / LAST_CODE;
}

// Derivative of linear light with respect to its sRGB code: 2.4/1.055 · c^(1.4/2.4), within 9 % and without a power; 1/12.92 at the dark end.
@if(shown)
fn linear_per_code(linear: vec3f) -> vec3f {
    let c = clamp(linear, vec3f(0.0), vec3f(1.0));
    return max(1.469 * sqrt(c) + 0.806 * c, vec3f(1.0 / 12.92));
}
