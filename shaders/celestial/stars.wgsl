// Stars: points, spread over 4 × 4 pixels by the cubic B-spline. Its values at whole steps add up to 1 at any subpixel position, so a star has the
// same brightness everywhere and at any size of the image.

struct StarInstance {
    // Position on screen, −1…1.
    @location(0) at: vec2f,
    // Mean light of a pixel that contains all of it, RGB.
    @location(1) light: vec3f,
}

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat) center_px: vec2f,
    @location(1) @interpolate(flat) light: vec3f,
}

// Half the side of the quad, pixels: the support of the spline, with a margin for all samples of its outermost pixels.
const STAR_REACH_PX: f32 = 2.75;

@vertex
fn vertex(@builtin(vertex_index) index: u32, in: StarInstance) -> Varying {
    let corner = vec2f(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0;
    let at = in.at + corner * 2.0 * STAR_REACH_PX / sky.size_px;
    let center = sky.origin_px + sky.size_px * (0.5 + vec2f(0.5, -0.5) * in.at);
    return Varying(vec4f(at, sky.sun.depth, 1.0), center, in.light);
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    let off = abs(in.clip.xy - in.center_px);
    let part = spline(off.x) * spline(off.y);
    if part <= 0.0 {
        discard;
    }
    return added(part * in.light * through_all(in.center_px), 0.0);
}

fn spline(x: f32) -> f32 {
    let far = max(2.0 - x, 0.0);
    let near = max(1.0 - x, 0.0);
    return (far * far * far - 4.0 * near * near * near) / 6.0;
}
