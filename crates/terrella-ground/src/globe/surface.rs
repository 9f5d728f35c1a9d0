//! The [`Surface`] trait of every terrain surface, and the plain data that a surface returns for drawing. Nothing here uses the GPU or is
//! specific to one surface.

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

/// The eye and its view of the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundView {
    pub eye_itrf_m: DVec3,
    /// Takes eye-relative ITRF metres to clip space, z in 0…w.
    pub clip_from_eye: DMat4,
    /// Angle of a pixel in the middle of the image, radians.
    pub pixel_rad: f64,
    /// Largest allowed distance, in pixels of the image, between drawn terrain and its data; 0 requests full detail.
    pub tolerance_px: f64,
}

/// How a surface is drawn, with the data for it.
#[derive(Clone, Copy, Debug)]
pub enum DrawKind<'a> {
    /// As patches of triangles: [`Surface::for_each_patch`].
    Patches,
    /// As a grid whose vertices are computed on the GPU.
    Grid(GridDraw<'a>),
    /// As pages of contours at which the GPU casts rays: [`Surface::for_each_contour_page`].
    ContourPages(ContourPageSet),
}

/// A way to draw terrain.
pub trait Surface: Send + Sync {
    /// Name in scene files.
    fn name(&self) -> &'static str;

    /// Selects the level of detail for the view, and builds what is missing. Allocates nothing in steady state, and never waits.
    fn prepare(&mut self, view: &GroundView, ground: &dyn Elevation) -> SurfaceStats;

    /// Reports where heights have changed since the last [`Self::prepare`]; from now on `ground` has the heights. The next calls of
    /// [`Self::prepare`] rebuild what depends on them, within their budgets. Meanwhile no crack opens and nothing is left out.
    fn heights_changed(&mut self, changes: &[HeightChange], ground: &dyn Elevation);

    /// Forgets choices for earlier views that are kept only so that a moving eye does not toggle them. The result of the next calls of
    /// [`Self::prepare`] for one view then depends on that view and the heights alone.
    fn forget_views(&mut self);

    /// Calls `draw` with each patch of the last view, near ones first if the order is known. Other kinds have no patches.
    fn for_each_patch(&self, draw: &mut dyn FnMut(&Patch));

    /// Calls `draw` with each page of contours of the last view, near ones first. Other kinds have no pages.
    fn for_each_contour_page(&self, draw: &mut dyn FnMut(&ContourPage<'_>)) {
        let _ = draw;
    }

    /// Fills in the blocks that each range of a grid's triangles may touch. Leaves `ranges` empty for other kinds.
    fn grid_ranges(&self, ranges: &mut Vec<IndexRange>) {
        ranges.clear();
    }

    /// Whether patches may span several blocks and must be drawn with the tiles of each. The result never changes.
    fn crosses_blocks(&self) -> bool {
        false
    }

    /// How the surface is drawn. The variant never changes.
    fn draw_kind(&self) -> DrawKind<'_> {
        DrawKind::Patches
    }
}
