// The surface: one block a draw, texture coordinates and normals exact at every pixel.
//
// Features (see src/gpu/shader.rs): paper, clouds, normals, night_lights, air, encode, decode.

#import common/frame.wgsl
#import common/color.wgsl
#if air
#import common/air.wgsl
#endif

// | group | binding | what                        | when         |
// |-------|---------|-----------------------------|--------------|
// | 0     | 0       | frame                       | always       |
// | 0     | 1       | map sampler                 | always       |
// | 0     | 2       | day                         | always       |
// | 0     | 3       | cloud cover                 | clouds       |
// | 0     | 4       | slopes east, north          | normals      |
// | 0     | 5       | city lights                 | night_lights |
// | 0     | 6       | sunlight through the air    | air          |
// | 0     | 7       | table sampler               | air          |
@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var map_sampler: sampler;
@group(0) @binding(2) var day_map: texture_2d<f32>;
#if clouds
@group(0) @binding(3) var cloud_map: texture_2d<f32>;
#endif
#if normals
@group(0) @binding(4) var slope_map: texture_2d<f32>;
#endif
#if night_lights
@group(0) @binding(5) var light_map: texture_2d<f32>;
#endif
#if air
@group(0) @binding(6) var sunlight_table: texture_2d<f32>;
@group(0) @binding(7) var table_sampler: sampler;
#endif

const PI: f32 = 3.14159265;

struct BlockVertex {
    // Vertex less eye, ITRF metres: subtracted in f64.
    @location(0) from_eye_m: vec3f,
    // The block's centre: (cos, sin) of longitude and of latitude, and its texture coordinates.
    @location(1) center_lon: vec2f,
    @location(2) center_lat: vec2f,
    @location(3) center_uv: vec2f,
}

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat) center_lon: vec2f,
    @location(1) @interpolate(flat) center_lat: vec2f,
    @location(2) @interpolate(flat) center_uv: vec2f,
}

@vertex
fn vertex(in: BlockVertex) -> Varying {
    let clip = frame.clip_from_eye * vec4f(in.from_eye_m, 1.0);
    return Varying(clip, in.center_lon, in.center_lat, in.center_uv);
}

// atan(y/x) for |y/x| ≤ tan 15°, error below 1e-7: a block reaches 11.25° to each side of its centre.
fn atan_near(y: f32, x: f32) -> f32 {
    let t = y / x;
    let s = t * t;
    return t * (1.0 + s * (-0.33333333 + s * (0.2 + s * (-0.14285714 + s * 0.11111111))));
}

// Where a pixel lies on the ground.
struct Place {
    // Outward normal of the ellipsoid, unit vectors east and north.
    up: vec3f,
    east: vec3f,
    north: vec3f,
    uv: vec2f,
    // Change of uv to the next pixel right and down, u counted in ground distance as v is (× cos latitude), so that
    // the mip level follows the pixel's footprint at the poles and has no seam at ±180°.
    uv_dx: vec2f,
    uv_dy: vec2f,
}

// The mesh says which pixels show the ground; what they show is found by the pixel's own ray on the exact ellipsoid.
// So nothing is interpolated: facets seen edge on, where interpolation is ill-conditioned, cannot shake, and a coarse
// mesh shifts nothing.
fn place(in: Varying) -> Place {
    var out: Place;
    let ray = frame.corner_ray + in.clip.x * frame.pixel_right + in.clip.y * frame.pixel_down;
    let to_scaled = vec3f(1.0, 1.0, frame.polar_stretch);
    let scaled = ray * to_scaled;
    let d = normalize(scaled);
    // |e + t d| = 1 with c = |e|² − 1: t = c / (−e·d + √(1 − |e × d|²)). Lagrange's identity instead of b² − c.
    let across_ray = cross(frame.eye_scaled, d);
    let root = sqrt(max(1.0 - dot(across_ray, across_ray), 0.0));
    let t = max(frame.above / max(root - dot(frame.eye_scaled, d), 1e-9), 0.0);
    let p = frame.eye_scaled + t * d;
    out.up = normalize(p * to_scaled);

    let across = max(length(out.up.xy), 1e-7);
    out.east = vec3f(-out.up.y, out.up.x, 0.0) / across;
    out.north = cross(out.up, out.east);
    let x = max(dot(in.center_lon, out.up.xy), 1e-7);
    let y = in.center_lon.x * out.up.y - in.center_lon.y * out.up.x;
    let longitude = atan_near(clamp(y, -0.25 * x, 0.25 * x), x);
    let latitude = atan_near(
        in.center_lat.x * out.up.z - in.center_lat.y * across,
        in.center_lat.x * across + in.center_lat.y * out.up.z,
    );
    out.uv = in.center_uv + vec2f(longitude / (2.0 * PI), -latitude / PI);

    // The neighbour pixel's ray on the tangent plane: r − ray·(up·r)/(up·ray), times the distance in radii.
    let facing = min(dot(out.up, ray), -0.02 * length(ray));
    let radii = t / length(scaled);
    let dx = radii * (frame.pixel_right - ray * (dot(out.up, frame.pixel_right) / facing));
    let dy = radii * (frame.pixel_down - ray * (dot(out.up, frame.pixel_down) / facing));
    let to_uv = vec2f(0.5, -1.0) / PI;
    out.uv_dx = vec2f(dot(out.east, dx), dot(out.north, dx)) * to_uv;
    out.uv_dy = vec2f(dot(out.east, dy), dot(out.north, dy)) * to_uv;
    return out;
}

