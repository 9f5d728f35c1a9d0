// City lights: they go on at dusk. The map's values are brightness in a published picture whose tone curve is not known and
// shows hamlets beside cities; their fourth power spans the hundredfold range that radiometers find between these.
import rust::{LAMPS_FULL_SIN, LAMPS_OUT_SIN, NIGHT_LIGHTS};
@if(detail) import earth/shading/detail/lamps.wgsl;

const LAMP_COLOR: vec3f = vec3f(1.0, 0.72, 0.38);

fn city_light(at: SurfacePoint, mu_s: f32) -> vec3f {
    let is_on = 1.0 - smoothstep(LAMPS_FULL_SIN, LAMPS_OUT_SIN, mu_s);
    let glow = sample_map(light_map, light_sampler, NIGHT_LIGHTS, at).r;
    let squared = glow * glow;
    var light = squared * squared;
    @if(detail) if light * is_on > 1e-5 { light *= lamps_apart(at); }
    return surface_light.lamp_light * is_on * light * LAMP_COLOR;
}
