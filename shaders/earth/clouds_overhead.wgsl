// Clouds in the sky for an eye below them: the same layer from beneath, over everything behind it.
import common/displayed.wgsl;
import earth/shading/clouds_from_below.wgsl;
import earth/surface_point/on_whole_map.wgsl;

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

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    let ray = pixel_ray(in.clip.xy);
    let stretch = vec3f(1.0, 1.0, frame.polar_stretch);
    let stretched = ray * stretch;
    let direction = normalize(stretched);
    let rise = dot(frame.eye_scaled, direction);
    // (1 + h)² − L².
    let between = max(clouds_above() - frame.above, 0.0);
    // An eye above their middle sees those around it.
    let are_around = between <= 0.0 && frame.clouds_around > 0.0;
    let meets_ground = rise < 0.0 && rise * rise >= frame.above;
    let root = sqrt(rise * rise + between);
    let distance = select(root - rise, between / max(root + rise, 1e-9), rise > 0.0);
    let place = frame.eye_scaled + distance * direction;
    let up = normalize(place * stretch);

    let at = on_whole_map(seen_along(ray, distance / length(stretched), up));
    let clouds = clouds_at(at, Lifted(up, vec2f(0.0)), 1.0 - frame.clouds_before);
    if meets_ground || are_around || clouds.albedo <= 0.0 {
        discard;
    }

    let thickness = scaled_thickness(clouds.albedo);
    let through = exp(-thickness / max(dot(normalize(ray), up), LOWEST_SIGHT));
    var color = light_from_below(at, clouds.lift.up, clouds.albedo, through, frame.sun_itrf);
    @if(moonlight) color += frame.moon_light * light_from_below(at, clouds.lift.up, clouds.albedo, through, frame.moon_itrf);
    // Without a shadow in view there is no Moon.
    @if(eclipse) if frame.shadow.radius > 0.0 { color *= sun_left_to_clouds(clouds); }
    @if(air) color = behind_air(color, direction, at.center_uv + at.uv, 1.0 - through);
    return vec4f(displayed(color, frame.exposure, in.clip.xy), 1.0 - through);
}

// Behind the air in front of the layer, which hides the air beyond it.
@if(air)
fn behind_air(color: vec3f, direction: vec3f, uv: vec2f, hidden: f32) -> vec3f {
    let column = view_column(direction);
    let before = thinned(AirBefore(through_seen(column), seen(column, direction, uv).rgb), air.before_clouds);
    return before.through * color + hidden * before.light;
}
