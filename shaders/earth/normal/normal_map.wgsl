// The normal map of the ellipsoid's ground: slopes to the east and to the north.
import rust::NORMALS;

fn surface_normal(at: SurfacePoint) -> vec3f {
    let texel = sample_map(slope_map, slope_sampler, NORMALS, at).xy;
    @if(paper) let slope = texel;
    @if(!paper) let slope = surface_light.slope_gain * texel;
    return normalize(at.up - slope.x * at.east - slope.y * at.north);
}
