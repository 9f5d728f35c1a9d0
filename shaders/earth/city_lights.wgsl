// City lights as points of constant light: each a normal distribution on the ground, as wide as its lamps are spread and blurred by about half a
// pixel, so that a point has the same brightness everywhere and at any size of the image. Wide ones are uneven.
//
// The air scatters a part of the light, LAMP_GLOW, which the ground's own pass draws by the map.
//
// They are seen through clouds and air. Everything except the distribution and its grains is computed per corner.
import rust::{CITY_LIGHT_RADIUS_M, LAMP_GLOW, LAMPS_OUT_SIN, PI};
@if(clouds) import rust::CLOUD_ALBEDO;
import earth/shading/lamps.wgsl;
import earth/surface_point/on_whole_map.wgsl;
import common/displayed.wgsl;
@if(air) import common/air.wgsl;
@if(clouds) import earth/shading/cloud_cover.wgsl;

// Mirrored by `CityLight` in crates/terrella-imagery/src/cities/point.rs.
struct CityLight {
    // Normal of the ellipsoid.
    @location(0) up: vec3f,
    // Light, in square equatorial radii of ground at the brightness of the brightest lamps.
    @location(1) light: f32,
    // Colour, and the spread of its lamps relative to the maximum.
    @location(2) color: vec4f,
}

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat) center_px: vec2f,
    // Light of the central pixel.
    @location(1) @interpolate(flat) light: vec3f,
    // Inverse covariance of the distribution, pixels: xx, xy, yy.
    @location(2) @interpolate(flat) narrow: vec3f,
    // Metres east and north per pixel to the right, and per pixel down.
    @location(3) @interpolate(flat) ground_m: vec4f,
    // Fraction of its light that is uneven; direction of the grains, radians, and their seed.
    @location(4) @interpolate(flat) in_grains: f32,
    @location(5) @interpolate(flat) turn: f32,
    @location(6) @interpolate(flat) seed: u32,
    // Cut-off radius, standard deviations.
    @location(7) @interpolate(flat) reach: f32,
    // Standard deviation on the ground, metres, and the fraction of its light that fades outwards like a district's.
    @location(8) @interpolate(flat) radius_m: f32,
    @location(9) @interpolate(flat) as_district: f32,
}

// Variance of the pixel blur, square pixels. The sum over all pixels is then uniform to 1 %.
const BLUR: f32 = 0.3;
// Largest cut-off radius of the distribution, standard deviations: 4e-5 of the light is outside. A margin for all samples of the outermost pixels.
const REACH: f32 = 4.5;
const SAMPLE_REACH_PX: f32 = 0.5;
// Upper limit of a standard deviation, pixels: near the ground lamps are drawn less spread than they are.
const WIDEST_PX: f32 = 40.0;
// Factor of the cut-off radius for wide districts, which fade outwards more slowly.
const WIDER_REACH: f32 = 1.5;
// Points are drawn at a fraction of the ground's distance so that the ground does not hide them: the mesh deviates from the ellipsoid. Points
// behind the limb are left out here.
const NEARER: f32 = 0.95;
// Limit of screen coordinates (edges at ±1) beyond which no visible part of a point is inside.
const BESIDE: f32 = 2.5;

