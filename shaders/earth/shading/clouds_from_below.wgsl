// Light from the underside of clouds.
//
// For sunlight at the cosine μ a layer reflects ρ(μ), transmits exp(−1.85 x/μ) directly (delta-Eddington, see shading/clouds.wgsl), and scatters
// the rest downwards, thin clouds mostly forwards. Its underside reflects light from the ground below.
import earth/shading/clouds.wgsl;
import earth/shading/light.wgsl;
@if(air) import rust::DAY;

// Asymmetry of the scattering after delta-Eddington scaling, g/(1 + g) with g = 0.85.
const SCALED_ASYMMETRY: f32 = 0.459;
// Sines of the Sun's elevation between which the lit side changes from the underside to the upper side.
const UNDERSIDE_LIT: vec2f = vec2f(-0.03, 0.06);

// Light that a layer of this reflectance for diffuse light, with this vertical, sends down to the eye from a Sun in this direction, its sky and the
// ground; `through` is the directly transmitted fraction of the background.
fn light_from_below(at: SurfacePoint, up: vec3f, albedo: f32, through: f32, sun: vec3f) -> vec3f {
    let thickness = scaled_thickness(albedo);
    let mu = dot(up, sun);
    let above = max(mu, CLOUD_SIDES);
    let light = light_on_layer(at, mu);
    let back = sunlit_albedo(albedo, above);
    let down = max(1.0 - back - exp(-thickness / above), 0.0);
    let cosine = dot(-normalize(at.to_eye), sun);
    let g = SCALED_ASYMMETRY;
    let forward = (1.0 - g * g) / pow(1.0 + g * g - 2.0 * g * cosine, 1.5);
    // Multiply scattered light is isotropic.
    let spread = mix(1.0, forward, exp(-thickness));
    // A Sun at the horizon lights protrusions of the underside.
    let lit_above = smoothstep(UNDERSIDE_LIT.x, UNDERSIDE_LIT.y, mu);
    var color = light.sun * mix(back * CLOUD_SIDES, down * above * spread, lit_above);
    // Light of the sky that is not transmitted directly.
    color += light.sky * max(1.0 - albedo - through, 0.0);
    let on_ground = (1.0 - back) * above * lit_above * light.sun + light.sky;
    @if(air) color += albedo * light_of_ground(at, albedo, on_ground);
    return color;
}

// Fraction of the Earth's circumference, 300 km: radius of the ground that lights the clouds.
@if(air) const GROUND_ABOUT: f32 = 0.0075;

// Light that the ground below a layer sends up where this much falls on it.
@if(air)
fn light_of_ground(at: SurfacePoint, albedo: f32, on_ground: vec3f) -> vec3f {
    return sent_up_by(ground_below(at), vec3f(albedo)) * on_ground;
}

// Mean colour of the ground.
@if(air)
fn ground_below(at: SurfacePoint) -> vec3f {
    var about = at;
    about.uv_dx = vec2f(GROUND_ABOUT, 0.0);
    about.uv_dy = vec2f(0.0, 2.0 * GROUND_ABOUT);
    return sample_map(day_map, day_sampler, DAY, about).rgb;
}

@if(air)
fn light_on_layer(at: SurfacePoint, mu: f32) -> Light {
    return Light(sunlight(mu, OF_CLOUDS), sunlight(mu, OF_SKY_ON_CLOUDS));
}
@else
fn light_on_layer(at: SurfacePoint, mu: f32) -> Light {
    return light_on_clouds(mu);
}
