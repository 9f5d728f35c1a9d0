// Synthetic detail of land below the maps' texel size: a tile of eroded terrain, at the scales of the clouds' tile. It makes colour and slopes uneven.
import earth/shading/detail_tiles.wgsl;
@if(coarse_scale) import rust::LAND_SLOPE_STEP;

@if(coarse_scale) @group(0) @binding(15) var land_tile: texture_2d<f32>;

// Strength of the fine scale, relative to the coarse one: of heights where they decide about snow, and where slopes are lit, which are as steep as
// the coarse ones.
@if(fine_scale) const FINE_HEIGHT: f32 = 0.3;
@if(fine_scale) const FINE_RELIEF: f32 = 0.06;
// Eroded terrain is never empty, so the fine scale fades out over these mip levels.
@if(fine_scale) const FADING_LEVELS: f32 = 2.0;

// Structures of land: patches of different brightness, the height of terrain, and the change of the latter along the ground, per equatorial radius.
struct LandDetail {
    patches: Detail,
    height: Detail,
    change: vec3f,
}

@if(coarse_scale)
fn land_structure(up: vec3f, texel: f32, pixel: f32) -> LandDetail {
    let shown = shown_detail(texel, pixel);
    var out: LandDetail;
    if shown == 0.0 { return out; }
    out = land_of_scale(up, scale_at(COARSE_TILES, texel, pixel));
    @if(fine_scale) out = with_finer_land(out, up, texel, pixel);
    out.patches = scaled(shown, out.patches);
    out.height = scaled(shown, out.height);
    out.change *= shown;
    return out;
}
@else
fn land_structure(up: vec3f, texel: f32, pixel: f32) -> LandDetail {
    return LandDetail(Detail(0.0, 0.0), Detail(0.0, 0.0), vec3f(0.0));
}

@if(coarse_scale)
fn land_of_scale(up: vec3f, scale: Scale) -> LandDetail {
    let place = place_on_tile(up, scale);
    let read = sample_land(place, scale);
    return LandDetail(value_of(read.r, scale), value_of(read.g, scale), change_of(read, scale, place.side, LAND_SLOPE_STEP));
}

@if(fine_scale)
fn with_finer_land(coarse: LandDetail, up: vec3f, texel: f32, pixel: f32) -> LandDetail {
    let scale = scale_at(FINE_TILES, texel, pixel);
    let shown = 1.0 - smoothstep(EMPTY_LEVEL - FADING_LEVELS, EMPTY_LEVEL, scale.level);
    if shown == 0.0 { return coarse; }
    let fine = land_of_scale(FINE_TURN * up, scale);
    return LandDetail(
        plus(coarse.patches, FINE_STRENGTH * shown, fine.patches),
        plus(coarse.height, FINE_HEIGHT * shown, fine.height),
        coarse.change + FINE_RELIEF * shown * (fine.change * FINE_TURN),
    );
}

@if(coarse_scale)
fn sample_land(place: TilePlace, scale: Scale) -> vec4f {
    return shown_at(place, textureSampleLevel(land_tile, detail_sampler, place.uv, scale.level));
}

// Dark land is a mosaic of woods and fields, bright land is desert or snow: contrast of patches, whose mean is the map's colour. Woods are greener.
const WOODS_CONTRAST: vec3f = vec3f(0.5, 0.4, 0.4);
const BRIGHT_CONTRAST: vec3f = vec3f(0.15);
const PATCHES: f32 = 1.5;
// Contrast of the share of snow, as for clouds. In mountains it lies on ridges and melts in valleys; in plains it is seen where there are no woods.
const MOUNTAIN_SNOW: f32 = 1.6;
const PLAIN_SNOW: f32 = 1.0;
// Land of the first slope of the map is a plain, land of the second one mountains.
const PLAIN_SLOPE: f32 = 0.002;
const MOUNTAIN_SLOPE: f32 = 0.006;
// Reflectance of snow, and that of the ground below it.
const SNOW_REFLECTANCE: vec3f = vec3f(0.75, 0.76, 0.78);
const BARE_REFLECTANCE: vec3f = vec3f(0.07, 0.06, 0.05);

// Colour of land with these structures where the map has this slope. Its mean is approximately preserved.
fn land_with_detail(color: vec3f, slope: f32, land: LandDetail) -> vec3f {
    let snow = snow_share(color);
    let mountains = smoothstep(PLAIN_SLOPE, MOUNTAIN_SLOPE, slope);
    let lies = plus(scaled(1.0 - mountains, land.patches), mountains, land.height);
    let more_snow = uneven_share(snow, mix(PLAIN_SNOW, MOUNTAIN_SNOW, mountains), lies) - snow;
    let contrast = mix(WOODS_CONTRAST, BRIGHT_CONTRAST, smoothstep(0.1, 0.4, color.r));
    let patches = 1.0 + contrast * (2.0 * uneven_share(0.5, PATCHES, land.patches) - 1.0);
    return max(color * patches + more_snow * (SNOW_REFLECTANCE - BARE_REFLECTANCE), vec3f(0.0));
}

// Share of snow in a colour of the map: bright, and neither yellow, as sand is, nor blue, as water is.
fn snow_share(color: vec3f) -> f32 {
    let blue = color.b / max(color.r, 1e-3);
    let white = smoothstep(0.5, 0.7, blue) * (1.0 - smoothstep(1.2, 1.6, blue));
    let least = min(color.r, min(color.g, color.b));
    return white * saturate((least - BARE_REFLECTANCE.b) / (SNOW_REFLECTANCE.b - BARE_REFLECTANCE.b));
}

// Height of structures in lengths of a texel, per slope of the map: mountains are rugged, plains are smooth. Slopes over 170 m are eight times those of
// the map, as in the Sangre de Cristo Mountains of Colorado.
@if(normals) const RUGGEDNESS: f32 = 1.5;
// The steepest slope of the starter map, whose texels are 20 km wide: finer maps show more of the terrain themselves.
@if(normals) const MOST_RUGGED: f32 = 0.06;

// Normal of the ground with these structures, for a map with texels of this size, equatorial radii, and with this slope. It is as long as its facet is
// larger than the ground below it, so that the mean of the light on it is that of the map.
@if(normals)
fn normal_with_detail(normal: vec3f, slope: f32, change: vec3f, texel: f32) -> vec3f {
    return normal - RUGGEDNESS * min(slope, MOST_RUGGED) * texel * change;
}
