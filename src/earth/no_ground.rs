//! Replaces `ground.rs` if the feature `terrain` is off: types without a value, so that no code for terrain is compiled in.

use super::EarthError;
use super::view::ItrfView;
use crate::plan::{DeviceLimits, SurfaceDraw};
use std::time::Duration;
use terrella_frames::Ellipsoid;
use terrella_ground::globe::{Block, BlockGrid, BlockSet, Figure, Surface, SurfaceStats};
use terrella_ground::height::HeightTileStats;

/// Terrain in place of the smooth ellipsoid. Without the feature `terrain` this type has no value.
#[derive(Clone, Debug)]
pub enum GroundOptions {}

impl GroundOptions {
    pub(super) fn is_same(&self, _: &Self) -> bool {
        match *self {}
    }
}

pub(super) enum GroundDriver {}

impl GroundDriver {
    pub fn new(options: &GroundOptions, _: Figure, _: &DeviceLimits) -> Result<Self, EarthError> {
        match *options {}
    }

    pub fn for_another_view(&self) -> Result<Self, EarthError> {
        match *self {}
    }

    pub fn take_over(&self, _: bool) {
        match *self {}
    }

    pub fn wait(&self, _: Duration) {
        match *self {}
    }

    pub fn height_tiles(&self) -> HeightTileStats {
        match *self {}
    }

    pub fn plan(&mut self, _: &BlockGrid, _: &ItrfView, _: &mut Vec<Block>) -> (SurfaceStats, f64) {
        match *self {}
    }

    pub fn list_draws(&mut self, _: &Ellipsoid, _: Option<BlockSet>, _: &mut Vec<SurfaceDraw>) {
        match *self {}
    }

    pub fn forget_views(&mut self) {
        match *self {}
    }

    pub fn has_forgotten(&self) -> bool {
        match *self {}
    }

    pub fn is_settled(&self) -> bool {
        match *self {}
    }

    pub fn surface(&self) -> &dyn Surface {
        match *self {}
    }

    pub fn has_edges(&self) -> bool {
        match *self {}
    }

    pub fn features(&self) -> &'static [&'static str] {
        match *self {}
    }
}
