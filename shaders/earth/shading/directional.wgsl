// How land and clouds reflect more light to some sides than to others. Over all directions of the eye they reflect what a Lambertian
// surface of the same albedo does.

// Shadows hide behind what casts them where the eye looks along the sunlight: rough land and broken clouds are brightest there. This is
// Hapke's opposition effect (Hapke 1986, Icarus 67, 264). Its strength and width make the geometric albedo of the whole disc 0.234 and
// its phase integral 1.23; Robinson 2025 (arXiv 2507.22258) measured 0.242 and 1.22.
const OPPOSITION: f32 = 3.2;
const OPPOSITION_WIDTH: f32 = 0.25;

// What an eye at this cosine to the Sun sees of a place that the Sun lights at the cosine `mu`, of a Lambertian surface's light.
fn opposition(cos_phase: f32, mu: f32) -> f32 {
    let half_tangent = sqrt(max(1.0 - cos_phase, 0.0) / max(1.0 + cos_phase, 1e-6));
    let surge = 1.0 / (1.0 + half_tangent / OPPOSITION_WIDTH);
    // Its mean over the eye's directions: a fit within 5e-4.
    let mean = 0.2192 + mu * (0.165 + 0.024 * mu);
    return (1.0 + OPPOSITION * surge) / (1.0 + OPPOSITION * mean);
}

// Asymmetry of a droplet's scattering as delta-Eddington scales it, g/(1 + g) with g = 0.85.
const SCALED_ASYMMETRY: f32 = 0.4595;

// Reflectance of a layer of this scaled thickness for light that it scatters once: forwards, towards a low Sun, more than elsewhere.
fn scattered_once(thickness: f32, mu_eye: f32, mu: f32, cos_phase: f32) -> f32 {
    let squared = SCALED_ASYMMETRY * SCALED_ASYMMETRY;
    // Henyey and Greenstein; light goes on by 180° less the phase angle.
    let phase = (1.0 - squared) * pow(1.0 + squared + 2.0 * SCALED_ASYMMETRY * cos_phase, -1.5);
    return phase * (1.0 - exp(-thickness * (1.0 / mu_eye + 1.0 / mu))) / (4.0 * (mu_eye + mu));
}

// The same of all directions together, the layer's albedo of that light: a fit within 0.006.
fn albedo_of_scattered_once(thickness: f32, mu: f32) -> f32 {
    return (1.0 - exp(-thickness * (1.0 / mu + 2.6))) / (2.1 + mu * (8.0 + 9.2 * mu));
}
