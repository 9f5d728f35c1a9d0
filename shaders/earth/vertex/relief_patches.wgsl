// Patches of terrain, with vertices displaced on the CPU: `GroundVertex` relative to the origin of each, `PatchInstance` in src/gpu/ground.rs.

struct PatchVertex {
    // From the patch's origin, ITRF metres.
    @location(0) from_origin_m: vec3f,
    // Elevation above the ellipsoid, and slope of the ground to the east and to the north.
    @location(5) height_m: f32,
    @location(6) slope: vec2f,
}

struct PatchOrigin {
    // From the eye to the patch's origin in two parts, subtracted in f64.
    @location(7) origin_from_anchor_m: vec3f,
    @location(8) anchor_from_eye_m: vec3f,
}

@vertex
fn vertex(in: PatchVertex, reference: BlockInstance, origin: PatchOrigin) -> Varying {
    var out = varying_of(reference);
    // In this order: the first sum is the same in all patches that share the vertex.
    out.from_eye_m = (origin.origin_from_anchor_m + in.from_origin_m) + origin.anchor_from_eye_m;
    out.height_m = in.height_m;
    out.slope = in.slope;
    out.clip = frame.clip_from_eye * vec4f(out.from_eye_m, 1.0);
    return out;
}
