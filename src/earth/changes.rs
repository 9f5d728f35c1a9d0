//! What is changed while an Earth is drawn.

use super::surface_config::surface_config;
use super::tiles::TileLevels;
use super::{Earth, EarthError, Quality, air_textures, resolved};
use crate::air::Atmosphere;
use crate::gpu::{AirDrawable, PassFormat, SurfaceOutput};
use crate::light::Exposure;

impl Earth {
    /// Exposes so from the next [`Self::prepare`] on.
    ///
    /// # Errors
    /// An exposure outside its range; it is then as it was.
    pub fn set_exposure(&mut self, exposure: Exposure) -> Result<(), EarthError> {
        self.first.set_exposure(exposure)
    }

    /// How well it is drawn.
    pub fn quality(&self) -> &Quality {
        &self.quality
    }

    /// Draws better or worse from the next [`Self::prepare`] on. Maps and tiles stay on the GPU; pipelines and the
    /// lattice are made anew where they differ, which takes some milliseconds.
    ///
    /// # Errors
    /// As [`Self::new`]; the Earth is then as it was.
    pub fn set_quality(
        &mut self,
        queue: &wgpu::Queue,
        quality: &Quality,
    ) -> Result<(), EarthError> {
        let before = self.quality;
        self.apply(queue, quality).or_else(|failure| {
            self.apply(queue, &before)?;
            Err(failure)
        })
    }

    fn apply(&mut self, queue: &wgpu::Queue, quality: &Quality) -> Result<(), EarthError> {
        let mut quality = *quality;
        if !Quality::SCALES.contains(&quality.scale) {
            return Err(EarthError::Scale(quality.scale));
        }
        if self.style.diagnostics.output != SurfaceOutput::Color {
            quality.atmosphere = Atmosphere::None;
        }
        let first = &mut self.first;
        let meshes = first.planner.meshes_of(quality.subdivision)?;
        let format = PassFormat {
            samples: quality.samples,
            ..self.format
        };
        let device = self.device.clone();
        let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let fits = quality.samples == self.format.samples;
        let albedo = first.planner.exposure.albedo();
        let air = match (quality.atmosphere, first.air.take()) {
            (Atmosphere::None, _) => None,
            (Atmosphere::Billboard, Some(air)) if fits => Some(air),
            (Atmosphere::Billboard, before) => {
                let textures = before.map(|air| air.textures().clone());
                let textures = textures.unwrap_or_else(|| {
                    let (air, light) = (&self.air_options, &self.style.light);
                    air_textures(&device, queue, air, light, albedo, &quality)
                });
                let night = self.style.light.night_light();
                Some(AirDrawable::new(&device, format, textures, night)?)
            }
        };
        if let Some(air) = &air {
            air.textures()
                .set_albedo(queue, &albedo.texels(&quality.maps));
        }
        let (air_drawn, ground) = (air.as_ref(), first.planner.ground());
        let config = surface_config(&device, self.style, format, &quality, air_drawn, ground);
        first.surface.reset(&device, meshes.grids());
        self.surface
            .set_config(&device, &config, &mut first.surface)?;
        first.air = air;
        first.planner.set_quality(&quality, meshes);
        first.plan = first.planner.empty_plan();
        // What is chosen now does not depend on what was chosen before.
        first.levels = TileLevels::default();
        first.drawn = None;
        first.version.pipelines += 1;
        if let Some(tiles) = &mut self.tiles {
            tiles.set_quality(&quality);
        }
        (self.format, self.quality) = (format, quality);
        match resolved(scope.pop()) {
            None => Ok(()),
            Some(error) => Err(EarthError::Refused(error.to_string())),
        }
    }
}
