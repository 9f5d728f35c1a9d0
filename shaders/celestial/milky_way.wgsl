// The light of unresolved stars.
import common/map_uv.wgsl;
import rust::{MILKY_WAY_FLOOR, MILKY_WAY_LIGHT};

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return corner_of(vec4f(-1.0, -1.0, 1.0, 1.0), index, sky.sun.depth);
}

@fragment
fn fragment(@builtin(position) clip: vec4f) -> @location(0) vec4f {
    let through = through_all(clip.xy);
    let moon = 1.0 - covered(sky.moon, meet(sky.moon, clip.xy));
    let ray = sky.frame.corner_ray + clip.x * sky.frame.pixel_right + clip.y * sky.frame.pixel_down;
    let star = normalize(sky.stars_x * ray.x + sky.stars_y * ray.y + sky.stars_z * ray.z);
    // Right ascension increases to the left, as seen from inside; 90° is at the left edge.
    let east = map_uv(star);
    let uv = vec2f(0.75 - east.x, east.y);
    let map = textureSampleLevel(body_map, body_sampler, uv, sky.milky_way_level).rgb;
    return added(sky.star_gain * moon * (MILKY_WAY_LIGHT * map + MILKY_WAY_FLOOR) * through, 0.0);
}
