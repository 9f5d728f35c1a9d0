// What a pixel gets; its depth is that of the ground that the ray met, not of the prism that it was looked for in.
import earth/fragment/depth.wgsl;

struct Drawn {
    @location(0) color: vec4f,
    @builtin(frag_depth) depth: f32,
}

fn drawn(color: vec4f, at: SurfacePoint) -> Drawn {
    return Drawn(color, depth_of(at));
}
