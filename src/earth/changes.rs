//! What is changed while an Earth is drawn.

use super::{Earth, EarthError};
use crate::gpu::{ErrorScope, GpuMap, MapError};
use std::sync::Arc;
use terrella_ground::light::Exposure;
use terrella_imagery::tile::MapLayer;

impl Earth {
    /// Exposes so from the next [`Self::prepare`] on.
    ///
    /// # Errors
    /// An exposure outside its range; it is then as it was.
    pub fn set_exposure(&mut self, exposure: Exposure) -> Result<(), EarthError> {
        self.first.set_exposure(exposure)
    }

    /// Draws with another whole map from the next [`Self::prepare`] on, in all views: clouds of another hour, a texture that the
    /// host draws to, or a [`MapFade`](crate::MapFade)'s. It costs a bind group, or with a pack one for each block.
    ///
    /// What ground and clouds lend to the light of the air, and to metering, follows an uploaded map; of a texture it is not known, and
    /// stays as it was. So where one map fades into another, set [`MapFade::map_between`](crate::MapFade::map_between) from time to time,
    /// or the other at the end.
    ///
    /// # Errors
    /// A map that the Earth was made without or draws with tiles, one of city lights that are drawn as points, and one of another device; the Earth is then as it was.
    pub fn set_map(&mut self, queue: &wgpu::Queue, map: &GpuMap) -> Result<(), EarthError> {
        let device = self.device.clone();
        let scope = ErrorScope::open(&device, wgpu::ErrorFilter::Validation);
        let before = self.surface.set_map(&device, map)?;
        if let Some(error) = scope.error() {
            self.surface.set_map(&device, &before)?;
            return Err(MapError::Rejected(error.to_string()).into());
        }
        if matches!(map.layer(), MapLayer::Day | MapLayer::Water) {
            self.first.planner.set_kinds(None);
        }
        if let Some(part) = &map.albedo {
            let mut albedo = self.first.planner.exposure.albedo().clone();
            Arc::make_mut(&mut albedo).set(part);
            self.first.planner.exposure.set_albedo(&albedo);
            if let Some(air) = self.air_textures() {
                air.set_albedo(queue, &albedo.texels(&self.quality.maps));
            }
        }
        Ok(())
    }
}
