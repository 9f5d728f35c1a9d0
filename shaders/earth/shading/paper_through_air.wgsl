// The paper's display values under our air: both as the target stores them.
import common/displayed.wgsl;
import earth/shading/air_before.wgsl;

fn paper_through_air(color: vec3f, at: SurfacePoint, pixel: vec2f) -> vec3f {
    let air_ = air_before(at, dot(at.up, air.sun));
    return air_.through * color + displayed(air_.light, air.exposure, pixel);
}
