// Effect of the air on the light of clouds: the air above their layer, which has its own tables as if the layer were the ground.
import earth/shading/light.wgsl;

// At a cloud over a place whose normal is `up`, seen along `ray`, under a Sun.
@if(!inside)
fn air_above_clouds(up: vec3f, ray: vec3f, sun: vec3f) -> AirOfClouds {
    let mu = clamp(-dot(ray, up), 0.0, 1.0);
    let mu_s = dot(up, sun);
    let x = cloud_coordinate(mu);
    let parts = scattered_parts(x, mu, ray, sun, mu_s);
    return AirOfClouds(sunlight(mu_s, OF_CLOUDS), sunlight(mu_s, OF_SKY_ON_CLOUDS), through_at(x), parts.black.rgb, parts.bounce);
}

// For an eye in the air, the air in front of the clouds is computed as a fraction of that in front of the ground.
@if(inside)
fn air_above_clouds(up: vec3f, ray: vec3f, sun: vec3f) -> AirOfClouds {
    let mu_s = dot(up, sun);
    let none = vec3f(0.0);
    return AirOfClouds(sunlight(mu_s, OF_CLOUDS), sunlight(mu_s, OF_SKY_ON_CLOUDS), none, none, none);
}

// Sunlight and skylight on a cloud, including multiple reflection between clouds and air. `about`: albedo of the neighbourhood.
fn light_on_clouds(air_: AirOfClouds, mu_s: f32, about: vec3f) -> Light {
    let again = sent_up_by(about, air.sky_albedo_of_clouds) * air.sky_albedo_of_clouds;
    return Light(air_.sun, air_.sky * (1.0 + again) + air_.sun * max(mu_s, 0.0) * again);
}

fn added_above_clouds(air_: AirOfClouds, about: vec3f) -> vec3f {
    return air_.black + sent_up_by(about, air.sky_albedo_of_clouds) * air_.bounce;
}
