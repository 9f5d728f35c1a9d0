//! Times frames of an Earth beside their floor and a bare clear, interleaved on the same textures.

use super::floor::Floor;
use image::RgbaImage;
use std::time::Duration;
use terrella::frames::Epoch;
use terrella::internals::gpu::{GpuContext, GpuTimer};
use terrella::{EarthOptions, EyeView, FrameStats, Sky};
use terrella_play::{Moment, OffscreenRenderer, PlayError, TimedFrame};

/// An Earth, textures of one size, and the reference passes of its frames.
///
/// Absolute times on a shared machine have little meaning; the ratio of a frame to its floor, measured at the same moment, does.
pub struct FrameTimer {
    picture: OffscreenRenderer,
    floor: Floor,
}

/// Times of one frame and its floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameTimes {
    /// Statistics of the frame.
    pub stats: FrameStats,
    /// `prepare` alone, milliseconds.
    pub prepare_ms: f64,
    /// The whole frame, the device waited for, milliseconds.
    pub frame_ms: f64,
    /// The floor, waited for likewise, milliseconds.
    pub floor_ms: f64,
}

impl FrameTimer {
    /// Uploads the maps and makes both passes.
    ///
    /// # Errors
    /// As [`OffscreenRenderer::open`].
    pub fn new(
        gpu: &GpuContext,
        options: &EarthOptions,
        size: (u32, u32),
    ) -> Result<Self, PlayError> {
        let picture = OffscreenRenderer::open(gpu.clone(), options.clone(), size)?;
        Ok(Self {
            floor: Floor::new(gpu, options, picture.earth().format()),
            picture,
        })
    }

    /// The renderer of the frames.
    pub fn picture(&self) -> &OffscreenRenderer {
        &self.picture
    }

    /// The renderer of the frames, mutable, for drawing other ones.
    pub fn picture_mut(&mut self) -> &mut OffscreenRenderer {
        &mut self.picture
    }

    /// Draws a view when its tiles have come, or `wait` is over, and reads it back.
    ///
    /// # Errors
    /// A lost device.
    pub fn draw(
        &mut self,
        view: &EyeView,
        sky: &Sky,
        wait: Duration,
    ) -> Result<RgbaImage, PlayError> {
        self.picture.draw_complete(&moment(view, sky), wait);
        self.picture.read()
    }

    /// Draws a view when its tiles have arrived, or `wait` is over; returns the number of missing tiles. Does nothing without tiles.
    pub fn wait_for_tiles(&mut self, view: &EyeView, sky: &Sky, wait: Duration) -> usize {
        if !self.picture.earth().has_tiles() {
            return 0;
        }
        self.picture.draw_complete(&moment(view, sky), wait).1.len()
    }

    /// Draws a view when terrain is as fine as it will be, or `wait` is over.
    pub fn wait_for_ground(&mut self, view: &EyeView, sky: &Sky, wait: Duration) {
        self.picture.draw_complete(&moment(view, sky), wait);
    }

    /// Prepares a view and draws nothing: a frame of a flight on the way to one that is timed.
    ///
    /// # Errors
    /// A lost device.
    pub fn prepare_alone(&mut self, view: &EyeView, sky: &Sky) -> Result<(), PlayError> {
        self.picture.prepare_alone(&moment(view, sky))
    }

    /// Times the floor of a view, milliseconds.
    ///
    /// # Errors
    /// A lost device.
    pub fn floor_ms(&mut self, view: &EyeView, sky: &Sky) -> Result<f64, PlayError> {
        let gpu = self.picture.gpu();
        self.floor
            .prepare(&gpu.queue, view, sky, self.picture.size());
        let floor = self.picture.time_other(|pass| self.floor.render(pass))?;
        Ok(milliseconds(floor))
    }

    /// Times the parts of a view on the device: as [`OffscreenRenderer::time_passes`].
    ///
    /// # Errors
    /// A lost device.
    pub fn time_passes(
        &mut self,
        view: &EyeView,
        sky: &Sky,
        timer: &GpuTimer,
    ) -> Result<Vec<(&'static str, f64)>, PlayError> {
        self.picture.time_passes(&moment(view, sky), timer)
    }

    /// Times a view and its floor, once each.
    ///
    /// # Errors
    /// A lost device.
    pub fn time_frame_and_floor(
        &mut self,
        view: &EyeView,
        sky: &Sky,
    ) -> Result<FrameTimes, PlayError> {
        let measured = self.time_frame(view, sky)?;
        let floor_ms = self.floor_ms(view, sky)?;
        Ok(FrameTimes {
            stats: measured.stats,
            prepare_ms: milliseconds(measured.prepare),
            frame_ms: milliseconds(measured.frame),
            floor_ms,
        })
    }

    /// Times a view, the device waited for.
    ///
    /// # Errors
    /// A lost device.
    pub fn time_frame(&mut self, view: &EyeView, sky: &Sky) -> Result<TimedFrame, PlayError> {
        self.picture.time(&moment(view, sky))
    }

    /// Times a pass that clears and draws nothing, milliseconds.
    ///
    /// # Errors
    /// A lost device.
    pub fn clear_ms(&self) -> Result<f64, PlayError> {
        Ok(milliseconds(self.picture.time_other(|_| {})?))
    }
}

/// A view without a craft as an instant of a flight.
pub(super) fn moment(view: &EyeView, sky: &Sky) -> Moment {
    Moment {
        // Without spacecraft nothing depends on the epoch.
        epoch: Epoch::from_gregorian_utc(2000, 1, 1, 12, 0, 0, 0),
        frame: 0,
        view: *view,
        sky: *sky,
        satellite: None,
        craft: None,
        eye_velocity_m_s: None,
        turn: None,
        is_starless: false,
        exposure_ev: None,
        shot: 0,
    }
}

pub(super) fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}
