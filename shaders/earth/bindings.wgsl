// All resources of the surface's shader.
//
// | group | binding | what                        | when             |
// |-------|---------|-----------------------------|------------------|
// | 0     | 0       | frame                       | always           |
// | 0     | 1, 2    | the air, table sampler      | air              |
// | 0     | 3       | where tiles lie             | tiles            |
// | 0     | 4, 5    | the grid, its heights       | grid             |
// | 0     | 6       | nodes of contours           | cast             |
// | 0     | 7 … 10  | common/air.wgsl             | air              |
// | 0     | 11      | sunlight through the air    | sunlit, air      |
// | 0     | 12      | chosen light on the surface | surface_light    |
// | 1     | 0, 5    | day, its sampler            | picture          |
// | 1     | 1, 6    | cloud cover                 | clouds           |
// | 1     | 2, 7    | slopes east, north          | normals          |
// | 1     | 3, 8    | city lights                 | night_lights     |
// | 1     | 4, 9    | open water                  | water            |
//
// Group 1 is shared by the whole Earth; with tiles each block has its own: each map is then a tile of the block or the whole map. With parts they
// are arrays: of one such map, or of the tiles of the block's size, which include those of its parts.

@group(0) @binding(0) var<uniform> frame: FrameUniforms;

@if(sunlit && air) @group(0) @binding(11) var sunlight_table: texture_2d<f32>;

@if(tiles) import rust::{BLOCK_COUNT, MAP_LAYERS};
@if(parts && tiles) import rust::PART_CELL_WORDS;

// Placement of each block's texels. Mirrored by the buffer of src/gpu/tiles.rs.
@if(tiles)
struct Tiles {
    // For each block and each of its maps, in the order of the bindings of group 1: texture coordinates of the block's centre, and their scale. One
    // array: WebGL 2 has no arrays of arrays.
    placements: array<vec4f, MAP_LAYERS * BLOCK_COUNT>,
    // One bit for each block, set if it has tiles.
    @if(per_block_tiles) tiled: vec4u,
    @if(parts && !per_block_tiles) unused: vec4u,
    // Cells of blocks with parts, 16 bits each: layer of the array, and above that how often the block is halved.
    @if(parts) cells: array<vec4u, PART_CELL_WORDS>,
}
@if(tiles) @group(0) @binding(3) var<uniform> tiles: Tiles;

@if(grid) @group(0) @binding(4) var<uniform> grid: GridUniforms;
// Slots of GRID_TILE_TEXELS² elevations, from the south-west, ATLAS_COLUMNS of them to a row.
@if(grid) @group(0) @binding(5) var height_tiles: texture_2d<f32>;

// Options of the light on the surface. Mirrored by `SurfaceLightUniforms` in src/gpu/uniforms.rs.
@if(surface_light)
struct SurfaceLightUniforms {
    // Mean square slope of the sea's waves.
    wave_slope_squared: f32,
    // Reflectance of the sea's foam.
    foam: f32,
    // Exponent of 1 − cos θ in the reflectance of waves for sky light, and the factor of that power.
    mirror_power: f32,
    mirror_scale: f32,
    // Factor of the normal map's slopes.
    slope_gain: f32,
    // Height of the clouds, and of the tops of thick ones above thin ones; equatorial radii.
    cloud_height: f32,
    cloud_relief: f32,
    // Sine of the Sun's depression at which it sets for the clouds.
    cloud_dip: f32,
}
@if(surface_light) @group(0) @binding(12) var<uniform> surface_light: SurfaceLightUniforms;

// The trees of all pages, one after another.
@if(cast) @group(0) @binding(6) var<storage, read> contour_nodes: array<ContourNode>;

@if(picture && !parts) @group(1) @binding(0) var day_map: texture_2d<f32>;
@if(picture && parts) @group(1) @binding(0) var day_map: texture_2d_array<f32>;
@if(picture) @group(1) @binding(5) var day_sampler: sampler;
@if(clouds && !parts) @group(1) @binding(1) var cloud_map: texture_2d<f32>;
@if(clouds && parts) @group(1) @binding(1) var cloud_map: texture_2d_array<f32>;
@if(clouds) @group(1) @binding(6) var cloud_sampler: sampler;
@if(normals && !parts) @group(1) @binding(2) var slope_map: texture_2d<f32>;
@if(normals && parts) @group(1) @binding(2) var slope_map: texture_2d_array<f32>;
@if(normals) @group(1) @binding(7) var slope_sampler: sampler;
@if(night_lights && !parts) @group(1) @binding(3) var light_map: texture_2d<f32>;
@if(night_lights && parts) @group(1) @binding(3) var light_map: texture_2d_array<f32>;
@if(night_lights) @group(1) @binding(8) var light_sampler: sampler;
@if(water && !parts) @group(1) @binding(4) var water_map: texture_2d<f32>;
@if(water && parts) @group(1) @binding(4) var water_map: texture_2d_array<f32>;
@if(water) @group(1) @binding(9) var water_sampler: sampler;
