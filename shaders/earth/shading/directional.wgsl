// Directional reflectance of land and clouds. Over all directions of the eye they reflect as much as a Lambertian surface of the same albedo.

// If the eye looks along the sunlight, shadows are hidden behind the objects that cast them: rough land and broken clouds are brightest there. This
// is Hapke's opposition effect (Hapke 1986, Icarus 67, 264). Its strength and width make the geometric albedo of the whole disc 0.234 and its phase
// integral 1.23; Robinson 2025 (arXiv 2507.22258) measured 0.242 and 1.22.
const OPPOSITION: f32 = 3.2;
const OPPOSITION_WIDTH: f32 = 0.25;

// Radiance relative to a Lambertian surface, at this cosine between eye and Sun, for the Sun at the cosine `mu`.
fn opposition(cos_phase: f32, mu: f32) -> f32 {
    let half_tangent = sqrt(max(1.0 - cos_phase, 0.0) / max(1.0 + cos_phase, 1e-6));
    let surge = 1.0 / (1.0 + half_tangent / OPPOSITION_WIDTH);
    // Mean over the eye's directions: a fit within 5e-4.
    let mean = 0.2192 + mu * (0.165 + 0.024 * mu);
    return (1.0 + OPPOSITION * surge) / (1.0 + OPPOSITION * mean);
}

// Asymmetry of a droplet's scattering after delta-Eddington scaling, g/(1 + g) with g = 0.85.
const SCALED_ASYMMETRY: f32 = 0.4595;

// Reflectance of a layer of this scaled thickness for singly scattered light: larger in the forward direction, towards a low Sun.
fn scattered_once(thickness: f32, mu_eye: f32, mu: f32, cos_phase: f32) -> f32 {
    let squared = SCALED_ASYMMETRY * SCALED_ASYMMETRY;
    // Henyey–Greenstein; the scattering angle is 180° minus the phase angle.
    let root = inverseSqrt(1.0 + squared + 2.0 * SCALED_ASYMMETRY * cos_phase);
    let phase = (1.0 - squared) * root * root * root;
    return phase * (1.0 - exp(-thickness * (1.0 / mu_eye + 1.0 / mu))) / (4.0 * (mu_eye + mu));
}

// Albedo for singly scattered light, over all directions: a fit within 0.006.
fn albedo_of_scattered_once(thickness: f32, mu: f32) -> f32 {
    return (1.0 - exp(-thickness * (1.0 / mu + 2.6))) / (2.1 + mu * (8.0 + 9.2 * mu));
}
