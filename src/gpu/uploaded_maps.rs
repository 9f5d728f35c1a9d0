//! Maps that are uploaded before an Earth is made with them.

use super::map::{is_stored, label, unfit};
use super::map_upload::MapUpload;
use super::{ErrorScope, GpuLayer, GpuMap, MapError};
use std::sync::{Arc, Mutex, PoisonError};
use terrella_ground::globe::Shading;
use terrella_imagery::tile::{MAP_LAYERS, MapLayer};
use terrella_imagery::{LayerImage, MapRows, MapSink, MapSummaryRows, TexelFormat};

/// Maps on one device for Earths that are made later. Clones share the textures, and so do all Earths made with them.
///
/// It is filled by [`EarthOptions::upload`](crate::EarthOptions::upload) from maps in memory, or by a [`MapUploader`] from files.
#[derive(Clone, Debug, Default)]
pub struct UploadedMaps(Arc<[Option<GpuMap>; MAP_LAYERS]>);

impl UploadedMaps {
    /// A map by its kind.
    pub fn get(&self, layer: MapLayer) -> Option<&GpuMap> {
        self.0[layer.index()].as_ref()
    }

    /// Adds maps, which replace those of the same kind.
    pub(crate) fn add(&mut self, others: Self) {
        others
            .0
            .iter()
            .flatten()
            .for_each(|map| self.set(map.clone()));
    }

    fn set(&mut self, map: GpuMap) {
        let index = map.layer().index();
        Arc::make_mut(&mut self.0)[index] = Some(map);
    }

    /// Whether there is another clone.
    #[cfg(feature = "offscreen")]
    pub(crate) fn has_clones(&self) -> bool {
        Arc::strong_count(&self.0) > 1
    }

    /// The uploaded map that replaces one without texels, for a device and a shading.
    pub(crate) fn fitting(
        &self,
        layer: MapLayer,
        map: &LayerImage,
        (device, shading): (&wgpu::Device, Shading),
    ) -> Option<Result<&GpuMap, MapError>> {
        let uploaded = self.get(layer).filter(|_| !map.has_texels())?;
        let (width, height) = uploaded.size();
        let what = if (width, height) != (map.width, map.height) {
            format!(
                "it is {width} × {height} on the GPU and {} × {} by its description; upload it again",
                map.width, map.height
            )
        } else if uploaded.device.as_ref().is_some_and(|of| of != device) {
            "it is on another device; load it again and upload it to this one".to_owned()
        } else if uploaded
            .shading
            .is_some_and(|of| is_stored(of) != is_stored(shading))
        {
            "it was uploaded for another shading; upload it again".to_owned()
        } else {
            return Some(Ok(uploaded));
        };
        Some(Err(unfit(layer, what)))
    }
}

/// Uploads maps while they are read from files ([`load_layers_to`](terrella_imagery::load_layers_to)): no map is in memory as a whole, except the
/// day map.
pub struct MapUploader(Arc<Uploads>);

struct Uploads {
    device: wgpu::Device,
    queue: wgpu::Queue,
    shading: Shading,
    done: Mutex<Result<UploadedMaps, MapError>>,
}

impl MapUploader {
    /// For Earths with this shading.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, shading: Shading) -> Self {
        Self(Arc::new(Uploads {
            device: device.clone(),
            queue: queue.clone(),
            shading,
            done: Mutex::new(Ok(UploadedMaps::default())),
        }))
    }

    /// The maps whose rows have all come.
    ///
    /// # Errors
    /// The first map that the device rejected.
    pub fn finish(self) -> Result<UploadedMaps, MapError> {
        let mut done = self.0.done.lock().unwrap_or_else(PoisonError::into_inner);
        std::mem::replace(&mut *done, Ok(UploadedMaps::default()))
    }

    /// Begins a map of this size, texels, whose rows come from elsewhere, such as a worker of a web page. `None` for a map that is too large for the
    /// device. Without the rows' last call, [`MapRows::finish`], the map is left out.
    pub fn rows(
        &self,
        layer: MapLayer,
        (width, height): (u32, u32),
        format: TexelFormat,
    ) -> Option<Box<dyn MapRows>> {
        let uploads = &self.0;
        if width.max(height) > uploads.device.limits().max_texture_dimension_2d {
            return None;
        }
        let map = LayerImage {
            width,
            height,
            format,
            levels: [].into(),
        };
        let (device, queue) = (&uploads.device, &uploads.queue);
        let memory = ErrorScope::open(device, wgpu::ErrorFilter::OutOfMemory);
        let validation = ErrorScope::open(device, wgpu::ErrorFilter::Validation);
        let is_stored = is_stored(uploads.shading);
        Some(Box::new(Rows {
            upload: MapUpload::new(device, queue, &label(layer), &map, is_stored),
            summary: MapSummaryRows::new(layer, (width, height), format),
            layer,
            validation,
            memory,
            uploads: uploads.clone(),
        }))
    }
}

impl MapSink for MapUploader {
    /// A map that is too large stays in memory. It is an error when an Earth is made with it.
    fn begin(
        &self,
        layer: MapLayer,
        size: (u32, u32),
        format: TexelFormat,
    ) -> Option<Box<dyn MapRows + '_>> {
        self.rows(layer, size, format)
    }
}

/// Rows of one map.
struct Rows {
    layer: MapLayer,
    upload: MapUpload,
    summary: MapSummaryRows,
    // In the order in which the scopes must end.
    validation: ErrorScope,
    memory: ErrorScope,
    uploads: Arc<Uploads>,
}

impl MapRows for Rows {
    fn rows(&mut self, level: usize, first: u32, texels: &[u8]) {
        self.upload.rows(level, first, texels);
        self.summary.rows(level, first, texels);
    }

    fn finish(self: Box<Self>) {
        let held = GpuLayer::of_upload(self.upload);
        let rejected = self.validation.error();
        let full = self.memory.error();
        let uploads = self.uploads;
        let mut done = uploads.done.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(error) = full.or(rejected) {
            if done.is_ok() {
                *done = Err(MapError::Rejected(error.to_string()));
            }
        } else if let Ok(maps) = &mut *done {
            let summary = self.summary.summary();
            maps.set(GpuMap::of_summary(
                self.layer,
                held,
                summary,
                (&uploads.device, uploads.shading),
            ));
        }
    }
}
