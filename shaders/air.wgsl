// The halo: the air beside the Earth, on a ring around the limb at the distance where rays leave the air. Ground and spacecraft in front of that
// hide it, and it covers everything behind the Earth.
//
// `AirVariant` in src/gpu/shader/air.rs lists the legal combinations of conditions: inside (the eye is in the air), moonlight, eclipse, and those
// of common/displayed.wgsl.
//
// It is blended over the background: as light if that is developed after the pass; on 8-bit targets as displayed colour, each layer with its own
// tone curve. Its alpha is the fraction of background light that it absorbs.
import common/air.wgsl;
import common/displayed.wgsl;
@if(eclipse) import common/air/eclipsed.wgsl;

struct Varying {
    @builtin(position) clip: vec4f,
    // Relative to the eye, billboard frame.
    @location(0) ray: vec3f,
}

@vertex
fn vertex(@location(0) clip: vec4f, @location(1) ray: vec3f) -> Varying {
    return Varying(clip, ray);
}

// From the billboard frame to scaled space.
fn scaled(v: vec3f) -> vec3f {
    return v.x * air.across_x + v.y * air.across_y + v.z * air.toward_center;
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    // All without cancellation at any distance: q = L sin θ comes from the ray's own slope.
    let d = normalize(in.ray);
    let sin2 = dot(d.xy, d.xy);
    let pass_ = pass_by(scaled(d), air.eye_distance * sqrt(sin2), air.eye_distance * d.z);
    // Where the ray meets the ground or is nearest to it; the eye if that point is behind.
    let nearest = air.eye_distance * vec3f(d.z * d.xy, -sin2) - d * pass_.mu;
    let up = normal_at(scaled(select(vec3f(0.0, 0.0, -1.0), nearest, pass_.along > 0.0)));
    let light = gathered(pass_, up, map_uv(up));
    @if(eclipse) let shown = light.rgb * sun_on_air(pass_, scaled(nearest));
    @else let shown = light.rgb;
    return vec4f(displayed(shown, air.exposure, in.clip.xy), light.a);
}
