fn surface_normal(at: SurfacePoint) -> vec3f {
    return at.up;
}
