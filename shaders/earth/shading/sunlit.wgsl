// Linear light: a white sheet that faces the Sun in space is 1.
import rust::DAY;
@if(!air) import earth/shading/light_without_air.wgsl;
@if(air) import earth/shading/light_through_air.wgsl;
@if(water) import earth/shading/sea.wgsl;
@if(night_lights) import earth/shading/night_lights.wgsl;
@if(clouds) import earth/shading/clouds.wgsl;
@if(detail) import earth/shading/detail/land.wgsl;
@if(eclipse) import earth/shading/eclipsed.wgsl;

// Light that falls on the ground: the Sun's after the air, and the sky's.
struct Light {
    sun: vec3f,
    sky: vec3f,
}

// What of a place shows, whatever lights it.
struct Surface {
    // Colour of the land; in alpha the depth of the sea's floor.
    day: vec4f,
    // How the ground leans.
    normal: vec3f,
    @if(water) water: f32,
    @if(clouds) clouds: CloudsBefore,
}

fn surface_at(at: SurfacePoint) -> Surface {
    var out: Surface;
    out.day = sample_map(day_map, day_sampler, DAY, at);
    out.normal = surface_normal(at);
    @if(water) out.water = open_water(at);
    @if(detail && !water) out = with_detail(at, out);
    // Nothing of the land shows where there is none.
    @if(detail && water) if out.water < 0.98 { out = with_detail(at, out); }
    @if(clouds) out.clouds = clouds_before(at);
    return out;
}

// Its light, and that of the clouds before it, by a Sun in this direction.
fn lit(at: SurfacePoint, surface: Surface, sun: vec3f) -> vec3f {
    let mu_s = dot(at.up, sun);
    @if(!eclipse) let above = light_at(at, mu_s);
    @if(eclipse) let clear = light_at(at, mu_s);
    @if(eclipse) let above = eclipsed(clear, at);
    @if(!clouds) let light = above;
    @if(clouds) let light = below_clouds(at, above, sun, mu_s);
    var color = surface.day.rgb * (light.sun * max(dot(surface.normal, sun), 0.0) + light.sky);
    @if(water) color = mix(color, sea(at, light, sun, mu_s, surface.day.a), surface.water);
    @if(clouds && !eclipse) let of_clouds = light_of_clouds(surface.clouds, above, sun);
    @if(clouds && eclipse) let of_clouds = sun_left_to_clouds(surface.clouds) * light_of_clouds(surface.clouds, clear, sun);
    @if(clouds) color = of_clouds + (1.0 - surface.clouds.albedo) * color;
    return color;
}

fn shade(at: SurfacePoint) -> vec3f {
    let mu_s = dot(at.up, frame.sun_itrf);
    let surface = surface_at(at);
    var color = lit(at, surface, frame.sun_itrf);
    @if(moonlight) color += frame.moon_light * lit(at, surface, frame.moon_itrf);
    @if(night_lights && clouds) color += (1.0 - surface.clouds.albedo) * city_light(at, mu_s);
    @if(night_lights && !clouds) color += city_light(at, mu_s);
    @if(air) color = through_air(color, at, mu_s);
    return color;
}
