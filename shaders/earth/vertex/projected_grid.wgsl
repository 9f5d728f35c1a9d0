// The projected grid: no vertex buffer. A vertex is made from its number, and the instance's says whose tiles are drawn.
import earth/vertex/projected_grid_point.wgsl;

@vertex
fn vertex(
    @builtin(vertex_index) index: u32,
    @if(tiles) @builtin(instance_index) block: u32,
) -> Varying {
    let point = grid_point(index);
    var out: Varying;
    out.from_eye_m = point.from_eye_m;
    out.height_m = point.height_m;
    out.slope = point.slope;
    out.clip = frame.clip_from_eye * vec4f(point.from_eye_m, 1.0);
    out.center_lon = grid.eye_lon;
    out.center_lat = grid.center_lat;
    out.center_uv = grid.center_uv;
    @if(tiles) out.block = block;
    return out;
}
