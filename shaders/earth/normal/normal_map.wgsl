// The normal map of the ellipsoid's ground: slopes to the east and to the north.
import rust::NORMALS;

fn surface_normal(at: SurfacePoint) -> vec3f {
    let slope = sample_map(slope_map, slope_sampler, NORMALS, at).xy;
    return normalize(at.up - slope.x * at.east - slope.y * at.north);
}
