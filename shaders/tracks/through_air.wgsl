// A track through the air: where it lies beyond the near boundary of the air it is dimmed and veiled as all is that its pixel's
// ray meets there.
import common/air.wgsl;
import common/displayed.wgsl;

// Of premultiplied display values or light, as the target stores them.
fn through_air(color: vec4f, ray: Ray, from_eye: vec3f) -> vec4f {
    let pass_ = pass_by(ray.direction, ray.q, ray.along);
    // Where the ray meets the ground or passes nearest to the centre.
    let up = normal_at(track.frame.eye_scaled + max(ray.along - pass_.mu, 0.0) * ray.direction);
    let light = displayed(gathered(pass_, up, map_uv(up)).rgb, air.exposure, ray.pixel);
    let seen = left_through(pass_) * color.rgb + light * color.a;
    return vec4f(select(color.rgb, seen, is_beyond_air(ray, from_eye)), color.a);
}

// A ray that meets no air has none beyond.
fn is_beyond_air(ray: Ray, from_eye: vec3f) -> bool {
    let half_chord = sqrt(max((track.air_top - ray.q) * (track.air_top + ray.q), 0.0));
    return ray.q < track.air_top && dot(from_eye, ray.direction) > ray.along - half_chord;
}
