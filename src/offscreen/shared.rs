//! Devices and maps that the Earths of one program share: a map is in memory once, however many Earths draw it.

use crate::{EarthLayers, GpuContext, UploadedMaps};
use std::fs;
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;

/// What maps are made from. Equal sources give equal maps.
#[derive(PartialEq)]
struct MapSource {
    device: wgpu::Device,
    /// Files with their lengths and times of change; files that cannot be examined have none.
    files: Vec<(PathBuf, Option<(u64, SystemTime)>)>,
    variant: String,
}

struct SharedMaps {
    source: MapSource,
    layers: EarthLayers,
    uploaded: UploadedMaps,
}

/// What is in use.
struct Registry {
    /// The process that it belongs to. A forked process cannot use the devices of its parent.
    process: u32,
    /// Devices by the adapter's name that was asked for.
    devices: Vec<(Option<String>, GpuContext)>,
    maps: Vec<SharedMaps>,
}

static REGISTRY: Mutex<Registry> = Mutex::new(Registry {
    process: 0,
    devices: Vec::new(),
    maps: Vec::new(),
});

impl Registry {
    fn lock() -> MutexGuard<'static, Self> {
        let mut registry = REGISTRY.lock().unwrap_or_else(PoisonError::into_inner);
        let process = std::process::id();
        if registry.process != process {
            // Of a parent before a fork: dropping them would act on its devices.
            std::mem::forget(std::mem::take(&mut registry.maps));
            std::mem::forget(std::mem::take(&mut registry.devices));
            registry.process = process;
        }
        registry
    }

    fn drop_unused(&mut self) {
        self.maps.retain(|maps| maps.uploaded.has_clones());
        self.devices.retain(|(_, gpu)| gpu.has_clones());
    }
}

/// The device that an Earth of this program already has for this name of an adapter, or one that is opened.
pub(super) fn gpu<E>(
    wanted: Option<&str>,
    open: impl FnOnce() -> Result<GpuContext, E>,
) -> Result<GpuContext, E> {
    let mut registry = Registry::lock();
    registry.drop_unused();
    let mut devices = registry.devices.iter();
    let known = devices.find(|(name, gpu)| name.as_deref() == wanted && gpu.is_usable());
    if let Some((_, gpu)) = known {
        return Ok(gpu.clone());
    }
    let gpu = open()?;
    let name = wanted.map(str::to_owned);
    registry.devices.push((name, gpu.clone()));
    Ok(gpu)
}

/// The maps of some files; see [`OffscreenEarth::shared_maps`](super::OffscreenEarth::shared_maps).
pub(super) fn maps<E>(
    gpu: &GpuContext,
    files: Vec<PathBuf>,
    variant: String,
    load: impl FnOnce() -> Result<(EarthLayers, UploadedMaps), E>,
) -> Result<(EarthLayers, UploadedMaps), E> {
    let stamp = |file: PathBuf| {
        let stamp = fs::metadata(&file).and_then(|meta| Ok((meta.len(), meta.modified()?)));
        (file, stamp.ok())
    };
    let source = MapSource {
        device: gpu.device.clone(),
        files: files.into_iter().map(stamp).collect(),
        variant,
    };
    // Another thread that wants the same maps waits until they are read.
    let mut registry = Registry::lock();
    registry.drop_unused();
    if let Some(known) = registry.maps.iter().find(|maps| maps.source == source) {
        return Ok((known.layers.clone(), known.uploaded.clone()));
    }
    let (layers, uploaded) = load()?;
    registry.maps.push(SharedMaps {
        source,
        layers: layers.clone(),
        uploaded: uploaded.clone(),
    });
    Ok((layers, uploaded))
}

/// Releases, when it is dropped, what no Earth uses.
pub(super) struct Release;

impl Drop for Release {
    fn drop(&mut self) {
        Registry::lock().drop_unused();
    }
}
