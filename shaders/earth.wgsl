// The surface: one block a draw, texture coordinates and normals exact at every pixel.
//
// Features (see src/gpu/shader.rs): paper, clouds, normals, night_lights, water, tiles, air, encode, decode, places, relief, and
// with relief grid, or cast, that with depth, and with tiles and relief crossing.

#import common/frame.wgsl
#import common/color.wgsl
#if air
#import common/air.wgsl
#endif
#if grid
#import common/projected_grid.wgsl
#endif
#if cast
#import common/contours.wgsl
#endif

// | group | binding | what                        | when         |
// |-------|---------|-----------------------------|--------------|
// | 0     | 0       | frame                       | always       |
// | 0     | 1       | sunlight through the air    | air          |
// | 0     | 2       | table sampler               | air          |
// | 0     | 3       | where tiles lie             | tiles        |
// | 0     | 4, 5    | the grid, its heights       | grid         |
// | 0     | 6       | nodes of contours           | cast         |
// | 1     | 0, 5    | day, its sampler            | always       |
// | 1     | 1, 6    | cloud cover                 | clouds       |
// | 1     | 2, 7    | slopes east, north          | normals      |
// | 1     | 3, 8    | city lights                 | night_lights |
// | 1     | 4, 9    | open water                  | water        |
//
// Group 1 is the whole Earth's, or with tiles each block's own: maps then are tiles of its block or whole maps.
@group(0) @binding(0) var<uniform> frame: Frame;
#if air
@group(0) @binding(1) var sunlight_table: texture_2d<f32>;
@group(0) @binding(2) var table_sampler: sampler;
#endif
#if tiles
// Where a map's texels lie, for each block and map: texture coordinates of the block's centre, and their change per
// whole map. In the order of the bindings of group 1.
struct Tiles {
    placements: array<array<vec4f, 5>, 128>,
#if crossing
    // A bit for each block that has tiles.
    tiled: vec4u,
#endif
}
@group(0) @binding(3) var<uniform> tiles: Tiles;
#endif
#if cast
@group(0) @binding(6) var<storage, read> contour_nodes: array<ContourNode>;
#endif
@group(1) @binding(0) var day_map: texture_2d<f32>;
@group(1) @binding(5) var day_sampler: sampler;
#if clouds
@group(1) @binding(1) var cloud_map: texture_2d<f32>;
@group(1) @binding(6) var cloud_sampler: sampler;
#endif
#if normals
@group(1) @binding(2) var slope_map: texture_2d<f32>;
@group(1) @binding(7) var slope_sampler: sampler;
#endif
#if night_lights
@group(1) @binding(3) var light_map: texture_2d<f32>;
@group(1) @binding(8) var light_sampler: sampler;
#endif
#if water
@group(1) @binding(4) var water_map: texture_2d<f32>;
@group(1) @binding(9) var water_sampler: sampler;
#endif

const PI: f32 = 3.14159265;
#if tiles
#if relief
// In place of a block: whole maps.
const WHOLE: u32 = 256u;
#endif
#endif
#if crossing
// What lies in several blocks is drawn once with whole maps, and once for each block that has tiles, whose index is added to
// this. Each pixel is kept by one of these draws.
const CROSSING: u32 = 128u;
#endif

#if grid
#else
struct BlockVertex {
#if cast
    // A corner of a page's prism less the eye, ITRF metres: subtracted in f64.
    @location(0) from_eye_m: vec3f,
    // Of the page: the eye less its origin, where its tree begins, and slack, cone and step of its rays.
    @location(5) eye_from_origin_m: vec3f,
    @location(6) root: u32,
    @location(7) ray: vec3f,
#else
#if relief
    // Vertex less its patch's origin, ITRF metres, height above the ellipsoid, and rise of the ground to east and north.
    @location(0) from_origin_m: vec3f,
    @location(5) height_m: f32,
    @location(6) slope: vec2f,
    // Of the patch: its origin less the eye, subtracted in f64.
    @location(7) origin_from_anchor_m: vec3f,
    @location(8) anchor_from_eye_m: vec3f,
#else
    // Vertex less eye, ITRF metres: subtracted in f64.
    @location(0) from_eye_m: vec3f,
#endif
#endif
    // The block's centre: (cos, sin) of longitude and of latitude, and its texture coordinates.
    @location(1) center_lon: vec2f,
    @location(2) center_lat: vec2f,
    @location(3) center_uv: vec2f,
#if tiles
    @location(4) block: u32,
#endif
}
#endif

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat) center_lon: vec2f,
    @location(1) @interpolate(flat) center_lat: vec2f,
    @location(2) @interpolate(flat) center_uv: vec2f,
