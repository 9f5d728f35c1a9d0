// Effect of the air on light between an object and the eye: for the ground, the halo and tracks.
//
// `SurfaceAir` in src/gpu/shader/air.rs selects the eye outside or inside; both files of common/air/ define:
//   fn gathered(pass_: Pass, up: vec3f, uv: vec2f) -> vec4f: light scattered into a line of sight; alpha is the fraction of luminance absorbed from
//       the background,
//   fn left_through(pass_: Pass) -> vec3f: transmittance for background light, RGB.
import common/air/uniforms.wgsl;
import common/air/coordinates.wgsl;
@if(inside) import common/air/inside.wgsl;
@else import common/air/outside.wgsl;
import rust::ALBEDO_SIZE;

// | group | binding | what                                   | when              |
// |-------|---------|----------------------------------------|-------------------|
// | 0     | 1       | the air's uniforms                     | air               |
// | 0     | 2       | table sampler                          | air               |
// | 0     | 7       | albedo of neighbourhoods               | air               |
// | 0     | 8       | scattered light; from inside, black    | air               |
// | 0     | 9       | light of the ground that is scattered  | air               |
// | 0     | 10      | transmittance                          | air               |
//
// From inside they are the sky view, drawn once a frame by air_view.wgsl.
@group(0) @binding(1) var<uniform> air: AirUniforms;
@group(0) @binding(2) var table_sampler: sampler;
@group(0) @binding(7) var albedo_map: texture_2d<f32>;
@if(!inside) @group(0) @binding(8) var scattering_table: texture_3d<f32>;
@if(!inside) @group(0) @binding(9) var bounce_table: texture_2d<f32>;
@if(!inside) @group(0) @binding(10) var through_table: texture_2d<f32>;
@if(inside) @group(0) @binding(8) var black_view: texture_2d<f32>;
@if(inside) @group(0) @binding(9) var bounce_view: texture_2d<f32>;
@if(inside) @group(0) @binding(10) var through_view: texture_2d<f32>;

// Light that ground of albedo A sends up, time after time, for a unit that comes down first: A/(1 − A s), where the air sends the
// part s back.
fn sent_up(uv: vec2f) -> vec3f {
    return sent_up_by(neighbourhood(uv), air.sky_albedo);
}

fn sent_up_by(albedo: vec3f, sent_back: vec3f) -> vec3f {
    return albedo / (1.0 - albedo * sent_back);
}

// Scattered light is stored as its fourth root.
fn fourth_power(root: vec3f) -> vec3f {
    let square = root * root;
    return square * square;
}

// Mean albedo of the ground for some hundred kilometres around. Its map has one more column on either side, so that it wraps around.
fn neighbourhood(uv: vec2f) -> vec3f {
    let u = (fract(uv.x) * ALBEDO_SIZE.x + 1.0) / (ALBEDO_SIZE.x + 2.0);
    return textureSampleLevel(albedo_map, table_sampler, vec2f(u, uv.y), 0.0).rgb;
}
