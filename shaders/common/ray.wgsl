// A pixel's ray in scaled space: its unit direction, the distance of its line from the centre, and the distance along it to the point nearest to
// the centre.
import common/frame.wgsl;

struct Ray {
    pixel: vec2f,
    direction: vec3f,
    q: f32,
    along: f32,
}

fn ray_through(frame: FrameUniforms, pixel: vec2f) -> Ray {
    let ray = frame.corner_ray + pixel.x * frame.pixel_right + pixel.y * frame.pixel_down;
    return ray_along(frame, ray * vec3f(1.0, 1.0, frame.polar_stretch), pixel);
}

// In a direction of scaled space, which need not be a unit.
fn ray_along(frame: FrameUniforms, towards: vec3f, pixel: vec2f) -> Ray {
    var out: Ray;
    out.pixel = pixel;
    out.direction = normalize(towards);
    out.q = length(cross(frame.eye_scaled, out.direction));
    out.along = -dot(frame.eye_scaled, out.direction);
    return out;
}
