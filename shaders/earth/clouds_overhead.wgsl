// Clouds in the sky for an eye below them: the same layer from beneath, over everything behind it.
//
// For sunlight at the cosine μ a layer reflects ρ(μ), transmits exp(−1.85 x/μ) directly (delta-Eddington, see shading/clouds.wgsl), and scatters
// the rest downwards, thin clouds mostly forwards. Its underside reflects light from the ground below.
import common/displayed.wgsl;
import earth/shading/clouds.wgsl;
import earth/shading/light.wgsl;
import earth/surface_point/on_whole_map.wgsl;
@if(air) import rust::DAY;

struct Varying {
    @builtin(position) clip: vec4f,
}

// At the farthest depth: everything in front of the sky hides it.
@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Varying {
    return Varying(vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0));
}

// Lowest elevation angle for the path through the layer, as sine: it is not perfectly flat.
const LOWEST_SIGHT: f32 = 0.03;
// Asymmetry of the scattering after delta-Eddington scaling, g/(1 + g) with g = 0.85.
const SCALED_ASYMMETRY: f32 = 0.459;
// Sines of the Sun's elevation between which the lit side changes from the underside to the upper side.
const UNDERSIDE_LIT: vec2f = vec2f(-0.03, 0.06);

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    let ray = pixel_ray(in.clip.xy);
    let stretch = vec3f(1.0, 1.0, frame.polar_stretch);
    let stretched = ray * stretch;
    let direction = normalize(stretched);
    let rise = dot(frame.eye_scaled, direction);
    // (1 + h)² − L².
    let between = max(clouds_above() - frame.above, 0.0);
    let meets_ground = rise < 0.0 && rise * rise >= frame.above;
    let root = sqrt(rise * rise + between);
    let distance = select(root - rise, between / max(root + rise, 1e-9), rise > 0.0);
    let place = frame.eye_scaled + distance * direction;
    let up = normalize(place * stretch);

    let at = on_whole_map(seen_along(ray, distance / length(stretched), up));
    let clouds = clouds_at(at, Lifted(up, vec2f(0.0)), 1.0 - frame.clouds_before);
    if meets_ground || clouds.albedo <= 0.0 {
        discard;
    }

    let thickness = scaled_thickness(clouds.albedo);
    let through = exp(-thickness / max(dot(normalize(ray), up), LOWEST_SIGHT));
    var color = light_from_below(at, clouds, thickness, through, frame.sun_itrf);
    @if(moonlight) color += frame.moon_light * light_from_below(at, clouds, thickness, through, frame.moon_itrf);
    // Without a shadow in view there is no Moon.
    @if(eclipse) if frame.shadow.radius > 0.0 { color *= sun_left_to_clouds(clouds); }
    @if(air) color = behind_air(color, direction, at.center_uv + at.uv, 1.0 - through);
    return vec4f(displayed(color, frame.exposure, in.clip.xy), 1.0 - through);
}

// Light that the layer sends down to the eye from a Sun in this direction, its sky and the ground; `through` is the directly transmitted fraction
// of the background.
fn light_from_below(at: SurfacePoint, clouds: CloudsBefore, thickness: f32, through: f32, sun: vec3f) -> vec3f {
    let mu = dot(clouds.lift.up, sun);
    let above = max(mu, CLOUD_SIDES);
    let light = light_on_layer(at, mu);
    let back = sunlit_albedo(clouds.albedo, above);
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
    color += light.sky * max(1.0 - clouds.albedo - through, 0.0);
    let on_ground = (1.0 - back) * above * lit_above * light.sun + light.sky;
    @if(air) color += clouds.albedo * sent_up_by(ground_below(at), vec3f(clouds.albedo)) * on_ground;
    return color;
}

// Fraction of the Earth's circumference, 300 km: radius of the ground that lights the clouds.
@if(air) const GROUND_ABOUT: f32 = 0.0075;

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

// Behind the air in front of the layer, which hides the air beyond it.
@if(air)
fn behind_air(color: vec3f, direction: vec3f, uv: vec2f, hidden: f32) -> vec3f {
    let column = view_column(direction);
    let before = thinned(AirBefore(through_seen(column), seen(column, direction, uv).rgb), air.before_clouds);
    return before.through * color + hidden * before.light;
}
