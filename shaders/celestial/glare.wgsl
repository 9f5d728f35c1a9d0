// Light of the Sun that lens and eye scatter about it, over all that is in the picture.
import rust::{GLARE_RADIUS_RAD, PI};

// Light about a source at an angle θ in degrees is 10/θ² for its light on the eye, in a young eye (Stiles and Holladay; CIE 112): so
// much of it a good lens has. Nearer than the core it does not mount.
const GLARE: f32 = 10.0 * 0.01;
const GLARE_CORE_DEG: f32 = 0.4;

struct Varying {
    @builtin(position) clip: vec4f,
    // Of the Sun on the eye, after Earth, Moon and air.
    @location(0) @interpolate(flat) light: vec3f,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Varying {
    let light = sky.sun_seen * through_air(ray_through(sky.frame, sun_px()));
    return Varying(corner_of(sky.glare_bounds, index, sky.near_depth), light);
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    // The square of the angle, in degrees, from that of its sine.
    let ray = meet(sky.sun, in.clip.xy).ray;
    let sine_squared = dot(ray.xy, ray.xy);
    let squared = degrees(degrees(sine_squared * (1.0 + sine_squared * (1.0 / 3.0 + 8.0 / 45.0 * sine_squared))));
    let core = GLARE_CORE_DEG * GLARE_CORE_DEG;
    let edge = degrees(GLARE_RADIUS_RAD) * degrees(GLARE_RADIUS_RAD);
    // Nothing at the edge, without a step.
    let shape = select(0.0, 1.0 / (squared + core) - 1.0 / (edge + core), ray.z > 0.0);
    return added(PI * GLARE * max(shape, 0.0) * in.light, 0.0);
}

// The pixel of the Sun's centre: there the rays across are 0.
fn sun_px() -> vec2f {
    let x = sky.sun.pixel_x;
    let y = sky.sun.pixel_y;
    let span = x.x * y.y - x.y * y.x;
    return vec2f(x.y * y.z - x.z * y.y, x.z * y.x - x.x * y.z) / span;
}
