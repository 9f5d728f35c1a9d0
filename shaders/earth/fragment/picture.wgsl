// The picture: what the surface looks like there, as the target stores it.
@if(sunlit) import common/displayed.wgsl;
@if(decode) import common/color.wgsl;

@fragment
fn fragment(in: Varying) -> Drawn {
    var at = surface_point(in);
    @if(interpolated) at.air = air_between_vertices(in);
    @if(per_block_tiles) if drawn_block(at) != in.block { discard; }
    @if(per_block_tiles) at = in_block(at);
    var color = shade(at);
    @if(sunlit) color = displayed(color, frame.exposure, in.clip.xy);
    @if(decode) color = decode_srgb(color);
    @if(paper && air) color = paper_through_air(color, at, in.clip.xy);
    return drawn(vec4f(color, 1.0), at);
}
