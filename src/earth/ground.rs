//! Ground with relief: the surface that a scene chose, and the heights that it is made from.

use super::view::ItrfView;
use crate::elevation::{Bounds, Elevation};
use crate::globe::contours::ContourOptions;
use crate::globe::projected_grid::GPU_TILES;
use crate::globe::{
    Block, BlockGrid, DrawKind, Figure, GroundView, Surface, SurfaceError, SurfaceSettings,
    SurfaceStats, select_blocks_between,
};
use crate::gpu::{GridMesh, PageMesh};
use std::fmt;
use std::sync::Arc;

/// Ground with relief in place of the smooth ellipsoid.
#[derive(Clone)]
pub struct GroundOptions {
    /// Where heights come from.
    pub elevation: Arc<dyn Elevation>,
    /// The surface that draws the ground, with its settings.
    pub surface: SurfaceSettings,
    /// Most pixels by which the drawn ground may differ from its data, for surfaces that know; 0 asks for all there is.
    pub tolerance_px: f64,
}

impl GroundOptions {
    /// Whether the ground is the same: made by the same surface from the same heights.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.elevation, &other.elevation)
            && self.surface == other.surface
            && self.tolerance_px == other.tolerance_px
    }
}

impl fmt::Debug for GroundOptions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("GroundOptions")
            .field("surface", &self.surface)
            .field("tolerance_px", &self.tolerance_px)
            .finish_non_exhaustive()
    }
}

/// Prepares the surface for each frame, and says when it is settled.
pub(super) struct GroundDriver {
    elevation: Arc<dyn Elevation>,
    settings: SurfaceSettings,
    figure: Figure,
    surface: Box<dyn Surface>,
    tolerance_px: f64,
    before: SurfaceStats,
    /// Frames since anything was read or drawn otherwise than the frame before.
    quiet: u32,
}

/// A surface is settled when so many frames are alike: more than a level takes to fade in.
const QUIET_FRAMES: u32 = 10;

impl GroundDriver {
    /// A grid that is to be made on the GPU is made on the CPU, and contours that are to be cast at are drawn as patches,
    /// where the device has no room for them; a warning is given.
    pub fn new(
        options: &GroundOptions,
        figure: Figure,
        limits: &wgpu::Limits,
    ) -> Result<Self, SurfaceError> {
        let mut surface = options.surface;
        if let SurfaceSettings::ProjectedGrid(grid) = &mut surface
            && grid.on_gpu
            && !GridMesh::fits(limits, GPU_TILES)
        {
            tracing::warn!(
                "this device's textures or uniforms are too small for the projected grid; its vertices are made on the CPU"
            );
            grid.on_gpu = false;
        }
        if let SurfaceSettings::CastContours(pages) = &surface
            && !PageMesh::fits(limits, pages)
        {
            tracing::warn!(
                "this device's fragment shaders cannot read so large a storage buffer; contours are drawn as patches"
            );
            surface = SurfaceSettings::Contours(ContourOptions::default());
        }
        let tolerance_px = options.tolerance_px.max(0.0);
        Self::made(options.elevation.clone(), surface, figure, tolerance_px)
    }

    fn made(
        elevation: Arc<dyn Elevation>,
        settings: SurfaceSettings,
        figure: Figure,
        tolerance_px: f64,
    ) -> Result<Self, SurfaceError> {
        Ok(Self {
            elevation,
            surface: settings.make(figure)?,
            settings,
            figure,
            tolerance_px,
            before: SurfaceStats::default(),
            quiet: 0,
        })
    }

    /// The same ground for another eye, of which nothing is made yet.
    pub fn for_another_view(&self) -> Result<Self, SurfaceError> {
        let elevation = self.elevation.clone();
        Self::made(elevation, self.settings, self.figure, self.tolerance_px)
    }

    /// Chooses what is drawn, and the blocks in sight, whose tiles it is drawn with.
    pub fn plan(
        &mut self,
        grid: &BlockGrid,
        view: &ItrfView,
        blocks: &mut Vec<Block>,
    ) -> SurfaceStats {
        let (eye_itrf_m, clip_from_eye) = (view.eye_itrf_m, view.clip_from_eye);
        let range = self.elevation.range_m(&Bounds::GLOBE);
        select_blocks_between(grid, range, eye_itrf_m, &clip_from_eye, blocks);
        let view = GroundView {
            eye_itrf_m,
            clip_from_eye,
            pixel_rad: view.pixel_rad(),
            tolerance_px: self.tolerance_px,
        };
        let stats = self.surface.prepare(&view, self.elevation.as_ref());
        let is_quiet = stats.samples_read == 0 && stats == self.before;
        self.quiet = if is_quiet { self.quiet + 1 } else { 0 };
        self.before = stats;
        stats
    }

    /// Whether a view that does not move would be drawn as it is now.
    pub fn is_settled(&self) -> bool {
        self.quiet >= QUIET_FRAMES
    }

    pub fn surface(&self) -> &dyn Surface {
        self.surface.as_ref()
    }

    /// Whether it is drawn as triangles, whose edges could be drawn.
    pub fn has_edges(&self) -> bool {
        !matches!(self.surface.draw_kind(), DrawKind::ContourPages(_))
    }

    /// Names of the features that its form turns on.
    pub fn features(&self) -> &'static [&'static str] {
        match self.surface.draw_kind() {
            DrawKind::Grid(_) => &["relief", "grid"],
            DrawKind::ContourPages(_) => &["relief", "cast"],
            DrawKind::Patches => &["relief"],
        }
    }
}
