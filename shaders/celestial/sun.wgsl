// The Sun's disc with limb darkening, partly hidden by the Moon.

// 1 − u − v, u and v of I(μ) = 1 − u − v + uμ + vμ² at 610, 550 and 455 nm (Cox 2000, Allen's Astrophysical Quantities, table
// 14.17, between its wavelengths), and the disc's mean by that.
const SUN_LIMB: vec3f = vec3f(0.36, 0.30, 0.18);
const SUN_LINEAR: vec3f = vec3f(0.87, 0.93, 0.96);
const SUN_SQUARE: vec3f = vec3f(-0.23, -0.23, -0.14);
const SUN_MEAN: vec3f = SUN_LIMB + SUN_LINEAR * 2.0 / 3.0 + SUN_SQUARE / 2.0;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return corner_of(sky.sun.bounds, index, sky.sun.depth);
}

@fragment
fn fragment(@builtin(position) clip: vec4f) -> @location(0) vec4f {
    let met = meet(sky.sun, clip.xy);
    let mu = sqrt(max((1.0 - met.off) * (1.0 + met.off), 0.0));
    let shape = (SUN_LIMB + mu * (SUN_LINEAR + mu * SUN_SQUARE)) / SUN_MEAN;
    // A white sheet that faces it is 1: π over the solid angle of its disc.
    let light = sky.sun.distance * sky.sun.distance * shape * covered(sky.sun, met);
    let moon = 1.0 - covered(sky.moon, meet(sky.moon, clip.xy));
    return added(sky.sun_kept * light * moon * through_all(clip.xy), 0.0);
}
