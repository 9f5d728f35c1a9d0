// Open water: water-leaving light, reflected sky, sunglint and foam. Radiance relative to a white sheet that faces the Sun in space.
import rust::{FLOOR_SEEN_M, PI, SEA_REFLECTANCE, SEA_WATER_INDEX};
@if(!open_sea) import earth/shading/open_water.wgsl;
@if(detail) import earth/shading/detail_tiles.wgsl;

// Water-leaving reflectance of clear ocean: π times the remote-sensing reflectance of Case 1 water with 0.1 mg of chlorophyll a in a cubic metre,
// by Morel 1988 (J. Geophys. Res. 93, 10749) with the absorption of pure water of Pope and Fry 1997 (Appl. Opt. 36, 8710), from 400 to 700 nm,
// converted to linear sRGB with the Sun as white. Its red would be −0.0015: this blue is outside the display's gamut.
const WATER_LEAVING: vec3f = vec3f(0.0, 0.0042, 0.0194);
// The floor's reflectance, 0.3 for pale sand, times the fraction of its light that leaves the water (0.53).
const FLOOR_REFLECTANCE: f32 = 0.16;
// Down to the floor and up again, twice the diffuse attenuation of that water for the display's primaries, per metre.
const FLOOR_ATTENUATION: vec3f = vec3f(0.68, 0.124, 0.056);

// Water-leaving reflectance of shelf water with 3 mg of chlorophyll a and 3 g of mineral particles in a cubic metre, and coloured dissolved matter
// that absorbs 0.2 a metre at 443 nm: absorption by Pope and Fry 1997, Bricaud and others 1998 and Babin and others 2003 (J. Geophys. Res. 108,
// 3211), 1.8 % of 0.51 m² a gram scattered back, reflectance by Lee, Carder and Arnone 2002 (Appl. Opt. 41, 5755). It is green and brown.
const SHELF_LEAVING: vec3f = vec3f(0.0139, 0.0327, 0.0117);
// Sines of the latitudes between which shelves become turbid, 25° and 40°: rivers, tides and winter storms stir them. Tropical shelves with corals
// are clear.
const CLEAR_SHELVES: f32 = 0.423;
const TURBID_SHELVES: f32 = 0.643;

// Fraction of shelf water at a place: 1 where its floor is at most half as deep as the visible limit.
fn shelf_water(at: SurfacePoint, depth: f32) -> f32 {
    return smoothstep(CLEAR_SHELVES, TURBID_SHELVES, abs(at.up.z)) * smoothstep(0.0, 0.5, 1.0 - depth);
}

// `sun`: direction of the light source. `depth`: alpha of the day map, the floor's depth in FLOOR_SEEN_M.
fn sea(at: SurfacePoint, light: Light, sun: vec3f, mu_s: f32, depth: f32) -> vec3f {
    let to_eye = normalize(at.to_eye);
    let cos_eye = max(dot(to_eye, at.up), 1e-3);
    let through = exp(-FLOOR_SEEN_M * depth * FLOOR_ATTENUATION);
    let seen = (1.0 - depth) * (1.0 - depth);
    let clear = WATER_LEAVING * (1.0 - through) + FLOOR_REFLECTANCE * seen * through;
    let leaving = mix(clear, SHELF_LEAVING, shelf_water(at, depth));
    let falls = light.sun * max(mu_s, 0.0) + light.sky;
    // The sky reflected by waves, with the mean Fresnel reflectance over their slopes: Bruneton, Neyret and Holzschuch 2010, equation 18.
    let grazing = pow(1.0 - cos_eye, surface_light.mirror_power) * surface_light.mirror_scale;
    let mirrored = SEA_REFLECTANCE + (1.0 - SEA_REFLECTANCE) * grazing;
    return falls * (leaving + surface_light.foam) + light.sky * mirrored + light.sun * glint(at, to_eye, cos_eye, sun, mu_s);
}

// Sunlight reflected by the waves, per light on a sheet that faces the Sun. Cox and Munk 1954 (J. Opt. Soc. Am. 44, 838): slopes of the waves are
// Gaussian with mean square σ².
//   L/E = ρ(ω) p(β) G / (4 cos θ cos⁴β),  p = exp(−tan²β/σ²)/(πσ²)
// G is the masking and shadowing of waves: Smith 1967 in the rational form of Walter et al. 2007.
fn glint(at: SurfacePoint, to_eye: vec3f, cos_eye: f32, sun: vec3f, mu_s: f32) -> f32 {
    let half_way = normalize(to_eye + sun);
    let cos_beta = max(dot(half_way, at.up), 1e-3);
    let cos_squared = cos_beta * cos_beta;
    let tan_squared = (1.0 - cos_squared) / cos_squared;
    @if(!detail) let waves = surface_light.wave_slope_squared;
    @if(detail) let waves = uneven_waves(at, tan_squared);
    let slopes = exp(-tan_squared / waves) / (PI * waves);
    let unhidden = 1.0 / (1.0 + hidden(cos_eye) + hidden(max(mu_s, 1e-3)));
    // A white sheet that faces the Sun is L = E/π.
    return PI * fresnel(dot(half_way, to_eye)) * slopes * unhidden / (4.0 * cos_eye * cos_squared * cos_squared);
}

// The wind is uneven: gusts, currents and slicks make streaks in the glint, a few to some 50 km long. Tiles along an edge of the cube, and the
// standard deviation of the logarithm of the mean square slope: the centre of the glint varies by a third.
@if(detail) const WIND_TILES: f32 = 6.0;
@if(detail) const WIND_CONTRAST: f32 = 0.45;
// Axes permuted, so that the structures differ from those of the clouds.
@if(detail) const WIND_AXES: vec3f = vec3f(-1.0, -1.0, 1.0);

// Mean square slope of the waves at a place that would reflect the Sun at this slope.
@if(detail)
fn uneven_waves(at: SurfacePoint, tan_squared: f32) -> f32 {
    let waves = surface_light.wave_slope_squared;
    let in_glint = 1.0 - smoothstep(6.0, 16.0, tan_squared / waves);
    if in_glint == 0.0 { return waves; }
    // There is no map of the wind: all scales are shown.
    let made = structure_of_size(WIND_AXES * at.up.zxy, WIND_TILES, 1.0, 2.0 * pixel_radii(at));
    return waves * uneven_factor(in_glint * WIND_CONTRAST, made);
}

// Smith's Λ for light that leaves at this cosine.
fn hidden(cosine: f32) -> f32 {
    let a = cosine * inverseSqrt(surface_light.wave_slope_squared * max(1.0 - cosine * cosine, 1e-6));
    return select((1.0 - a * (1.259 - 0.396 * a)) / (a * (3.535 + 2.181 * a)), 0.0, a >= 1.6);
}

// Reflectance of a smooth water surface for unpolarised light and the cosine of the angle of incidence, by Fresnel's equations
// in the form of Cook and Torrance 1982, with c = cos ω and g² = n² − 1 + c²:
//   ρ = ½ ((g − c)/(g + c))² (1 + ((c(g + c) − 1)/(c(g − c) + 1))²)
fn fresnel(cos_incidence: f32) -> f32 {
    let c = saturate(cos_incidence);
    let g = sqrt(SEA_WATER_INDEX * SEA_WATER_INDEX - 1.0 + c * c);
    let apart = (g - c) / (g + c);
    let ratio = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
    return 0.5 * apart * apart * (1.0 + ratio * ratio);
}
