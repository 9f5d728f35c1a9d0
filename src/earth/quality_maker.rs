//! What another quality needs, made by any thread while the Earth is drawn.

use super::earth_view::Version;
use super::surface_config::{SurfaceStyle, surface_config};
use super::{Earth, EarthError, Quality, air_textures, resolved};
use crate::air::{AirOptions, Atmosphere};
use crate::frames::Ellipsoid;
use crate::globe::Meshes;
use crate::gpu::{
    AirDrawable, AirTextures, PassFormat, SurfaceMaker, SurfaceOutput, SurfacePipelines,
};
use crate::imagery::NeighbourhoodAlbedo;
use std::sync::Arc;

/// Makes pipelines and meshes of other qualities for one Earth, on any thread: [`Earth::quality_maker`].
///
/// ```no_run
/// # fn frame(earth: &mut terrella::Earth, queue: &terrella::wgpu::Queue, wanted: terrella::Quality) -> Result<(), terrella::EarthError> {
/// let (maker, of_thread) = (earth.quality_maker(queue), wanted);
/// let making = std::thread::spawn(move || maker.make(&of_thread));
/// // Frames go on as before, until `making.is_finished()`.
/// let ready = making.join().expect("it does not panic")?;
/// earth.set_ready_quality(queue, ready)
/// # }
/// ```
#[derive(Clone)]
pub struct QualityMaker {
    device: wgpu::Device,
    queue: wgpu::Queue,
    surface: SurfaceMaker,
    /// Those that there are; the Earth may have been made without air.
    air: Option<AirTextures>,
    air_options: AirOptions,
    albedo: Arc<NeighbourhoodAlbedo>,
    style: SurfaceStyle,
    format: PassFormat,
    ellipsoid: Ellipsoid,
    has_tiles: bool,
    version: Version,
}

/// All that an Earth needs to be drawn with another quality: [`Earth::set_ready_quality`].
pub struct ReadyQuality {
    quality: Quality,
    format: PassFormat,
    meshes: Meshes,
    air: ReadyAir,
    surface: SurfacePipelines,
    version: Version,
}

/// The air of another quality.
enum ReadyAir {
    None,
    /// The one that there is.
    Kept,
    Made(Box<AirDrawable>),
}

impl ReadyQuality {
    /// The quality that it is for.
    pub fn quality(&self) -> &Quality {
        &self.quality
    }
}

impl QualityMaker {
    /// Makes what a quality needs: pipelines and meshes. It takes tens of milliseconds, and much more where drivers compile slowly.
    ///
    /// # Errors
    /// As [`Earth::new`].
    pub fn make(&self, quality: &Quality) -> Result<ReadyQuality, EarthError> {
        let mut quality = *quality;
        if !Quality::SCALES.contains(&quality.scale) {
            return Err(EarthError::Scale(quality.scale));
        }
        if self.style.diagnostics.output != SurfaceOutput::Color {
            quality.atmosphere = Atmosphere::None;
        }
        let meshes = super::plan::meshes(self.ellipsoid, quality.subdivision, self.has_tiles)?;
        let format = PassFormat {
            samples: quality.samples,
            ..self.format
        };
        let device = &self.device;
        let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let fits = quality.samples == self.format.samples;
        let air = match (quality.atmosphere, &self.air) {
            (Atmosphere::None, _) => ReadyAir::None,
            (Atmosphere::Billboard, Some(_)) if fits => ReadyAir::Kept,
            (Atmosphere::Billboard, before) => {
                let textures = before.clone().unwrap_or_else(|| {
                    let (air, light) = (&self.air_options, &self.style.light);
                    air_textures(device, &self.queue, air, light, &self.albedo, &quality)
                });
                let night = self.style.light.night_light();
                let air = AirDrawable::new(device, format, textures, night)?;
                ReadyAir::Made(Box::new(air))
            }
        };
        let textures = match &air {
            ReadyAir::None => None,
            ReadyAir::Kept => self.air.as_ref(),
            ReadyAir::Made(air) => Some(air.textures()),
        };
        let config = surface_config(device, self.style, format, &quality, textures, None);
        let surface = self.surface.make(device, &config)?;
        if let Some(error) = resolved(scope.pop()) {
            return Err(EarthError::Refused(error.to_string()));
        }
        Ok(ReadyQuality {
            quality,
            format,
            meshes,
            air,
            surface,
            version: self.version,
        })
    }
}

impl Earth {
    /// How well it is drawn.
    pub fn quality(&self) -> &Quality {
        &self.quality
    }

    /// Draws better or worse from the next [`Self::prepare`] on. Maps and tiles stay on the GPU; pipelines and the
    /// lattice are made anew, which takes longer than a frame: [`Self::quality_maker`] has another thread do it.
    ///
    /// # Errors
    /// As [`Self::new`]; the Earth is then as it was.
    pub fn set_quality(
        &mut self,
        queue: &wgpu::Queue,
        quality: &Quality,
    ) -> Result<(), EarthError> {
        let ready = self.quality_maker(queue).make(quality)?;
        self.set_ready_quality(queue, ready)
    }

    /// What makes other qualities ready for this Earth as it is now.
    pub fn quality_maker(&self, queue: &wgpu::Queue) -> QualityMaker {
        let planner = &self.first.planner;
        QualityMaker {
            device: self.device.clone(),
            queue: queue.clone(),
            surface: self.surface.maker(&self.first.surface),
            air: self.air_textures().cloned(),
            air_options: self.air_options,
            albedo: planner.exposure.albedo().clone(),
            style: self.style,
            format: self.format,
            ellipsoid: planner.ellipsoid(),
            has_tiles: self.tiles.is_some(),
            version: self.first.version,
        }
    }

    /// Draws so from the next [`Self::prepare`] on. Nothing is compiled: it binds textures and makes some buffers. If the sample count
    /// differs, the next pass must have it.
    ///
    /// # Errors
    /// [`EarthError::OutOfDate`] of what was made for another Earth, or before this one was given another quality; the Earth is then as it
    /// was.
    pub fn set_ready_quality(
        &mut self,
        queue: &wgpu::Queue,
        ready: ReadyQuality,
    ) -> Result<(), EarthError> {
        let first = &mut self.first;
        if ready.version != first.version {
            return Err(EarthError::OutOfDate);
        }
        let (device, quality) = (&self.device, ready.quality);
        let air = match ready.air {
            ReadyAir::None => None,
            ReadyAir::Kept => first.air.take(),
            ReadyAir::Made(air) => Some(*air),
        };
        if let Some(air) = &air {
            let albedo = first.planner.exposure.albedo().texels(&quality.maps);
            air.textures().set_albedo(queue, &albedo);
        }
        first.set_quality(device, &quality, ready.meshes, air);
        let ground = first.planner.ground();
        let air = first.air.as_ref().map(AirDrawable::textures);
        let config = surface_config(device, self.style, ready.format, &quality, air, ground);
        self.surface
            .set_pipelines(device, ready.surface, &config, &mut first.surface);
        first.version.pipelines += 1;
        if let Some(tiles) = &mut self.tiles {
            tiles.set_quality(&quality);
        }
        (self.format, self.quality) = (ready.format, quality);
        Ok(())
    }
}
