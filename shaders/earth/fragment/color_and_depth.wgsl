// What a pixel gets; its depth is that of the ground that the ray met, not of the prism that it was looked for in.
struct Drawn {
    @location(0) color: vec4f,
    @builtin(frag_depth) depth: f32,
}

fn drawn(color: vec4f, at: SurfacePoint) -> Drawn {
    let clip = frame.clip_from_eye * vec4f(-at.to_eye * at.along, 1.0);
    return Drawn(color, saturate(clip.z / max(clip.w, 1e-6)));
}