@vertex
fn vertex(@builtin(vertex_index) index: u32, in: CityLight) -> Varying {
    var out: Varying;
    out.clip = vec4f(2.0, 2.0, 0.5, 1.0);
    let stretch = vec3f(1.0, 1.0, frame.polar_stretch);
    let from_eye = (normalize(in.up / stretch) - frame.eye_scaled) / stretch;
    let distance = length(from_eye);
    let direction = from_eye / distance;
    let facing = -dot(direction, in.up);
    let mu_s = dot(in.up, frame.sun_itrf);
    let plane = cross(frame.pixel_right, frame.pixel_down);
    let pixel_area = length(plane);
    let ahead = dot(direction, plane) * sign(dot(plane, frame.corner_ray)) / pixel_area;
    if facing <= 0.0 || mu_s >= LAMPS_OUT_SIN || ahead <= 0.0 {
        return out;
    }
    let middle = frame.clip_from_eye * vec4f(from_eye * frame.radius_m, 1.0);
    if max(abs(middle.x), abs(middle.y)) > BESIDE * middle.w {
        return out;
    }

    // To the plane one metre in front of the eye, and there in pixels.
    let ray = direction / ahead;
    let on_plane = ray - frame.corner_ray;
    let right = frame.pixel_right / dot(frame.pixel_right, frame.pixel_right);
    let down = frame.pixel_down / dot(frame.pixel_down, frame.pixel_down);
    out.center_px = vec2f(dot(on_plane, right), dot(on_plane, down));
    let at = seen_along(ray, distance * ahead, in.up);
    let to_m = frame.radius_m * PI * vec2f(2.0, -1.0);
    let x = at.uv_dx * to_m;
    let y = at.uv_dy * to_m;
    out.ground_m = vec4f(x, y);

    let squares = vec3f(dot(x, x), dot(x, y), dot(y, y));
    let determinant = max(squares.x * squares.z - squares.y * squares.y, 1e-12);
    let widest_m = WIDEST_PX * sqrt(sqrt(determinant));
    let radius_m = min(in.color.a * CITY_LIGHT_RADIUS_M, widest_m);
    let radius_px = radius_m * inverseSqrt(sqrt(determinant));
    out.in_grains = smoothstep(0.5, 2.0, radius_px);
    out.as_district = smoothstep(0.3, 1.0, radius_px);
    out.seed = bitcast<u32>(in.up.x) ^ bitcast<u32>(in.up.z);
    out.turn = 0.5 * PI * hashed(vec2i(0), out.seed);
    // Covariance of the lamps on the ground, in pixels, plus that of the blur.
    let spread = radius_m * radius_m / determinant * vec3f(squares.z, -squares.y, squares.x) + vec3f(BLUR, 0.0, BLUR);
    let area = spread.x * spread.z - spread.y * spread.y;
    out.narrow = vec3f(spread.z, -spread.y, spread.x) / area;

    // Solid angle of a pixel there.
    let pixel = pixel_area * ahead * ahead * ahead;
    let radiance = (1.0 - LAMP_GLOW) * frame.lamp_light * lamps_on(mu_s) * in.light * facing / (distance * distance * pixel);
    out.light = radiance / (2.0 * PI * sqrt(area)) * in.color.rgb * left_to_eye(at);

    out.radius_m = radius_m;
    out.reach = reach_of(out.light) * mix(1.0, WIDER_REACH, out.as_district);
    let corner = vec2f(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0;
    let pixel_at = out.center_px + corner * (out.reach * sqrt(spread.xz) + SAMPLE_REACH_PX);
    let place_m = pixel_ray(pixel_at) * (NEARER * distance * ahead * frame.radius_m);
    out.clip = frame.clip_from_eye * vec4f(place_m, 1.0);
    return out;
}

// Radius in standard deviations inside which a point with so much central light is visible.
@if(!exposed && !shown)
fn reach_of(light: vec3f) -> f32 {
    return REACH;
}
@else
fn reach_of(light: vec3f) -> f32 {
    let brightest = frame.exposure * max(light.r, max(light.g, light.b));
    // Exposed light below which the point is only drawn at its centre.
    let least = 5e-4;
    return clamp(sqrt(2.0 * log(max(brightest / least, 1.0))), 1.0, REACH);
}

// Transmittance of clouds and air for light from a place.
fn left_to_eye(place: SurfacePoint) -> vec3f {
    let at = on_whole_map(place);
    var left = vec3f(1.0);
    @if(clouds) left -= frame.clouds_before * CLOUD_ALBEDO * cover_at(at, lifted_before(at));
    @if(air) left *= through_air_to(at);
    return left;
}

@if(air && inside)
fn through_air_to(at: SurfacePoint) -> vec3f {
    return through_seen(view_column(normalize(-at.to_eye * vec3f(1.0, 1.0, air.polar_stretch))));
}

@if(air && !inside)
fn through_air_to(at: SurfacePoint) -> vec3f {
    return through_at(ground_coordinate(clamp(dot(normalize(at.to_eye), at.up), 0.0, 1.0)));
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    let off = in.clip.xy - in.center_px;
    let square = in.narrow.x * off.x * off.x + 2.0 * in.narrow.y * off.x * off.y + in.narrow.z * off.y * off.y;
    if square > in.reach * in.reach {
        discard;
    }
    var part = exp(-0.5 * square);
    let place_m = off.x * in.ground_m.xy + off.y * in.ground_m.zw;
    if in.as_district > 0.0 {
        part = mix(part, district(in, square, place_m), in.as_district);
    }
    if in.in_grains > 0.0 {
        part *= grain(in, place_m);
    }
    let light = part * in.light;
    let shown = toned(light, frame.exposure);
    @if(encode) return vec4f(encode_srgb(shown), 0.0);
    @else return vec4f(shown, 0.0);
}

// Wide districts fade outwards exponentially, as the density of cities does (Clark 1951), and have ragged edges: the distance from the middle, in
// standard deviations, is multiplied by noise from 1/RAGGED to RAGGED, over quarters of QUARTER standard deviations.
const RAGGED: f32 = 2.2;
const QUARTER: f32 = 0.8;
// Mean of the inverse square of that factor.
const MEAN_AREA: f32 = 1.2492;

// Light so far from the middle, metres east and north, relative to the central light of a normal distribution.
fn district(in: Varying, square: f32, place_m: vec2f) -> f32 {
    let value = uneven_square(place_m / (QUARTER * in.radius_m) + 100.0, in.seed + 2u);
    let ragged = pow(RAGGED, in.in_grains * (2.0 * value - 1.0));
    return 3.0 * exp(-sqrt(3.0 * square) * ragged) / mix(1.0, MEAN_AREA, in.in_grains);
}

// Sizes of quarters and blocks of a district, metres, and the fraction of its light that is distributed unevenly over them.
const GRAINS_M: vec2f = vec2f(1400.0, 420.0);
const UNEVEN: f32 = 0.9;
// Mean of the fourth power of the noise below.
const MEAN_GRAIN: f32 = 0.136;

// Brightness of a district at a place relative to its distribution; the mean is 1.
fn grain(in: Varying, place_m: vec2f) -> f32 {
    let along = vec2f(cos(in.turn), sin(in.turn));
    let turned_m = vec2f(dot(along, place_m), along.x * place_m.y - along.y * place_m.x);
    let pixel_m = max(length(in.ground_m.xy), length(in.ground_m.zw));
    var factor = 1.0;
    for (var i = 0; i < 2; i++) {
        let value = uneven_square(turned_m / GRAINS_M[i], in.seed + u32(i));
        let squared = value * value;
        let share = in.in_grains * UNEVEN * saturate(2.0 - 2.5 * pixel_m / GRAINS_M[i]);
        factor *= mix(1.0, squared * squared / MEAN_GRAIN, share);
    }
    return factor;
}

// Noise of 0…1 over squares of side 1.
fn uneven_square(at: vec2f, seed: u32) -> f32 {
    let cell = vec2i(floor(at));
    let inside = smoothstep(vec2f(0.0), vec2f(1.0), fract(at));
    let west = mix(hashed(cell, seed), hashed(cell + vec2i(0, 1), seed), inside.y);
    let east = mix(hashed(cell + vec2i(1, 0), seed), hashed(cell + vec2i(1, 1), seed), inside.y);
    return mix(west, east, inside.x);
}

// PCG of Jarzynski and Olano 2020, "Hash Functions for GPU Rendering".
fn hashed(cell: vec2i, seed: u32) -> f32 {
    let x = bitcast<u32>(cell.x) * 1664525u + bitcast<u32>(cell.y) * 22695477u + seed * 1013904223u;
    let state = x * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return f32((word >> 22u) ^ word) * (1.0 / 4294967296.0);
}
