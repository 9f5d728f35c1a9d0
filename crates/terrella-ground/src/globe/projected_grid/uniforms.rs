//! Data of the GPU form for each frame: the uniform of `shaders/earth/vertex/projected_grid.wgsl`, from a [`GridFrame`] in f64.

use super::tiles::{HeightTiles, eye_place, level_spacing_rad};
use super::{GridFrame, SampleFootprint};
use crate::globe::surface::{GridLevel, GridUniforms, LEVELS, TILE_CELLS, WINDOW_TILES};
use glam::{DVec2, UVec2, UVec4, Vec2};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

impl GridUniforms {
    /// Uniforms for a frame and the loaded tiles. All differences of large numbers are computed here, in f64.
    pub fn new(frame: &GridFrame, tiles: &HeightTiles) -> Self {
        let (screen, caster) = (&frame.screen, &frame.caster);
        let (columns, rows) = frame.samples;
        let mut step = frame.step;
        let mut low = frame.rect.low;
        let cell_area = screen.area * step.x * step.y;
        if screen.mirrored {
            low.x = frame.rect.high.x;
            step.x = -step.x;
        }
        let (eye_lat, eye_lon) = eye_place(caster);
        let eye_normal = (caster.up / caster.radii_m).normalize();
        let base = (1.0 + caster.above) * caster.sin_limb;
        let radial_m = caster.up * caster.radii_m;
        // Rounded as in the shader, so that the rounding error is not applied twice.
        let base_m = f64::from(((base - 1.0) * radial_m.length()) as f32);
        let to_base_m = eye_normal * base_m - radial_m * caster.above;
        let mut levels = [GridLevel::default(); LEVELS];
        let mut slots = [[UVec4::ZERO; WINDOW_TILES / 4]; LEVELS];
        for (k, window) in tiles.windows().iter().enumerate() {
            let spacing = level_spacing_rad(k as u32 + 1);
            let cells = f64::from(TILE_CELLS);
            let period = 2.0 * PI / spacing;
            // Small if the eye is near the window, on either side of it: f32 then resolves fractions of a cell.
            let east = (eye_lon + PI) / spacing - f64::from(window.first.0) * cells;
            let east = (east + 0.5 * period).rem_euclid(period) - 0.5 * period;
            let north = (eye_lat + FRAC_PI_2) / spacing - f64::from(window.first.1) * cells;
            levels[k] = GridLevel {
                eye_cells: Vec2::new(east as f32, north as f32),
                per_radian: (1.0 / spacing) as f32,
                period: period as f32,
                size: UVec2::new(window.size.0, window.size.1),
                padding: UVec2::ZERO,
            };
            for (four, chunk) in slots[k].iter_mut().zip(window.slots.chunks_exact(4)) {
                *four = UVec4::new(chunk[0], chunk[1], chunk[2], chunk[3]);
            }
        }
        Self {
            forward: screen.forward.as_vec3(),
            corner: screen.corner as f32,
            middle: (screen.middle - screen.forward).as_vec3(),
            corner_rad: screen.corner_rad as f32,
            right: screen.right.as_vec3(),
            cell_area: cell_area as f32,
            screen_up: screen.up.as_vec3(),
            longer: f32::from(u8::from(frame.footprint == SampleFootprint::Longer)),
            eye_up: caster.up.as_vec3(),
            limb_rad: caster.limb_rad as f32,
            eye_normal: eye_normal.as_vec3(),
            sin_limb: caster.sin_limb as f32,
            to_base_m: to_base_m.as_vec3(),
            cos_limb: caster.cos_limb as f32,
            radii_m: caster.radii_m.as_vec3(),
            base_m: base_m as f32,
            eye_lon: Vec2::new(eye_lon.cos() as f32, eye_lon.sin() as f32),
            low: low.as_vec2(),
            step: step.as_vec2(),
            samples: UVec2::new(columns, rows),
            near_rad: caster.near_rad as f32,
            far_rad: caster.far_rad as f32,
            spread_rad: caster.spread_rad as f32,
            eye_lat: eye_lat as f32,
            center_lat: DVec2::new(eye_lat.cos(), eye_lat.sin()).as_vec2(),
            center_uv: DVec2::new(eye_lon / TAU + 0.5, 0.5 - eye_lat / PI).as_vec2(),
            levels,
            slots,
        }
    }
}
