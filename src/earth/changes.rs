//! Changes while an Earth is drawn.

use super::{Earth, EarthError};
use crate::gpu::{ErrorScope, GpuMap, MapError, UploadedMaps};
use std::sync::Arc;
use terrella_ground::light::Exposure;
use terrella_imagery::GroundKinds;
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
        self.replace_map(map)?;
        if matches!(map.layer(), MapLayer::Day | MapLayer::Water) {
            self.first.planner.set_kinds(None);
        }
        self.follow_albedos(queue, [map]);
        Ok(())
    }

    /// Replaces all maps that were uploaded, as [`Self::set_map`] does one: finer maps that come after the first frame. The cells of land and of
    /// open sea then follow the new maps.
    ///
    /// # Errors
    /// As [`Self::set_map`]. Maps before the rejected one are then replaced.
    pub fn set_maps(&mut self, queue: &wgpu::Queue, maps: &UploadedMaps) -> Result<(), EarthError> {
        let maps = MapLayer::ALL.map(|layer| maps.get(layer));
        for map in maps.into_iter().flatten() {
            self.replace_map(map)?;
        }
        let [day, .., water] = maps;
        if day.or(water).is_some() {
            let kinds = day.and_then(|map| map.kinds.as_ref());
            let kinds = kinds.zip(water.and_then(|map| map.kinds.as_ref()));
            // An Earth without kinds has no use for them.
            let had_kinds = self.first.planner.kinds().is_some();
            let kinds = kinds.filter(|_| had_kinds);
            let kinds = kinds.map(|(day, water)| Arc::new(GroundKinds::of_parts(water, day)));
            self.first.planner.set_kinds(kinds);
        }
        self.follow_albedos(queue, maps.into_iter().flatten());
        Ok(())
    }

    fn replace_map(&mut self, map: &GpuMap) -> Result<(), EarthError> {
        let device = self.device.clone();
        let scope = ErrorScope::open(&device, wgpu::ErrorFilter::Validation);
        let before = self.surface.set_map(&device, map)?;
        if let Some(error) = scope.error() {
            self.surface.set_map(&device, &before)?;
            return Err(MapError::Rejected(error.to_string()).into());
        }
        if map.layer() == MapLayer::Day {
            self.first.planner.set_day_width(map.size().0);
        }
        Ok(())
    }

    /// The light of the air and metering follow the albedos of new maps, where they are known.
    fn follow_albedos<'m>(
        &mut self,
        queue: &wgpu::Queue,
        maps: impl IntoIterator<Item = &'m GpuMap>,
    ) {
        let mut albedo = self.first.planner.exposure.albedo().clone();
        let mut parts = maps
            .into_iter()
            .filter_map(|map| map.albedo.as_ref())
            .peekable();
        if parts.peek().is_none() {
            return;
        }
        parts.for_each(|part| Arc::make_mut(&mut albedo).set(part));
        self.first.planner.exposure.set_albedo(&albedo);
        if let Some(air) = self.air_textures() {
            air.set_albedo(queue, &albedo.texels(&self.quality.maps));
        }
    }
}
