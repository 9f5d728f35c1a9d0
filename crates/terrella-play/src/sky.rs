//! The sky in images and the window: the player draws it as any host of [`terrella::celestial`] would.

use super::error::PlayError;
use super::flight::{Flight, Moment};
use super::maps::DroppedLayer;
use super::satellites::orientation_at;
use super::sky_parts::{Reading, read};
use crate::scene::Scene;
use terrella::celestial::{Celestial, CelestialMoment};
use terrella::frames::EarthOrientation;
use terrella::{Earth, FrameStats, GpuContext};

/// The sky in an image or a window.
pub struct SkyLayer {
    celestial: Celestial,
    orientation: Option<EarthOrientation>,
}

impl SkyLayer {
    /// The layer of a flight's scene, or of another scene with the same flight; `None` if it has none. Unreadable parts are left out, with a
    /// warning.
    ///
    /// # Errors
    /// In a strict scene, an unreadable part.
    pub fn of_scene(
        scene: &Scene,
        flight: &Flight,
        gpu: &GpuContext,
        earth: &Earth,
    ) -> Result<Option<Self>, PlayError> {
        if !scene.sky.is_on() {
            return Ok(None);
        }
        let (options, dropped) = read(scene, Reading::Whole)?;
        for DroppedLayer { layer, missing } in &dropped {
            tracing::warn!("{missing}; {layer} left out");
        }
        Ok(Some(Self {
            celestial: Celestial::new(&gpu.device, &gpu.queue, earth, &options)?,
            orientation: flight.earth_orientation().cloned(),
        }))
    }

    /// Follows the Earth to another quality.
    pub fn follow(&mut self, gpu: &GpuContext, earth: &Earth) -> Result<(), PlayError> {
        Ok(self.celestial.follow(&gpu.device, &gpu.queue, earth)?)
    }

    /// Writes an instant's sky, after the Earth's frame, and counts it.
    pub fn prepare(
        &mut self,
        gpu: &GpuContext,
        earth: &Earth,
        moment: &Moment,
        size: (u32, u32),
        stats: &mut FrameStats,
    ) {
        let orientation = orientation_at(self.orientation.as_ref(), moment.epoch);
        let when = CelestialMoment {
            epoch: moment.epoch,
            orientation: orientation.unwrap_or_default(),
            view: &moment.view,
            target: size.into(),
            velocity_m_s: moment.eye_velocity_m_s,
        };
        self.celestial.show_stars(!moment.is_starless);
        let own = self.celestial.prepare(&gpu.queue, earth, &when);
        stats.triangles += own.triangles;
        stats.draw_calls += own.draw_calls;
        stats.uploaded_bytes += own.uploaded_bytes;
        stats.texture_bytes += self.celestial.texture_bytes();
    }

    /// After the Earth.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.celestial.render(pass);
    }

    pub fn celestial(&self) -> &Celestial {
        &self.celestial
    }
}
