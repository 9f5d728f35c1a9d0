// Linear light: a white sheet that faces the Sun in space is 1.
@if(!open_sea) import rust::DAY;
import earth/shading/light.wgsl;
@if(air) import earth/shading/air_before.wgsl;
@if(interpolated) import earth/shading/air_at_vertices.wgsl;
@if(water) import earth/shading/sea.wgsl;
@if(night_lights) import earth/shading/night_lights.wgsl;
@if(clouds) import earth/shading/clouds.wgsl;
@if(detail && !open_sea) import earth/shading/land_detail.wgsl;
@if(directional_reflectance && !open_sea) import earth/shading/directional.wgsl;

// Surface properties of a place that do not depend on the light source.
struct Surface {
    // Colour of the land; alpha is the depth of the sea's floor.
    @if(!open_sea) day: vec4f,
    // Normal of the ground.
    normal: vec3f,
    @if(water && !open_sea) water: f32,
    @if(clouds) clouds: CloudsBefore,
}

fn surface_at(at: SurfacePoint) -> Surface {
    var out: Surface;
    @if(!open_sea) out.day = sample_map(day_map, day_sampler, DAY, at);
    @if(open_sea) out.normal = at.up;
    @else out.normal = surface_normal(at);
    @if(water && !open_sea) out.water = open_water(at);
    @if(detail && !water) out = with_detail(at, out);
    // Land details are skipped where there is no land.
    @if(detail && water && !open_sea) if out.water < 0.98 {
        out = with_detail(at, out);
    }
    @if(clouds) out.clouds = clouds_before(at);
    return out;
}

// The same surface with synthetic terrain.
@if(detail && !open_sea)
fn with_detail(at: SurfacePoint, surface: Surface) -> Surface {
    let texel = texel_radii(DAY, at, textureDimensions(day_map));
    let land = land_structure(at.up, texel, pixel_radii(at));
    // With terrain, ridges of the tile would lie beside its own.
    @if(relief) let slope = 0.0;
    @if(!relief) let upward = dot(surface.normal, at.up);
    @if(!relief) let slope = length(surface.normal - upward * at.up) / upward;
    var out = surface;
    out.day = vec4f(land_with_detail(out.day.rgb, slope, land), out.day.a);
    @if(normals && !relief) out.normal = normal_with_detail(out.normal, slope, land.change, texel);
    return out;
}

// Light of the ground under a Sun in this direction.
fn lit(at: SurfacePoint, surface: Surface, sun: vec3f) -> vec3f {
    let mu_s = dot(at.up, sun);
    @if(eclipse) let above = eclipsed(light_at(at, mu_s), at);
    @else let above = light_at(at, mu_s);
    @if(clouds) let light = below_clouds(at, above, sun, mu_s);
    @else let light = above;
    // The floor of the open sea has the map's maximum depth.
    @if(open_sea) return sea(at, light, sun, mu_s, 1.0);
    @if(!open_sea) var falls = max(dot(surface.normal, sun), 0.0);
    @if(directional_reflectance && !open_sea) falls *= opposition(dot(normalize(at.to_eye), sun), max(mu_s, 0.0));
    @if(!open_sea) var color = surface.day.rgb * (falls * light.sun + light.sky);
    @if(water && !open_sea) color = mix(color, sea(at, light, sun, mu_s, surface.day.a), surface.water);
    @if(!open_sea) return color;
}

fn shade(at: SurfacePoint) -> vec3f {
    let mu_s = dot(at.up, frame.sun_itrf);
    let surface = surface_at(at);
    @if(!night) var color = lit(at, surface, frame.sun_itrf);
    @if(!night && moonlight) color += frame.moon_light * lit(at, surface, frame.moon_itrf);
    // Without sunlight.
    @if(night && moonlight) var color = frame.moon_light * lit(at, surface, frame.moon_itrf);
    @if(night && !moonlight) var color = vec3f(0.0);
    @if(night_lights) color += city_light(at, mu_s);
    @if(air) let smooth_ = air_before_smooth_ground(at, mu_s);
    @if(air) color = through_air(color, at, smooth_);
    @if(clouds && air) color = clouds_seen(at, surface.clouds, smooth_) + (1.0 - surface.clouds.albedo) * color;
    @if(clouds && !air) color = clouds_seen(at, surface.clouds) + (1.0 - surface.clouds.albedo) * color;
    return color;
}

// Light of the ground at the eye, through the air in front of smooth ground.
@if(air)
fn through_air(color: vec3f, at: SurfacePoint, smooth_: AirBefore) -> vec3f {
    @if(relief) let before = air_before_relief(at, smooth_);
    @else let before = smooth_;
    @if(eclipse) return before.through * color + sun_on_air_before(at) * before.light;
    @else return before.through * color + before.light;
}
