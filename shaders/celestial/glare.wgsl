// Light of the Sun that lens and eye scatter around it, over the whole image.
import rust::{GLARE_RADIUS_RAD, PI};
@if(aperture) import rust::{APERTURE_FADING, APERTURE_SCALES, SUN_PLACE, SUN_PLACES, SUN_RADIUS_RAD};

// Veiling glare at an angle θ in degrees from a source is 10/θ² per illuminance at the eye, for a young eye (Stiles and Holladay; CIE 112). A good
// lens has this fraction of it. Inside the core it is constant.
const GLARE: f32 = 10.0 * 0.01;
const GLARE_CORE_DEG: f32 = 0.4;

struct Varying {
    @builtin(position) clip: vec4f,
    // Light of the Sun at the eye, after Earth, Moon and air.
    @location(0) @interpolate(flat) light: vec3f,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Varying {
    var ray = ray_through(sky.frame, sun_px());
    // Where the limb hides the Sun's centre, its light comes over the limb. The way to the ground would be half as long.
    ray.q = select(ray.q, max(ray.q, 1.0), ray.along > 0.0);
    let light = sky.sun_seen * through_air(ray);
    return Varying(corner_of(sky.glare_bounds, index, sky.near_depth), light);
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    // The squared angle, in degrees, computed from its sine.
    let ray = meet(sky.sun, in.clip.xy).ray;
    let sine_squared = dot(ray.xy, ray.xy);
    let squared = degrees(degrees(sine_squared * (1.0 + sine_squared * (1.0 / 3.0 + 8.0 / 45.0 * sine_squared))));
    let core = GLARE_CORE_DEG * GLARE_CORE_DEG;
    let edge = degrees(GLARE_RADIUS_RAD) * degrees(GLARE_RADIUS_RAD);
    // Zero at the edge, without a step.
    let shape = select(0.0, 1.0 / (squared + core) - 1.0 / (edge + core), ray.z > 0.0);
    var light = PI * GLARE * max(shape, 0.0) * in.light;
    @if(aperture) light += PI * diffracted(in.clip.xy - sun_px(), radians(radians(squared))) * in.light;
    return added(light, 0.0);
}

// Light that the aperture diffracts into a solid angle at this distance from the Sun, and this squared angle, per light at the eye.
// `DiffractionPattern` in crates/terrella-ground/src/light/aperture.rs is the pattern.
@if(aperture)
fn diffracted(off_px: vec2f, squared_rad: f32) -> vec3f {
    let at = sky.aperture.x * off_px;
    // Spikes have faded to exp(-8) there.
    if dot(at, at) > 0.3 {
        return vec3f(0.0);
    }
    let radius = SUN_PLACE * sky.aperture.y;
    let side = f32(textureDimensions(body_map).x);
    let level = log2(max(side * radius, 1.0));
    var sum = vec3f(0.0);
    for (var n = 0u; n < SUN_PLACES; n++) {
        let turn = (f32(n) + 0.5) * 2.0 * PI / f32(SUN_PLACES);
        let place = at + radius * vec2f(cos(turn), sin(turn));
        sum.r += pattern(place * APERTURE_SCALES.r, side, level);
        sum.g += pattern(place * APERTURE_SCALES.g, side, level);
        sum.b += pattern(place * APERTURE_SCALES.b, side, level);
    }
    // On the disc it is clamped to the value at its edge.
    return exp(-APERTURE_FADING * dot(at, at)) * sum / f32(SUN_PLACES) / max(squared_rad, SUN_RADIUS_RAD * SUN_RADIUS_RAD);
}

// The pattern at a distance from its core, which is at the centre of a texel.
@if(aperture)
fn pattern(off: vec2f, side: f32, level: f32) -> f32 {
    let at = 0.5 + 0.5 / side + off;
    let value = textureSampleLevel(body_map, body_sampler, at, level).r;
    return select(0.0, value, all(abs(off) < vec2f(0.5)));
}
