// Fraction of the Sun's light that the Moon leaves at a position: zero if it hides the whole disc. Without the corona, and without light scattered
// into the shadow by the surrounding air.
import common/moon_shadow.wgsl;
import rust::{MOON_PER_SUN, PI};

// If a fraction x of the disc's area is visible, its light is x (1 − (1 − x)(a + b √x)) of the whole: the disc is darker and redder towards its
// limb. Fitted to the law of celestial/sun.wgsl for Moons of 0.92 to 1.06 of the Sun's radius, within 0.02 of the whole.
const LIMB_A: vec3f = vec3f(0.495, 0.556, 0.702);
const LIMB_B: vec3f = vec3f(-0.611, -0.684, -0.854);

// `place`: ITRF axes, equatorial radii.
fn sun_left(shadow: MoonShadow, place: vec3f) -> vec3f {
    let x = disc_left(shadow, place);
    return x * (1.0 - (1.0 - x) * (LIMB_A + LIMB_B * sqrt(x)));
}

// Visible fraction of the disc's area.
fn disc_left(shadow: MoonShadow, place: vec3f) -> f32 {
    let from_moon = place - shadow.moon;
    let behind = dot(from_moon, shadow.axis);
    // In units of the Sun's angular radius: the Moon's radius, and the distance of their centres. All angles are small.
    let per_length = shadow.spread / behind;
    let moon = MOON_PER_SUN + shadow.radius * per_length;
    let apart = length(from_moon - behind * shadow.axis) * per_length;
    if apart >= 1.0 + moon { return 1.0; }
    if apart <= moon - 1.0 { return 0.0; }
    if apart <= 1.0 - moon { return 1.0 - moon * moon; }
    // Two sectors minus the quadrilateral of the centres and the corners.
    let x = clamp((apart * apart + 1.0 - moon * moon) / (2.0 * apart), -1.0, 1.0);
    let across = sqrt((1.0 - x) * (1.0 + x));
    let of_moon = moon * moon * acos(clamp((apart - x) / moon, -1.0, 1.0));
    return saturate(1.0 - (acos(x) + of_moon - apart * across) / PI);
}

// Position at a height over the ellipsoid whose normal is `up`, both lengths equatorial radii; `polar_stretch` is a/b.
fn place_over(up: vec3f, height: f32, polar_stretch: f32) -> vec3f {
    let flat = up / vec3f(1.0, 1.0, polar_stretch);
    return flat / vec3f(1.0, 1.0, polar_stretch) / length(flat) + height * up;
}
