// The paper's square that faces the eye, with a computed halo.
//
// Features (see src/gpu/shader.rs): inside (the eye is in the air: march along the ray instead of reading the table
// of rays from outside), depth (write the depth at which the air stands), standard_z, encode.

#import common/color.wgsl
#import common/air.wgsl

// | group | binding | what                    | when    |
// |-------|---------|-------------------------|---------|
// | 0     | 0       | this frame's square     | always  |
// | 0     | 1       | table sampler           | always  |
// | 0     | 2       | scattering              | outside |
// | 0     | 3       | transmittance           | inside  |
// | 0     | 4       | multiple scattering     | inside  |

// Mirrored by `AirFrame` in src/gpu/uniforms.rs. The billboard frame starts at the eye, its z axis points to the
// Earth's centre, and lengths are equatorial radii of scaled space.
struct AirFrame {
    clip_from_billboard: mat4x4f,
    // Unit vector to the Sun, billboard frame.
    sun: vec3f,
    // Distance of the eye from the centre, ≥ 1.
    eye_distance: f32,
    // Upper boundary of the air.
    top: f32,
    // Height of the eye above the surface, without cancellation.
    eye_height: f32,
    exposure: f32,
    // How far the air is drawn before its place, in depth: what the backend rounds depths by.
    depth_rounding: f32,
}

@group(0) @binding(0) var<uniform> air: AirFrame;
@group(0) @binding(1) var table_sampler: sampler;
#if inside
@group(0) @binding(3) var transmittance_table: texture_2d<f32>;
@group(0) @binding(4) var multiple_table: texture_2d<f32>;
#else
@group(0) @binding(2) var scattering_table: texture_3d<f32>;
#endif

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) ray: vec3f,
}

struct Output {
    @location(0) color: vec4f,
#if depth
    @builtin(frag_depth) depth: f32,
#endif
}

@vertex
fn vertex(@location(0) clip: vec4f, @location(1) ray: vec3f) -> Varying {
    return Varying(clip, ray);
}

const PI: f32 = 3.14159265;

// How a ray passes the Earth. All without cancellation at any distance: q = L sin θ comes from the ray's own slope.
struct Pass {
    direction: vec3f,
    // Distance of the ray's line from the centre and its nearest point (from the centre).
    q: f32,
    nearest: vec3f,
    // Distance along the ray to that point; negative if it lies behind.
    along: f32,
}

fn pass_of(ray: vec3f) -> Pass {
    var out: Pass;
    let d = ray / length(ray);
    let sin2 = dot(d.xy, d.xy);
    out.direction = d;
    out.q = air.eye_distance * sqrt(sin2);
    out.nearest = air.eye_distance * vec3f(d.z * d.xy, -sin2);
    out.along = air.eye_distance * d.z;
    return out;
}

#if inside
// A ray that starts in the air, in steps. `start` and lengths as in the billboard frame, from the centre.
fn scattered(pass_: Pass) -> vec4f {
    let start = vec3f(0.0, 0.0, -air.eye_distance);
    let d = pass_.direction;
    let half_top = sqrt(max((air.top - pass_.q) * (air.top + pass_.q), 0.0));
    var length_ = max(pass_.along + half_top, 0.0);
    if pass_.along > 0.0 && pass_.q < 1.0 {
        // Distance to the ground, h(L + 1)/(along + √(1 − q²)): no difference of large numbers.
        length_ = air.eye_height * (air.eye_distance + 1.0)
            / (pass_.along + sqrt((1.0 - pass_.q) * (1.0 + pass_.q)));
    }
    const STEPS: i32 = 24;
    let nu = dot(d, air.sun);
    let g = 0.8;
    let phase_molecules = 3.0 / (16.0 * PI) * (1.0 + nu * nu);
    let phase_aerosol = 3.0 / (8.0 * PI) * (1.0 - g * g) / (2.0 + g * g) * (1.0 + nu * nu)
        / pow(max(1.0 + g * g - 2.0 * g * nu, 1e-5), 1.5);
    var light = vec3f(0.0);
    var through = vec3f(1.0);
    var begin = 0.0;
    for (var i = 0; i < STEPS; i++) {
        let s = f32(i + 1) / f32(STEPS);
        let to = length_ * s * s;
        let step = to - begin;
        let t = 0.5 * (begin + to);
        begin = to;
        let p = start + d * t;
        let r = length(p);
        // h from L² − 1 + 2t·(e·d) + t², each term small near the ground.
        let height = max((air.eye_height * (air.eye_distance + 1.0) - 2.0 * t * pass_.along + t * t) / (r + 1.0), 0.0);
        let mu_s = dot(p, air.sun) / r;
        let h = height * RADIUS_M;
        let molecules = MOLECULES * (RADIUS_M * exp(-h / 8000.0));
        let aerosol = AEROSOL * (RADIUS_M * exp(-h / 1200.0));
        let ozone = OZONE * (RADIUS_M * max(1.0 - abs(h - 25000.0) / 15000.0, 0.0));
        let extinction = molecules + vec3f(aerosol * AEROSOL_EXTINCTION) + ozone;
        let source = to_sun(height, r, mu_s) * (molecules * phase_molecules + aerosol * phase_aerosol)
            + multiple(height, mu_s) * (molecules + aerosol);
        let fade = exp(-extinction * step);
        light += through * source * (1.0 - fade) / max(extinction, vec3f(1e-9));
        through *= fade;
    }
    return vec4f(light * PI, 1.0 - dot(through, vec3f(0.2126, 0.7152, 0.0722)));
}

