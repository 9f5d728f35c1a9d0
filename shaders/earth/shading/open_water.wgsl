// Water fraction of a pixel.
import rust::WATER;
@if(detail) import earth/shading/detail.wgsl;

// Strength of the displacement of coasts below the map's texel size.
@if(detail) const COAST_CONTRAST: f32 = 2.3;

@if(detail)
fn coast_detail(at: SurfacePoint, share: f32) -> f32 {
    let texel = texel_radii(WATER, at, textureDimensions(water_map));
    return uneven_share(share, COAST_CONTRAST, detail(at.up, texel, pixel_radii(at), 0.4));
}

// The map is one half at the coast, which is drawn as wide as a pixel if texels are larger than pixels; otherwise the pixel shows the map's own
// mean.
fn open_water(at: SurfacePoint) -> f32 {
    var share = sample_map(water_map, water_sampler, WATER, at).r;
    @if(detail) if share > 0.02 && share < 0.98 {
        share = coast_detail(at, share);
    }
    let per_map = map_texels(WATER, at, vec2f(textureDimensions(water_map)));
    let footprint = max(length(at.uv_dx * per_map), length(at.uv_dy * per_map));
    return saturate((share - 0.5) / clamp(0.7 * footprint, 1e-3, 1.0) + 0.5);
}
