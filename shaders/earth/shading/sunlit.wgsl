// Linear light: a white sheet that faces the Sun in space is 1.
import rust::DAY;
@if(!air) import earth/shading/light_without_air.wgsl;
@if(air) import earth/shading/light_through_air.wgsl;
@if(water) import earth/shading/sea.wgsl;
@if(night_lights) import earth/shading/night_lights.wgsl;
@if(clouds) import earth/shading/clouds.wgsl;

// Light that falls on the ground: the Sun's after the air, and the sky's.
struct Light {
    sun: vec3f,
    sky: vec3f,
}

fn shade(at: SurfacePoint) -> vec3f {
    let mu_s = dot(at.up, frame.sun_itrf);
    let above = light_at(at, mu_s);
    @if(!clouds) let light = above;
    @if(clouds) let light = below_clouds(at, above, mu_s);
    let facing = max(dot(surface_normal(at), frame.sun_itrf), 0.0);
    let day = sample_map(day_map, day_sampler, DAY, at);
    var color = day.rgb * (light.sun * facing + light.sky);
    @if(water) color = mix(color, sea(at, light, mu_s, day.a), open_water(at));
    @if(night_lights) color += city_light(at, mu_s);
    @if(clouds) color = under_clouds(color, at, above);
    @if(air) color = through_air(color, at, mu_s);
    return color;
}