// Coefficients of src/air/model.rs, 1/m; a test compares this shader's picture with the table's at the boundary.
const RADIUS_M: f32 = 6378137.0;
const MOLECULES: vec3f = vec3f(8.90e-6, 13.66e-6, 26.77e-6);
const AEROSOL: f32 = 3.996e-6;
const AEROSOL_EXTINCTION: f32 = 4.44 / 3.996;
const OZONE: vec3f = vec3f(2.28e-6, 1.86e-6, 0.225e-6);

fn height_coordinate(height: f32) -> f32 {
    return sqrt(clamp(height / (air.top - 1.0), 0.0, 1.0));
}

fn to_sun(height: f32, r: f32, mu_s: f32) -> vec3f {
    let horizon = -sqrt(height * (r + 1.0)) / r;
    let x = sqrt(max((mu_s - horizon) / (1.0 - horizon), 0.0));
    let size = vec2f(textureDimensions(transmittance_table));
    let at = vec2f(table_coordinate(x, size.x), table_coordinate(height_coordinate(height), size.y));
    return select(vec3f(0.0), textureSampleLevel(transmittance_table, table_sampler, at, 0.0).rgb, mu_s >= horizon);
}

fn multiple(height: f32, mu_s: f32) -> vec3f {
    let size = vec2f(textureDimensions(multiple_table));
    let at = vec2f(table_coordinate(0.5 + 0.5 * mu_s, size.x), table_coordinate(height_coordinate(height), size.y));
    return textureSampleLevel(multiple_table, table_sampler, at, 0.0).rgb;
}
#else
// A ray from outside: one look into the table.
fn scattered(pass_: Pass) -> vec4f {
    if pass_.along <= 0.0 || pass_.q >= air.top {
        return vec4f(0.0);
    }
    let size = vec3f(textureDimensions(scattering_table));
    let half_ = 0.5 * size.x;
    let d = pass_.direction;
    var p: vec3f;
    var x: f32;
    var mu: f32;
    if pass_.q < 1.0 {
        mu = sqrt((1.0 - pass_.q) * (1.0 + pass_.q));
        p = pass_.nearest - d * mu;
        x = 0.5 * table_coordinate(sqrt(mu), half_);
    } else {
        mu = 0.0;
        p = pass_.nearest / pass_.q;
        x = 0.5 + 0.5 * table_coordinate(sqrt((pass_.q - 1.0) / (air.top - 1.0)), half_);
    }
    let mu_s = clamp(dot(p, air.sun), -1.0, 1.0);
    // Azimuth of the Sun about the reference point, from the ray's horizontal direction.
    let flat = sqrt(max((1.0 - mu * mu) * (1.0 - mu_s * mu_s), 1e-12));
    let cosine = clamp((dot(d, air.sun) + mu * mu_s) / flat, -1.0, 1.0);
    let at = vec3f(
        x,
        table_coordinate(sun_coordinate(mu_s), size.y),
        table_coordinate(acos(cosine) / PI, size.z),
    );
    return textureSampleLevel(scattering_table, table_sampler, at, 0.0);
}
#endif

@fragment
fn fragment(in: Varying) -> Output {
    let pass_ = pass_of(in.ray);
    let air_light = scattered(pass_) * vec4f(vec3f(air.exposure), 1.0);
    var out: Output;
#if encode
    out.color = vec4f(encode_srgb(air_light.rgb), air_light.a);
#else
    out.color = air_light;
#endif
#if depth
    // The air stands where the ray enters it: what is nearer hides it, what is farther is seen through it.
    let at = max(pass_.along - sqrt(max((air.top - pass_.q) * (air.top + pass_.q), 0.0)), 0.0);
    let clip = air.clip_from_billboard * vec4f(pass_.direction * at, 1.0);
    let depth = clip.z / max(clip.w, 1e-30);
#if standard_z
    out.depth = select(depth - air.depth_rounding, 0.0, at == 0.0);
#else
    out.depth = select(depth + air.depth_rounding, 1.0, at == 0.0);
#endif
    out.depth = clamp(out.depth, 0.0, 1.0);
#endif
    return out;
}