fn sample_map(map: texture_2d<f32>, at: Place) -> vec4f {
    return textureSampleGrad(map, map_sampler, at.uv, at.uv_dx, at.uv_dy);
}

fn surface_normal(at: Place) -> vec3f {
#if normals
    let slope = sample_map(slope_map, at).xy;
    return normalize(at.up - slope.x * at.east - slope.y * at.north);
#else
    return at.up;
#endif
}

#if paper
// The three layers as printed (section 1.2): n = normal texel, L = direction to the light,
//   ninfo = saturate(n·L + 0.3)·1.1
//   blend = 1 − (1 − earth)(1 − cloud)
//   out   = blend·ninfo
// in display values. n and L are both taken in Earth-fixed axes, so that the normal texel carries day and night.
fn shade(at: Place) -> vec3f {
    let earth = sample_map(day_map, at).rgb;
#if clouds
    let cloud = vec3f(sample_map(cloud_map, at).r);
#else
    let cloud = vec3f(0.0);
#endif
    let ninfo = saturate(dot(surface_normal(at), frame.sun_itrf) + 0.3) * 1.1;
    let blend = 1.0 - (1.0 - earth) * (1.0 - cloud);
    return blend * ninfo;
}
#else
#if clouds
const CLOUD_ALBEDO: f32 = 0.85;
#endif
#if night_lights
const LAMP_COLOR: vec3f = vec3f(1.0, 0.72, 0.38);
#endif
#if air
// Mean colour of a clear sky, luminance 1.
const SKYLIGHT_COLOR: vec3f = vec3f(0.62, 1.0, 1.9);
#endif

// Light that falls on the ground: the Sun's after the air, and the sky's.
struct Light {
    sun: vec3f,
    sky: vec3f,
}

fn light_at(mu_s: f32) -> Light {
    var out: Light;
#if air
    let at = vec2f(table_coordinate(sun_coordinate(mu_s), f32(textureDimensions(sunlight_table).x)), 0.5);
    let sunlight = textureSampleLevel(sunlight_table, table_sampler, at, 0.0);
    out.sun = sunlight.rgb;
    out.sky = sunlight.a * SKYLIGHT_COLOR;
#else
    // The Sun's disc, 0.27° in radius, sets gradually.
    out.sun = vec3f(smoothstep(-0.00465, 0.00465, mu_s));
    out.sky = vec3f(0.0);
#endif
    return out;
}

// Linear light: a white sheet that faces the Sun in space is `exposure`.
fn shade(at: Place) -> vec3f {
    let mu_s = dot(at.up, frame.sun_itrf);
    let light = light_at(mu_s);
    let facing = max(dot(surface_normal(at), frame.sun_itrf), 0.0);
    var color = sample_map(day_map, at).rgb * (light.sun * facing + light.sky);
#if night_lights
    let glow = sample_map(light_map, at).r * (1.0 - smoothstep(-0.12, 0.02, mu_s));
    color += 0.6 * glow * glow * LAMP_COLOR;
#endif
#if clouds
    let cover = sample_map(cloud_map, at).r;
    let cloud = CLOUD_ALBEDO * (light.sun * max(mu_s, 0.0) + light.sky);
    color = mix(color, cloud, cover);
#endif
    return color * frame.exposure;
}
#endif

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    var color = shade(place(in));
#if encode
    color = encode_srgb(color);
#endif
#if decode
    color = decode_srgb(color);
#endif
    return vec4f(color, 1.0);
}
