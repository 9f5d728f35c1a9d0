// What a pixel gets; its depth is the mesh's.
struct Drawn {
    @location(0) color: vec4f,
}

fn drawn(color: vec4f, at: SurfacePoint) -> Drawn {
    return Drawn(color);
}
