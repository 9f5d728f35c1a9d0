//! Lens ghosts of the Sun: positions on screen, and light.

use super::projection::Projection;
use crate::gpu::GhostPoint;
use glam::DVec3;
use std::f64::consts::PI;
use terrella_ground::light::Ghosts;

/// The ghosts of a Sun in this direction; `None` if it is behind the eye or too far outside the image.
pub(super) fn points(
    ghosts: &Ghosts,
    sun: DVec3,
    projection: &Projection<'_>,
) -> Option<[GhostPoint; Ghosts::ALL.len()]> {
    let at = projection.on_screen(sun)?;
    let size = projection.size;
    let seen = Ghosts::seen((at * size).length() / size.length());
    if seen <= 0.0 || ghosts.part <= 0.0 {
        return None;
    }
    let pixel_sr = projection.pixel_rad().powi(2);
    Some(Ghosts::ALL.map(|ghost| {
        let radius_px = ghost.radius * size.y;
        let solid_angle_sr = ghosts.area() * radius_px * radius_px * pixel_sr;
        // A white sheet that faces the Sun has light 1, so the Sun's irradiance at the eye is π.
        let light = PI * seen * ghosts.part / solid_angle_sr;
        GhostPoint {
            at: (ghost.place * at).as_vec2().to_array(),
            half_size: (2.0 * radius_px / size).as_vec2().to_array(),
            light: ghost.shares.map(|share| (light * share) as f32),
            blades: ghosts.blades.map_or(0.0, |blades| blades as f32),
        }
    }))
}
