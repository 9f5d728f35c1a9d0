// Normal of the ground: from the mesh's own slopes with terrain, and from the normal map, whose texels are slopes to the east and to the north.
@if(normals) import rust::NORMALS;

@if(normals)
fn surface_normal(at: SurfacePoint) -> vec3f {
    let texel = sample_map(slope_map, slope_sampler, NORMALS, at).xy;
    @if(paper) let of_map = texel;
    @else let of_map = surface_light.slope_gain * texel;
    @if(!relief) let slope = of_map;
    // Where a pixel is smaller than the map's texels, the mesh's own slopes are more accurate.
    @if(relief) let per_map = map_texels(NORMALS, at, vec2f(textureDimensions(slope_map)));
    @if(relief) let footprint = max(length(at.uv_dx * per_map), length(at.uv_dy * per_map));
    @if(relief) let slope = mix(at.slope, of_map, smoothstep(0.25, 1.0, footprint));
    return normalize(at.up - slope.x * at.east - slope.y * at.north);
}
@else
fn surface_normal(at: SurfacePoint) -> vec3f {
    @if(relief) return normalize(at.up - at.slope.x * at.east - at.slope.y * at.north);
    @else return at.up;
}
