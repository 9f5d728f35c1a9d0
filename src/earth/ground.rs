//! Ground with relief: the surface that a scene chose, and the heights that it is made from.

use crate::elevation::{Bounds, Elevation};
use crate::frames::Ellipsoid;
use crate::globe::{
    Block, BlockGrid, GroundView, SubdivisionError, Surface, SurfaceSettings, SurfaceStats,
    select_blocks_between,
};
use glam::{DMat4, DVec3};
use std::fmt;
use std::sync::Arc;

/// Ground with relief in place of the smooth ellipsoid.
#[derive(Clone)]
pub struct GroundOptions {
    /// Where heights come from.
    pub elevation: Arc<dyn Elevation>,
    /// What draws them.
    pub surface: SurfaceSettings,
    /// Most pixels by which the drawn ground may differ from its data, for surfaces that know; 0 asks for all there is.
    pub tolerance_px: f64,
}

impl fmt::Debug for GroundOptions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("GroundOptions")
            .field("surface", &self.surface)
            .field("tolerance_px", &self.tolerance_px)
            .finish_non_exhaustive()
    }
}

/// Draws it.
pub(super) struct GroundDriver {
    elevation: Arc<dyn Elevation>,
    surface: Box<dyn Surface>,
    tolerance_px: f64,
}

impl GroundDriver {
    pub fn new(options: &GroundOptions, ellipsoid: Ellipsoid) -> Result<Self, SubdivisionError> {
        Ok(Self {
            elevation: options.elevation.clone(),
            surface: options.surface.make(ellipsoid)?,
            tolerance_px: options.tolerance_px.max(0.0),
        })
    }

    /// Chooses what is drawn, and the blocks in sight, whose tiles it is drawn with.
    pub fn prepare(
        &mut self,
        grid: &BlockGrid,
        eye_itrf_m: DVec3,
        clip_from_eye: &DMat4,
        pixel_rad: f64,
        drawn: &mut Vec<Block>,
    ) -> SurfaceStats {
        let range = self.elevation.range_m(&Bounds::GLOBE);
        let heights = (range.low_m, range.high_m);
        select_blocks_between(grid, heights, eye_itrf_m, clip_from_eye, drawn);
        let view = GroundView {
            eye_itrf_m,
            clip_from_eye: *clip_from_eye,
            pixel_rad,
            tolerance_px: self.tolerance_px,
        };
        self.surface.prepare(&view, self.elevation.as_ref())
    }

    pub fn surface(&self) -> &dyn Surface {
        self.surface.as_ref()
    }
}
