// Light of the Sun that lens and eye scatter about it, over all that is in the picture.
import rust::{GLARE_RADIUS_RAD, PI};

// Light about a source at an angle θ in degrees is 10/θ² for its light on the eye, in a young eye (Stiles and Holladay; CIE 112): so
// much of it a good lens has. Nearer than the core it does not mount.
const GLARE: f32 = 10.0 * 0.01;
const GLARE_CORE_DEG: f32 = 0.4;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return corner_of(sky.glare_bounds, index, sky.near_depth);
}

@fragment
fn fragment(@builtin(position) clip: vec4f) -> @location(0) vec4f {
    let met = meet(sky.sun, clip.xy);
    let theta = degrees(atan2(length(met.ray.xy), met.ray.z));
    let edge = degrees(GLARE_RADIUS_RAD);
    // Nothing at the edge, without a step.
    let shape = 1.0 / (theta * theta + GLARE_CORE_DEG * GLARE_CORE_DEG) - 1.0 / (edge * edge + GLARE_CORE_DEG * GLARE_CORE_DEG);
    let light = PI * GLARE * sky.sun_seen * max(shape, 0.0);
    return added(light * through_air(ray_through(sky.frame, sun_px())), 0.0);
}

// The pixel of the Sun's centre: there the rays across are 0.
fn sun_px() -> vec2f {
    let x = sky.sun.pixel_x;
    let y = sky.sun.pixel_y;
    let span = x.x * y.y - x.y * y.x;
    return vec2f(x.y * y.z - x.z * y.y, x.z * y.x - x.x * y.z) / span;
}
