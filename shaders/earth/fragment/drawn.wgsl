// What a pixel gets. Its depth is the mesh's, or where rays are cast that of the ground that the ray met, not of the prism that it was
// looked for in.

@if(!truth)
struct Drawn {
    @location(0) color: vec4f,
    @if(depth) @builtin(frag_depth) depth: f32,
}

@if(!truth)
fn drawn(color: vec4f, at: SurfacePoint) -> Drawn {
    @if(depth) return Drawn(color, depth_of(at));
    @else return Drawn(color);
}

// How deep a point of the ground lies, reversed.
@if(depth)
fn depth_of(at: SurfacePoint) -> f32 {
    let clip = frame.clip_from_eye * vec4f(-at.to_eye * at.along, 1.0);
    return saturate(clip.z / max(clip.w, 1e-6));
}
