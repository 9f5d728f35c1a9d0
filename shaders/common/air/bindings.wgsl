// | group | binding | what                                   | when              |
// |-------|---------|----------------------------------------|-------------------|
// | 0     | 1       | the air's uniforms                     | air               |
// | 0     | 2       | table sampler                          | air               |
// | 0     | 7       | albedo of neighbourhoods               | air               |
// | 0     | 8       | scattered light; from inside, black    | air               |
// | 0     | 9       | light of the ground that is scattered  | air               |
// | 0     | 10      | transmittance                          | air               |
//
// From inside they are what the eye sees in each direction, drawn once a frame by air_view.wgsl.
import common/air/uniforms.wgsl;
import rust::ALBEDO_SIZE;

@group(0) @binding(1) var<uniform> air: AirUniforms;
@group(0) @binding(2) var table_sampler: sampler;
@group(0) @binding(7) var albedo_map: texture_2d<f32>;
@if(!inside) @group(0) @binding(8) var scattering_table: texture_3d<f32>;
@if(!inside) @group(0) @binding(9) var bounce_table: texture_2d<f32>;
@if(!inside) @group(0) @binding(10) var through_table: texture_2d<f32>;
@if(inside) @group(0) @binding(8) var black_view: texture_2d<f32>;
@if(inside) @group(0) @binding(9) var bounce_view: texture_2d<f32>;
@if(inside) @group(0) @binding(10) var through_view: texture_2d<f32>;
