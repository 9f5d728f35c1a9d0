// What the air before a point of the ground does to its light.
import common/air.wgsl;
@if(!inside) import earth/shading/air_before/from_outside.wgsl;
@if(inside) import earth/shading/air_before/from_inside.wgsl;
@if(relief) import earth/shading/air_before/thinned.wgsl;
@if(eclipse) import earth/shading/air_before/eclipsed.wgsl;

// What it leaves of the ground's light, and what it adds.
struct AirBefore {
    through: vec3f,
    light: vec3f,
}

// The ground's light as the eye sees it. `mu_s` is the cosine of the Sun's zenith angle there.
fn through_air(color: vec3f, at: SurfacePoint, mu_s: f32) -> vec3f {
    let air_ = air_before(at, mu_s);
    @if(!eclipse) return air_.through * color + air_.light;
    @if(eclipse) return air_.through * color + sun_on_air_before(at) * air_.light;
}
