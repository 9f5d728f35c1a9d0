// The sky view for an eye in the air, over black ground: a small image per frame, in three targets, that ground and sky are then drawn from. Ray
// marching is done only here.
//
// With moonlight the rows of the Moon are below those of the Sun. The mapping of directions is that of common/air/inside.wgsl.
import common/air/uniforms.wgsl;
import common/air/coordinates.wgsl;
import common/air/view_spacing.wgsl;
import rust::{AEROSOL_ASYMMETRY, AEROSOL_SCALE_HEIGHT, AIR_TOP, LUMINANCE, MOLECULE_SCALE_HEIGHT, PI, PROFILE_SIZE, RAYLEIGH_A, RAYLEIGH_B};
import rust::{SOURCES_SIZE, SOURCE_BANDS, TRANSMITTANCE_SIZE, VIEW_ANGLES, VIEW_AZIMUTHS};

// | group | binding | what                            | when   |
// |-------|---------|---------------------------------|--------|
// | 0     | 1       | the air's uniforms              | always |
// | 0     | 2       | table sampler                   | always |
// | 0     | 3       | transmittance to space          | always |
// | 0     | 4       | light scattered more than once  | always |
// | 0     | 5       | profile of molecules and ozone  | always |
@group(0) @binding(1) var<uniform> air: AirUniforms;
@group(0) @binding(2) var table_sampler: sampler;
@group(0) @binding(3) var transmittance_table: texture_2d<f32>;
@group(0) @binding(4) var sources_table: texture_2d<f32>;
@group(0) @binding(5) var profile_table: texture_2d<f32>;

struct Seen {
    // Scattered light over black ground, as its fourth root; alpha is the luminance that the air absorbs from the background.
    @location(0) black: vec4f,
    // Scattered light from the ground, for albedo 1 and one reflection; fourth root.
    @location(1) bounce: vec4f,
    @location(2) through: vec4f,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.5, 1.0);
}

// A ray from the eye, the Sun in the plane x–z and z upwards.
struct ViewRay {
    direction: vec3f,
    // −cos of the zenith angle, times the eye's distance from the centre.
    along: f32,
    // To the ground, or to the top of the air.
    length: f32,
}

fn view_ray(column: f32, row: f32) -> ViewRay {
    let half_ = 0.5 * VIEW_ANGLES;
    let is_ground = column < half_;
    let s = (column - select(half_, 0.0, is_ground)) / (half_ - 1.0);
    let limb_tangent = air.limb_sin / (1.0 + air.limb_cos);
    // δ from its half tangent.
    let t = view_spacing_inverse(s) * select(1.0 / limb_tangent, limb_tangent, is_ground);
    let cos_delta = (1.0 - t * t) / (1.0 + t * t);
    let sin_delta = 2.0 * t / (1.0 + t * t);
    let down = select(-sin_delta, sin_delta, is_ground);
    let cosine = air.limb_cos * cos_delta + air.limb_sin * down;
    let sine = max(air.limb_sin * cos_delta - air.limb_cos * down, 0.0);
    let turned = row / (VIEW_AZIMUTHS - 1.0);
    let cos_azimuth = 1.0 - 2.0 * turned * turned * turned * turned;
    let sin_azimuth = sqrt(max(1.0 - cos_azimuth * cos_azimuth, 0.0));
    var out: ViewRay;
    out.direction = vec3f(sine * cos_azimuth, sine * sin_azimuth, -cosine);
    out.along = air.eye_distance * cosine;
    let q = air.eye_distance * sine;
    // 1 − L sin(limb − δ) with L sin(limb) = 1, without a difference of large numbers.
    let inside = 2.0 * t * t / (1.0 + t * t) + air.eye_distance * air.limb_cos * sin_delta;
    let to_ground = air.eye_height * (air.eye_distance + 1.0) / max(out.along + sqrt(inside * (1.0 + q)), 1e-9);
    let to_space = max(out.along + sqrt(max((AIR_TOP - q) * (AIR_TOP + q), 0.0)), 0.0);
    out.length = select(to_space, to_ground, is_ground);
    return out;
}

fn height_coordinate(height: f32) -> f32 {
    return sqrt(clamp(height / (AIR_TOP - 1.0), 0.0, 1.0));
}

fn to_sun(height: f32, r: f32, mu_s: f32) -> vec3f {
    let horizon = -sqrt(height * (r + 1.0)) / r;
    let x = sqrt(max((mu_s - horizon) / (1.0 - horizon), 0.0));
    let at = vec2f(
        table_coordinate(x, TRANSMITTANCE_SIZE.x),
        table_coordinate(height_coordinate(height), TRANSMITTANCE_SIZE.y),
    );
    let light = textureSampleLevel(transmittance_table, table_sampler, at, 0.0).rgb;
    return select(vec3f(0.0), light, mu_s >= horizon);
}

