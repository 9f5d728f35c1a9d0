// City lights of a map. Its values come from a published image with an unknown tone curve that shows hamlets beside cities; their fourth power
// spans the hundredfold range that radiometers measure between these.
//
// Where points draw the lights (lamps_as_points), only what the air scatters of them.
import rust::{LAMP_COLOR, NIGHT_LIGHTS};
@if(lamps_as_points) import rust::LAMP_GLOW;
import earth/shading/lamps.wgsl;
@if(detail && !lamps_as_points) import earth/shading/detail.wgsl;

fn city_light(at: SurfacePoint, mu_s: f32) -> vec3f {
    let is_on = lamps_on(mu_s);
    let glow = sample_map(light_map, light_sampler, NIGHT_LIGHTS, at).r;
    let squared = glow * glow;
    var light = squared * squared;
    @if(lamps_as_points) light *= LAMP_GLOW;
    @if(detail && !lamps_as_points) if light * is_on > 1e-5 {
        light *= lamps_apart(at);
    }
    return frame.lamp_light * is_on * light * LAMP_COLOR;
}

// Below the map's texel size, lamps are dense in a town's centre and along its streets. Contrast of towns with their surroundings, down to spacings
// of 1 km (equatorial radii).
@if(detail && !lamps_as_points) const TOWN_CONTRAST: f32 = 2.0;
@if(detail && !lamps_as_points) const FINEST_TOWN: f32 = 1.6e-4;
// Streets are the zero crossings of noise: those between towns and those inside them, on lattices of 5 and 1.2 km. Fraction of the light along
// them.
@if(detail && !lamps_as_points) const STREETS: array<f32, 2> = array<f32, 2>(8e-4, 1.9e-4);
@if(detail && !lamps_as_points) const STREET_SHARE: f32 = 0.65;
// Half the width of a street, in values of the noise, and the noise's probability density at 0 times √π.
@if(detail && !lamps_as_points) const STREET_WIDTH: f32 = 0.06;
@if(detail && !lamps_as_points) const STREET_DENSITY: f32 = 1.758;

// Brightness of a place relative to the map; the mean is 1.
@if(detail && !lamps_as_points)
fn lamps_apart(at: SurfacePoint) -> f32 {
    let pixel = pixel_radii(at);
    let texel = texel_radii(NIGHT_LIGHTS, at, textureDimensions(light_map));
    var light = uneven_factor(TOWN_CONTRAST, detail(at.up, texel, max(pixel, 0.4 * FINEST_TOWN), 1.0));
    for (var i = 0; i < 2; i++) {
        let spacing = STREETS[i];
        let share = STREET_SHARE * shown(spacing, 2.0 * pixel);
        if share > 0.0 {
            light *= 1.0 - share + share * street(at.up / spacing, pixel / spacing);
        }
    }
    return light;
}

@if(detail && !lamps_as_points)
fn street(at: vec3f, pixel: f32) -> f32 {
    let off = value_noise(at);
    let width = sqrt(STREET_WIDTH * STREET_WIDTH + pixel * pixel);
    return exp(-off * off / (width * width)) / (STREET_DENSITY * width);
}
