//! A sensor's raw frame, drawn: light band by band, then electrons and numbers.

use super::error::PlayError;
use super::flight::{Flight, Moment};
use super::offscreen::OffscreenRenderer;
use super::raw_manifest::{RawManifest, RawParts};
use super::sensor_bands::SensorView;
use std::path::Path;
use std::time::Duration;
use terrella::{EarthOptions, GpuContext};
use terrella_imagery::tile::TileKey;
use terrella_sensor::{ASTRONOMICAL_UNIT_M, PinholePicture, RawFrame, Wells};

/// A raw frame and its wells.
pub struct RawPicture {
    /// The frame.
    pub raw: RawFrame,
    wells: Wells,
    /// Its place in the scene's film, by which noise differs from frame to frame.
    number: u32,
    /// Tiles that its light lacks.
    pub missing: Vec<TileKey>,
}

/// Draws raw frames, one after the other.
pub struct RawPainter {
    renderer: OffscreenRenderer,
    /// How long a picture waits for tiles.
    wait: Duration,
}

impl RawPainter {
    /// For a flight's scene. Synthetic detail is off: measurements use data only.
    ///
    /// # Errors
    /// Maps that cannot be read, or a device that is out of memory.
    pub fn new(
        flight: &Flight,
        gpu: GpuContext,
        mut options: EarthOptions,
    ) -> Result<Self, PlayError> {
        options.light.detail = false;
        // Each band has its own size.
        let mut renderer = OffscreenRenderer::open_for_radiance(gpu, options, (1, 1))?;
        renderer.show_dated_maps(flight)?;
        renderer.show_models(flight)?;
        // Ghosts are centred on the full image, not on a band.
        renderer.show_sky_without(flight, "ghosts")?;
        Ok(Self {
            renderer,
            wait: flight.scene().output.wait(),
        })
    }

    /// Waits for tiles no longer than this.
    pub fn limit_wait(&mut self, most: Duration) {
        self.wait = self.wait.min(most);
    }

    /// Draws the light of a moment as the sensor sees it, and reads the sensor out.
    ///
    /// # Errors
    /// A lost device, a device without room.
    pub fn draw(&mut self, seen: &SensorView, moment: &Moment) -> Result<RawPicture, PlayError> {
        let renderer = &mut self.renderer;
        let (mut light, mut missing) = (Vec::new(), Vec::new());
        for band in &seen.bands.bands {
            renderer.resize(band.size())?;
            let (_, lacks) = renderer.draw_complete(&band.pinhole(), self.wait);
            missing.extend(lacks);
            let pixels = renderer.read_light()?;
            let picture = PinholePicture::new(band.frame, &pixels)?;
            light.extend(seen.sensor.expose(band.rows.clone(), &picture)?);
        }
        let number = moment.frame;
        let sun_distance_au = moment.sky.sun_distance_m / ASTRONOMICAL_UNIT_M;
        let (raw, wells) = seen.sensor.read_out(&light, sun_distance_au, number)?;
        missing.sort();
        missing.dedup();
        Ok(RawPicture {
            raw,
            wells,
            number,
            missing,
        })
    }
}

impl RawPicture {
    /// The page of the frame, whose file this is.
    pub fn manifest(
        &self,
        flight: &Flight,
        seen: &SensorView,
        moment: &Moment,
        file: &Path,
    ) -> RawManifest {
        let name = file.file_name().unwrap_or_default();
        RawManifest::new(
            flight,
            &RawParts {
                file: name.display().to_string(),
                moment,
                sensor: &seen.sensor,
                bands: &seen.bands,
                number: self.number,
                raw: &self.raw,
                wells: &self.wells,
            },
        )
    }
}
