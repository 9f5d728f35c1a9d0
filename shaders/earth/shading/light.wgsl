// Light that falls on the ground, and on the clouds over it.
@if(air) import common/air.wgsl;
@if(air) import rust::SUNLIGHT_SIZE;
@else import rust::SUN_RADIUS_RAD;
@if(eclipse) import common/eclipse.wgsl;

// Sunlight after the air, and skylight.
struct Light {
    sun: vec3f,
    sky: vec3f,
}

// Direct sunlight and skylight on horizontal ground, including multiple reflection between ground and air.
@if(air)
fn light_at(at: SurfacePoint, mu_s: f32) -> Light {
    @if(interpolated) let sun = at.air.sun;
    @else let sun = sunlight(mu_s, OF_GROUND);
    @if(interpolated) let sky = at.air.sky;
    @else let sky = sunlight(mu_s, OF_SKY);
    // (direct + sky)/(1 − A s) is direct + sky + (direct + sky)·A s/(1 − A s).
    let again = sent_up(at.center_uv + at.uv) * air.sky_albedo;
    return Light(sun, sky * (1.0 + again) + sun * max(mu_s, 0.0) * again);
}
@else
fn light_at(at: SurfacePoint, mu_s: f32) -> Light {
    return Light(light_of_disc(mu_s), vec3f(0.0));
}

// Rows of the table: transmittance of sunlight to the ground, skylight on black ground, and the same two for the clouds.
@if(air) const OF_GROUND: f32 = 0.5 / 4.0;
@if(air) const OF_SKY: f32 = 1.5 / 4.0;
@if(air && clouds) const OF_CLOUDS: f32 = 2.5 / 4.0;
@if(air && clouds) const OF_SKY_ON_CLOUDS: f32 = 3.5 / 4.0;

@if(air)
fn sunlight(mu: f32, row: f32) -> vec3f {
    let at = vec2f(table_coordinate(sun_coordinate(mu), SUNLIGHT_SIZE.x), row);
    return textureSampleLevel(sunlight_table, table_sampler, at, 0.0).rgb;
}

// The Sun's disc sets gradually.
@if(!air)
fn light_of_disc(above_horizon: f32) -> vec3f {
    return vec3f(smoothstep(-SUN_RADIUS_RAD, SUN_RADIUS_RAD, above_horizon));
}

// Fraction of light that the Moon leaves at a place on the ground, and at the clouds in front of it. The sky there is as dark as the place: light
// from beyond the shadow is neglected.
@if(eclipse)
fn eclipsed(light: Light, at: SurfacePoint) -> Light {
    @if(relief) let height = at.height_m / frame.radius_m;
    @else let height = 0.0;
    let left = sun_left(frame.shadow, place_over(at.up, height, frame.polar_stretch));
    return Light(left * light.sun, left * light.sky);
}

@if(eclipse && clouds)
fn sun_left_to_clouds(clouds: CloudsBefore) -> vec3f {
    return sun_left_at_clouds(clouds.lift.up);
}

// With their vertical.
@if(eclipse && clouds)
fn sun_left_at_clouds(up: vec3f) -> vec3f {
    return sun_left(frame.shadow, place_over(up, surface_light.cloud_height, frame.polar_stretch));
}
