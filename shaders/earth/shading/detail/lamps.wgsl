// City lights between their map's texels: lamps stand close in a town's heart and along its streets.
import rust::NIGHT_LIGHTS;
import earth/shading/detail.wgsl;

// How much towns differ from what is about them, down to spacings of 1 km (equatorial radii).
const TOWN_CONTRAST: f32 = 2.0;
const FINEST_TOWN: f32 = 1.6e-4;
// Streets run where noise changes its sign: those between towns and those in them, lattices of 5 and 1.2 km. What of the light
// stands in them.
const STREETS: array<f32, 2> = array<f32, 2>(8e-4, 1.9e-4);
const STREET_SHARE: f32 = 0.65;
// Half the width of a street, in values of the noise, and the noise's density at 0 times √π.
const STREET_WIDTH: f32 = 0.06;
const STREET_DENSITY: f32 = 1.758;

// How much brighter a place is than the map has it; the mean is 1.
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

fn street(at: vec3f, pixel: f32) -> f32 {
    let off = value_noise(at).w;
    let width = sqrt(STREET_WIDTH * STREET_WIDTH + pixel * pixel);
    return exp(-off * off / (width * width)) / (STREET_DENSITY * width);
}
