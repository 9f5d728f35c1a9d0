// Fraction of sunlight that the Moon leaves for scattering in the air in front of the eye: the mean over two or three points of a ray, by Gauss's
// rules for an exponentially falling density. Lengths are equatorial radii of scaled space.
import common/eclipse.wgsl;
import rust::{AIR_RADIUS_M, AIR_SCALE_HEIGHT_M};

const SCALE_HEIGHT: f32 = AIR_SCALE_HEIGHT_M / AIR_RADIUS_M;
// Gauss–Laguerre: heights in scale heights, and their weights.
const LOW: vec2f = vec2f(0.5858, 0.8536);
const HIGH: vec2f = vec2f(3.4142, 0.1464);

// For a ray that misses the ground and is nearest to it at `nearest`. If the eye looks up, all of the air is beyond it.
fn sun_on_air(pass_: Pass, nearest: vec3f) -> vec3f {
    if pass_.along <= 0.0 {
        let eye = -air.eye_distance * air.toward_center;
        return sun_on_rising_air(eye, pass_.direction, -pass_.along / air.eye_distance, 1.0);
    }
    return sun_on_passed_air(nearest, pass_.direction, pass_.along);
}

// For a ray that rises from `start` in the direction `outwards` at a cosine to the vertical, over at most `reach`.
fn sun_on_rising_air(start: vec3f, outwards: vec3f, cosine: f32, reach: f32) -> vec3f {
    let low = min(way_up(LOW.x * SCALE_HEIGHT, cosine), reach);
    let high = min(way_up(HIGH.x * SCALE_HEIGHT, cosine), reach);
    return LOW.y * sun_at(start + low * outwards) + HIGH.y * sun_at(start + high * outwards);
}

// For a ray past the ground, nearest to it at `nearest`, from the eye, which is `back` before that point.
fn sun_on_passed_air(nearest: vec3f, direction: vec3f, back: f32) -> vec3f {
    // Gauss–Hermite: for a density e^(−x²/2) at 0 and ±√3.
    let step = sqrt(3.0 * SCALE_HEIGHT) * direction;
    let before = nearest - min(back, length(step)) * direction;
    return (4.0 * sun_at(nearest) + sun_at(before) + sun_at(nearest + step)) / 6.0;
}

// Length of a ray until it is this much higher.
fn way_up(height: f32, cosine: f32) -> f32 {
    let above = height * (2.0 + height);
    return above / (sqrt(cosine * cosine + above) + cosine);
}

fn sun_at(scaled: vec3f) -> vec3f {
    return sun_left(air.shadow, scaled / vec3f(1.0, 1.0, air.polar_stretch));
}
