//! Flying, timing and comparing.

use super::rows::SurfaceRow;
use super::{Candidate, SurfacePath, SurfacesError, TestGround};
use crate::frames::Ellipsoid;
use crate::gpu::GpuContext;
use crate::measure::errors::{GeolocationRenderer, GroundErrors, GroundPicture};
use crate::measure::reference::TrueRelief;
use crate::measure::{FrameTimer, FrameTimes, Quartiles};
use crate::play::Progress;
use crate::{EarthOptions, GroundOptions, Sky};
use std::time::Duration;

/// Between two frames, seconds.
const FRAME_S: f64 = 1.0 / 60.0;
/// Frames before a place's own. The first waits until the surface is as it would be had it flown there; the others move.
const FRAMES_BEFORE: u32 = 8;
/// How long it waits at most.
const SETTLE: Duration = Duration::from_secs(5);

/// What the measurements of all candidates share.
pub(super) struct FlightMeter<'s> {
    pub gpu: &'s GpuContext,
    pub options: &'s EarthOptions,
    pub sky: Sky,
    /// Of timed frames.
    pub size: (u32, u32),
    /// Of pictures that are held against the data.
    pub compared_size: (u32, u32),
    pub places: u32,
    pub progress: &'s dyn Progress,
}

impl FlightMeter<'_> {
    /// The true pictures of a path's places; fewer if that was stopped.
    pub fn exact(&self, ground: &TestGround, path: SurfacePath) -> Vec<TrueRelief> {
        let figure = self.options.figure.ellipsoid();
        let elevation = ground.elevation.as_ref();
        let size = self.compared_size;
        let aspect = f64::from(size.0) / f64::from(size.1);
        let times_s = self
            .times_s(path)
            .take_while(|_| !self.progress.cancelled());
        let views =
            times_s.map(|time_s| path.view(time_s, ground.site, &figure, elevation, aspect));
        views
            .filter_map(|view| TrueRelief::new(&view, size, &figure, elevation))
            .collect()
    }

    /// Flies one path with one setting, its places held against the [`Self::exact`] ones; `None` if that was stopped.
    pub fn fly(
        &self,
        ground: &TestGround,
        path: SurfacePath,
        candidate: &Candidate,
        exact: &[TrueRelief],
    ) -> Result<Option<SurfaceRow>, SurfacesError> {
        let figure = self.options.figure.ellipsoid();
        let relief = GroundOptions {
            elevation: ground.elevation.clone(),
            surface: candidate.surface,
            tolerance_px: candidate.tolerance_px,
        };
        let options = EarthOptions {
            ground: Some(relief.clone()),
            ..self.options.clone()
        };
        let mut row = SurfaceRow {
            data: ground.name,
            path,
            setting: candidate.setting.clone(),
            places: self.places,
            frame_ms: Quartiles::NONE,
            floor_ratio: Quartiles::NONE,
            prepare_ms: Quartiles::NONE,
            max_prepare_ms: 0.0,
            vertices: 0,
            triangles: 0,
            resident_bytes: 0,
            gpu_bytes: 0,
            uploaded_bytes: 0.0,
            errors: GroundErrors::default(),
            popping_px: 0.0,
        };
        if !self.time(&mut row, ground, &figure, &options)?
            || !self.compare(&mut row, ground, &figure, &relief, exact)?
        {
            return Ok(None);
        }
        Ok(Some(row))
    }

    /// When each place of a flight is reached, seconds.
    fn times_s(&self, path: SurfacePath) -> impl Iterator<Item = f64> + use<> {
        let (places, duration_s) = (self.places, path.duration_s());
        (0..places).map(move |n| duration_s * (f64::from(n) + 0.5) / f64::from(places))
    }

    /// Times frames; `false` if that was stopped.
    fn time(
        &self,
        row: &mut SurfaceRow,
        ground: &TestGround,
        figure: &Ellipsoid,
        options: &EarthOptions,
    ) -> Result<bool, SurfacesError> {
        let mut timer = FrameTimer::new(self.gpu, options, self.size)?;
        let aspect = f64::from(self.size.0) / f64::from(self.size.1);
        let mut times = Vec::new();
        for time_s in self.times_s(row.path) {
            if self.progress.cancelled() {
                return Ok(false);
            }
            let view = |time_s| {
                let elevation = ground.elevation.as_ref();
                row.path
                    .view(time_s, ground.site, figure, elevation, aspect)
            };
            let first_s = time_s - f64::from(FRAMES_BEFORE) * FRAME_S;
            timer.wait_for_ground(&view(first_s), &self.sky, SETTLE);
            for before in (1..FRAMES_BEFORE).rev() {
                timer.time_frame(&view(time_s - f64::from(before) * FRAME_S), &self.sky)?;
            }
            times.push(timer.time_frame_and_floor(&view(time_s), &self.sky)?);
        }
        let spread = |of: &dyn Fn(&FrameTimes) -> f64| Quartiles::of(times.iter().map(of));
        row.frame_ms = spread(&|sample| sample.frame_ms);
        row.floor_ratio = spread(&|sample| sample.frame_ms / sample.floor_ms);
        row.prepare_ms = spread(&|sample| sample.prepare_ms);
        row.uploaded_bytes = spread(&|sample| sample.stats.uploaded_bytes as f64).median;
        for sample in &times {
            let (stats, ground) = (&sample.stats, &sample.stats.ground);
            row.max_prepare_ms = row.max_prepare_ms.max(sample.prepare_ms);
            row.vertices = row.vertices.max(ground.vertices);
            row.triangles = row.triangles.max(ground.triangles);
            row.resident_bytes = row.resident_bytes.max(ground.resident_bytes);
            row.gpu_bytes = row.gpu_bytes.max(stats.ground_bytes);
        }
        Ok(true)
    }

    /// Holds pictures against the data; `false` if that was stopped.
    fn compare(
        &self,
        row: &mut SurfaceRow,
        ground: &TestGround,
        figure: &Ellipsoid,
        relief: &GroundOptions,
        exact: &[TrueRelief],
    ) -> Result<bool, SurfacesError> {
        let mut earth = GeolocationRenderer::with_ground(self.gpu, relief)?;
        let size = self.compared_size;
        let aspect = f64::from(size.0) / f64::from(size.1);
        let elevation = ground.elevation.as_ref();
        for (time_s, exact) in self.times_s(row.path).zip(exact) {
            if self.progress.cancelled() {
                return Ok(false);
            }
            let mut before: Option<GroundPicture> = None;
            for frame in (0..=FRAMES_BEFORE).rev() {
                let time_s = time_s - f64::from(frame) * FRAME_S;
                let view = row
                    .path
                    .view(time_s, ground.site, figure, elevation, aspect);
                if frame == FRAMES_BEFORE {
                    earth.settle(&view, size, SETTLE);
                    continue;
                }
                let places = earth.draw(&view, size)?;
                if frame > 1 {
                    continue;
                }
                let Some(now) = GroundPicture::new(&places, &view, figure, elevation) else {
                    continue;
                };
                let Some(before) = &before else {
                    before = Some(now);
                    continue;
                };
                row.popping_px = row.popping_px.max(now.popping_px(before));
                let errors = now.errors(figure, elevation, Some(exact));
                row.errors = row.errors.combined(&errors);
            }
        }
        Ok(true)
    }
}
