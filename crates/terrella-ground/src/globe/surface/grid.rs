//! Terrain as a grid whose vertices `shaders/earth/vertex/projected_grid.wgsl` computes on the GPU, from a uniform and tiles of heights.

use super::TriangleList;
use bytemuck::{Pod, Zeroable};
use glam::{UVec2, UVec4, Vec2, Vec3};

/// Cells along a tile's side.
pub const TILE_CELLS: u32 = 64;
/// Samples along a tile's side.
pub const TILE_SAMPLES: u32 = TILE_CELLS + 1;
/// Levels of the pyramid; the finest has a sample every 2.3 m.
pub const LEVELS: usize = 22;
/// Largest number of tiles in a window.
pub const WINDOW_TILES: usize = 64;
/// No tile: the entry of a window's table for a tile that is not loaded.
pub const NO_SLOT: u32 = u32::MAX;

/// Data that a grid is drawn with.
#[derive(Clone, Copy, Debug)]
pub struct GridDraw<'a> {
    /// The grid of the last view; `None` if no ground is visible.
    pub uniforms: Option<&'a GridUniforms>,
    /// Increases with each change of the grid's placement.
    pub revision: u64,
    /// Heights of the grid, metres: slots of [`TILE_SAMPLES`]² each. The number of slots never changes.
    pub heights_m: &'a [f32],
    /// Number of the update that last wrote each slot, 0 for none. A reader with copies sees from it which are out of date, even after
    /// updates that it missed.
    pub written: &'a [u64],
    /// Triangles over the indices of grid points. They are the same in each frame, in the order of [`Surface::grid_ranges`].
    ///
    /// [`Surface::grid_ranges`]: super::Surface::grid_ranges
    pub indices: &'a TriangleList,
}

impl GridDraw<'_> {
    /// The heights of a slot: rows from the south, each from the west.
    pub fn slot(&self, slot: u32) -> &[f32] {
        let size = (TILE_SAMPLES * TILE_SAMPLES) as usize;
        &self.heights_m[slot as usize * size..][..size]
    }
}

/// One level's window, in the shader's layout.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct GridLevel {
    /// Cells of the level from the window's south-western corner to the point under the eye, east and north.
    pub eye_cells: Vec2,
    /// Cells per radian.
    pub per_radian: f32,
    /// Cells around the Earth.
    pub period: f32,
    /// Columns and rows of tiles; zero if the level has none.
    pub size: UVec2,
    /// Always zero.
    pub padding: UVec2,
}

/// The uniform of the GPU form. A test compares the offsets with the shader's.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct GridUniforms {
    /// [`ScreenPlane::forward`](crate::globe::projected_grid::ScreenPlane::forward).
    pub forward: Vec3,
    /// [`ScreenPlane::corner`](crate::globe::projected_grid::ScreenPlane::corner).
    pub corner: f32,
    /// [`ScreenPlane::middle`](crate::globe::projected_grid::ScreenPlane::middle) minus `forward`.
    pub middle: Vec3,
    /// [`ScreenPlane::corner_rad`](crate::globe::projected_grid::ScreenPlane::corner_rad).
    pub corner_rad: f32,
    /// [`ScreenPlane::right`](crate::globe::projected_grid::ScreenPlane::right).
    pub right: Vec3,
    /// Area of a grid cell straight ahead, steradians.
    pub cell_area: f32,
    /// [`ScreenPlane::up`](crate::globe::projected_grid::ScreenPlane::up).
    pub screen_up: Vec3,
    /// 1 if heights are averaged over the longer of along and across, 0 for the mean.
    pub longer: f32,
    /// The eye's direction in scaled space.
    pub eye_up: Vec3,
    /// [`Caster::limb_rad`](crate::globe::projected_grid::Caster::limb_rad).
    pub limb_rad: f32,
    /// Outward normal of the ellipsoid on the eye's radius.
    pub eye_normal: Vec3,
    /// [`Caster::sin_limb`](crate::globe::projected_grid::Caster::sin_limb).
    pub sin_limb: f32,
    /// From the eye to the ground at height `base_m` on the eye's radius, ITRF metres.
    pub to_base_m: Vec3,
    /// [`Caster::cos_limb`](crate::globe::projected_grid::Caster::cos_limb).
    pub cos_limb: f32,
    /// Semi-axes, metres.
    pub radii_m: Vec3,
    /// Height of the base, metres.
    pub base_m: f32,
    /// Cosine and sine of the eye's longitude.
    pub eye_lon: Vec2,
    /// Plane coordinates of the first sample.
    pub low: Vec2,
    /// Change of plane coordinates to the next column and row; negative across in a mirrored image.
    pub step: Vec2,
    /// Samples across and down.
    pub samples: UVec2,
    /// [`Caster::near_rad`](crate::globe::projected_grid::Caster::near_rad).
    pub near_rad: f32,
    /// [`Caster::far_rad`](crate::globe::projected_grid::Caster::far_rad).
    pub far_rad: f32,
    /// [`Caster::spread_rad`](crate::globe::projected_grid::Caster::spread_rad).
    pub spread_rad: f32,
    /// Latitude of the point under the eye, radians.
    pub eye_lat: f32,
    /// Cosine and sine of `eye_lat`.
    pub center_lat: Vec2,
    /// Texture coordinates of the point under the eye on a whole map, u east from 180° W, v south from the north pole.
    pub center_uv: Vec2,
    /// The windows, the coarsest first.
    pub levels: [GridLevel; LEVELS],
    /// Slots of the windows' tiles, [`WINDOW_TILES`] a level, row by row from the south-west.
    pub slots: [[UVec4; WINDOW_TILES / 4]; LEVELS],
}
