//! Creation of an Earth: in one call, or awaited where the device answers later.

use super::appearance::Appearance;
use super::earth_view::{EarthView, Version};
use super::options::{EarthOptions, Pipelines};
use super::plan::Planner;
use super::quality::Quality;
use super::surface_config::{SurfaceStyle, surface_config};
use super::tiles::TileDriver;
use super::{Earth, EarthError};
#[cfg(not(target_family = "wasm"))]
use crate::gpu::resolved;
use crate::gpu::{
    AirDrawable, AirTextures, CreationErrors, CreationScopes, SurfaceDrawable, SurfaceOutput,
    SurfaceView, device_limits,
};
use crate::plan::ChosenTiles;
use std::sync::atomic::{AtomicU64, Ordering};
use terrella_ground::air::{AirAboveClouds, AirModel, AirTables, Atmosphere};
use terrella_imagery::NeighbourhoodAlbedo;

/// Gives each Earth a unique number.
static EARTHS: AtomicU64 = AtomicU64::new(0);

impl Earth {
    /// Makes pipelines and uploads the maps that [`EarthOptions::upload`] has not uploaded. It submits large maps to `queue` in parts and waits for
    /// them, so that few copies are in memory at once. A web page, which cannot wait, calls [`Self::create`] instead.
    ///
    /// # Errors
    /// Options out of their range or that exclude each other, a map that does not fit its description or the device, not enough memory, or what the
    /// device rejects: a colour format that it cannot render and blend, or a number of samples that it lacks.
    #[cfg(not(target_family = "wasm"))]
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        options: &EarthOptions,
    ) -> Result<Self, EarthError> {
        let scopes = CreationScopes::open(device);
        let made = Self::make(device, queue, options);
        let errors = resolved(scopes.end()).unwrap_or_default();
        made?.unless(errors)
    }

    /// Like [`Self::new`], for devices that report errors asynchronously, as in a web page: errors are awaited, everything else is done in the
    /// call.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub async fn create(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        options: &EarthOptions,
    ) -> Result<Self, EarthError> {
        let scopes = CreationScopes::open(device);
        let made = Self::make(device, queue, options);
        let errors = scopes.end().await;
        made?.unless(errors)
    }

    /// Returns itself if the device reported no error.
    fn unless(self, errors: CreationErrors) -> Result<Self, EarthError> {
        if let Some(error) = errors.out_of_memory {
            return Err(EarthError::NoRoom {
                mib: self.surface.texture_bytes() >> 20,
                cause: error.to_string(),
            });
        }
        match errors.rejected {
            Some(error) => Err(EarthError::rejected(error)),
            None => Ok(self),
        }
    }

    fn make(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        options: &EarthOptions,
    ) -> Result<Self, EarthError> {
        options.check(device)?;
        let appearance = options.appearance();
        let mut quality = Quality::of(options);
        if options.diagnostics.output != SurfaceOutput::Color {
            quality.atmosphere = Atmosphere::None;
        }
        let tiles = options.tiles.as_ref();
        let tiles =
            tiles.map(|t| TileDriver::new(t, &options.layers, options.visibility, options.figure));
        let tiles = tiles.transpose()?;
        let planner = Planner::new(options, &quality, &device_limits(&device.limits()))?;
        if options.diagnostics.wireframe && !planner.has_edges() {
            return Err(EarthError::NoEdges);
        }
        let format = options.pass_format();
        let mut air = match quality.atmosphere {
            Atmosphere::Billboard => {
                let albedo = planner.exposure.albedo();
                let textures = air_textures(device, queue, &appearance, albedo, &quality);
                Some(AirDrawable::new(device, format, textures, &options.light))
            }
            Atmosphere::None => None,
        };
        let style = SurfaceStyle {
            shading: options.shading,
            light: options.light,
            diagnostics: options.diagnostics,
            interpolates_air: options.interpolates_air(),
            pipelines: options.pipelines,
            has_city_lights: options.city_lights.is_some(),
        };
        let ground = planner.ground();
        let textures = air.as_ref().map(AirDrawable::textures);
        let config = surface_config(device, style, format, &quality, textures, ground);
        let pools = tiles.as_ref().map(TileDriver::pools);
        let mut view = SurfaceView::new(device, planner.meshes().grids(), &config);
        let maps = (&options.layers, &options.uploaded);
        let mut surface = SurfaceDrawable::new(device, queue, maps, pools, &config, &mut view);
        if let Some(lights) = &options.city_lights {
            surface.set_city_lights(lights.clone());
        }
        if options.pipelines == Pipelines::AtOnce {
            surface.make_all(device, &config, &view)?;
            if let Some(air) = &mut air {
                air.make_all(device)?;
            }
        }
        let version = Version {
            earth: EARTHS.fetch_add(1, Ordering::Relaxed),
            grounds: 0,
            pipelines: 0,
        };
        let first = EarthView::new(planner, view, air, version);
        Ok(Self {
            first,
            surface,
            tiles,
            chosen: ChosenTiles::default(),
            figure: options.figure,
            appearance,
            device: device.clone(),
            style,
            format,
            quality,
            uploaded_tiles: 0,
            error: None,
        })
    }
}

/// Textures of the air over the ground of a quality.
pub(super) fn air_textures(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    appearance: &Appearance,
    albedo: &NeighbourhoodAlbedo,
    quality: &Quality,
) -> AirTextures {
    let (model, tables) = (
        AirModel::new(&appearance.air),
        AirTables::shared(&appearance.air),
    );
    let height_m = appearance.light.cloud_height_m;
    let above = albedo
        .has_clouds()
        .then(|| AirAboveClouds::shared(&appearance.air, height_m));
    let clouds = above.as_deref().map(|above| (above, height_m));
    let albedo = albedo.texels(&quality.maps);
    let moonlight = appearance.light.moonlight;
    AirTextures::new(device, queue, model, &tables, &albedo, clouds, moonlight)
}
