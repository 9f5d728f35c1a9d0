// In place of colour, for measuring: the texture coordinates that maps would be read with, from the block's centre, and
// that centre. Kept apart, they are rounded as little as the samplers' are. The target is cleared to 0; no centre is 0.
// With relief: how many of its rays long the pixel's way to the ground is, in the last number, and 1 in the others.

@fragment
fn fragment(in: Varying) -> Drawn {
    let at = surface_point(in);
    @if(per_block_tiles) if drawn_block(at) != in.block { discard; }
    @if(relief) return drawn(vec4f(1.0, 1.0, 1.0, at.along), at);
    @else return drawn(vec4f(at.uv, at.center_uv), at);
}
