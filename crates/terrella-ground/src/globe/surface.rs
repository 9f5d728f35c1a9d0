//! What every surface with relief answers: its [`Surface`] trait, and the plain data that it hands over to be drawn. No GPU
//! here, and nothing of any one surface.

mod contour_page;
mod grid;
mod index_range;
mod patch;

pub use super::surface_stats::SurfaceStats;
pub use contour_page::{ContourPage, ContourPageSet};
pub use grid::{
    GridDraw, GridLevel, GridUniforms, LEVELS, NO_SLOT, TILE_CELLS, TILE_SAMPLES, WINDOW_TILES,
};
pub use index_range::{IndexRange, merged_ranges};
pub use patch::{GroundVertex, Patch, TriangleList};

use crate::elevation::{Elevation, HeightChange};
use glam::{DMat4, DVec3};

/// Where the eye is and what it sees of the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundView {
    pub eye_itrf_m: DVec3,
    /// Takes eye-relative ITRF metres to clip space, z in 0…w.
    pub clip_from_eye: DMat4,
    /// Angle of a pixel in the middle of the picture, radians.
    pub pixel_rad: f64,
    /// Most pixels of the picture by which the drawn ground may differ from its data; 0 asks for all there is.
    pub tolerance_px: f64,
}

/// How a surface is drawn, and what with.
#[derive(Clone, Copy, Debug)]
pub enum DrawKind<'a> {
    /// As patches of triangles: [`Surface::for_each_patch`].
    Patches,
    /// As a grid whose vertices the GPU makes.
    Grid(GridDraw<'a>),
    /// As pages of contours that the GPU casts rays at: [`Surface::for_each_contour_page`].
    ContourPages(ContourPageSet),
}

/// A way to draw ground that has relief.
pub trait Surface: Send + Sync {
    /// As scene files name it.
    fn name(&self) -> &'static str;

    /// Selects the level of detail, and builds where needed, what the view needs. Allocates nothing in steady state, and never
    /// waits.
    fn prepare(&mut self, view: &GroundView, ground: &dyn Elevation) -> SurfaceStats;

    /// Hears where heights have changed since the last [`Self::prepare`], from now on those of `ground`. What was made of them is
    /// made again by the next calls of that, within its budgets; no edge opens meanwhile, and nothing is left out.
    fn heights_changed(&mut self, changes: &[HeightChange], ground: &dyn Elevation);

    /// Forgets what was chosen for views before and is kept only so that an eye that moves does not toggle it. What the next calls of
    /// [`Self::prepare`] come to for one view then depends on that view and the heights alone, whatever was before.
    fn forget_views(&mut self);

    /// Hands over each patch of the last view, near ones first where that is known; none of another kind.
    fn for_each_patch(&self, draw: &mut dyn FnMut(&Patch));

    /// Hands over each page of contours of the last view, near ones first; none of another kind.
    fn for_each_contour_page(&self, draw: &mut dyn FnMut(&ContourPage<'_>)) {
        let _ = draw;
    }

    /// Fills in which blocks the triangles of a grid may touch; leaves it empty for another kind.
    fn grid_ranges(&self, ranges: &mut Vec<IndexRange>) {
        ranges.clear();
    }

    /// Whether it has patches that lie in several blocks, to be drawn with the tiles of each of them. The same answer all its
    /// life.
    fn crosses_blocks(&self) -> bool {
        false
    }

    /// How it is drawn: the same variant all its life.
    fn draw_kind(&self) -> DrawKind<'_> {
        DrawKind::Patches
    }
}
