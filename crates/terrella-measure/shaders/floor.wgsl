// The texture samples of a frame: the point of the ground and the footprint are those of the renderer's
// shaders/earth/surface_point/ray_on_ellipsoid.wgsl. `Samples::shader` in src/floor/samples.rs adds CORNERS, the textures and
//   fn sampled(uv: vec2f, dx: vec2f, dy: vec2f, mu: f32, mu_s: f32) -> vec4f

struct View {
    clip_from_eye: mat4x4f,
    eye_scaled: vec3f, above: f32,
    corner_ray: vec3f, polar_stretch: f32,
    pixel_right: vec3f, padding_0: f32,
    pixel_down: vec3f, padding_1: f32,
    limb_center: vec3f, padding_2: f32,
    limb_across: vec3f, padding_3: f32,
    limb_beside: vec3f, padding_4: f32,
    sun_itrf: vec3f, padding_5: f32,
}
@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var maps: sampler;
@group(0) @binding(2) var tables: sampler;
const PI: f32 = 3.14159265;
// Shadows of clouds: some kilometres.
const ASIDE: vec2f = vec2f(0.0003, 0.0003);

@vertex fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    // One triangle over the middle, then one on each side of those before: few of them are slivers.
    let rest = max(i / 3u, 1u) - 1u;
    let level = firstLeadingBit(rest / 3u + 1u);
    let side = (CORNERS / 3u) >> level;
    let outer = side * (rest + 3u - (3u << level)) + (i % 3u) * (side / 2u);
    let corner = select(outer, (i % 3u) * (CORNERS / 3u), i < 3u);
    let angle = f32(corner) * (2.0 * PI / f32(CORNERS));
    let at = view.limb_center + cos(angle) * view.limb_across + sin(angle) * view.limb_beside;
    return view.clip_from_eye * vec4f(at, 1.0);
}
@fragment fn fragment(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    let ray = view.corner_ray + pixel.x * view.pixel_right + pixel.y * view.pixel_down;
    let to_scaled = vec3f(1.0, 1.0, view.polar_stretch);
    let scaled = ray * to_scaled;
    let d = normalize(scaled);
    let across_ray = cross(view.eye_scaled, d);
    let root = sqrt(max(1.0 - dot(across_ray, across_ray), 0.0));
    let t = max(view.above / max(root - dot(view.eye_scaled, d), 1e-9), 0.0);
    let up = normalize((view.eye_scaled + t * d) * to_scaled);
    let across = max(length(up.xy), 1e-7);
    let uv = vec2f(0.5 + atan2(up.y, up.x) / (2.0 * PI), acos(clamp(up.z, -1.0, 1.0)) / PI);
    let east = vec3f(-up.y, up.x, 0.0) / across;
    let north = cross(up, east);
    let radii = t / length(scaled);
    let facing = min(dot(up, ray), -0.02 * length(ray));
    let right = radii * (view.pixel_right - ray * (dot(up, view.pixel_right) / facing));
    let down = radii * (view.pixel_down - ray * (dot(up, view.pixel_down) / facing));
    let to_uv = vec2f(0.5, -1.0) / PI;
    let dx = vec2f(dot(east, right), dot(north, right)) * to_uv;
    let dy = vec2f(dot(east, down), dot(north, down)) * to_uv;
    let mu = -dot(up, ray) / length(ray);
    let mu_s = dot(up, view.sun_itrf);
    return 0.2 * sampled(uv, dx, dy, mu, mu_s);
}
