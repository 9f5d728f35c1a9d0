// How much of a pixel clouds cover.
import rust::{CLOUDS, PI};
@if(detail) import earth/shading/detail.wgsl;

// Where the ray from the eye to a place goes through the clouds' layer.
fn lifted_before(at: SurfacePoint) -> Lifted {
    let to_eye = normalize(at.to_eye);
    return lifted(at, to_eye, max(dot(to_eye, at.up), 0.0), surface_light.cloud_height);
}

// In pixels of this size, as a part of the picture's: detail smaller than that is left out.
fn cover_at(at: SurfacePoint, lift: Lifted, pixels: f32) -> f32 {
    var moved = at;
    moved.uv += map_shift(CLOUDS, at, vec2f(textureDimensions(cloud_map)), lift.uv);
    var cover = sample_map(cloud_map, cloud_sampler, CLOUDS, moved).r;
    @if(detail) if cover > 0.01 && cover < 0.99 {
        let texel = texel_radii(CLOUDS, at, textureDimensions(cloud_map));
        cover = uneven_share(cover, CLOUD_CONTRAST, detail(lift.up, texel, pixels * pixel_radii(at), 0.75));
    }
    return cover;
}

@if(detail) const CLOUD_CONTRAST: f32 = 4.0;

// A point of a layer above the ground, seen from a place of the ground.
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
