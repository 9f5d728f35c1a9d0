//! Frame times of a surface, measured interleaved with its floor and a frame of blocks.

use super::flight_errors::FRAMES_PER_S;
use super::rows::{TimeRow, rounded};
use super::run::FlightMeter;
use super::{Candidate, SurfacePath, SurfacesError, TestGround};
use crate::FrameTimer;
use crate::frame_timer::milliseconds;
use cpu_time::ProcessTime;
use std::time::Duration;
use terrella::{EarthOptions, EyeView, Subdivision};
use terrella_ground::globe::SurfaceKind;

/// Frames that move before the one that is timed.
const FRAMES_BEFORE: u32 = 8;
/// How long a surface may take to become as fine as it would be had it been flown there.
const SETTLE: Duration = Duration::from_secs(20);

impl FlightMeter<'_> {
    /// Timer of frames of blocks, for all settings.
    pub fn blocks_timer(&self, ground: &TestGround) -> Result<FrameTimer, SurfacesError> {
        let blocks = SurfaceKind::Blocks.settings(Subdivision::Auto);
        self.timer(ground, &Candidate::unnamed(blocks))
    }

    fn timer(
        &self,
        ground: &TestGround,
        candidate: &Candidate,
    ) -> Result<FrameTimer, SurfacesError> {
        let options = EarthOptions {
            ground: Some(self.ground_options(ground, candidate)),
            ..self.options.clone()
        };
        Ok(FrameTimer::new(self.gpu, &options, self.size)?)
    }

    /// Times frames of one setting in places of a flight; `None` if that was stopped.
    pub fn times(
        &self,
        ground: &TestGround,
        path: SurfacePath,
        candidate: &Candidate,
        blocks: &mut FrameTimer,
    ) -> Result<Option<Vec<TimeRow>>, SurfacesError> {
        let mut timer = self.timer(ground, candidate)?;
        let setting = &candidate.setting;
        let mut rows = Vec::new();
        for place in 0..self.places {
            if self.progress.cancelled() {
                return Ok(None);
            }
            let time_s = path.duration_s() * (f64::from(place) + 0.5) / f64::from(self.places);
            let view =
                |before: u32| self.view(path, ground, time_s - f64::from(before) / FRAMES_PER_S);
            let settle = |timer: &mut FrameTimer| {
                timer.wait_for_ground(&view(FRAMES_BEFORE), &self.sky, SETTLE);
                (1..FRAMES_BEFORE)
                    .rev()
                    .try_for_each(|before| timer.prepare_alone(&view(before), &self.sky))
            };
            settle(&mut timer)?;
            settle(blocks)?;
            let now = view(0);
            // Either one first, in alternation.
            let (one, other) = match place % 2 {
                0 => {
                    let one = self.time_one(&mut timer, &now)?;
                    (one, self.time_one(blocks, &now)?)
                }
                _ => {
                    let other = self.time_one(blocks, &now)?;
                    (self.time_one(&mut timer, &now)?, other)
                }
            };
            rows.push(TimeRow {
                data: ground.name.into(),
                path,
                surface: setting.surface,
                parameter: setting.parameter.into(),
                value: setting.value.clone(),
                time_s: rounded(time_s, 3),
                frame_ms: rounded(one.0, 3),
                processor_ms: rounded(one.1, 3),
                floor_ms: rounded(timer.floor_ms(&now, &self.sky)?, 3),
                blocks_ms: rounded(other.0, 3),
                blocks_processor_ms: rounded(other.1, 3),
            });
        }
        Ok(Some(rows))
    }

    /// A frame, and the time that threads of this process worked meanwhile, milliseconds.
    fn time_one(
        &self,
        timer: &mut FrameTimer,
        view: &EyeView,
    ) -> Result<(f64, f64), SurfacesError> {
        let begin = ProcessTime::now();
        let timed = timer.time_frame(view, &self.sky)?;
        Ok((milliseconds(timed.frame), milliseconds(begin.elapsed())))
    }
}
