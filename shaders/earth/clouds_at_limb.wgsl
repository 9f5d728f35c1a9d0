// Clouds above the edge of the ground, for an eye outside the air: where a ray passes the ground and enters the clouds' layer. They continue the
// clouds in front of the ground, and the edge of the ground does not show through them.
import rust::{LIMB_SEGMENTS, PI};
import common/displayed.wgsl;
import earth/shading/clouds.wgsl;
import earth/shading/light.wgsl;
import earth/surface_point/on_whole_map.wgsl;

struct Varying {
    @builtin(position) clip: vec4f,
}

// A ring of quads of two triangles, from the edge of the ground to that of the layer. At the farthest depth: everything in front of the sky hides it.
@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Varying {
    let corner = index % 6u;
    let is_next = corner == 1u || corner == 2u || corner == 4u;
    let is_outer = corner >= 2u && corner <= 4u;
    let turn = f32(index / 6u + select(0u, 1u, is_next)) * (2.0 * PI / f32(LIMB_SEGMENTS));

    let away = normalize(frame.eye_scaled);
    let across = normalize(cross(away, select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 0.0, 1.0), abs(away.z) < 0.7)));
    let other = cross(away, across);
    // Tangents of the angles from the centre at which the ground and the layer end. Chords between the outer corners pass outside of the layer.
    let ground = inverseSqrt(frame.above);
    let layer = sqrt((1.0 + clouds_above()) / (frame.above - clouds_above())) / cos(PI / f32(LIMB_SEGMENTS));
    let direction = -away + select(ground, layer, is_outer) * (cos(turn) * across + sin(turn) * other);
    let ray = frame.radius_m * direction * vec3f(1.0, 1.0, 1.0 / frame.polar_stretch);
    let clip = frame.clip_from_eye * vec4f(ray, 1.0);
    return Varying(vec4f(clip.xy, 0.0, clip.w));
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    let ray = pixel_ray(in.clip.xy);
    let stretch = vec3f(1.0, 1.0, frame.polar_stretch);
    let stretched = ray * stretch;
    let direction = normalize(stretched);
    // Square of the ray's least distance from the centre, less 1.
    let nearest = length(cross(frame.eye_scaled, direction));
    let lowest = (nearest - 1.0) * (nearest + 1.0);
    let top = clouds_above();
    let distance = -dot(frame.eye_scaled, direction) - sqrt(max(top - lowest, 0.0));
    let up = normalize((frame.eye_scaled + distance * direction) * stretch);

    let at = on_whole_map(seen_along(ray, distance / length(stretched), up));
    let clouds = clouds_at(at, Lifted(up, vec2f(0.0)), frame.clouds_before);
    if lowest < 0.0 || lowest >= top || clouds.albedo <= 0.0 {
        discard;
    }
    // The fraction of the clouds whose tops are above the ray.
    let higher = frame.clouds_at_limb * (1.0 - smoothstep(0.0, top, lowest));
    @if(air) let color = clouds_seen(at, clouds, AirBefore(vec3f(1.0), vec3f(0.0)));
    @else let color = clouds_seen(at, clouds);
    return vec4f(displayed(higher * color, frame.exposure, in.clip.xy), higher * clouds.albedo);
}
