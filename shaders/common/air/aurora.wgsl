// The aurora: curtains of green oxygen light from 95 km up, and red oxygen light above them, in an oval around each geomagnetic pole.
//
// The oval is a ring around a centre that is fixed relative to the Sun while the Earth rotates. Midnight has four times as much light as noon. Rays
// are integrated in steps, exactly in height; structure across or along the oval that is finer than a step or a pixel is averaged. Curtains are
// vertical; the true field lines are inclined by up to 20°.
import rust::AIR_RADIUS_M;

// Mirrored by `AuroraUniforms` in src/plan/aurora.rs.
struct AuroraUniforms {
    // Unit vector to the northern geomagnetic pole, ITRF axes.
    pole: vec3f,
    // Angles of the oval's boundaries from its centre.
    inner: f32,
    // Unit vector perpendicular to that, towards the Sun.
    noon: vec3f,
    outer: f32,
    // Mean radiances of the two lines seen from directly below.
    green: vec3f,
    // Of the angle between the oval's centre and the pole.
    center_sin: f32,
    red: vec3f,
    center_cos: f32,
    // Phases of the curtains' folds and of their rays.
    folds: vec4f,
    rays: vec4f,
}

@group(0) @binding(3) var<uniform> aurora_now: AuroraUniforms;

// Emission starts at a height and is x e^(−x), with x the height above it in scale heights: it is greatest one scale height up.
const GREEN_BASE: f32 = 95e3 / AIR_RADIUS_M;
const GREEN_SCALE: f32 = 14e3 / AIR_RADIUS_M;
const GREEN_TOP: f32 = 180e3 / AIR_RADIUS_M;
const RED_BASE: f32 = 170e3 / AIR_RADIUS_M;
const RED_SCALE: f32 = 40e3 / AIR_RADIUS_M;
const RED_TOP: f32 = 400e3 / AIR_RADIUS_M;
const GREEN_STEPS: i32 = 12;
const RED_STEPS: i32 = 4;

// Curtains: their positions across the oval, 0 at its poleward boundary and 1 at the other, and their thickness.
const CURTAINS: vec3f = vec3f(0.3, 0.52, 0.76);
const CURTAIN_WIDTH: f32 = 0.012;
// Their fraction of all light.
const CURTAIN_SHARE: f32 = 0.35;
// Limit of the displacement by their folds.
const FOLDS_REACH: f32 = 0.15;

// `angle`: of a pixel. `far`: transmittance of the lower air for light from beyond the point nearest to the Earth.
fn aurora(ray: GlowRay, angle: f32, far: vec3f) -> vec3f {
    let along = ray.pass_.along;
    let green = vec2f(half_chord(ray, GREEN_BASE), half_chord(ray, GREEN_TOP));
    let red = vec2f(half_chord(ray, RED_BASE), half_chord(ray, RED_TOP));
    var light = aurora_now.green * curtains(ray, along - green.y, along - green.x, angle);
    light += aurora_now.red * red_glow(ray, along - red.y, along - red.x);
    if !meets_ground(ray.pass_) {
        light += far * aurora_now.green * curtains(ray, along + green.x, along + green.y, angle);
        light += far * aurora_now.red * red_glow(ray, along + red.x, along + red.y);
    }
    return light;
}

// The oval of a hemisphere.
struct Oval {
    center: vec3f,
    // Across that, towards midnight and dusk.
    midnight: vec3f,
    dusk: vec3f,
    // Fraction that is not outshone by twilight; 0 if this part of a ray misses the oval.
    night: f32,
}

