// Noise of at most half a step of 8 bits, the same for a pixel in every frame, so that gradients too dark for 8 bits are shown
// by how many pixels have the next step, and their mean is right.

import rust::LAST_CODE;

// Interleaved gradient noise (Jimenez 2014, "Next Generation Post Processing in Call of Duty"): evenly spread over any small
// neighbourhood.
fn dither(pixel: vec2f) -> f32 {
    return (fract(52.9829189 * fract(dot(pixel, vec2f(0.06711056, 0.00583715)))) - 0.5) / LAST_CODE;
}

// Change of linear light for a change of its sRGB code: 2.4/1.055 · c^(1.4/2.4), within 9 % and without a power; 1/12.92 at the
// dark end.
fn linear_per_code(linear: vec3f) -> vec3f {
    let c = clamp(linear, vec3f(0.0), vec3f(1.0));
    return max(1.469 * sqrt(c) + 0.806 * c, vec3f(1.0 / 12.92));
}
