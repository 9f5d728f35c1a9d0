// The normal of a ground with relief, by the mesh's own slopes.
fn surface_normal(at: SurfacePoint) -> vec3f {
    return normalize(at.up - at.slope.x * at.east - at.slope.y * at.north);
}
