//! The order of a run: cheap checks first, then the rows, the features, and the output.

use super::baseline::{Baseline, Comparison};
use super::error::BenchError;
use super::features::{self, FeatureKind, FeatureMeter};
use super::plots;
use super::report::{BenchReport, BenchRow, VERSION};
use super::rows::{RowMeter, RowRuns, rounded};
use super::settings;
use super::table;
use crate::{EYE_HEIGHTS, FrameTimer, GroundPath, machine, median};
use std::num::NonZeroU32;
use std::path::Path;
use terrella::internals::gpu::{GpuContext, GpuTimer};
use terrella::{EarthError, EarthOptions};
use terrella_ground::globe::Meshes;
use terrella_play::{Flight, OutputError, PendingFile, PlayError, Progress};

/// A measurement, and its output files.
#[derive(Clone, Debug)]
pub struct BenchRequest<'r> {
    /// Frames that each row and each feature is timed with in each run.
    pub frames: NonZeroU32,
    /// Runs, one after the other; at most [`MAX_FRAMES`] frames a row in all.
    pub repeats: NonZeroU32,
    /// The command's arguments, to be recorded.
    pub arguments: Vec<String>,
    /// Width and height, pixels; `None` is the scene's.
    pub size: Option<(u32, u32)>,
    /// Part of the adapter's name; `None` takes the best.
    pub adapter: Option<&'r str>,
    /// JSON file of the report.
    pub json: Option<&'r Path>,
    /// CSV file of the rows.
    pub csv: Option<&'r Path>,
    /// The folder for the charts. It is made if it is not there.
    pub plots: Option<&'r Path>,
    /// An earlier report to compare with.
    pub baseline: Option<&'r Path>,
    /// Part by which a row's frame over floor must exceed the baseline's to count as slower.
    pub smallest_effect: f64,
}

/// Most frames a row in all runs together.
pub const MAX_FRAMES: u32 = 10_000;

/// A finished or interrupted run. Its files are written.
#[derive(Clone, Debug)]
pub struct BenchRun {
    pub report: BenchReport,
    /// The comparison with the baseline, if one was given and the run is complete.
    pub comparison: Option<Comparison>,
    /// Remarks for the reader of the numbers.
    pub notices: Vec<String>,
}

impl BenchRun {
    /// Headline, rows, features, comparison and notices, as a person reads them.
    pub fn to_table(&self) -> String {
        table::text(&self.report, self.comparison.as_ref(), &self.notices)
    }

    /// Checks that the run is complete and no slower than the baseline.
    ///
    /// # Errors
    /// [`BenchError::Interrupted`], [`BenchError::Slower`].
    pub fn verdict(&self) -> Result<(), BenchError> {
        if self.report.partial {
            return Err(BenchError::Interrupted {
                done: self.report.rows.len(),
                wanted: EYE_HEIGHTS.len() * GroundPath::ALL.len(),
            });
        }
        match &self.comparison {
            Some(comparison) => comparison.verdict(),
            None => Ok(()),
        }
    }
}

/// Files that are begun before anything is measured.
struct Outputs {
    json: Option<PendingFile>,
    csv: Option<PendingFile>,
    plots: Vec<PendingFile>,
}

impl Outputs {
    fn create(request: &BenchRequest<'_>) -> Result<Self, OutputError> {
        let pending = |path: Option<&Path>, what, extension| {
            path.map(|path| PendingFile::create(path, what, extension))
                .transpose()
        };
        let json = pending(request.json, "reports", "json")?;
        let csv = pending(request.csv, "rows", "csv")?;
        let mut files = Vec::new();
        if let Some(folder) = request.plots {
            std::fs::create_dir_all(folder).map_err(|source| OutputError::Write {
                path: folder.into(),
                source,
            })?;
            for name in plots::NAMES {
                files.push(PendingFile::create(&folder.join(name), "charts", "svg")?);
            }
        }
        Ok(Self {
            json,
            csv,
            plots: files,
        })
    }

    fn write(self, report: &BenchReport) -> Result<(), BenchError> {
        if let Some(file) = self.json {
            file.write_whole(report.to_json().as_bytes())?;
        }
        if let Some(file) = self.csv {
            file.write_whole(table::csv(report).as_bytes())?;
        }
        if self.plots.is_empty() {
            return Ok(());
        }
        for (file, chart) in self.plots.into_iter().zip(plots::charts(report)) {
            match chart.to_svg() {
                Ok(svg) => file.write_whole(svg.as_bytes())?,
                // A run that was interrupted early, or a scene without features: no chart then.
                Err(crate::ChartError::Empty(_)) => {}
                Err(error) => return Err(error.into()),
            }
        }
        Ok(())
    }
}

