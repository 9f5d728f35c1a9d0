// Lens ghosts of the Sun: images of the aperture, over the whole image. `Ghosts` in crates/terrella-ground/src/light/ghosts.rs is the model.
import rust::PI;

struct GhostInstance {
    // Position on screen, −1…1, and half of its width and height in the same units.
    @location(0) at: vec2f,
    @location(1) half_size: vec2f,
    // Its light for an undimmed Sun, RGB.
    @location(2) light: vec3f,
    // Number of aperture blades, 0 for a round aperture.
    @location(3) blades: f32,
}

struct Varying {
    @builtin(position) clip: vec4f,
    // In radii.
    @location(0) place: vec2f,
    @location(1) @interpolate(flat) light: vec3f,
    @location(2) @interpolate(flat) blades: f32,
}

// Half the width of its blurred edge, radii.
const GHOST_EDGE: f32 = 0.12;

@vertex
fn vertex(@builtin(vertex_index) index: u32, in: GhostInstance) -> Varying {
    let place = (vec2f(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0) * (1.0 + GHOST_EDGE);
    let light = sky.sun_seen * through_air(ray_through(sky.frame, sun_px()));
    return Varying(vec4f(in.at + place * in.half_size, sky.near_depth, 1.0), place, light * in.light, in.blades);
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    // From the centre to the edge in this direction.
    var edge = 1.0;
    if in.blades > 0.0 {
        let sector = 2.0 * PI / in.blades;
        let turn = atan2(in.place.y, in.place.x);
        edge = cos(0.5 * sector) / cos(turn - sector * round(turn / sector));
    }
    let part = 1.0 - smoothstep(-GHOST_EDGE, GHOST_EDGE, length(in.place) - edge);
    return added(part * in.light, 0.0);
}