struct Medium {
    molecules: vec3f,
    aerosol: vec3f,
    extinction: vec3f,
}

fn medium_at(height: f32) -> Medium {
    let x = table_coordinate(height_coordinate(height), PROFILE_SIZE.x);
    let density = textureSampleLevel(profile_table, table_sampler, vec2f(x, 0.5), 0.0).rg;
    let aerosol = exp(-height / AEROSOL_SCALE_HEIGHT);
    var out: Medium;
    out.molecules = air.molecules * (density.r * exp(-height / MOLECULE_SCALE_HEIGHT));
    out.aerosol = air.aerosol_scattering * aerosol;
    out.extinction = out.molecules + air.aerosol_extinction * aerosol + air.ozone * density.g;
    return out;
}

// A band of the source table.
fn source(band: f32, sun_at: f32, height_at: f32) -> vec3f {
    let rows = SOURCES_SIZE.y / SOURCE_BANDS;
    let y = (band * rows + height_at * (rows - 1.0) + 0.5) / SOURCES_SIZE.y;
    return textureSampleLevel(sources_table, table_sampler, vec2f(sun_at, y), 0.0).rgb;
}

// Ends of steps: dense around the fraction `crowd` of the way, where the air is densest.
fn step_end(part: f32, crowd: f32) -> f32 {
    let low = -sqrt(crowd);
    let at = low + part * (sqrt(1.0 - crowd) - low);
    return clamp(crowd + sign(at) * at * at, 0.0, 1.0);
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> Seen {
    var row = floor(position.y);
    var zenith_cosine = air.eye_sun;
    @if(moonlight) if row >= VIEW_AZIMUTHS { row -= VIEW_AZIMUTHS; zenith_cosine = air.eye_moon; }
    let ray = view_ray(floor(position.x), row);
    let start = vec3f(0.0, 0.0, air.eye_distance);
    // The Sun, or the Moon in its place.
    let sun = vec3f(sqrt(max(1.0 - zenith_cosine * zenith_cosine, 0.0)), 0.0, zenith_cosine);
    let nu = dot(ray.direction, sun);
    let phase_molecules = RAYLEIGH_A + RAYLEIGH_B * nu * nu;
    let g = AEROSOL_ASYMMETRY;
    let phase_aerosol = (1.0 - g * g) / (4.0 * PI * pow(max(1.0 + g * g - 2.0 * g * nu, 1e-5), 1.5));
    let crowd = clamp(ray.along / max(ray.length, 1e-9), 0.0, 1.0);
    const VIEW_STEPS: i32 = 32;
    var black = vec3f(0.0);
    var bounce = vec3f(0.0);
    var through = vec3f(1.0);
    var begin = 0.0;
    for (var i = 0; i < VIEW_STEPS; i++) {
        let to = ray.length * step_end(f32(i + 1) / f32(VIEW_STEPS), crowd);
        let step = to - begin;
        let t = 0.5 * (begin + to);
        begin = to;
        let p = start + ray.direction * t;
        let r = length(p);
        // h from L² − 1 − 2t·along + t², each term small near the ground.
        let height = max((air.eye_height * (air.eye_distance + 1.0) - 2.0 * t * ray.along + t * t) / (r + 1.0), 0.0);
        let up = p / r;
        let mu_s = clamp(dot(up, sun), -1.0, 1.0);
        let medium = medium_at(height);
        // Local vertical at the sample, and the horizontal direction to the Sun.
        let level = sun - mu_s * up;
        let z = dot(ray.direction, up);
        let x = clamp(dot(ray.direction, level) / max(length(level), 1e-3), -1.0, 1.0);
        let sun_at = table_coordinate(sun_coordinate(mu_s), SOURCES_SIZE.x);
        let height_at = height_coordinate(height);
        let again = source(0.0, sun_at, height_at) + x * source(1.0, sun_at, height_at) + z * source(2.0, sun_at, height_at)
            + x * x * source(3.0, sun_at, height_at) + z * z * source(4.0, sun_at, height_at)
            + x * z * source(5.0, sun_at, height_at);
        let once = to_sun(height, r, mu_s) * (PI * (medium.molecules * phase_molecules + medium.aerosol * phase_aerosol));
        let both = medium.molecules + medium.aerosol;
        // ∫ source·e^(−σt) over the step, exact for constant values.
        let fade = exp(-medium.extinction * step);
        let gain = through * (1.0 - fade) / max(medium.extinction, vec3f(1e-9));
        black += gain * max(once + again * both, vec3f(0.0));
        bounce += gain * source(6.0, sun_at, height_at) * both;
        through *= fade;
    }
    var out: Seen;
    out.black = vec4f(sqrt(sqrt(black)), 1.0 - dot(through, LUMINANCE));
    out.bounce = vec4f(sqrt(sqrt(max(bounce, vec3f(0.0)))), 1.0);
    out.through = vec4f(through, 1.0);
    return out;
}
