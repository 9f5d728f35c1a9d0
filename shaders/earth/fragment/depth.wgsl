// How deep a point of the ground lies, reversed.
fn depth_of(at: SurfacePoint) -> f32 {
    let clip = frame.clip_from_eye * vec4f(-at.to_eye * at.along, 1.0);
    return saturate(clip.z / max(clip.w, 1e-6));
}
