//! What the GPU form is given each frame: the uniform of `shaders/earth/vertex/projected_grid_uniforms.wgsl`, from a [`Frame`] in f64.

use super::tiles::{HeightTiles, LEVELS, TILE_CELLS, WINDOW_TILES, eye_place, level_spacing_rad};
use super::{Footprint, Frame};
use bytemuck::{Pod, Zeroable};
use glam::{DVec2, UVec2, UVec4, Vec2, Vec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// One level's window, as the shader reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct GridLevel {
    /// Cells of the level from the window's south-western corner to the place under the eye, east and north.
    pub eye_cells: Vec2,
    /// Cells a radian.
    pub per_radian: f32,
    /// Cells around the Earth.
    pub period: f32,
    /// Columns and rows of tiles; none where the level is not there.
    pub size: UVec2,
    /// Zero.
    pub padding: UVec2,
}

/// The uniform of the GPU form. A test compares the offsets with the shader's.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct GridUniforms {
    /// [`super::Screen::forward`].
    pub forward: Vec3,
    /// [`super::Screen::corner`].
    pub corner: f32,
    /// [`super::Screen::middle`] less forward.
    pub middle: Vec3,
    /// [`super::Screen::corner_rad`].
    pub corner_rad: f32,
    /// [`super::Screen::right`].
    pub right: Vec3,
    /// Area of a grid cell straight ahead, steradians.
    pub cell_area: f32,
    /// [`super::Screen::up`].
    pub screen_up: Vec3,
    /// 1 if heights are averaged over the longer of along and across, 0 for the mean.
    pub longer: f32,
    /// The eye's direction in scaled space.
    pub eye_up: Vec3,
    /// [`super::Caster::limb_rad`].
    pub limb_rad: f32,
    /// Outward normal of the ellipsoid on the eye's radius.
    pub eye_normal: Vec3,
    /// [`super::Caster::sin_limb`].
    pub sin_limb: f32,
    /// From the eye to the ground on its radius at `base_m`, ITRF metres.
    pub to_base_m: Vec3,
    /// [`super::Caster::cos_limb`].
    pub cos_limb: f32,
    /// Semi-axes, metres.
    pub radii_m: Vec3,
    /// Height of the base, metres.
    pub base_m: f32,
    /// Cosine and sine of the eye's longitude.
    pub eye_lon: Vec2,
    /// Plane coordinates of the first sample.
    pub low: Vec2,
    /// Their change to the next column and row; negative across in a mirrored picture.
    pub step: Vec2,
    /// Samples across and down.
    pub samples: UVec2,
    /// [`super::Caster::near_rad`].
    pub near_rad: f32,
    /// [`super::Caster::far_rad`].
    pub far_rad: f32,
    /// [`super::Caster::spread_rad`].
    pub spread_rad: f32,
    /// Latitude of the place under the eye, radians.
    pub eye_lat: f32,
    /// Cosine and sine of it.
    pub center_lat: Vec2,
    /// Texture coordinates of that place on a whole map, u east from 180° W, v south from the north pole.
    pub center_uv: Vec2,
    /// The windows, the coarsest first.
    pub levels: [GridLevel; LEVELS],
    /// Slots of the windows' tiles, [`WINDOW_TILES`] a level, row by row from the south-west.
    pub slots: [[UVec4; WINDOW_TILES / 4]; LEVELS],
}

impl GridUniforms {
    /// Of a frame and the tiles that are there. All differences of large numbers are taken here, in f64.
    pub fn new(frame: &Frame, tiles: &HeightTiles) -> Self {
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
        // As the shader has it: what rounding takes from it must not come twice.
        let base_m = f64::from(((base - 1.0) * radial_m.length()) as f32);
        let to_base_m = eye_normal * base_m - radial_m * caster.above;
        let mut levels = [GridLevel::default(); LEVELS];
        let mut slots = [[UVec4::ZERO; WINDOW_TILES / 4]; LEVELS];
        for (k, window) in tiles.windows().iter().enumerate() {
            let spacing = level_spacing_rad(k as u32 + 1);
            let cells = f64::from(TILE_CELLS);
            let period = 2.0 * PI / spacing;
            // Small where the eye is near the window, on either side of it: f32 then counts to fractions of a cell.
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
            longer: f32::from(u8::from(frame.footprint == Footprint::Longer)),
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
