//! The frames of a scene's film, drawn in any order.
//!
//! A frame is a function of its number: also where exposure is metered, which follows the frames before. Whoever draws a part of a film
//! therefore draws the same pictures as who draws all of it.

use super::painter::FilmPainter;
use super::picture::FilmPicture;
use super::record::FrameRecord;
use super::settings::PictureSettings;
use crate::clock::{epoch_after, frame_epoch};
use crate::error::PlayError;
use crate::flight::Flight;
use terrella::frames::Epoch;
use terrella::{EarthOptions, Exposure, GpuContext};
use terrella_imagery::tile::TileKey;

/// Draws the frames of a scene's film.
pub struct FilmFrames {
    painter: FilmPainter,
    settings: PictureSettings,
    has_tiles: bool,
    /// Metered exposures of the first frames, as far as known, EV; `None` before the first that is metered.
    exposures_ev: Vec<Option<f64>>,
}

/// A frame that is drawn and not written.
pub struct DrawnFrame {
    /// Its record without the file.
    pub record: FrameRecord,
    /// The image.
    pub picture: FilmPicture,
    /// Tiles that it lacks.
    pub missing: Vec<TileKey>,
}

impl FilmFrames {
    /// Uploads the maps to an adapter with [`FilmPainter::features`].
    ///
    /// # Errors
    /// Invalid settings; maps and textures that do not fit into the device's memory.
    pub fn open(
        flight: &Flight,
        gpu: GpuContext,
        options: EarthOptions,
        size: (u32, u32),
        settings: PictureSettings,
    ) -> Result<Self, PlayError> {
        Ok(Self {
            has_tiles: options.tiles.is_some(),
            painter: FilmPainter::open(flight, gpu, options, size, settings)?,
            settings,
            exposures_ev: Vec::new(),
        })
    }

    /// The painter of the frames.
    pub fn painter(&mut self) -> &mut FilmPainter {
        &mut self.painter
    }

    /// Where exposure is metered, follows the light up to a frame that is not drawn itself.
    ///
    /// # Errors
    /// An instant that is not known.
    pub fn follow(&mut self, flight: &Flight, index: u64) -> Result<(), PlayError> {
        let time = &flight.scene().time;
        let aspect = self.painter.aspect();
        let renderer = self.painter.renderer();
        if !renderer.meters_exposure() {
            return Ok(());
        }
        for n in self.exposures_ev.len() as u64..=index {
            let moment = flight.at(frame_epoch(time, n), aspect)?;
            let ev = renderer.follow_light(&moment, 1.0 / time.frame_rate_hz)?;
            // If nothing is metered, the exposure is kept.
            let before = self.exposures_ev.last().copied().flatten();
            self.exposures_ev.push(ev.or(before));
        }
        Ok(())
    }

    /// Draws a frame.
    ///
    /// # Errors
    /// An instant that is not known, a lost device.
    pub fn draw(&mut self, flight: &Flight, index: u64) -> Result<DrawnFrame, PlayError> {
        let scene = flight.scene();
        let (time, aspect) = (&scene.time, self.painter.aspect());
        let epoch = frame_epoch(time, index);
        let moment = flight.at(epoch, aspect)?;
        self.follow(flight, index)?;
        // 2^64 frames are not drawn.
        if let Some(ev) = self.exposures_ev.get(index as usize) {
            let exposure = ev.map_or(Exposure::Auto, Exposure::Ev);
            self.painter.renderer().set_exposure(exposure)?;
        }
        if self.has_tiles {
            // The next frame's tiles are read while this one is drawn and written.
            let next = flight.at(frame_epoch(time, index + 1), aspect);
            let next = next.as_ref();
            let views = next.map_or(&[][..], |next| std::slice::from_ref(&next.view));
            self.painter.renderer().prefetch(views);
        }
        let after = |part: f64| epoch_after(time, index as f64 + part);
        let painted = self
            .painter
            .paint(&moment, |part| flight.at(after(part), aspect))?;
        let (start, ev) = (time.start, painted.exposure_ev);
        let mut record = FrameRecord::new(index, start, epoch, &moment.view, ev);
        record.shutter_ns = self.settings.shutter.map(|shutter| {
            let ns = |epoch: Epoch| (epoch - start).total_nanoseconds();
            // Scenes reach over two hundred years, 6.3e18 ns.
            [0.0, shutter.open].map(|part| ns(after(part)) as i64)
        });
        Ok(DrawnFrame {
            record,
            picture: painted.picture,
            missing: painted.missing,
        })
    }
}
