// The air before ground with relief, as a part of the air before the smooth ground: by an exponential profile, since only the part
// counts.
import rust::AIR_SCALE_HEIGHT_M;
@if(inside) import earth/shading/air_before/part_before.wgsl;

// `part` of the optical depth, and of the light as if its source were the same all along.
fn thinned(air_: AirBefore, part: f32) -> AirBefore {
    let through = pow(max(air_.through, vec3f(1e-6)), vec3f(part));
    return AirBefore(through, air_.light * (1.0 - through) / max(1.0 - air_.through, vec3f(1e-6)));
}
