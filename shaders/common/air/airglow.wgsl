// The green light of atomic oxygen, 557.7 nm, which the air sends out at night in a thin layer 95 km up. Before the ground, where
// it is a fortieth as bright as beside it, nothing of it is drawn.
import rust::AIR_RADIUS_M;

// The layer's lower and upper boundary, equatorial radii.
const AIRGLOW_RADII: vec2f = vec2f(1.0 + 90e3 / AIR_RADIUS_M, 1.0 + 99e3 / AIR_RADIUS_M);
// Sines of the Sun's elevation, −12° and −6°, between which twilight outshines it.
const AIRGLOW_TWILIGHT: vec2f = vec2f(-0.2079, -0.1045);
const AIRGLOW_RAYS: i32 = 6;
// Linear sRGB of that wavelength at luminance 1; it has less than no blue there.
const AIRGLOW_COLOR: vec3f = vec3f(0.282, 1.336, 0.0);

// `mu_s`: cosine of the Sun's zenith angle where the ray passes nearest to the Earth. `pixel`: what the ray's distance from the
// centre changes by to the next pixel. From far away the layer is thinner than that, so the mean over some rays of it is taken.
fn airglow(pass_: Pass, mu_s: f32, pixel: f32) -> vec3f {
    var way = 0.0;
    for (var n = 0; n < AIRGLOW_RAYS; n++) {
        var ray = pass_;
        ray.q += pixel * ((f32(n) + 0.5) / f32(AIRGLOW_RAYS) - 0.5);
        way += (way_below(ray, AIRGLOW_RADII.y) - way_below(ray, AIRGLOW_RADII.x)) / f32(AIRGLOW_RAYS);
    }
    let night = 1.0 - smoothstep(AIRGLOW_TWILIGHT.x, AIRGLOW_TWILIGHT.y, mu_s);
    return air.airglow * night * way / (AIRGLOW_RADII.y - AIRGLOW_RADII.x) * AIRGLOW_COLOR;
}

// How much of a ray lies within a sphere, radii.
fn way_below(pass_: Pass, radius: f32) -> f32 {
    let half_ = sqrt(max((radius - pass_.q) * (radius + pass_.q), 0.0));
    return max(pass_.along + half_, 0.0) - max(pass_.along - half_, 0.0);
}
