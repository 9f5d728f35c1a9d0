//! A sensor's raw frame, drawn: light band by band, then electrons and numbers.

use super::error::PlayError;
use super::flight::{Flight, Moment};
use super::offscreen::OffscreenRenderer;
use super::raw_manifest::{RawManifest, RawParts};
use super::sensor_bands::SensorView;
use std::path::Path;
use terrella::{EarthOptions, GpuContext};
use terrella_imagery::tile::TileKey;
use terrella_sensor::{ASTRONOMICAL_UNIT_M, PinholePicture, RawFrame, Wells};

/// A raw frame and what it was read from.
pub struct RawPicture {
    /// The frame.
    pub raw: RawFrame,
    wells: Wells,
    /// Its place in the scene's film, by which noise differs from frame to frame.
    number: u32,
    /// Tiles that its light lacks.
    pub missing: Vec<TileKey>,
}

impl RawPicture {
    /// Draws the light of a moment as the sensor sees it, and reads the sensor out. `options` are those of light.
    pub fn draw(
        flight: &Flight,
        gpu: GpuContext,
        options: EarthOptions,
        seen: &SensorView,
        moment: &Moment,
    ) -> Result<Self, PlayError> {
        let bands = &seen.bands.bands;
        let size = bands.first().map_or((1, 1), |band| band.size());
        let mut renderer = OffscreenRenderer::open_for_light(gpu, options, size)?;
        renderer.show_dated_maps(flight)?;
        renderer.show_sky(flight)?;
        let (mut light, mut missing) = (Vec::new(), Vec::new());
        for band in bands {
            renderer.resize(band.size())?;
            let wait = flight.scene().output.wait();
            let (_, lacks) = renderer.draw_complete(&band.pinhole(), wait);
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
        Ok(Self {
            raw,
            wells,
            number,
            missing,
        })
    }

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
