// The Moon's disc: a sphere with its map, lit by the Sun, eclipsed by the Earth, and by earthshine.
//
// Its dust follows McEwen's law (1991), between Lommel and Seeliger's and Lambert's: a full Moon is as bright at the limb as in the middle.
import common/map_uv.wgsl;
import rust::{PI, SUN_RADIUS_RAD};

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return corner_of(sky.moon.bounds, index, sky.moon.depth);
}

@fragment
fn fragment(@builtin(position) clip: vec4f) -> @location(0) vec4f {
    let met = meet(sky.moon, clip.xy);
    let cover = covered(sky.moon, met);
    if cover <= 0.0 {
        discard;
    }
    let place = sky.moon_x * met.normal.x + sky.moon_y * met.normal.y + sky.moon_z * met.normal.z;
    let albedo = sky.moon_albedo * textureSampleLevel(body_map, body_sampler, map_uv(place), sky.moon_level).rgb;
    let mu = max(-dot(met.normal, met.ray), 0.0);
    let facing = dot(met.normal, sky.moon_to_sun);
    let lit = max(facing, 0.0);
    let law = (1.0 - sky.moon_lambert) * 2.0 * lit / max(mu + lit, 1e-4) + sky.moon_lambert * lit;
    // The Sun sets over an arc of its own size.
    let sun = sun_past_earth(met.normal) * law * saturate(facing / SUN_RADIUS_RAD + 0.5);
    // In front of the Earth there is no air before the Moon.
    let through = select(through_all(clip.xy), vec3f(1.0), sky.moon.covers > 0.0);
    let earth = sky.earthshine * step(0.0, dot(met.normal, sky.moon_to_earth) - 1.0);
    return added(albedo * (sun + earth) * cover * through, cover * sky.moon.covers);
}

// Fraction of the Sun's disc that the Earth leaves visible at a point of the Moon, without light refracted into the shadow by the Earth's air.
fn sun_past_earth(place: vec3f) -> f32 {
    let to_earth = sky.moon_to_earth - place;
    let distance = length(to_earth);
    let earth = sky.earth_radius / distance;
    // By the sine: the directions are nearly equal where it matters.
    let apart = length(cross(to_earth, sky.moon_to_sun)) / distance;
    if dot(to_earth, sky.moon_to_sun) <= 0.0 || apart >= earth + SUN_RADIUS_RAD {
        return 1.0;
    }
    // Across the penumbra the Earth's edge is nearly straight.
    let x = clamp((apart - earth) / SUN_RADIUS_RAD, -1.0, 1.0);
    return 0.5 + (x * sqrt(1.0 - x * x) + asin(x)) / PI;
}
