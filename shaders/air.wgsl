// The paper's square that faces the eye, with a computed halo.
//
// `AirVariant` in src/gpu/shader/air.rs says which conditions hold together: inside (the eye is in the air), depth (write the
// depth at which the air stands), standard_z, encode.
import rust::PI;
import common/air_tables.wgsl;
@if(encode) import common/color.wgsl;

// The light that a ray gathers and what it dims: fn scattered(pass_: Pass) -> vec4f.
@if(!inside) import air/outside.wgsl;
@if(inside) import air/inside.wgsl;

// The depth at which the air stands: what is nearer hides it, what is farther is seen through it.
@if(depth) import air/depth.wgsl;

// | group | binding | what                    | when    |
// |-------|---------|-------------------------|---------|
// | 0     | 0       | this frame's square     | always  |
// | 0     | 1       | table sampler           | always  |
// | 0     | 2       | scattering              | outside |
// | 0     | 3       | transmittance           | inside  |
// | 0     | 4       | multiple scattering     | inside  |

// Mirrored by `AirUniforms` in src/gpu/uniforms.rs. The billboard frame starts at the eye, its z axis points to the
// Earth's centre, and lengths are equatorial radii of scaled space.
struct AirUniforms {
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

@group(0) @binding(0) var<uniform> air: AirUniforms;
@group(0) @binding(1) var table_sampler: sampler;
@if(!inside) @group(0) @binding(2) var scattering_table: texture_3d<f32>;
@if(inside) @group(0) @binding(3) var transmittance_table: texture_2d<f32>;
@if(inside) @group(0) @binding(4) var multiple_table: texture_2d<f32>;

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) ray: vec3f,
}

struct Output {
    @location(0) color: vec4f,
    @if(depth) @builtin(frag_depth) depth: f32,
}

@vertex
fn vertex(@location(0) clip: vec4f, @location(1) ray: vec3f) -> Varying {
    return Varying(clip, ray);
}

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

@fragment
fn fragment(in: Varying) -> Output {
    let pass_ = pass_of(in.ray);
    let air_light = scattered(pass_) * vec4f(vec3f(air.exposure), 1.0);
    var out: Output;
    @if(!encode) out.color = air_light;
    @if(encode) out.color = vec4f(encode_srgb(air_light.rgb), air_light.a);
    @if(depth) out.depth = depth_of(pass_);
    return out;
}
