// The normal map over a ground with relief: where a pixel is smaller than the map's texels the mesh's own slopes tell more.
import rust::NORMALS;

fn surface_normal(at: SurfacePoint) -> vec3f {
    let texel = sample_map(slope_map, slope_sampler, NORMALS, at).xy;
    @if(paper) let of_map = texel;
    @if(!paper) let of_map = surface_light.slope_gain * texel;
    let per_map = map_texels(NORMALS, at, vec2f(textureDimensions(slope_map)));
    let footprint = max(length(at.uv_dx * per_map), length(at.uv_dy * per_map));
    let slope = mix(at.slope, of_map, smoothstep(0.25, 1.0, footprint));
    return normalize(at.up - slope.x * at.east - slope.y * at.north);
}
