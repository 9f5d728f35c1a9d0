//! Changes while an Earth is drawn.

use super::{Earth, EarthError};
use crate::gpu::{ErrorScope, GpuMap, MapError};
use std::sync::Arc;
use terrella_ground::light::Exposure;
use terrella_imagery::tile::MapLayer;

impl Earth {
    /// Draws with this exposure from the next [`Self::prepare`] on.
    ///
    /// # Errors
    /// An exposure outside its range. The exposure is then unchanged.
    pub fn set_exposure(&mut self, exposure: Exposure) -> Result<(), EarthError> {
        self.first.set_exposure(exposure)
    }

    /// Replaces a whole map from the next [`Self::prepare`] on, in all views: clouds of another hour, a texture that the host draws to, or the
    /// output of a [`MapFade`](crate::MapFade). It costs one bind group, or with a pack one for each block.
    ///
    /// The contribution of ground and clouds to the light of the air and to metering follows an uploaded map. For a texture it is not known and
    /// stays unchanged. During a fade between two maps, therefore set [`MapFade::map_between`](crate::MapFade::map_between) from time to time, or
    /// the second map at the end.
    ///
    /// # Errors
    /// A map that the Earth was made without or draws with tiles, a map of city lights that are drawn as points, or a map of another device. The
    /// Earth is then unchanged.
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
