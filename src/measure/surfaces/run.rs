//! Flying, timing and comparing.

use super::rows::SurfaceRow;
use super::{Ground, SurfacePath, SurfacesError, Trial};
use crate::frames::Ellipsoid;
use crate::gpu::GpuContext;
use crate::measure::errors::{GroundErrors, GroundPicture, PlacesEarth};
use crate::measure::reference::TrueRelief;
use crate::measure::{Rig, Spread};
use crate::play::Progress;
use crate::{EarthOptions, GroundOptions, Sky};
use std::time::Duration;

/// Between two frames, seconds.
const FRAME_S: f64 = 1.0 / 60.0;
/// Frames before a place's own. The first waits until the surface is as it would be had it flown there; the others move.
const FRAMES_BEFORE: u32 = 8;
/// How long it waits at most.
const SETTLE: Duration = Duration::from_secs(5);

/// What all trials share.
pub(super) struct Stand<'s> {
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

impl Stand<'_> {
    /// The true pictures of a path's places; fewer if that was stopped.
    pub fn exact(&self, ground: &Ground, path: SurfacePath) -> Vec<TrueRelief> {
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
        ground: &Ground,
        path: SurfacePath,
        trial: &Trial,
        exact: &[TrueRelief],
    ) -> Result<Option<SurfaceRow>, SurfacesError> {
        let figure = self.options.figure.ellipsoid();
        let relief = GroundOptions {
            elevation: ground.elevation.clone(),
            surface: trial.surface,
            tolerance_px: trial.tolerance_px,
        };
        let options = EarthOptions {
            ground: Some(relief.clone()),
            ..self.options.clone()
        };
        let mut row = SurfaceRow {
            data: ground.name,
            path,
            setting: trial.setting.clone(),
            places: self.places,
            frame_ms: Spread::default(),
            floor_ratio: Spread::default(),
            prepare_ms: Spread::default(),
            prepare_most_ms: 0.0,
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
        ground: &Ground,
        figure: &Ellipsoid,
        options: &EarthOptions,
    ) -> Result<bool, SurfacesError> {
        let mut rig = Rig::new(self.gpu, options, self.size)?;
        let aspect = f64::from(self.size.0) / f64::from(self.size.1);
        let mut samples = Vec::new();
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
            rig.settle(&view(first_s), &self.sky, SETTLE);
            for before in (1..FRAMES_BEFORE).rev() {
                rig.frame(&view(time_s - f64::from(before) * FRAME_S), &self.sky)?;
            }
            samples.push(rig.sample(&view(time_s), &self.sky)?);
        }
        let spread = |of: &dyn Fn(&crate::measure::Sample) -> f64| {
            Spread::of(&samples.iter().map(of).collect::<Vec<_>>())
        };
        row.frame_ms = spread(&|sample| sample.frame_ms);
        row.floor_ratio = spread(&|sample| sample.frame_ms / sample.floor_ms);
        row.prepare_ms = spread(&|sample| sample.prepare_ms);
        row.uploaded_bytes = spread(&|sample| sample.stats.uploaded_bytes as f64).median;
        for sample in &samples {
            let (stats, ground) = (&sample.stats, &sample.stats.ground);
            row.prepare_most_ms = row.prepare_most_ms.max(sample.prepare_ms);
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
        ground: &Ground,
        figure: &Ellipsoid,
        relief: &GroundOptions,
        exact: &[TrueRelief],
    ) -> Result<bool, SurfacesError> {
        let mut earth = PlacesEarth::with_ground(self.gpu, relief)?;
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
                row.errors = row.errors.with(&errors);
            }
        }
        Ok(true)
    }
}
