// The spacecraft that the chase camera follows: linear light, one mesh, one draw.

// | group | binding | what  | when   |
// |-------|---------|-------|--------|
// | 0     | 0       | craft | always |
@group(0) @binding(0) var<uniform> craft: CraftFrame;

// Mirrored by `CraftFrame` in crates/terrella-play/src/craft.rs; a test compares the offsets. Craft axes: x along flight, z down.
struct CraftFrame {
    // Transform from craft metres to clip space.
    clip_from_craft: mat4x4f,
    // Unit vector to the Sun, craft axes, and the fraction of its disc that the Earth does not hide, 0…1.
    sun: vec3f,
    sunlight: f32,
    // The eye, craft metres, and the irradiance from the Earth on a sheet that faces it; the Sun's is 1.
    eye: vec3f,
    earthshine: f32,
    // (cos, sin) of the wings' rotation about y.
    wing: vec2f,
    // Exposure factor of light on 8-bit targets.
    exposure: f32,
    padding: f32,
}

// Prepended to this text: `displayed` of common/displayed.wgsl, and the numbers of materials from crates/terrella-play/src/craft.rs. Materials are
// numbered by `Material` of crates/terrella-play/src/craft/mesh.rs, which declares FOIL, PAINT, CELLS, WING, METAL and DISH.

// Ambient light, so that an eclipsed spacecraft is dark but not black; the Sun's is 1.
const DARK_LIGHT: f32 = 0.004;
// Colour of the Earth seen from above: slightly bluer than the Sun.
const EARTH_COLOR: vec3f = vec3f(0.85, 0.97, 1.2);

struct CraftVertex {
    @location(0) position_m: vec3f,
    @location(1) normal: vec3f,
    // Metres along and across a wing from its root's edge; 0 elsewhere.
    @location(2) along_m: vec2f,
    @location(3) material: u32,
}

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) position_m: vec3f,
    @location(1) normal: vec3f,
    @location(2) along_m: vec2f,
    @location(3) @interpolate(flat) material: u32,
}

fn turn(v: vec3f) -> vec3f {
    let c = craft.wing.x;
    let s = craft.wing.y;
    return vec3f(c * v.x + s * v.z, v.y, c * v.z - s * v.x);
}

@vertex
fn vertex(in: CraftVertex) -> Varying {
    var out: Varying;
    out.position_m = in.position_m;
    out.normal = in.normal;
    if in.material == CELLS || in.material == WING {
        out.position_m = turn(in.position_m);
        out.normal = turn(in.normal);
    }
    out.clip = craft.clip_from_craft * vec4f(out.position_m, 1.0);
    out.along_m = in.along_m;
    out.material = in.material;
    return out;
}

// Fraction of a pixel covered by lines of `width_m`, one every `period_m`; `pixel_m` is the pixel's size on the wing.
fn lines(at_m: vec2f, pixel_m: vec2f, period_m: f32, width_m: f32) -> f32 {
    let off_m = abs(fract(at_m / period_m + 0.5) - 0.5) * period_m;
    let pixel = max(pixel_m, vec2f(1e-4));
    let covered = saturate((0.5 * width_m - off_m) / pixel + 0.5) * min(vec2f(1.0), width_m / pixel);
    return max(covered.x, covered.y);
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    let pixel_m = fwidth(in.along_m);
    let to_eye = normalize(craft.eye - in.position_m);
    var n = normalize(in.normal);
    var albedo = vec3f(0.6);
    // Specular reflectance, and its sharpness.
    var gloss = vec3f(0.04);
    var sharpness = 30.0;
    switch in.material {
        case FOIL: {
            // Foil is crumpled: the normal varies with position.
            let p = in.position_m;
            n = normalize(n + 0.06 * sin(5.3 * p.yzx + 2.9 * sin(3.7 * p.zxy + 2.1 * sin(4.9 * p))));
            albedo = vec3f(0.55, 0.34, 0.10);
            gloss = vec3f(0.9, 0.6, 0.22);
            sharpness = 22.0;
        }
        case PAINT: {
            albedo = vec3f(0.62, 0.62, 0.6);
        }
        case CELLS: {
            let cell = lines(in.along_m, pixel_m, 0.4, 0.035);
            let string = lines(in.along_m, pixel_m, 1.2, 0.07);
            albedo = mix(vec3f(0.014, 0.03, 0.125), vec3f(0.36, 0.37, 0.4), max(0.55 * cell, string));
            gloss = vec3f(0.25, 0.28, 0.4);
            sharpness = 90.0;
        }
        case WING: {
            albedo = vec3f(0.3, 0.27, 0.22);
        }
        case METAL: {
            albedo = vec3f(0.17, 0.17, 0.18);
            gloss = vec3f(0.4);
        }
        case DISH: {
            // A sheet: the visible side is lit.
            n = select(n, -n, dot(n, to_eye) < 0.0);
            albedo = vec3f(0.58, 0.58, 0.57);
        }
        default: {}
    }
    let facing = max(dot(n, craft.sun), 0.0);
    // The Earth fills nearly half the sky below: a sheet edge-on to it still gets half.
    let below = 0.5 + 0.5 * n.z;
    var light = vec3f(craft.sunlight * facing + DARK_LIGHT);
    light += craft.earthshine * below * EARTH_COLOR;
    let halfway = normalize(craft.sun + to_eye);
    let mirror = select(0.0, pow(max(dot(n, halfway), 0.0), sharpness), facing > 0.0);
    let color = albedo * light + gloss * (craft.sunlight * mirror);
    return vec4f(displayed(color, craft.exposure, in.clip.xy), 1.0);
}
