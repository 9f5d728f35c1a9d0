// Clouds: one layer at a height, lit from above, that lets light through.
//
// The map's cover is what of a thick cloud's reflectance the cloud has. A layer that scatters and does not absorb reflects of
// diffuse light, with the two-stream approximation,
//   ρ = x/(4/3 + x),  x = (1 − g)τ
// and of sunlight at the cosine μ, by the delta-Eddington approximation (Joseph, Wiscombe and Weinman 1976) with g = 0.85,
//   ρ(μ) = ρ + (1 − ρ)(1/2 − 3/4 μ)(1 − exp(−1.85 x/μ))
import rust::CLOUD_ALBEDO;
import earth/shading/cloud_cover.wgsl;
@if(whole_quads) import earth/shading/cloud_relief.wgsl;
@if(cloud_shadows) import earth/shading/cloud_shadow.wgsl;

// A cloud's sides catch some light of a Sun at their horizon.
const CLOUD_SIDES: f32 = 0.05;

// Part of sunlight at this cosine that a layer throws back which throws back `albedo` of diffuse light.
fn sunlit_albedo(albedo: f32, mu: f32) -> f32 {
    let x = 4.0 / 3.0 * albedo / (1.0 - albedo);
    return max(albedo + (1.0 - albedo) * (0.5 - 0.75 * mu) * (1.0 - exp(-1.85 * x / max(mu, CLOUD_SIDES))), 0.0);
}

// The Sun's light on clouds over a place where it stands at this cosine. Their horizon is lower than the ground's.
@if(air) fn sun_on_clouds(mu_s: f32) -> vec3f { return sunlight(mu_s, OF_CLOUDS); }
@if(!air) fn sun_on_clouds(mu_s: f32) -> vec3f { return light_of_disc(mu_s + surface_light.cloud_dip); }

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
    @if(!whole_quads) let slope = vec2f(0.0);
    let normal = normalize(lift.up - slope.x * at.east - slope.y * at.north);
    return CloudsBefore(CLOUD_ALBEDO * cover, lift.up, normal);
}

// What they throw back of the light of a Sun and its sky.
fn light_of_clouds(clouds: CloudsBefore, light: Light, sun: vec3f) -> vec3f {
    let facing = max(dot(clouds.normal, sun), CLOUD_SIDES);
    let sunlit = sunlit_albedo(clouds.albedo, facing) * facing * sun_on_clouds(dot(clouds.up, sun));
    return sunlit + clouds.albedo * light.sky;
}

// What clouds leave of the light that falls on the ground.
@if(!cloud_shadows) fn below_clouds(at: SurfacePoint, light: Light, sun: vec3f, mu_s: f32) -> Light { return light; }
