// Clouds: one layer at a height, lit from above, that lets light through.
//
// The map's cover is what of a thick cloud's reflectance the cloud has. A layer that scatters and does not absorb reflects of
// diffuse light, with the two-stream approximation,
//   ρ = x/(4/3 + x),  x = (1 − g)τ
// and of sunlight at the cosine μ, by the delta-Eddington approximation (Joseph, Wiscombe and Weinman 1976) with g = 0.85,
//   ρ(μ) = ρ + (1 − ρ)(1/2 − 3/4 μ)(1 − exp(−1.85 x/μ))
import rust::CLOUD_ALBEDO;
import earth/shading/cloud_cover.wgsl;
@if(whole_quads) import rust::PI;

// A cloud's sides catch some light of a Sun at their horizon.
const CLOUD_SIDES: f32 = 0.05;

// Part of sunlight at this cosine that a layer throws back which throws back `albedo` of diffuse light.
fn sunlit_albedo(albedo: f32, mu: f32) -> f32 {
    let x = 4.0 / 3.0 * albedo / (1.0 - albedo);
    return max(albedo + (1.0 - albedo) * (0.5 - 0.75 * mu) * (1.0 - exp(-1.85 * x / max(mu, CLOUD_SIDES))), 0.0);
}

// The Sun's light on clouds over a place where it stands at this cosine. Their horizon is lower than the ground's.
fn sun_at_clouds(mu_s: f32) -> vec3f {
    @if(air) return sunlight(mu_s, OF_CLOUDS);
    @else return light_of_disc(mu_s + surface_light.cloud_dip);
}

// Of the clouds before a place of the ground.
struct CloudsBefore {
    // What they throw back of diffuse light.
    albedo: f32,
    // Normal of the ellipsoid below them, and of their tops.
    up: vec3f,
    normal: vec3f,
}

fn clouds_before(at: SurfacePoint) -> CloudsBefore {
    let lift = lifted_before(at);
    let cover = cover_at(at, lift, 1.0);
    @if(whole_quads) let slope = cloud_slope(at, cover);
    @else let slope = vec2f(0.0);
    let normal = normalize(lift.up - slope.x * at.east - slope.y * at.north);
    return CloudsBefore(CLOUD_ALBEDO * cover, lift.up, normal);
}

// What they throw back of the light of a Sun, which is so bright there, and of its sky.
fn light_of_clouds(clouds: CloudsBefore, sun_on_clouds: vec3f, light: Light, sun: vec3f) -> vec3f {
    let facing = max(dot(clouds.normal, sun), CLOUD_SIDES);
    let sunlit = sunlit_albedo(clouds.albedo, facing) * facing * sun_on_clouds;
    return sunlit + clouds.albedo * light.sky;
}

// Steepest that a cloud's top is drawn: a map's noise must not look like towers.
@if(whole_quads) const STEEPEST: f32 = 0.7;

// Rise of the clouds' tops to the east and to the north, thick clouds being higher than thin ones: from what the cover changes by
// to the next pixel right and down.
@if(whole_quads)
fn cloud_slope(at: SurfacePoint, cover: f32) -> vec2f {
    // Pixels as steps over the ground to the east and north, equatorial radii.
    let right = at.uv_dx * vec2f(2.0, -1.0) * PI;
    let down = at.uv_dy * vec2f(2.0, -1.0) * PI;
    let area = right.x * down.y - down.x * right.y;
    let dx = dpdx(cover);
    let dy = dpdy(cover);
    let gradient = vec2f(dx * down.y - dy * right.y, right.x * dy - down.x * dx) / select(area, 1.0, area == 0.0);
    let slope = surface_light.cloud_relief * gradient;
    return slope * min(STEEPEST * inverseSqrt(max(dot(slope, slope), 1e-12)), 1.0);
}

// A Sun lower than this casts shadows longer than clouds are far apart.
@if(cloud_shadows) const LOWEST_SHADOW: f32 = 0.05;
// Their edges are soft: they need no detail as small as the clouds' own.
@if(cloud_shadows) const SHADOW_PIXELS: f32 = 4.0;

// What clouds leave of the light that falls on the ground: the cover where the ray to the Sun leaves their layer casts a shadow.
@if(cloud_shadows)
fn below_clouds(at: SurfacePoint, light: Light, sun: vec3f, mu_s: f32) -> Light {
    let lift = lifted(at, sun, max(mu_s, LOWEST_SHADOW), surface_light.cloud_height);
    let albedo = CLOUD_ALBEDO * cover_at(at, lift, SHADOW_PIXELS);
    let left = 1.0 - sunlit_albedo(albedo, max(mu_s, LOWEST_SHADOW));
    // What falls through is spread over the sky: half of it comes from there.
    return Light(light.sun * left, light.sky * (1.0 - 0.5 * albedo));
}
@else
fn below_clouds(at: SurfacePoint, light: Light, sun: vec3f, mu_s: f32) -> Light {
    return light;
}
