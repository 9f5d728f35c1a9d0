// Clouds: one layer at a height, lit from above, which transmits light.
//
// The map's cover is the cloud's reflectance relative to that of a thick cloud. A layer that scatters and does not absorb reflects of diffuse
// light, with the two-stream approximation,
//   ρ = x/(4/3 + x),  x = (1 − g)τ
// and of sunlight at the cosine μ, by the delta-Eddington approximation (Joseph, Wiscombe and Weinman 1976) with g = 0.85,
//   ρ(μ) = ρ + (1 − ρ)(1/2 − 3/4 μ)(1 − exp(−1.85 x/μ))
import rust::CLOUD_ALBEDO;
import earth/shading/cloud_cover.wgsl;
@if(air) import earth/shading/air_above_clouds.wgsl;
@if(air) import earth/shading/air_before.wgsl;
@if(directional_reflectance) import earth/shading/directional.wgsl;

// The sides of a cloud catch some light of a Sun at their horizon.
const CLOUD_SIDES: f32 = 0.05;
// Least cosine between line of sight and vertical, as clouds are not perfectly flat.
@if(directional_reflectance) const LEAST_CLOUD_EYE: f32 = 0.03;

// Reflectance for sunlight at this cosine of a layer that reflects the fraction `albedo` of diffuse light.
fn sunlit_albedo(albedo: f32, mu: f32) -> f32 {
    let hit = 1.0 - exp(-scaled_thickness(albedo) / max(mu, CLOUD_SIDES));
    return max(albedo + (1.0 - albedo) * (0.5 - 0.75 * mu) * hit, 0.0);
}

// Its optical thickness scaled by delta-Eddington: (1 − g²)/(1 − g) = 1.85 times that of two streams.
fn scaled_thickness(albedo: f32) -> f32 {
    let x = 4.0 / 3.0 * albedo / (1.0 - albedo);
    return 1.85 * x;
}

// The clouds in front of a place on the ground.
struct CloudsBefore {
    cover: f32,
    // The cover according to the map, and what makes it uneven.
    @if(detail) mapped: f32,
    @if(detail) uneven: Flanked,
    // Their reflectance for diffuse light.
    albedo: f32,
    lift: Lifted,
}

fn clouds_before(at: SurfacePoint) -> CloudsBefore {
    return clouds_at(at, lifted_before(at), frame.clouds_before);
}

// `seen`: the fraction of them that is in front of the eye.
fn clouds_at(at: SurfacePoint, lift: Lifted, seen: f32) -> CloudsBefore {
    let mapped = mapped_cover(at, lift);
    @if(!detail) return CloudsBefore(mapped, seen * CLOUD_ALBEDO * mapped, lift);
    @if(detail) let uneven = flanked_structure(lift.up, cloud_texel_radii(at), pixel_radii(at));
    @if(detail) let cover = uneven_cover(mapped, uneven.made);
    @if(detail) return CloudsBefore(cover, mapped, uneven, seen * CLOUD_ALBEDO * cover, lift);
}

// Light reflected to the eye from a Sun in a direction, which falls on them at this cosine, and from its sky.
fn light_of_clouds(at: SurfacePoint, clouds: CloudsBefore, light: Light, sun: vec3f, cosine: f32) -> vec3f {
    @if(!directional_reflectance) let reflected = sunlit_albedo(clouds.albedo, cosine);
    @if(directional_reflectance) let reflected = reflected_by_clouds(at, clouds, sun, cosine);
    return reflected * cosine * light.sun + clouds.albedo * light.sky;
}

// Singly scattered light has the droplets' phase function, multiply scattered light that of broken clouds.
@if(directional_reflectance)
fn reflected_by_clouds(at: SurfacePoint, clouds: CloudsBefore, sun: vec3f, cosine: f32) -> f32 {
    let to_eye = normalize(at.to_eye);
    let cos_phase = dot(to_eye, sun);
    let thickness = scaled_thickness(clouds.albedo);
    let once = scattered_once(thickness, max(dot(clouds.lift.up, to_eye), LEAST_CLOUD_EYE), cosine, cos_phase);
    let often = max(sunlit_albedo(clouds.albedo, cosine) - albedo_of_scattered_once(thickness, cosine), 0.0);
    return once + often * opposition(cos_phase, cosine);
}

// Their light at the eye, without air: their horizon is lower than the ground's.
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

// Without sunlight and moonlight.
@if(air && night && !moonlight)
fn clouds_seen(at: SurfacePoint, clouds: CloudsBefore, ground: AirBefore) -> vec3f {
    return vec3f(0.0);
}

// Without sunlight, by the Moon alone.
@if(air && night && moonlight)
fn clouds_seen(at: SurfacePoint, clouds: CloudsBefore, ground: AirBefore) -> vec3f {
    let about = neighbourhood(at.center_uv + at.uv);
    let of_moon = air_of_clouds(at, clouds, frame.moon_itrf);
    let color = of_moon.through * moonlit_clouds(at, clouds, of_moon, about);
    return frame.moon_light * (color + clouds.albedo * added_above_clouds(of_moon, about));
}

// Through the air above them, plus its own light. `ground` is the air in front of the ground.
@if(air && !night)
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

