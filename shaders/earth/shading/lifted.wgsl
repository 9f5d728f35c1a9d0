// A point of a layer above the ground, seen from a place of the ground.
import rust::PI;

struct Lifted {
    // Normal of the ellipsoid below the point.
    up: vec3f,
    // The point's texture coordinates less the place's.
    uv: vec2f,
}

// Where the ray from `at` in a direction at this cosine to the vertical reaches the height, equatorial radii. The Earth is a
// sphere for it: a height of 10 km is moved by 30 m at most.
fn lifted(at: SurfacePoint, towards: vec3f, cosine: f32, height: f32) -> Lifted {
    // (1 + h)² = 1 + 2 s cos + s² without cancellation.
    let above = height * (2.0 + height);
    let s = above / (sqrt(cosine * cosine + above) + cosine);
    let east = s * dot(at.east, towards);
    let north = s * dot(at.north, towards);
    let up = 1.0 + s * cosine;
    var out: Lifted;
    out.up = normalize(up * at.up + east * at.east + north * at.north);
    // In the plane of the place's meridian: outwards from the axis, and along it.
    let across = length(at.up.xy);
    let outwards = up * across - north * at.up.z;
    let along = up * at.up.z + north * across;
    let longitude = atan2(east, outwards);
    let rho = length(vec2f(east, outwards));
    // sin and cos of the change of latitude, both times 1 + h; the angle is small.
    let t = (along * across - rho * at.up.z) / (along * at.up.z + rho * across);
    let latitude = t * (1.0 - t * t / 3.0);
    out.uv = vec2f(0.5 * longitude, -latitude) / PI;
    return out;
}
