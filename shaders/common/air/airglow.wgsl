// The airglow: light that three layers of the upper air emit at night. Sodium and OH at 88 km, green oxygen at 98 km and red oxygen at 250 km, each
// a Gaussian in height. Vectors of three hold the layers in this order.
import rust::{AIRGLOW_GREEN_LIGHT, AIRGLOW_HEIGHTS, AIRGLOW_LOW_LIGHT, AIRGLOW_RED_LIGHT, AIRGLOW_SIGMAS};

// `pixel`: change of the ray's minimum height to the next pixel. `far`: transmittance of the lower air for light from beyond the point nearest to
// the Earth.
fn airglow(ray: GlowRay, pixel: f32, far: vec3f) -> vec3f {
    let nights = vec2f(glow_at_night(ray, -1.0), glow_at_night(ray, 1.0));
    if max(nights.x, nights.y) <= 0.0 {
        return vec3f(0.0);
    }
    let pass_ = ray.pass_;
    let column = half_column(ray, pixel);
    // Fraction of the half of the line on the eye's side between the eye and the nearest point. Near that point density falls by e^(−x²/2) within
    // √(q σ).
    let near = column * glow.beneath * pass_.along / sqrt(pass_.q * AIRGLOW_SIGMAS + pass_.along * pass_.along);
    if meets_ground(pass_) {
        return nights.x * of_layers(max(near, vec3f(0.0)));
    }
    // An eye that looks up sees the part of the other half above it.
    let beyond = column + min(near, vec3f(0.0));
    return nights.y * far * of_layers(beyond) + nights.x * of_layers(max(near, vec3f(0.0)));
}

fn of_layers(columns: vec3f) -> vec3f {
    return columns.x * AIRGLOW_LOW_LIGHT + columns.y * AIRGLOW_GREEN_LIGHT + columns.z * AIRGLOW_RED_LIGHT;
}

// Emission along half of a line at distance q from the centre, from its nearest point on, per unit of vertical column.
//
// With u = (q − r)/σ and the distance t√(2qσ) from the nearest point, height is σ(u + t²), and the column √(q/πσ) G(u) with G = ∫₀^∞ e^(−(u +
// t²)²/2) dt = √π/2 e^(−u²/4) D₋½(u), D being the parabolic cylinder function. Where the line crosses the layer at an angle, it is the secant of
// that angle, to the fourth order in the layer's width.
fn half_column(ray: GlowRay, pixel: f32) -> vec3f {
    // A pixel that is wider than a layer gets the layer's mean.
    let sigma = sqrt(AIRGLOW_SIGMAS * AIRGLOW_SIGMAS + pixel * pixel / 12.0);
    let q = ray.pass_.q;
    let below = AIRGLOW_HEIGHTS - ray.height;
    let u = -below / sigma;
    let inverse2 = 1.0 / max(u * u, vec3f(9.0));
    let secant = (1.0 + AIRGLOW_HEIGHTS) / sqrt(max(below, 3.0 * sigma) * (1.0 + AIRGLOW_HEIGHTS + q));
    let crossing = secant * (1.0 + inverse2 * (0.375 + inverse2 * 0.8203));
    let grazing = sqrt(q / (PI * sigma)) * grazing_integral(clamp(u, vec3f(-3.0), vec3f(5.0)));
    return select(grazing, crossing, u < vec3f(-3.0)) * step(u, vec3f(5.0));
}

// G(u), −3 ≤ u ≤ 5: a fit of its logarithm, accurate to 0.4 %.
fn grazing_integral(u: vec3f) -> vec3f {
    let low = 7.40810e-2 + u * (-4.745711e-1 + u * (-3.621490e-1 + u * -3.974509e-2));
    let u4 = u * u * u * u;
    return exp(low + u4 * (7.405551e-3 + u * (-9.586579e-5 + u * (-2.036139e-4 + u * 2.224381e-5))));
}
