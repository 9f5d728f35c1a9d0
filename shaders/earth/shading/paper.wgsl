// The three layers as printed by Wang and Dai 2011 (section 1.2): n = normal texel, L = direction to the light,
//   ninfo = saturate(n·L + 0.3)·1.1
//   blend = 1 − (1 − earth)(1 − cloud)
//   out   = blend·ninfo
// in display values. n and L are both taken in Earth-fixed axes, so that the normal texel carries day and night.
@if(air) import common/displayed.wgsl;
@if(air) import earth/shading/air_before.wgsl;
import rust::DAY;
@if(clouds) import rust::CLOUDS;

fn shade(at: SurfacePoint) -> vec3f {
    let earth = sample_map(day_map, day_sampler, DAY, at).rgb;
    @if(clouds) let cloud = vec3f(sample_map(cloud_map, cloud_sampler, CLOUDS, at).r);
    @else let cloud = vec3f(0.0);
    let ninfo = saturate(dot(surface_normal(at), frame.sun_itrf) + 0.3) * 1.1;
    let blend = 1.0 - (1.0 - earth) * (1.0 - cloud);
    return blend * ninfo;
}

// Display values seen through our air: both as the target stores them.
@if(air)
fn paper_through_air(color: vec3f, at: SurfacePoint, pixel: vec2f) -> vec3f {
    let air_ = air_before(at, dot(at.up, air.sun));
    return air_.through * color + displayed(air_.light, air.exposure, pixel);
}
