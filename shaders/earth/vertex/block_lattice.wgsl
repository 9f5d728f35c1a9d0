// The block sphere: a lattice of vertices on the ellipsoid.

struct BlockVertex {
    // From the eye, ITRF metres: subtracted in f64.
    @location(0) from_eye_m: vec3f,
}

@vertex
fn vertex(in: BlockVertex, reference: BlockInstance) -> Varying {
    var out = varying_of(reference);
    out.clip = frame.clip_from_eye * vec4f(in.from_eye_m, 1.0);
    return out;
}
