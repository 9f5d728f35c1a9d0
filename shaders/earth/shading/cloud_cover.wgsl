// Cloud cover of a pixel.
import rust::{CLOUDS, PI};
@if(detail) import earth/shading/detail_tiles.wgsl;

// Where the ray from the eye to a place crosses the clouds' layer.
fn lifted_before(at: SurfacePoint) -> Lifted {
    let to_eye = normalize(at.to_eye);
    return lifted(at, to_eye, max(dot(to_eye, at.up), 0.0));
}

fn cover_at(at: SurfacePoint, lift: Lifted) -> f32 {
    @if(!detail) return mapped_cover(at, lift);
    @if(detail) return uneven_cover(mapped_cover(at, lift), structure(lift.up, cloud_texel_radii(at), pixel_radii(at)));
}

// For shadows, whose edges are soft: only with the larger scale of detail.
@if(cloud_shadows)
fn soft_cover_at(at: SurfacePoint, lift: Lifted) -> f32 {
    @if(!detail) return mapped_cover(at, lift);
    @if(detail) return uneven_cover(mapped_cover(at, lift), soft_structure(lift.up, cloud_texel_radii(at), pixel_radii(at)));
}

@if(detail)
fn uneven_cover(mapped: f32, made: Detail) -> f32 {
    return THICKEST_CLOUD * uneven_share(mapped / THICKEST_CLOUD, CLOUD_CONTRAST, made);
}

fn mapped_cover(at: SurfacePoint, lift: Lifted) -> f32 {
    var moved = at;
    moved.uv += map_shift(CLOUDS, at, vec2f(textureDimensions(cloud_map)), lift.uv);
    return sample_map(cloud_map, cloud_sampler, CLOUDS, moved).r;
}

fn cloud_texel_radii(at: SurfacePoint) -> f32 {
    return texel_radii(CLOUDS, at, textureDimensions(cloud_map));
}

@if(detail) const CLOUD_CONTRAST: f32 = 1.6;
// Reflectance of the thickest part of a cloud, relative to the mean of a cloud that is thick throughout. The map ends at that mean: without it, the
// tops of weather systems would be evenly white.
@if(detail) const THICKEST_CLOUD: f32 = 1.2;

// A point of a layer above the ground, seen from a place on the ground.
struct Lifted {
    // Normal of the ellipsoid below the point.
    up: vec3f,
    // The point's texture coordinates relative to the place's.
    uv: vec2f,
}

// Moved by a step along the ground, equatorial radii: steps are short, and near the poles they are bounded.
fn moved(at: SurfacePoint, lift: Lifted, step: vec3f) -> Lifted {
    let east = dot(at.east, step) / max(length(at.up.xy), 0.03);
    return Lifted(normalize(lift.up + step), lift.uv + vec2f(0.5 * east, -dot(at.north, step)) / PI);
}

// How far the layer is above the ground, as `frame.above` for the eye: (1 + h)² − 1 without cancellation.
fn clouds_above() -> f32 {
    return surface_light.cloud_height * (2.0 + surface_light.cloud_height);
}

// Where the ray from `at` in a direction at this cosine to the vertical crosses the clouds' layer. The Earth is approximated by a sphere: a layer
// at 10 km is displaced by 30 m at most.
fn lifted(at: SurfacePoint, towards: vec3f, cosine: f32) -> Lifted {
    // (1 + h)² = 1 + 2 s cos + s².
    let above = clouds_above();
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
