// Values from the vertex stage for each pixel.
struct Varying {
    @builtin(position) clip: vec4f,
    // Reference of the texture coordinates: (cos, sin) of its longitude and of its latitude, and its own coordinates.
    @location(0) @interpolate(flat) center_lon: vec2f,
    @location(1) @interpolate(flat) center_lat: vec2f,
    @location(2) @interpolate(flat) center_uv: vec2f,
    // Imagery: a block's index, PER_BLOCK_TILES plus that, or WHOLE_MAP.
    @if(tiles) @location(3) @interpolate(flat) block: u32,
    // Interpolated position on the mesh. If it selects the block, it is a position inside the triangle, so that the block is one that the triangle
    // touches.
    @if(relief && !cast && !per_block_tiles) @location(4) from_eye_m: vec3f,
    @if(per_block_tiles) @location(4) @interpolate(perspective, centroid) from_eye_m: vec3f,
    // Elevation above the ellipsoid, and slope of the ground to the east and to the north.
    @if(relief && !cast) @location(5) height_m: f32,
    @if(relief && !cast) @location(6) slope: vec2f,
    // Page of contours behind the prism: see PagePrism.
    @if(cast) @location(4) @interpolate(flat) eye_from_origin_m: vec3f,
    @if(cast) @location(5) @interpolate(flat) root: u32,
    @if(cast) @location(6) @interpolate(flat) ray: vec3f,
    // Effect of the air there: see AirAtPoint.
    @if(interpolated) @location(4) through: vec3f,
    @if(interpolated) @location(5) black: vec3f,
    @if(interpolated) @location(6) bounce: vec3f,
    @if(interpolated) @location(7) sun: vec3f,
    @if(interpolated) @location(8) sky: vec3f,
    // Effect of the air on the clouds in front of it: see AirOfClouds in surface_point.wgsl.
    @if(interpolated && clouds) @location(9) sun_on_clouds: vec3f,
    @if(interpolated && clouds) @location(10) sky_on_clouds: vec3f,
    @if(interpolated && clouds) @location(11) through_to_clouds: vec3f,
    @if(interpolated && clouds) @location(12) black_above_clouds: vec3f,
    @if(interpolated && clouds) @location(13) bounce_above_clouds: vec3f,
}

// Values common to a whole block, patch or page. Mirrored by `BlockInstance` in src/gpu/lattice.rs.
@if(!grid)
struct BlockInstance {
    // Centre of the block, or of a patch that spans several blocks: (cos, sin) of longitude and of latitude, and its texture coordinates.
    @location(1) center_lon: vec2f,
    @location(2) center_lat: vec2f,
    @location(3) center_uv: vec2f,
    @if(tiles) @location(4) block: u32,
}

@if(!grid)
fn varying_of(instance: BlockInstance) -> Varying {
    var out: Varying;
    out.center_lon = instance.center_lon;
    out.center_lat = instance.center_lat;
    out.center_uv = instance.center_uv;
    @if(tiles) out.block = instance.block;
    return out;
}
