// Clouds around an eye within or near their layer, over everything farther away.
//
// The layer is a medium here. Thick clouds fill it; thinner ones are flatter, above bases of more equal height. Their density follows 6 t (1 − t) from
// t = 0 at their base to 1 at their top, and their optical thickness is that of the cover there.
import common/displayed.wgsl;
import earth/shading/clouds_from_below.wgsl;
import earth/surface_point/on_whole_map.wgsl;

struct Varying {
    @builtin(position) clip: vec4f,
}

// At the nearest depth: it is in front of everything.
@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Varying {
    return Varying(vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 1.0, 1.0));
}

// Length of the first step along a ray, metres, and how much farther the end of each further step is: the last one ends at 7 km, where the layer as a
// whole is seen.
const FIRST_STEP_M: f32 = 40.0;
const NEXT_END: f32 = 1.41421356;
const NEAR_STEPS: i32 = 16;
const LEAST_SEEN: f32 = 1e-3;
// 1 − g² with g = 0.85: scaled optical thickness for one of the medium.
const SCALED: f32 = 0.2775;
// Least cover whose clouds are flatter than those of more.
const LEAST_COVER: f32 = 0.02;
// Depth of the bases of thin clouds below the middle of the layer, of half its thickness.
const EVEN_BASE: f32 = 0.4;
@if(detail) const SMOOTH_TOPS: f32 = 0.4;
// How far tops of clouds are displaced, and how far their parts are to either side of that, of half the layer's thickness; and waves of the latter.
const LEAN: vec3f = vec3f(0.25, -0.3, 0.3);
const TWIST: vec3f = vec3f(-0.12, 0.08, 0.2);
const TWISTS: f32 = 6.0;
// Distance to the middle of what may shade a side of a cloud, equatorial radii: 150 m; and the light of a side that faces a Sun at the horizon.
const SIDE_STEP: f32 = 2.4e-5;
const LIT_SIDES: f32 = 0.5;

// Height above the middle of the layer at a distance along a ray that rises so steeply, 1 at its top.
fn height_within(distance: f32, rise: f32) -> f32 {
    let above = frame.above + distance * (2.0 * rise + distance);
    let height = above / (1.0 + sqrt(1.0 + above));
    return (height - surface_light.cloud_height) / frame.clouds_reach;
}

// Heights of the base and the top of a cloud with this cover.
fn base_and_top(cover: f32) -> vec2f {
    let top = sqrt(clamp(cover, LEAST_COVER, 1.0));
    return vec2f(-mix(EVEN_BASE, 1.0, top * top), top);
}

// Where on the layer's middle the part of a cloud at a height belongs, relative to the place below it: otherwise clouds would be columns.
fn leaning(height: f32) -> vec3f {
    return frame.clouds_reach * (height * LEAN + sin(TWISTS * height) * TWIST);
}

