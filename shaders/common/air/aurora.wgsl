// The aurora: curtains of green oxygen light from 95 km up, and red oxygen light above them, in an oval about either geomagnetic pole.
//
// The oval is a ring about a centre that is fixed to the Sun as the Earth turns. Midnight has four times as much light as noon. A ray is
// summed in steps, exactly in height; what is finer across the oval or along it than a step or a pixel is spread over that. Curtains
// stand upright; the field lines of the oval lean by up to 20°.
import rust::AIR_RADIUS_M;

// Mirrored by `AuroraUniforms` in src/plan/aurora.rs.
struct AuroraUniforms {
    // Unit vector to the northern geomagnetic pole, ITRF axes.
    pole: vec3f,
    // Angles of the oval's boundaries from its centre.
    inner: f32,
    // Unit vector across that, towards the Sun.
    noon: vec3f,
    outer: f32,
    // Mean radiances of the two lines seen from straight below.
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

// Emission begins at a height and goes as x e^(−x), x being the height above that in scale heights: it is greatest one scale height up.
const GREEN_BASE: f32 = 95e3 / AIR_RADIUS_M;
const GREEN_SCALE: f32 = 14e3 / AIR_RADIUS_M;
const GREEN_TOP: f32 = 180e3 / AIR_RADIUS_M;
const RED_BASE: f32 = 170e3 / AIR_RADIUS_M;
const RED_SCALE: f32 = 40e3 / AIR_RADIUS_M;
const RED_TOP: f32 = 400e3 / AIR_RADIUS_M;
const GREEN_STEPS: i32 = 12;
const RED_STEPS: i32 = 4;

// Curtains: where they stand across the oval, 0 at its poleward boundary and 1 at the other, and how thick they are.
const CURTAINS: vec3f = vec3f(0.3, 0.52, 0.76);
const CURTAIN_WIDTH: f32 = 0.012;
// The part of all light that is theirs.
const CURTAIN_SHARE: f32 = 0.35;
// How far their folds may reach.
const FOLDS_REACH: f32 = 0.15;

// `angle`: of a pixel. `far`: what the air below leaves of the light from beyond the point nearest to the Earth.
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
    // How much of it is not outshone by twilight; 0 where a part of a ray does not pass it.
    night: f32,
}

// The one that a part of a ray passes.
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

// Where a place lies across the oval, 0 at its poleward boundary and 1 at the other.
fn across_oval(cosine: f32) -> f32 {
    return (small_angle(cosine) - aurora_now.inner) / (aurora_now.outer - aurora_now.inner);
}

fn height_at(ray: GlowRay, along: f32) -> f32 {
    let off = along - ray.pass_.along;
    return ray.height + off * off / (ray.pass_.q + sqrt(ray.pass_.q * ray.pass_.q + off * off));
}

// The part of a column that lies below a height, given in scale heights above where emission begins.
fn column_below(x: f32) -> f32 {
    return 1.0 - (1.0 + max(x, 0.0)) * exp(-max(x, 0.0));
}

// Mean emission for each scale height between two such heights with their columns below.
fn mean_emission(low: vec2f, high: vec2f) -> f32 {
    let rise = high.x - low.x;
    let middle = max(0.5 * (low.x + high.x), 0.0);
    return select((high.y - low.y) / rise, middle * exp(-middle), abs(rise) < 0.02);
}

// Height in scale heights above where emission begins, and the column below it.
fn level_at(ray: GlowRay, along: f32, base: f32, scale: f32) -> vec2f {
    let x = (height_at(ray, along) - base) / scale;
    return vec2f(x, column_below(x));
}

// Green emission along a part of a ray, for each unit of the oval's mean vertical column.
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
        // What place and direction across and along the oval change by in a step, and in a pixel.
        let slope = (dot(ahead, up) * cosine - dot(ahead, oval.center)) / sine;
        let turn = (dot(ahead, oval.dusk) * level.x - dot(ahead, oval.midnight) * level.y) / sine;
        let spread = step_ * abs(vec2f(slope / width, turn)) + at * angle / vec2f(width, sine);
        sum += emission * (1.0 + 0.6 * level.x) * curtain_light(vec2f(across, atan2(level.y, level.x)), spread);
    }
    return oval.night * sum * step_ / GREEN_SCALE;
}

// Light of diffuse aurora and curtains at a place of the oval, its mean over the oval being about 1. `spread`: how much of the oval that
// is the mean of; a curtain is drawn at least as wide as half of it, so that steps do not show.
fn curtain_light(at: vec2f, spread: vec2f) -> f32 {
    let phi = at.y;
    let folds = aurora_now.folds;
    // Each curtain has folds of its own, of four sizes, crowded in some places and stretched in others.
    let own = vec3f(0.0, 2.1, 4.2) + folds.x;
    let warped = phi + 0.06 * sin(vec3f(7.0, 8.0, 6.0) * phi + 2.0 * own);
    let fold = 0.05 * sin(vec3f(4.0, 5.0, 3.0) * phi + own) + 0.028 * sin(vec3f(13.0, 11.0, 16.0) * warped + folds.y)
        + 0.011 * sin(vec3f(41.0, 34.0, 47.0) * warped + folds.z + own) + 0.006 * sin(vec3f(150.0, 130.0, 170.0) * warped + folds.w);
    // Folds lean by about a unit across for each radian along.
    let wide = spread.x + spread.y;
    let width2 = CURTAIN_WIDTH * CURTAIN_WIDTH + 0.5 * wide * wide;
    let off = vec3f(at.x) - CURTAINS - fold;
    // Curtains begin and end.
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

// Diffuse aurora across the oval, its mean being 1.
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
