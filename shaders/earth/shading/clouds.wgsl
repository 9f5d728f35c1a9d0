// Clouds: one layer at a height, lit from above, that lets light through.
//
// The map's cover is what of a thick cloud's reflectance the cloud has. A layer that scatters and does not absorb reflects of
// diffuse light, with the two-stream approximation,
//   ρ = x/(4/3 + x),  x = (1 − g)τ
// and of sunlight at the cosine μ, by the delta-Eddington approximation (Joseph, Wiscombe and Weinman 1976) with g = 0.85,
//   ρ(μ) = ρ + (1 − ρ)(1/2 − 3/4 μ)(1 − exp(−1.85 x/μ))
import rust::CLOUD_ALBEDO;
import earth/shading/cloud_cover.wgsl;
@if(air) import earth/shading/air_above_clouds.wgsl;
@if(air) import earth/shading/air_before.wgsl;
@if(directional_reflectance) import earth/shading/directional.wgsl;

// A cloud's sides catch some light of a Sun at their horizon.
const CLOUD_SIDES: f32 = 0.05;
// Lowest cosine to the vertical at which an eye sees them, as they are not as flat as a sheet.
@if(directional_reflectance) const LEAST_CLOUD_EYE: f32 = 0.03;

// Part of sunlight at this cosine that a layer throws back which throws back `albedo` of diffuse light.
fn sunlit_albedo(albedo: f32, mu: f32) -> f32 {
    let hit = 1.0 - exp(-scaled_thickness(albedo) / max(mu, CLOUD_SIDES));
    return max(albedo + (1.0 - albedo) * (0.5 - 0.75 * mu) * hit, 0.0);
}

// Its optical thickness as delta-Eddington scales it: (1 − g²)/(1 − g) = 1.85 times that of two streams.
fn scaled_thickness(albedo: f32) -> f32 {
    let x = 4.0 / 3.0 * albedo / (1.0 - albedo);
    return 1.85 * x;
}

// Of the clouds before a place of the ground.
struct CloudsBefore {
    cover: f32,
    // What of it the map says.
    @if(detail) mapped: f32,
    // What they throw back of diffuse light.
    albedo: f32,
    lift: Lifted,
}

fn clouds_before(at: SurfacePoint) -> CloudsBefore {
    return clouds_at(at, lifted_before(at), frame.clouds_before);
}

// `seen`: the part of them that the eye sees.
fn clouds_at(at: SurfacePoint, lift: Lifted, seen: f32) -> CloudsBefore {
    let mapped = mapped_cover(at, lift);
    @if(!detail) return CloudsBefore(mapped, seen * CLOUD_ALBEDO * mapped, lift);
    @if(detail) let cover = cover_with_detail(at, lift, mapped);
    @if(detail) return CloudsBefore(cover, mapped, seen * CLOUD_ALBEDO * cover, lift);
}

// What they reflect to the eye of the light of a Sun in a direction, which falls on them at this cosine, and of its sky.
fn light_of_clouds(at: SurfacePoint, clouds: CloudsBefore, light: Light, sun: vec3f, cosine: f32) -> vec3f {
    @if(!directional_reflectance) let reflected = sunlit_albedo(clouds.albedo, cosine);
    @if(directional_reflectance) let reflected = reflected_by_clouds(at, clouds, sun, cosine);
    return reflected * cosine * light.sun + clouds.albedo * light.sky;
}

// Light scattered once has the droplets' directions, what is scattered more often those of broken clouds.
@if(directional_reflectance)
fn reflected_by_clouds(at: SurfacePoint, clouds: CloudsBefore, sun: vec3f, cosine: f32) -> f32 {
    let to_eye = normalize(at.to_eye);
    let cos_phase = dot(to_eye, sun);
    let thickness = scaled_thickness(clouds.albedo);
    let once = scattered_once(thickness, max(dot(clouds.lift.up, to_eye), LEAST_CLOUD_EYE), cosine, cos_phase);
    let often = max(sunlit_albedo(clouds.albedo, cosine) - albedo_of_scattered_once(thickness, cosine), 0.0);
    return once + often * opposition(cos_phase, cosine);
}

// Their light as the eye sees it, without air: their horizon is lower than the ground's.
@if(!air)
fn clouds_seen(at: SurfacePoint, clouds: CloudsBefore) -> vec3f {
    let from_sun = light_on_clouds(dot(clouds.lift.up, frame.sun_itrf));
    var color = light_of_clouds(at, clouds, from_sun, frame.sun_itrf, sun_on_top(at, clouds, frame.sun_itrf));
    @if(moonlight) let mu = dot(clouds.lift.up, frame.moon_itrf);
    @if(moonlight) color += frame.moon_light * light_of_clouds(at, clouds, light_on_clouds(mu), frame.moon_itrf, max(mu, CLOUD_SIDES));
    @if(eclipse) color *= sun_left_to_clouds(clouds);
    return color;
}