// Mean density between two heights t, relative to its mean between base and top.
fn mean_density(t: vec2f) -> f32 {
    let a = clamp(t.x, 0.0, 1.0);
    let b = clamp(t.y, 0.0, 1.0);
    let crossed = abs(t.y - t.x);
    let inside = select(1.0, abs(b - a) / crossed, crossed > 1e-6);
    return inside * (3.0 * (a + b) - 2.0 * (a * a + a * b + b * b));
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    let ray = pixel_ray(in.clip.xy);
    let stretch = vec3f(1.0, 1.0, frame.polar_stretch);
    let stretched = ray * stretch;
    let direction = normalize(stretched);
    let rise = dot(frame.eye_scaled, direction);

    var left = 1.0;
    // Means of what is seen: the clouds' albedo, the part of them below it, and the cosine of sunlight on their tops.
    var albedo = 0.0;
    var below = 0.0;
    var facing = 0.0;
    var begin = 0.0;
    var end = FIRST_STEP_M / frame.radius_m;
    for (var step = 0; step < NEAR_STEPS && left > LEAST_SEEN; step++) {
        let heights = vec2f(height_within(begin, rise), height_within(end, rise));
        if min(heights.x, heights.y) < 1.0 && max(heights.x, heights.y) > -1.0 {
            let place = frame.eye_scaled + 0.5 * (begin + end) * direction;
            let clouds = clouds_near(place + leaning(0.5 * (heights.x + heights.y)), ray);
            let ends = base_and_top(cover_for_height(clouds));
            let t = (heights - ends.x) / (ends.y - ends.x);
            let density = mean_density(t) / (ends.y - ends.x);
            let thickness = scaled_thickness(clouds.albedo) / SCALED;
            let seen = left * (1.0 - exp(-thickness * density * (end - begin) / frame.clouds_reach));
            if seen > LEAST_SEEN {
                albedo += seen * clouds.albedo;
                below += seen * smoothstep(0.0, 1.0, 0.5 * (t.x + t.y));
                facing += seen * sun_on_part(place, ray);
                left -= seen;
            }
        }
        begin = end;
        end *= NEXT_END;
    }
    let hidden = 1.0 - left;
    if hidden < LEAST_SEEN {
        discard;
    }
    albedo /= hidden;
    below /= hidden;
    facing /= hidden;

    let up = normalize(frame.eye_scaled * stretch);
    let at = on_whole_map(seen_along(ray, 0.0, up));
    let upward = 0.5 + 0.5 * dot(normalize(ray), up);
    let shares = vec2f(upward, below);
    var color = light_within(at, shares, albedo, dot(up, frame.sun_itrf), facing);
    @if(moonlight) let mu = dot(up, frame.moon_itrf);
    @if(moonlight) color += frame.moon_light * light_within(at, shares, albedo, mu, max(mu, CLOUD_SIDES));
    @if(eclipse) if frame.shadow.radius > 0.0 { color *= sun_left_at_clouds(up); }
    let shown = frame.clouds_around * hidden;
    return vec4f(displayed(shown * color, frame.exposure, in.clip.xy), shown);
}

// The clouds over a place near the eye.
fn clouds_near(place: vec3f, ray: vec3f) -> CloudsBefore {
    let stretch = vec3f(1.0, 1.0, frame.polar_stretch);
    let up = normalize(place * stretch);
    let at = on_whole_map(seen_along(ray, distance(place, frame.eye_scaled) / length(ray * stretch), up));
    return clouds_at(at, Lifted(up, vec2f(0.0)), 1.0);
}

// The cover that decides the height of a cloud: smoother than the cover itself, whose peaks would be spikes.
fn cover_for_height(clouds: CloudsBefore) -> f32 {
    @if(!detail) return clouds.cover;
    @if(detail) let soft = clouds.uneven.soft;
    @if(detail) let made = clouds.uneven.made;
    @if(detail) let both = Detail(mix(made.value, soft.value, SMOOTH_TOPS), mix(made.variance, soft.variance, SMOOTH_TOPS));
    @if(detail) return uneven_cover(clouds.mapped, both);
}

// Cosine of sunlight on a part of a cloud, whose sides a low Sun lights through the clouds before them.
fn sun_on_part(place: vec3f, ray: vec3f) -> f32 {
    let up = normalize(place * vec3f(1.0, 1.0, frame.polar_stretch));
    let mu = dot(up, frame.sun_itrf);
    let level = frame.sun_itrf - mu * up;
    let before = clouds_near(place + SIDE_STEP * level, ray);
    let thickness = scaled_thickness(before.albedo) * SIDE_STEP / frame.clouds_reach;
    return max(mu, CLOUD_SIDES) + LIT_SIDES * length(level) * (1.0 - max(mu, 0.0)) * exp(-thickness);
}

// Light in two streams, up and down. Nothing is absorbed, so both change evenly with optical depth. `shares`: of the stream that goes down, which an
// eye sees that looks up, and of the clouds below. `mu` and `facing`: cosines of the light to the vertical, and on the tops.
fn light_within(at: SurfacePoint, shares: vec2f, albedo: f32, mu: f32, facing: f32) -> vec3f {
    let back = sunlit_albedo(albedo, max(mu, CLOUD_SIDES));
    let light = light_on_layer(at, mu);
    let sun_down = facing * light.sun;
    let below = shares.y;
    var goes_up = below * (back * sun_down + albedo * light.sky);
    var goes_down = mix(1.0 - back, 1.0, below) * sun_down + mix(1.0 - albedo, 1.0, below) * light.sky;
    @if(air) let from_ground = light_of_ground(at, albedo, (1.0 - back) * sun_down + light.sky);
    @if(air) goes_up += (1.0 - below * albedo) * from_ground;
    @if(air) goes_down += (1.0 - below) * albedo * from_ground;
    return mix(goes_up, goes_down, shares.x);
}
