// What the Moon leaves of the light on a place of the ground, and on the clouds before it. The sky there is as dark as the place: light
// from beyond the shadow does not come in.
import common/eclipse.wgsl;

fn eclipsed(light: Light, at: SurfacePoint) -> Light {
    @if(!relief) let height = 0.0;
    @if(relief) let height = at.height_m / frame.radius_m;
    let left = sun_left(frame.shadow, place_over(at.up, height, frame.polar_stretch));
    return Light(left * light.sun, left * light.sky);
}

@if(clouds) fn sun_left_to_clouds(clouds: CloudsBefore) -> vec3f { return sun_left(frame.shadow, place_over(clouds.up, surface_light.cloud_height, frame.polar_stretch)); }
