// Stars, the Milky Way, Sun and Moon, each pixel through the air in front of it.
//
// `CelestialVariant` in src/gpu/shader/celestial.rs lists the legal combinations of conditions: stars, milky_way, sun, moon, glare or ghosts;
// aperture (in glare), map; air, inside (of it); and those of common/displayed.wgsl.
//
// Drawn after all of the Earth, at the farthest depth: everything in front of the sky hides it, and its light is added to the air's. On 8-bit
// targets displayed colours are added instead of light.
import common/ray.wgsl;
import common/displayed.wgsl;
@if(air) import common/air.wgsl;
@if(air && !inside) import rust::AIR_TOP;
@if(stars) import celestial/stars.wgsl;
@if(milky_way) import celestial/milky_way.wgsl;
@if(sun) import celestial/sun.wgsl;
@if(moon) import celestial/moon.wgsl;
@if(glare) import celestial/glare.wgsl;
@if(ghosts) import celestial/ghosts.wgsl;

// | group | binding | what                     | when             |
// |-------|---------|--------------------------|------------------|
// | 0     | 0       | this                     | always           |
// | 0     | 1 …     | common/air.wgsl          | air              |
// | 1     | 0       | map, or pattern          | map              |
// | 1     | 1       | its sampler              | map              |

// Mirrored by `CelestialUniforms` in src/gpu/celestial.rs. Matrices are stored by columns.
struct CelestialUniforms {
    frame: FrameUniforms,
    // Width and height of the viewport, pixels, and its corner.
    size_px: vec2f,
    origin_px: vec2f,
    // From ITRF axes to those of the stars, GCRF.
    stars_x: vec3f,
    // Brightness of stars and Milky Way relative to the true one.
    star_gain: f32,
    stars_y: vec3f,
    // Mip level of the Milky Way's map with one texel a pixel.
    milky_way_level: f32,
    stars_z: vec3f,
    // Fraction of the Sun's light that is not hidden by Earth and Moon.
    sun_seen: f32,
    sun: Disc,
    moon: Disc,
    // From the axes of the Moon's disc to those of the Moon.
    moon_x: vec3f,
    // Mip level of the Moon's map with one texel a pixel.
    moon_level: f32,
    moon_y: vec3f,
    // Factor of the map's values: albedo, and the brightness of the phase relative to full Moon.
    moon_albedo: f32,
    moon_z: vec3f,
    // Weight of Lambert's law: 1 − L of McEwen's law.
    moon_lambert: f32,
    // From the Moon's centre to the Sun, unit, in the axes of the Moon's disc.
    moon_to_sun: vec3f,
    // Earthshine on the Moon, the Sun's light being 1.
    earthshine: f32,
    // From the Moon's centre to the Earth's, in the Moon's radii.
    moon_to_earth: vec3f,
    // Radius of the Earth, in the Moon's radii.
    earth_radius: f32,
    // Bounds of the glare on screen, as those of a disc.
    glare_bounds: vec4f,
    // Least depth.
    near_depth: f32,
    // Fraction of the Sun's light that the aperture leaves in its disc.
    sun_kept: f32,
    // Size of a pixel and radius of the Sun, in sides of the diffraction pattern.
    aperture: vec2f,
}

// A distant sphere, seen from the eye. Its axes: z from the eye to its centre, x and y across.
struct Disc {
    // Multiplied by the vector (pixel x, pixel y, 1), they give the pixel's ray in these axes.
    pixel_x: vec3f,
    // Distance of its centre, in its radii.
    distance: f32,
    pixel_y: vec3f,
    // Depth at which it is drawn.
    depth: f32,
    pixel_z: vec3f,
    // 1 if it is in front of the Earth and hides it, else 0.
    covers: f32,
    // Bounds on screen: least x and y, greatest x and y, −1…1.
    bounds: vec4f,
}

@group(0) @binding(0) var<uniform> sky: CelestialUniforms;
@if(map) @group(1) @binding(0) var body_map: texture_2d<f32>;
@if(map) @group(1) @binding(1) var body_sampler: sampler;

// Intersection of a pixel's ray with a sphere.
struct Meeting {
    // Unit vector of the ray.
    ray: vec3f,
    // Distance of the ray's line from the centre, radii; the ray misses if it is above 1 or the sphere is behind the eye.
    off: f32,
    // Outward normal there, unit.
    normal: vec3f,
}

fn meet(disc: Disc, pixel: vec2f) -> Meeting {
    let at = vec3f(pixel, 1.0);
    let ray = normalize(vec3f(dot(disc.pixel_x, at), dot(disc.pixel_y, at), dot(disc.pixel_z, at)));
    let sine = length(ray.xy);
    let off = select(disc.distance * sine, 1e9, ray.z <= 0.0);
    // From the centre to the ray's nearest point, and from there back to the sphere, without a difference of large numbers.
    let foot = disc.distance * sine * vec3f(ray.z * ray.xy / max(sine, 1e-30), -sine);
    return Meeting(ray, off, normalize(foot - sqrt(max((1.0 - off) * (1.0 + off), 0.0)) * ray));
}

// Fraction of a pixel that the sphere covers.
fn covered(disc: Disc, met: Meeting) -> f32 {
    // Change of the ray's distance from the centre to the next pixel.
    let change = disc.distance * length(vec2f(disc.pixel_x.x, disc.pixel_y.x));
    return saturate((1.0 - met.off) / max(change, 1e-12) + 0.5);
}

// A corner of a rectangle on screen.
fn corner_of(bounds: vec4f, index: u32, depth: f32) -> vec4f {
    return vec4f(select(bounds.x, bounds.z, (index & 1u) != 0u), select(bounds.y, bounds.w, (index & 2u) != 0u), depth, 1.0);
}

// Transmittance for light from beyond the Earth: zero if the ray meets the ground.
fn through_all(pixel: vec2f) -> vec3f {
    let ray = ray_through(sky.frame, pixel);
    if ray.along > 0.0 && ray.q < 1.0 {
        return vec3f(0.0);
    }
    return through_air(ray);
}

fn through_air(ray: Ray) -> vec3f {
    @if(air) return select(vec3f(1.0), left_through(pass_by(ray.direction, ray.q, ray.along)), meets_air(ray));
    @else return vec3f(1.0);
}

@if(air)
fn meets_air(ray: Ray) -> bool {
    @if(inside) return true;
    @else return ray.along > 0.0 && ray.q < AIR_TOP;
}

// The pixel of the Sun's centre: there the rays across are 0.
fn sun_px() -> vec2f {
    let x = sky.sun.pixel_x;
    let y = sky.sun.pixel_y;
    let span = x.x * y.y - x.y * y.x;
    return vec2f(x.y * y.z - x.z * y.y, x.z * y.x - x.x * y.z) / span;
}

// Added light as the target stores it, and its opacity over the background.
fn added(light: vec3f, hides: f32) -> vec4f {
    @if(encode) return vec4f(encode_srgb(toned(light, sky.frame.exposure)), hides);
    @else return vec4f(toned(light, sky.frame.exposure), hides);
}