#if tiles
    @location(3) @interpolate(flat) block: u32,
#endif
#if cast
    @location(4) @interpolate(flat) eye_from_origin_m: vec3f,
    @location(5) @interpolate(flat) root: u32,
    @location(6) @interpolate(flat) ray: vec3f,
#else
#if relief
#if crossing
    // Of a place within the triangle, so that its block is one that the triangle touches.
    @location(4) @interpolate(perspective, centroid) from_eye_m: vec3f,
#else
    @location(4) from_eye_m: vec3f,
#endif
    @location(5) height_m: f32,
    @location(6) slope: vec2f,
#endif
#endif
}

#if grid
// The grid has no vertex buffer: a vertex is made from its number, and the instance's says what it is drawn as.
@vertex
#if crossing
fn vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) drawn_as: u32) -> Varying {
#else
fn vertex(@builtin(vertex_index) index: u32) -> Varying {
#endif
    let point = ground_point(index);
    var out: Varying;
    out.from_eye_m = point.from_eye_m;
    out.height_m = point.height_m;
    out.slope = point.slope;
    out.clip = frame.clip_from_eye * vec4f(point.from_eye_m, 1.0);
    out.center_lon = grid.eye_lon;
    out.center_lat = grid.center_lat;
    out.center_uv = grid.center_uv;
#if crossing
    out.block = drawn_as;
#else
#if tiles
    out.block = WHOLE;
#endif
#endif
    return out;
}
#else
@vertex
fn vertex(in: BlockVertex) -> Varying {
    var out: Varying;
#if cast
    out.eye_from_origin_m = in.eye_from_origin_m;
    out.root = in.root;
    out.ray = in.ray;
    // Only what lies behind the eye is cut off: the prism is no part of the picture, the ground in it may be.
    out.clip = frame.clip_from_eye * vec4f(in.from_eye_m, 1.0);
    out.clip.z = 0.5 * out.clip.w;
#else
#if relief
    // In this order: the first sum is the same in all patches that share the vertex.
    out.from_eye_m = (in.origin_from_anchor_m + in.from_origin_m) + in.anchor_from_eye_m;
    out.height_m = in.height_m;
    out.slope = in.slope;
    out.clip = frame.clip_from_eye * vec4f(out.from_eye_m, 1.0);
#else
    out.clip = frame.clip_from_eye * vec4f(in.from_eye_m, 1.0);
#endif
#endif
    out.center_lon = in.center_lon;
    out.center_lat = in.center_lat;
    out.center_uv = in.center_uv;
#if tiles
    out.block = in.block;
#endif
    return out;
}
#endif

// atan(y/x) for |y/x| ≤ tan 15°, error below 1e-7: a block reaches 11.25° to each side of its centre.
fn atan_near(y: f32, x: f32) -> f32 {
    let t = y / x;
    let s = t * t;
    return t * (1.0 + s * (-0.33333333 + s * (0.2 + s * (-0.14285714 + s * 0.11111111))));
}

// Where a pixel lies on the ground.
struct Place {
    // Towards the eye, of any length.
    to_eye: vec3f,
    // Outward normal of the ellipsoid, unit vectors east and north.
    up: vec3f,
    east: vec3f,
    north: vec3f,
    // Texture coordinates on the whole map, from the block's centre.
    uv: vec2f,
    // Change of uv to the next pixel right and down, u counted in ground distance as v is (× cos latitude), so that
    // the mip level follows the pixel's footprint at the poles and has no seam at ±180°.
    uv_dx: vec2f,
    uv_dy: vec2f,
    center_uv: vec2f,
#if tiles
    block: u32,
#endif
#if relief
    slope: vec2f,
#if cast
    // The ground's distance in lengths of the pixel's ray.
    along: f32,
#else
#if places
    along: f32,
#endif
#endif
#endif
}

// The mesh says which pixels show the ground; what they show is found by the pixel's own ray on the exact ellipsoid.
// So nothing is interpolated: facets seen edge on, where interpolation is ill-conditioned, cannot shake, and a coarse
// mesh shifts nothing.
fn place(in: Varying) -> Place {
    var out: Place;
    let ray = frame.corner_ray + in.clip.x * frame.pixel_right + in.clip.y * frame.pixel_down;
    let to_scaled = vec3f(1.0, 1.0, frame.polar_stretch);
    let scaled = ray * to_scaled;
#if relief
#if cast
    // Where the ray meets the page's contours.
    let ray_length = length(ray);
    let in_page = ContourRay(in.eye_from_origin_m, 1e30, ray / ray_length, in.ray.y, in.ray.x, in.ray.z);
    let hit = contour_cast(in_page, in.root);
    if hit.node == 0xffffffffu {
        discard;
    }
    let along = hit.t / ray_length;
#else
    // The mesh's own place, moved onto the pixel's ray, so that what is interpolated can be wrong along the ray only.
    let along = dot(in.from_eye_m, ray) / dot(ray, ray);
#endif
    let radii = along / frame.radius_m;
    let p = frame.eye_scaled + radii * scaled;
#if cast
    // |p|² − 1 without cancellation.
    let above = frame.above + radii * (2.0 * dot(frame.eye_scaled, scaled) + radii * dot(scaled, scaled));
    let height_m = frame.radius_m * above / (1.0 + sqrt(max(1.0 + above, 0.0)));
#else
    let height_m = in.height_m;
#endif
    // The normal through a point at height h: z over ρ by the parallel radii of the figure h higher,
    //   q(a + h)/(q² a + h) in scaled space, q = b/a, where N is taken as a.
    let q = 1.0 / frame.polar_stretch;
    let lift = height_m / frame.radius_m;
    out.up = normalize(p * vec3f(1.0, 1.0, q * (1.0 + lift) / (q * q + lift)));
#if cast
    out.slope = contour_slope(hit.node, in_page.start + hit.t * in_page.towards);
    out.along = along;
#else
    out.slope = in.slope;
#if places
    out.along = along;
#endif
#endif
#else
    let d = normalize(scaled);
    // |e + t d| = 1 with c = |e|² − 1: t = c / (−e·d + √(1 − |e × d|²)). Lagrange's identity instead of b² − c.
    let across_ray = cross(frame.eye_scaled, d);
    let root = sqrt(max(1.0 - dot(across_ray, across_ray), 0.0));
    let t = max(frame.above / max(root - dot(frame.eye_scaled, d), 1e-9), 0.0);
    let p = frame.eye_scaled + t * d;
    let radii = t / length(scaled);
    out.up = normalize(p * to_scaled);
#endif
    out.to_eye = -ray;

    let across = max(length(out.up.xy), 1e-7);
    out.east = vec3f(-out.up.y, out.up.x, 0.0) / across;
    out.north = cross(out.up, out.east);
    let y = in.center_lon.x * out.up.y - in.center_lon.y * out.up.x;
#if relief
    // A patch may be wider than a block.
    let longitude = atan2(y, dot(in.center_lon, out.up.xy));
    let latitude = atan2(
        in.center_lat.x * out.up.z - in.center_lat.y * across,
        in.center_lat.x * across + in.center_lat.y * out.up.z,
    );
#else
    let x = max(dot(in.center_lon, out.up.xy), 1e-7);
    let longitude = atan_near(clamp(y, -0.25 * x, 0.25 * x), x);
    let latitude = atan_near(
        in.center_lat.x * out.up.z - in.center_lat.y * across,
        in.center_lat.x * across + in.center_lat.y * out.up.z,
    );
#endif
    out.uv = vec2f(longitude / (2.0 * PI), -latitude / PI);
    out.center_uv = in.center_uv;
#if tiles
    out.block = in.block;
#endif

    // The neighbour pixel's ray on the tangent plane: r − ray·(up·r)/(up·ray), times the distance in radii.
    let facing = min(dot(out.up, ray), -0.02 * length(ray));
    let dx = radii * (frame.pixel_right - ray * (dot(out.up, frame.pixel_right) / facing));
    let dy = radii * (frame.pixel_down - ray * (dot(out.up, frame.pixel_down) / facing));
    let to_uv = vec2f(0.5, -1.0) / PI;
    out.uv_dx = vec2f(dot(out.east, dx), dot(out.north, dx)) * to_uv;
    out.uv_dy = vec2f(dot(out.east, dy), dot(out.north, dy)) * to_uv;
    return out;
}

// Places in `placements`, and bindings of group 1.
const DAY: u32 = 0;
#if clouds
const CLOUDS: u32 = 1;
#endif
#if normals
const NORMALS: u32 = 2;
#endif
#if night_lights
const NIGHT_LIGHTS: u32 = 3;
#endif
#if water
const WATER: u32 = 4;
#endif

#if crossing
// The block that a place lies in, as it must be drawn: with that block's tiles, or with whole maps if there are none.
fn drawn_as(at: Place) -> u32 {
    let whole_uv = at.center_uv + at.uv;
    let row = min(u32(max(8.0 * whole_uv.y, 0.0)), 7u);
    let block = 16u * row + min(u32(16.0 * fract(whole_uv.x)), 15u);
    let is_tiled = tiles.tiled[block / 32u] >> (block % 32u) & 1u;
    return select(WHOLE, CROSSING + block, is_tiled == 1u);
}

// The same place from its own block's centre.
fn in_block(place: Place) -> Place {
    var at = place;
    if at.block >= WHOLE {
        return at;
    }
    at.block -= CROSSING;
    let whole_uv = at.center_uv + at.uv;
    at.center_uv = (vec2f(f32(at.block % 16u), f32(at.block / 16u)) + 0.5) / vec2f(16.0, 8.0);
    at.uv = whole_uv - at.center_uv;
    at.uv.x -= round(at.uv.x);
    return at;
}
#endif

#if tiles
fn placement_of(layer: u32, at: Place) -> vec4f {
#if relief
    if at.block >= WHOLE {
        return vec4f(at.center_uv, 1.0, 1.0);
    }
#endif
    return tiles.placements[at.block][layer];
}
#endif

fn sample_map(map: texture_2d<f32>, filtering: sampler, layer: u32, at: Place) -> vec4f {
#if tiles
    let placement = placement_of(layer, at);
    let uv = placement.xy + at.uv * placement.zw;
    return textureSampleGrad(map, filtering, uv, at.uv_dx * placement.zw, at.uv_dy * placement.zw);
#else
    return textureSampleGrad(map, filtering, at.center_uv + at.uv, at.uv_dx, at.uv_dy);
#endif
}

fn surface_normal(at: Place) -> vec3f {
#if normals
    var slope = sample_map(slope_map, slope_sampler, NORMALS, at).xy;
#if relief
    // Where a pixel is smaller than the map's texels the mesh's own slopes tell more.
    let texels = vec2f(textureDimensions(slope_map));
#if tiles
    let per_map = texels * placement_of(NORMALS, at).zw;
#else
    let per_map = texels;
#endif
    let footprint = max(length(at.uv_dx * per_map), length(at.uv_dy * per_map));
    slope = mix(at.slope, slope, smoothstep(0.25, 1.0, footprint));
#endif
    return normalize(at.up - slope.x * at.east - slope.y * at.north);
#else
#if relief
    return normalize(at.up - at.slope.x * at.east - at.slope.y * at.north);
#else
    return at.up;
#endif
#endif
}

#if paper
// The three layers as printed (section 1.2): n = normal texel, L = direction to the light,
//   ninfo = saturate(n·L + 0.3)·1.1
//   blend = 1 − (1 − earth)(1 − cloud)
//   out   = blend·ninfo
// in display values. n and L are both taken in Earth-fixed axes, so that the normal texel carries day and night.
fn shade(at: Place) -> vec3f {
    let earth = sample_map(day_map, day_sampler, DAY, at).rgb;
#if clouds
    let cloud = vec3f(sample_map(cloud_map, cloud_sampler, CLOUDS, at).r);
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

// Light that falls on the ground: the Sun's after the air, and the sky's.
struct Light {
    sun: vec3f,
    sky: vec3f,
}

#if air
// A row of the table: 0.25 is the transmittance of light that falls at this cosine, 0.75 the sky's light.
fn sunlight(mu: f32, row: f32) -> vec3f {
    let at = vec2f(table_coordinate(sun_coordinate(mu), f32(textureDimensions(sunlight_table).x)), row);
    return textureSampleLevel(sunlight_table, table_sampler, at, 0.0).rgb;
}

// What the air between leaves of the ground's light, colour by colour, over the one grey that the air's square dims it by.
// Light that goes up loses what light that comes down loses. Of an eye in the air only the part of it that lies below.
fn tint_of_air(at: Place) -> vec3f {
    let through = sunlight(max(dot(normalize(at.to_eye), at.up), 0.0), 0.25);
    let grey = max(dot(through, vec3f(0.2126, 0.7152, 0.0722)), 1e-4);
    return mix(vec3f(1.0), through / grey, frame.air_below);
}
#endif

fn light_at(mu_s: f32) -> Light {
    var out: Light;
#if air
    out.sun = sunlight(mu_s, 0.25);
    out.sky = sunlight(mu_s, 0.75);
#else
    // The Sun's disc, 0.27° in radius, sets gradually.
    out.sun = vec3f(smoothstep(-0.00465, 0.00465, mu_s));
    out.sky = vec3f(0.0);
#endif
    return out;
}

#if water
// Sunlight mirrored by the sea, per light that falls on a sheet facing the Sun. Cox and Munk 1954 (J. Opt. Soc. Am.
// 44, 838): slopes of the waves are Gaussian with mean square 0.003 + 0.00512 W, here for a wind of W = 7 m/s.
//   L/E = ρ(ω) p(β) / (4 cos θ cos⁴β),  p = exp(−tan²β/σ²)/(πσ²)
// with ρ by Schlick for water's 1.33. Where the eye looks along the sea, waves hide each other: cos θ is kept from 0.
const WAVE_SLOPE_SQUARED: f32 = 0.039;

fn glint(at: Place) -> f32 {
    let to_eye = normalize(at.to_eye);
    let half_way = normalize(to_eye + frame.sun_itrf);
    let cos_beta = max(dot(half_way, at.up), 1e-3);
    let cos_squared = cos_beta * cos_beta;
    let tan_squared = (1.0 - cos_squared) / cos_squared;
    let slopes = exp(-tan_squared / WAVE_SLOPE_SQUARED) / (PI * WAVE_SLOPE_SQUARED);
    let fresnel = 0.02 + 0.98 * pow(1.0 - saturate(dot(half_way, to_eye)), 5.0);
    let seen = max(dot(to_eye, at.up), 0.15);
    // A white sheet that faces the Sun is L = E/π.
    return PI * fresnel * slopes / (4.0 * seen * cos_squared * cos_squared);
}
#endif

// Linear light: a white sheet that faces the Sun in space is `exposure`.
fn shade(at: Place) -> vec3f {
    let mu_s = dot(at.up, frame.sun_itrf);
    let light = light_at(mu_s);
    let facing = max(dot(surface_normal(at), frame.sun_itrf), 0.0);
    var color = sample_map(day_map, day_sampler, DAY, at).rgb * (light.sun * facing + light.sky);
#if water
    // The glint fades with the last sunlight; waves do not mirror a Sun that is below their own horizon.
    let sea = sample_map(water_map, water_sampler, WATER, at).r;
    color += sea * light.sun * glint(at) * smoothstep(-0.01, 0.05, mu_s);
#endif
#if night_lights
    let glow = sample_map(light_map, light_sampler, NIGHT_LIGHTS, at).r * (1.0 - smoothstep(-0.12, 0.02, mu_s));
    color += 0.6 * glow * glow * LAMP_COLOR;
#endif
#if clouds
    let cover = sample_map(cloud_map, cloud_sampler, CLOUDS, at).r;
    let cloud = CLOUD_ALBEDO * (light.sun * max(mu_s, 0.0) + light.sky);
    color = mix(color, cloud, cover);
#endif
#if air
    color *= tint_of_air(at);
#endif
    return color * frame.exposure;
}
#endif

// What a pixel gets.
struct Drawn {
    @location(0) color: vec4f,
#if depth
    @builtin(frag_depth) depth: f32,
#endif
}

fn drawn(color: vec4f, at: Place) -> Drawn {
#if depth
    // The depth of the ground that the ray met, not of the prism that it was looked for in.
    let clip = frame.clip_from_eye * vec4f(-at.to_eye * at.along, 1.0);
    return Drawn(color, saturate(clip.z / max(clip.w, 1e-6)));
#else
    return Drawn(color);
#endif
}

#if places
// In place of colour, for measuring: the texture coordinates that maps would be read with, from the block's centre, and
// that centre. Kept apart, they are rounded as little as the samplers' are. The target is cleared to 0; no centre is 0.
// With relief: how many of its rays long the pixel's way to the ground is, in the last number, and 1 in the others.
@fragment
fn fragment(in: Varying) -> Drawn {
    let at = place(in);
#if crossing
    if drawn_as(at) != in.block {
        discard;
    }
#endif
#if relief
    return drawn(vec4f(1.0, 1.0, 1.0, at.along), at);
#else
    return drawn(vec4f(at.uv, at.center_uv), at);
#endif
}
#else
@fragment
fn fragment(in: Varying) -> Drawn {
#if crossing
    let found = place(in);
    if drawn_as(found) != in.block {
        discard;
    }
    let at = in_block(found);
#else
    let at = place(in);
#endif
    var color = shade(at);
#if encode
    color = encode_srgb(color);
#endif
#if decode
    color = decode_srgb(color);
#endif
    return drawn(vec4f(color, 1.0), at);
}
#endif
