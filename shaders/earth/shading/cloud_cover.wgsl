// How much of a pixel clouds cover.
import rust::CLOUDS;
import earth/shading/lifted.wgsl;
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
    @if(detail) if cover > 0.01 && cover < 0.99 { cover = uneven_share(cover, CLOUD_CONTRAST, detail(lift.up, texel_radii(CLOUDS, at, textureDimensions(cloud_map)), pixels * pixel_radii(at), 0.75)); }
    return cover;
}

@if(detail) const CLOUD_CONTRAST: f32 = 4.0;