// The oval that this part of a ray crosses.
fn oval_at(ray: GlowRay, begin: f32, end: f32) -> Oval {
    let middle = glow_place(ray, 0.5 * (begin + end));
    let place = aurora_up(middle);
    let side = select(-1.0, 1.0, dot(place, aurora_now.pole) > 0.0);
    var oval: Oval;
    oval.center = side * aurora_now.center_cos * aurora_now.pole - aurora_now.center_sin * aurora_now.noon;
    oval.midnight = -aurora_now.center_cos * aurora_now.noon - side * aurora_now.center_sin * aurora_now.pole;
    oval.dusk = cross(aurora_now.pole, aurora_now.noon);
    let from_center = small_angle(dot(place, oval.center));
    let reach = 0.5 * (end - begin) + FOLDS_REACH * (aurora_now.outer - aurora_now.inner);
    let passes = from_center + reach > aurora_now.inner && from_center - reach < aurora_now.outer;
    oval.night = select(0.0, is_night(middle), passes && end > begin);
    return oval;
}

fn aurora_up(scaled: vec3f) -> vec3f {
    return normalize(scaled / vec3f(1.0, 1.0, air.polar_stretch));
}

// The angle that has this cosine, to 0.1 % up to 50°.
fn small_angle(cosine: f32) -> f32 {
    let chord2 = max(2.0 - 2.0 * cosine, 0.0);
    return sqrt(chord2) * (1.0 + chord2 * (0.04167 + chord2 * 0.0047));
}

// Position across the oval, 0 at its poleward boundary and 1 at the other.
fn across_oval(cosine: f32) -> f32 {
    return (small_angle(cosine) - aurora_now.inner) / (aurora_now.outer - aurora_now.inner);
}

fn height_at(ray: GlowRay, along: f32) -> f32 {
    let off = along - ray.pass_.along;
    return ray.height + off * off / (ray.pass_.q + sqrt(ray.pass_.q * ray.pass_.q + off * off));
}

// Fraction of a column below a height, given in scale heights above the base of emission.
fn column_below(x: f32) -> f32 {
    return 1.0 - (1.0 + max(x, 0.0)) * exp(-max(x, 0.0));
}

// Mean emission per scale height between two such heights, from the columns below them.
fn mean_emission(low: vec2f, high: vec2f) -> f32 {
    let rise = high.x - low.x;
    let middle = max(0.5 * (low.x + high.x), 0.0);
    return select((high.y - low.y) / rise, middle * exp(-middle), abs(rise) < 0.02);
}

// Height in scale heights above the base of emission, and the column below it.
fn level_at(ray: GlowRay, along: f32, base: f32, scale: f32) -> vec2f {
    let x = (height_at(ray, along) - base) / scale;
    return vec2f(x, column_below(x));
}

// Green emission along a part of a ray, per unit of the oval's mean vertical column.
fn curtains(ray: GlowRay, from_: f32, to: f32, angle: f32) -> f32 {
    let begin = max(from_, 0.0);
    let end = max(to, 0.0);
    let oval = oval_at(ray, begin, end);
    if oval.night <= 0.0 {
        return 0.0;
    }
    let step_ = (end - begin) / f32(GREEN_STEPS);
    let ahead = aurora_up(ray.pass_.direction);
    let width = aurora_now.outer - aurora_now.inner;
    var low = level_at(ray, begin, GREEN_BASE, GREEN_SCALE);
    var sum = 0.0;
    for (var n = 0; n < GREEN_STEPS; n++) {
        let high = level_at(ray, begin + f32(n + 1) * step_, GREEN_BASE, GREEN_SCALE);
        let emission = mean_emission(low, high);
        low = high;
        let at = begin + (f32(n) + 0.5) * step_;
        let up = aurora_up(glow_place(ray, at));
        let cosine = dot(up, oval.center);
        let across = across_oval(cosine);
        if abs(across - 0.5) > 0.5 + FOLDS_REACH {
            continue;
        }
        let sine = sqrt(max(1.0 - cosine * cosine, 1e-9));
        let level = vec2f(dot(up, oval.midnight), dot(up, oval.dusk)) / sine;
        // Change of the position across and along the oval in a step, and in a pixel.
        let slope = (dot(ahead, up) * cosine - dot(ahead, oval.center)) / sine;
        let turn = (dot(ahead, oval.dusk) * level.x - dot(ahead, oval.midnight) * level.y) / sine;
        let spread = step_ * abs(vec2f(slope / width, turn)) + at * angle / vec2f(width, sine);
        sum += emission * (1.0 + 0.6 * level.x) * curtain_light(vec2f(across, atan2(level.y, level.x)), spread);
    }
    return oval.night * sum * step_ / GREEN_SCALE;
}