/// Measures a scene. An interrupt ends the run after the current frame; complete rows are kept.
///
/// # Errors
/// Unwritable files and an invalid or unrelated baseline, before anything is drawn; then errors of adapter, maps and drawing. A slow or interrupted
/// run is not an error here: [`BenchRun::verdict`].
pub fn run_bench(
    flight: &Flight,
    request: &BenchRequest<'_>,
    progress: &dyn Progress,
) -> Result<BenchRun, BenchError> {
    let scene = flight.scene();
    let size = request.size.unwrap_or(scene.output.size.into());
    let (frames, repeats) = (request.frames.get(), request.repeats.get());
    if u64::from(frames) * u64::from(repeats) > MAX_FRAMES.into() {
        return Err(BenchError::TooManyFrames { frames, repeats });
    }
    let baseline = request.baseline.map(Baseline::load).transpose()?;
    let mut report = BenchReport {
        version: VERSION,
        partial: false,
        date: machine::date(),
        arguments: request.arguments.clone(),
        commit: machine::commit(Path::new(env!("CARGO_MANIFEST_DIR"))),
        adapter: String::new(),
        backend: String::new(),
        driver: String::new(),
        cpu: machine::cpu(),
        os: machine::os(),
        size: size.into(),
        samples: 0,
        frames,
        repeats,
        scene: settings::of_scene(scene),
        floor_ms: 0.0,
        clear_ms: 0.0,
        rows: Vec::new(),
        features: Vec::new(),
        unmeasured: Vec::new(),
    };
    if let Some(baseline) = &baseline {
        baseline.check_settings(&report)?;
    }
    let outputs = Outputs::create(request)?;

    let open = GpuContext::open_with(request.adapter, GpuTimer::FEATURES);
    let gpu = pollster::block_on(open).map_err(PlayError::from)?;
    progress.begin("loading maps", None);
    // Every feature is measured with separate Earths, and the floor with the same maps.
    let options = flight.uploaded_options(&gpu)?;
    let mut timer = FrameTimer::new(&gpu, &options, size)?;
    progress.end();
    let info = timer.picture().adapter_info();
    report.adapter = info.name;
    report.backend = info.backend.to_string();
    report.driver = format!("{} {}", info.driver, info.driver_info)
        .trim()
        .to_owned();
    report.samples = timer.picture().samples();
    report.unmeasured = features::unmeasured(&options, report.samples, gpu.is_software());
    report.scene.extend([settings::of_maps(&options)]);
    if let Some(baseline) = &baseline {
        baseline.check_all(&report)?;
    }
    // Options that were rejected at opening are not requested again.
    let options = EarthOptions {
        samples: report.samples,
        ..options
    };
    let mut notices = measure(flight, &gpu, &mut timer, &options, &mut report, progress)?;
    outputs.write(&report)?;
    let comparison = match &baseline {
        Some(baseline) if !report.partial => {
            notices.extend(baseline.notices(&report));
            Some(baseline.compare(&report, request.smallest_effect)?)
        }
        _ => None,
    };
    Ok(BenchRun {
        report,
        comparison,
        notices,
    })
}

/// Fills in rows and features; returns remarks for the reader.
fn measure(
    flight: &Flight,
    gpu: &GpuContext,
    timer: &mut FrameTimer,
    options: &EarthOptions,
    report: &mut BenchReport,
    progress: &dyn Progress,
) -> Result<Vec<String>, BenchError> {
    let scene = flight.scene();
    let gpu_timer = GpuTimer::new(&gpu.device, &gpu.queue);
    let features = FeatureKind::on(flight, options, gpu);
    let mut rows = Vec::new();
    for path in GroundPath::ALL {
        rows.extend(EYE_HEIGHTS.iter().map(|height| RowRuns::new(height, path)));
    }
    let steps = rows.len() as u64 * u64::from(report.repeats) + features.len() as u64;
    progress.begin("rows and features", Some(steps));
    let mut meter = RowMeter {
        scene,
        timer,
        gpu_timer: gpu_timer.as_ref(),
        meshes: Meshes::new(options.figure.ellipsoid(), options.subdivision, 1)
            .map_err(|error| PlayError::from(EarthError::from(error)))?,
        sky: flight.sky_at(scene.time.start),
        frames: report.frames,
        progress,
    };
    // All rows once per run, so that slow changes of the machine appear as spread between runs.
    'runs: for _ in 0..report.repeats {
        for row in &mut rows {
            if !meter.measure(row)? {
                report.partial = true;
                break 'runs;
            }
            tracing::info!("{}", row.progress());
            progress.step();
        }
    }
    let missing_tiles = rows.iter().map(|row| row.missing_tiles).max().unwrap_or(0);
    report.rows = rows.into_iter().filter_map(RowRuns::row).collect();
    let of_rows = |of: fn(&BenchRow) -> f64| {
        let values: Vec<_> = report.rows.iter().map(of).collect();
        rounded(median(&values))
    };
    report.floor_ms = of_rows(|row| row.floor_ms);
    report.clear_ms = of_rows(|row| row.clear_ms);
    for kind in features {
        if report.partial {
            break;
        }
        let mut feature = FeatureMeter::new(kind, flight, meter.timer, options)?;
        match feature.measure(meter.timer, report.frames, report.repeats, progress)? {
            Some(features) => report.features.extend(features),
            None => report.partial = true,
        }
        progress.step();
    }
    progress.end();
    Ok(notices(report, gpu, missing_tiles))
}

fn notices(report: &BenchReport, gpu: &GpuContext, missing_tiles: usize) -> Vec<String> {
    let mut notices = Vec::new();
    let has = gpu.device.features();
    if !has.contains(GpuTimer::FEATURES) {
        notices.push(format!(
            "{} has no timestamp queries: gpu_ms is empty",
            report.adapter
        ));
    }
    if gpu.is_software() {
        notices.push(format!(
            "{} draws with the processor: its times, those of the passes too, grow with all else that runs here; \
             compare ratios",
            report.adapter
        ));
    }
    if report.rows.iter().any(|row| row.frame_ms.p99.is_none()) {
        notices.push(
            "p95 is given for 20 frames a row and more, p99 of 100 and more (--frames, --repeats)"
                .to_owned(),
        );
    }
    if missing_tiles > 0 {
        notices.push(format!(
            "up to {missing_tiles} tiles had not come when a frame was drawn, which was drawn coarser; \
             give them more time (wait_s under [output]) or memory (texture_mb under [earth])"
        ));
    }
    notices
}
