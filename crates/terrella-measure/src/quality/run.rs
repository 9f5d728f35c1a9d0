//! Drawing, timing and comparing.

use super::search::{Combination, best};
use super::study::QualityStudy;
use super::views::views;
use super::{QualityError, QualityRequest};
use crate::errors::flip_mean;
use crate::frame_timer::{milliseconds, moment};
use crate::{Quartiles, median};
use cpu_time::ProcessTime;
use image::RgbaImage;
use std::time::Duration;
use terrella::{Exposure, GpuContext, Quality, QualityReduction};
use terrella_play::scene::EDGE_SAMPLES;
use terrella_play::{Flight, Moment, OffscreenRenderer, PlayError, Progress};

/// Measures all that is worth it, or what was when it is stopped.
pub(super) fn run(
    flight: &Flight,
    request: &QualityRequest<'_>,
    progress: &dyn Progress,
) -> Result<QualityStudy, QualityError> {
    progress.begin("loading maps", None);
    let gpu = pollster::block_on(GpuContext::open(request.adapter)).map_err(PlayError::from)?;
    let mut options = flight.earth_options(gpu.bc_support())?;
    // One exposure for all, so that they can be compared, and multisampling that can be reduced.
    options.exposure = Exposure::Ev(options.exposure.fixed_ev());
    options.samples = EDGE_SAMPLES;
    let open = || OffscreenRenderer::open(gpu.clone(), options.clone(), request.size);
    let (full, tried) = (open()?, open()?);
    progress.end();
    let info = gpu.adapter.get_info();
    let (views, sky) = views(flight, full.aspect());
    let moments: Vec<Moment> = views.iter().map(|view| moment(view, &sky)).collect();
    let mut meter = Meter {
        finest: *full.earth().quality(),
        full,
        tried,
        is_software: gpu.is_software(),
        wait: flight.scene().output.wait(),
        repeats: request.repeats.max(1),
        pictures: Vec::new(),
        moments,
    };
    meter.draw_full()?;
    let mut study = QualityStudy {
        scene: match flight.scene().path.file_name() {
            Some(name) => name.to_string_lossy().into_owned(),
            None => flight.scene().path.display().to_string(),
        },
        adapter: format!("{} ({})", info.name, info.backend),
        size: request.size,
        repeats: meter.repeats,
        views: meter.moments.len(),
        combinations: Vec::new(),
        is_stopped: false,
    };
    let (mut given_up, mut cost, mut error) = (Vec::new(), 1.0, 0.0);
    loop {
        let left = meter.left(&given_up);
        let first = study.combinations.len();
        progress.begin("combinations", Some(left.len() as u64));
        for reduction in left {
            if progress.cancelled() {
                study.is_stopped = true;
                return Ok(study);
            }
            let mut reductions = given_up.clone();
            reductions.push(reduction);
            let measured = meter.measure(reductions)?;
            tracing::info!(
                "without {reduction}: {:.3} of the full cost, FLIP {:.5}",
                measured.cost(),
                measured.error
            );
            study.combinations.push(measured);
            progress.step();
        }
        progress.end();
        let tried = &mut study.combinations[first..];
        let Some(taken) = best(cost, error, tried) else {
            return Ok(study);
        };
        let taken = &mut tried[taken];
        taken.is_taken = true;
        tracing::info!("taken: {:?}", taken.reductions);
        given_up.clone_from(&taken.reductions);
        (cost, error) = (taken.cost(), taken.error);
    }
}

/// Two renderers of one Earth, one at full quality and one for the tried combination.
struct Meter {
    full: OffscreenRenderer,
    tried: OffscreenRenderer,
    finest: Quality,
    moments: Vec<Moment>,
    /// Each moment in full quality.
    pictures: Vec<RgbaImage>,
    wait: Duration,
    repeats: u32,
    is_software: bool,
}

/// Cost of a frame, milliseconds: its time including the wait for the device. With CPU rendering, the processor time of all threads, which does not
/// depend on other load of the machine.
fn time_ms(
    renderer: &mut OffscreenRenderer,
    moment: &Moment,
    is_software: bool,
) -> Result<f64, PlayError> {
    let begin = ProcessTime::now();
    let frame = renderer.time(moment)?.frame;
    Ok(milliseconds(match is_software {
        true => begin.elapsed(),
        false => frame,
    }))
}

impl Meter {
    fn draw_full(&mut self) -> Result<(), PlayError> {
        for moment in &self.moments {
            self.full.draw_complete(moment, self.wait);
            self.pictures.push(self.full.read()?);
        }
        Ok(())
    }

    /// Reductions that would have an effect in addition to these.
    fn left(&self, given_up: &[QualityReduction]) -> Vec<QualityReduction> {
        let has_tiles = self.full.earth().has_tiles();
        let quality = given_up
            .iter()
            .fold(self.finest, |quality, one| one.apply(quality, has_tiles));
        let all = QualityReduction::ALL.into_iter();
        all.filter(|one| one.apply(quality, has_tiles) != quality)
            .collect()
    }

    /// Draws and times these reductions interleaved with the full quality.
    fn measure(&mut self, reductions: Vec<QualityReduction>) -> Result<Combination, PlayError> {
        let has_tiles = self.full.earth().has_tiles();
        let quality = reductions
            .iter()
            .fold(self.finest, |quality, one| one.apply(quality, has_tiles));
        self.tried.set_quality(&quality)?;
        let mut error = 0.0;
        for (moment, picture) in self.moments.iter().zip(&self.pictures) {
            self.tried.draw_complete(moment, self.wait);
            error += flip_mean(&self.tried.read()?, picture);
        }
        error /= self.moments.len().max(1) as f64;
        // The ratio of each view separately, weighted by its time: pairs of frames are short, and the machine's load seldom changes within one.
        let (mut cost, mut weight) = ([0.0; 3], 0.0);
        for moment in &self.moments {
            let (mut full_ms, mut ratios) = (Vec::new(), Vec::new());
            for _ in 0..self.repeats {
                let full = time_ms(&mut self.full, moment, self.is_software)?;
                ratios.push(time_ms(&mut self.tried, moment, self.is_software)? / full);
                full_ms.push(full);
            }
            let (ratio, full_ms) = (Quartiles::of(ratios), median(&full_ms));
            for (sum, part) in cost
                .iter_mut()
                .zip([ratio.lower, ratio.median, ratio.upper])
            {
                *sum += full_ms * part;
            }
            weight += full_ms;
        }
        Ok(Combination {
            reductions,
            cost: cost.map(|sum| sum / weight),
            error,
            is_taken: false,
        })
    }
}
