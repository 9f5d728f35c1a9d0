// The vertex stage of passes that cover their whole target.

struct Varying {
    @builtin(position) clip: vec4f,
    // Position in the source texture, 0…1 from its upper left corner.
    @location(0) uv: vec2f,
}

// One triangle over the whole target.
@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Varying {
    let uv = vec2f(f32(index & 1u), f32(index >> 1u)) * 2.0;
    return Varying(vec4f(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y, 0.5, 1.0), uv);
}