@if(!air)
fn light_on_clouds(mu: f32) -> Light {
    return Light(light_of_disc(mu + surface_light.cloud_dip), vec3f(0.0));
}

// Through the air above them, with what that adds. `ground` is the air before the ground.
@if(air)
fn clouds_seen(at: SurfacePoint, clouds: CloudsBefore, ground: AirBefore) -> vec3f {
    let about = neighbourhood(at.center_uv + at.uv);
    @if(interpolated) let air_ = at.air.of_clouds;
    @else let air_ = air_of_clouds(at, clouds, frame.sun_itrf);
    let light = light_on_clouds(air_, dot(clouds.lift.up, frame.sun_itrf), about);
    var color = light_of_clouds(at, clouds, light, frame.sun_itrf, sun_on_top(at, clouds, frame.sun_itrf));
    var added = added_above_clouds(air_, about);
    @if(moonlight) let of_moon = air_of_clouds(at, clouds, frame.moon_itrf);
    @if(moonlight) color += frame.moon_light * moonlit_clouds(at, clouds, of_moon, about);
    @if(moonlight) added += frame.moon_light * added_above_clouds(of_moon, about);
    var before = AirBefore(air_.through, added);
    @if(inside) before = thinned(ground, air.before_clouds);
    @if(eclipse) color *= sun_left_to_clouds(clouds);
    @if(eclipse) before.light *= sun_on_air_before(at);
    return before.through * color + clouds.albedo * before.light;
}

// The Moon shows no relief of clouds: for it they would be looked at once more.
@if(air && moonlight)
fn moonlit_clouds(at: SurfacePoint, clouds: CloudsBefore, air_: AirOfClouds, about: vec3f) -> vec3f {
    let mu = dot(clouds.lift.up, frame.moon_itrf);
    return light_of_clouds(at, clouds, light_on_clouds(air_, mu, about), frame.moon_itrf, max(mu, CLOUD_SIDES));
}

// What the air does at a cloud, which lies above most of it and hides what is below.
@if(air && !interpolated)
fn air_of_clouds(at: SurfacePoint, clouds: CloudsBefore, sun: vec3f) -> AirOfClouds {
    return air_above_clouds(clouds.lift.up, -normalize(at.to_eye), sun);
}

// Steepest that a cloud's top is drawn: a map's noise must not look like towers.
const STEEPEST: f32 = 0.7;
// How far towards the Sun a cloud's top is looked at again, equatorial radii: 1 km where there is detail.
@if(detail) const CLOUD_STEP: f32 = 1.6e-4;
// How high the tops of single clouds stand, of what the weather's systems do.
@if(detail) const SINGLE_CLOUDS: f32 = 0.5;

// Cosine at which sunlight falls on a cloud's top, thick clouds being higher than thin ones: from how much higher clouds are some way
// towards the Sun. Where those reach above the ray to the Sun they shade it.
fn sun_on_top(at: SurfacePoint, clouds: CloudsBefore, sun: vec3f) -> f32 {
    let upward = dot(clouds.lift.up, sun);
    let level = sun - upward * clouds.lift.up;
    let flat_ = max(length(level), 1e-3);
    let ahead = level / flat_;
    @if(detail) let step = max(CLOUD_STEP, 2.3 * pixel_radii(at));
    @else let step = max(cloud_texel_radii(at), 1.5 * pixel_radii(at));
    @if(detail) let here = top_with_detail(at, clouds.mapped, clouds.lift.up);
    @else let here = surface_light.cloud_relief * clouds.cover;
    let rise = top_at(at, moved(at, clouds.lift, ahead * step)) - here;
    let slope = clamp(rise / step, -STEEPEST, STEEPEST);
    return max((upward - slope * flat_) * inverseSqrt(1.0 + slope * slope), CLOUD_SIDES);
}

// How far a cloud's top rises over those of thin clouds, equatorial radii.
fn top_at(at: SurfacePoint, lift: Lifted) -> f32 {
    @if(!detail) return surface_light.cloud_relief * mapped_cover(at, lift);
    @if(detail) return top_with_detail(at, mapped_cover(at, lift), lift.up);
}

// Softer than the cover, as light is spread inside of a cloud: hard flanks look like crumpled foil.
@if(detail)
fn top_with_detail(at: SurfacePoint, mapped: f32, up: vec3f) -> f32 {
    let cover = uneven_cover(mapped, soft_structure(up, cloud_texel_radii(at), 0.75 * pixel_radii(at)));
    return surface_light.cloud_relief * mix(mapped, cover, SINGLE_CLOUDS);
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
