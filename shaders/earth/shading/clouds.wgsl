// Clouds: one layer at a height, lit from above, that lets light through.
//
// The map's cover is what of a thick cloud's reflectance the cloud has. A layer that scatters and does not absorb reflects of
// diffuse light, with the two-stream approximation,
//   ρ = x/(4/3 + x),  x = (1 − g)τ
// and of sunlight at the cosine μ, by the delta-Eddington approximation (Joseph, Wiscombe and Weinman 1976) with g = 0.85,
//   ρ(μ) = ρ + (1 − ρ)(1/2 − 3/4 μ)(1 − exp(−1.85 x/μ))
import rust::CLOUD_ALBEDO;
import earth/shading/cloud_cover.wgsl;

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
    cover: f32,
    // What they throw back of diffuse light.
    albedo: f32,
    lift: Lifted,
}

fn clouds_before(at: SurfacePoint) -> CloudsBefore {
    let lift = lifted_before(at);
    let cover = cover_at(at, lift);
    return CloudsBefore(cover, CLOUD_ALBEDO * cover, lift);
}

// What they throw back of the light of a Sun, which falls on them at this cosine, and of its sky.
fn light_of_clouds(clouds: CloudsBefore, falls: vec3f, cosine: f32, light: Light) -> vec3f {
    return sunlit_albedo(clouds.albedo, cosine) * falls + clouds.albedo * light.sky;
}

// Steepest that a cloud's top is drawn: a map's noise must not look like towers.
const STEEPEST: f32 = 0.7;
// How far towards the Sun a cloud's top is looked at again, equatorial radii: 1 km where there is detail.
@if(detail) const CLOUD_STEP: f32 = 1.6e-4;

// Cosine at which sunlight falls on a cloud's top, thick clouds being higher than thin ones: from how much higher clouds are some way
// towards the Sun. Where those reach above the ray to the Sun they shade it.
fn sun_on_top(at: SurfacePoint, clouds: CloudsBefore, sun: vec3f) -> f32 {
    let upward = dot(clouds.lift.up, sun);
    let level = sun - upward * clouds.lift.up;
    let flat_ = length(level);
    @if(detail) let step = max(CLOUD_STEP, 1.5 * pixel_radii(at));
    @else let step = max(cloud_texel_radii(at), 1.5 * pixel_radii(at));
    let ahead = cover_at(at, moved(at, clouds.lift, level * (step / max(flat_, 1e-3))));
    let slope = clamp(surface_light.cloud_relief * (ahead - clouds.cover) / step, -STEEPEST, STEEPEST);
    return max((upward - slope * flat_) * inverseSqrt(1.0 + slope * slope), CLOUD_SIDES);
}

// A Sun lower than this casts shadows longer than clouds are far apart.
@if(cloud_shadows) const LOWEST_SHADOW: f32 = 0.05;

// What clouds leave of the light that falls on the ground: the cover where the ray to the Sun leaves their layer casts a shadow.
@if(cloud_shadows)
fn below_clouds(at: SurfacePoint, light: Light, sun: vec3f, mu_s: f32) -> Light {
    let lift = lifted(at, sun, max(mu_s, LOWEST_SHADOW), surface_light.cloud_height);
    let albedo = CLOUD_ALBEDO * soft_cover_at(at, lift);
    let left = 1.0 - sunlit_albedo(albedo, max(mu_s, LOWEST_SHADOW));
    // What falls through is spread over the sky: half of it comes from there.
    return Light(light.sun * left, light.sky * (1.0 - 0.5 * albedo));
}
@else
fn below_clouds(at: SurfacePoint, light: Light, sun: vec3f, mu_s: f32) -> Light {
    return light;
}