// Moonlight has no cloud relief: it would need one more sample.
@if(air && moonlight)
fn moonlit_clouds(at: SurfacePoint, clouds: CloudsBefore, air_: AirOfClouds, about: vec3f) -> vec3f {
    let mu = dot(clouds.lift.up, frame.moon_itrf);
    return light_of_clouds(at, clouds, light_on_clouds(air_, mu, about), frame.moon_itrf, max(mu, CLOUD_SIDES));
}

// Effect of the air at a cloud, which is above most of it and hides the rest.
@if(air && !interpolated)
fn air_of_clouds(at: SurfacePoint, clouds: CloudsBefore, sun: vec3f) -> AirOfClouds {
    return air_above_clouds(clouds.lift.up, -normalize(at.to_eye), sun);
}

// Slopes of clouds' tops tend to a maximum: a map's noise must not look like towers. A low Sun reaches only the crests, which are flatter. So the
// maximum has a value at sunset, and grows by so much for the sine of the Sun's elevation.
const STEEPEST: f32 = 0.7;
const STEEPEST_AT_SUNSET: f32 = 0.06;
const STEEPER_BY_DAY: f32 = 2.5;
// Most light of a low Sun on a facet, relative to level ground.
const MOST_FACING: f32 = 4.0;
// Distance towards the Sun of the second sample of a cloud's top, equatorial radii: 1 km with detail.
@if(detail) const CLOUD_STEP: f32 = 1.6e-4;
// Height of the tops of single clouds, relative to that of weather systems.
@if(detail) const SINGLE_CLOUDS: f32 = 0.5;

// Cosine of sunlight on a cloud's top, with thick clouds higher than thin ones: from the increase of height at some distance towards the Sun.
// Clouds that rise above the ray to the Sun shade it.
fn sun_on_top(at: SurfacePoint, clouds: CloudsBefore, sun: vec3f) -> f32 {
    let upward = dot(clouds.lift.up, sun);
    let level = sun - upward * clouds.lift.up;
    let flat_ = max(length(level), 1e-3);
    let ahead = level / flat_;
    @if(detail) let step = max(CLOUD_STEP, 2.3 * pixel_radii(at));
    @else let step = max(cloud_texel_radii(at), 1.5 * pixel_radii(at));
    let along = ahead * step;
    // A texel ahead: over a shorter distance, the slope of a bilinear map is a pattern of squares.
    @if(detail) let reach = max(step, cloud_texel_radii(at));
    @if(detail) let mapped = mix(clouds.mapped, mapped_cover(at, moved(at, clouds.lift, ahead * reach)), step / reach);
    @else let mapped = mapped_cover(at, moved(at, clouds.lift, along));
    @if(!detail) let rise = surface_light.cloud_relief * (mapped - clouds.cover);
    @if(detail) let soft = clouds.uneven.soft;
    @if(detail) let there = Detail(soft.value + dot(clouds.uneven.change, along), soft.variance);
    @if(detail) let rise = top_with_detail(mapped, there) - top_with_detail(clouds.mapped, soft);
    let steepest = min(STEEPEST, STEEPEST_AT_SUNSET + STEEPER_BY_DAY * max(upward, 0.0));
    let slope = rise / (step + abs(rise) / steepest);
    let cosine = (upward - slope * flat_) * inverseSqrt(1.0 + slope * slope);
    return max(shaded_by_clouds(cosine, upward), CLOUD_SIDES);
}

// Light of a Sun at the cosine `level` to level ground, on a facet at a cosine to it, past the facets before it. Of equal facets that face the Sun and
// that face away, the former get twice the light of level ground (Torrance and Sparrow 1967, J. Opt. Soc. Am. 57, 1105). Single clouds get more.
fn shaded_by_clouds(cosine: f32, level: f32) -> f32 {
    let most = MOST_FACING * max(level, 0.02) * (1.0 + 2.0 * level);
    return cosine * (1.0 + level / most) / (1.0 + max(cosine, 0.0) / most);
}

// Height of a cloud's top above those of thin clouds, equatorial radii. Smoother than the cover, as light is diffused inside a cloud: hard flanks
// look like crumpled foil.
@if(detail)
fn top_with_detail(mapped: f32, soft: Detail) -> f32 {
    return surface_light.cloud_relief * mix(mapped, uneven_cover(mapped, soft), SINGLE_CLOUDS);
}

// A lower Sun casts shadows longer than the spacing of clouds.
@if(cloud_shadows) const LOWEST_SHADOW: f32 = 0.05;

// Light on the ground below clouds: the cover where the ray to the Sun leaves their layer casts a shadow.
@if(cloud_shadows)
fn below_clouds(at: SurfacePoint, light: Light, sun: vec3f, mu_s: f32) -> Light {
    let lift = lifted(at, sun, max(mu_s, LOWEST_SHADOW));
    let albedo = CLOUD_ALBEDO * soft_cover_at(at, lift);
    let left = 1.0 - sunlit_albedo(albedo, max(mu_s, LOWEST_SHADOW));
    // Transmitted light is spread over the sky, half of which is affected.
    return Light(light.sun * left, light.sky * (1.0 - 0.5 * albedo));
}
@else
fn below_clouds(at: SurfacePoint, light: Light, sun: vec3f, mu_s: f32) -> Light {
    return light;
}