// Light of diffuse aurora and curtains at a point of the oval, with a mean of about 1 over the oval. `spread`: width over which it is averaged; a
// curtain is drawn at least half as wide, so that steps are invisible.
fn curtain_light(at: vec2f, spread: vec2f) -> f32 {
    let phi = at.y;
    let folds = aurora_now.folds;
    // Each curtain has separate folds, at four scales, with varying density.
    let own = vec3f(0.0, 2.1, 4.2) + folds.x;
    let warped = phi + 0.06 * sin(vec3f(7.0, 8.0, 6.0) * phi + 2.0 * own);
    let fold = 0.05 * sin(vec3f(4.0, 5.0, 3.0) * phi + own) + 0.028 * sin(vec3f(13.0, 11.0, 16.0) * warped + folds.y)
        + 0.011 * sin(vec3f(41.0, 34.0, 47.0) * warped + folds.z + own) + 0.006 * sin(vec3f(150.0, 130.0, 170.0) * warped + folds.w);
    // Folds are inclined by about one unit across per radian along.
    let wide = spread.x + spread.y;
    let width2 = CURTAIN_WIDTH * CURTAIN_WIDTH + 0.5 * wide * wide;
    let off = vec3f(at.x) - CURTAINS - fold;
    // Curtains have ends.
    let lit = 0.5 + 0.5 * sin(vec3f(7.0, 9.0, 5.0) * warped + 3.0 * own + folds.y);
    let ray_waves = vec3f(410.0, 1100.0, 2900.0);
    let bends = vec3f(4.0, 5.0, 6.0) * sin(vec3f(53.0, 97.0, 190.0) * phi + aurora_now.rays.w);
    let off_rays = ray_waves * spread.y;
    let ray_parts = vec3f(0.45, 0.35, 0.25) * exp(off_rays * off_rays / -8.0);
    let rays = dot(ray_parts, sin(ray_waves * phi + bends + aurora_now.rays.xyz));
    let bright = exp(-off * off / width2) * lit * lit;
    // ∫ e^(−x²/w²) dx = w√π, and the mean of lit² is 3/8.
    let of_curtains = (bright.x + bright.y + bright.z) * max(1.0 + rays, 0.0) / (sqrt(width2) * 1.994);
    return mix(band(at.x), of_curtains, CURTAIN_SHARE);
}

// Diffuse aurora across the oval, with mean 1.
fn band(across: f32) -> f32 {
    return smoothstep(0.0, 0.25, across) * (1.0 - smoothstep(0.75, 1.0, across)) / 0.75;
}

// Red emission along a part of a ray, likewise. Its atoms live for two minutes: it has no curtains.
fn red_glow(ray: GlowRay, from_: f32, to: f32) -> f32 {
    let begin = max(from_, 0.0);
    let end = max(to, 0.0);
    let oval = oval_at(ray, begin, end);
    if oval.night <= 0.0 {
        return 0.0;
    }
    let step_ = (end - begin) / f32(RED_STEPS);
    var low = level_at(ray, begin, RED_BASE, RED_SCALE);
    var sum = 0.0;
    for (var n = 0; n < RED_STEPS; n++) {
        let high = level_at(ray, begin + f32(n + 1) * step_, RED_BASE, RED_SCALE);
        let up = aurora_up(glow_place(ray, begin + (f32(n) + 0.5) * step_));
        let cosine = dot(up, oval.center);
        let around = 1.0 + 0.6 * dot(up, oval.midnight) / sqrt(max(1.0 - cosine * cosine, 1e-9));
        sum += mean_emission(low, high) * around * band(across_oval(cosine));
        low = high;
    }
    return oval.night * sum * step_ / RED_SCALE;
}
