//! The order of a run: what is cheap to find out first, then the rows, the features, and what is written.

use super::baseline::{Baseline, Comparison};
use super::error::BenchError;
use super::features::{self, FeatureKind};
use super::plots;
use super::report::{BenchReport, VERSION};
use super::rows::{RowMeter, rounded};
use super::settings;
use super::table;
use crate::globe::Meshes;
use crate::gpu::{GpuContext, GpuTimer};
use crate::measure::{EYE_HEIGHTS, FrameTimer, GroundPath, median};
use crate::play::{Flight, OutputError, PendingFile, PlayError, Progress};
use crate::{EarthError, EarthOptions};
use std::num::NonZeroU32;
use std::path::Path;

/// What is measured and where it goes.
#[derive(Clone, Debug)]
pub struct BenchRequest<'r> {
    /// Frames that each row and each feature is timed with.
    pub frames: NonZeroU32,
    /// Width and height, pixels; `None` is the scene's.
    pub size: Option<(u32, u32)>,
    /// Part of the adapter's name; `None` takes the best.
    pub adapter: Option<&'r str>,
    /// Where the report goes.
    pub json: Option<&'r Path>,
    /// Where the rows go.
    pub csv: Option<&'r Path>,
    /// The folder for the charts. It is made if it is not there.
    pub plots: Option<&'r Path>,
    /// An earlier report to compare with.
    pub baseline: Option<&'r Path>,
    /// Part by which a row's frame over floor may exceed the baseline's.
    pub tolerance: f64,
}

/// A finished or interrupted run. Its files are written.
#[derive(Clone, Debug)]
pub struct BenchRun {
    /// The report.
    pub report: BenchReport,
    /// The comparison with the baseline, if one was given and the run is complete.
    pub comparison: Option<Comparison>,
    /// What a reader of the numbers should know.
    pub notices: Vec<String>,
}

impl BenchRun {
    /// Headline, rows, features, comparison and notices, as a person reads them.
    pub fn to_table(&self) -> String {
        table::text(&self.report, self.comparison.as_ref(), &self.notices)
    }

    /// Whether the run is complete and no slower than the baseline.
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
                Err(crate::measure::ChartError::Empty(_)) => {}
                Err(error) => return Err(error.into()),
            }
        }
        Ok(())
    }
}

/// Measures a scene. An interrupt ends the run after the frame that is being drawn; complete rows are kept.
///
/// # Errors
/// Files that cannot be written and a baseline that is none or of something else, before anything is drawn; then what
/// adapter, maps and drawing say. A slow or interrupted run is no error here: [`BenchRun::verdict`].
pub fn run_bench(
    flight: &Flight,
    request: &BenchRequest<'_>,
    progress: &dyn Progress,
) -> Result<BenchRun, BenchError> {
    let scene = flight.scene();
    let size = request.size.unwrap_or(scene.output.size.into());
    let baseline = request.baseline.map(Baseline::load).transpose()?;
    let mut report = BenchReport {
        version: VERSION,
        partial: false,
        adapter: String::new(),
        backend: String::new(),
        size: size.into(),
        samples: 0,
        frames: request.frames.get(),
        scene: settings::of_scene(scene),
        floor_ms: 0.0,
        clear_ms: 0.0,
        rows: Vec::new(),
        features: Vec::new(),
    };
    if let Some(baseline) = &baseline {
        baseline.check_settings(&report)?;
    }
    let outputs = Outputs::create(request)?;

    let open = GpuContext::open_with(request.adapter, GpuTimer::FEATURES);
    let gpu = pollster::block_on(open).map_err(PlayError::from)?;
    progress.begin("loading maps", None);
    let options = flight.earth_options(gpu.bc_support())?;
    let mut timer = FrameTimer::new(&gpu, &options, size)?;
    progress.end();
    let info = timer.picture().adapter_info();
    report.adapter = info.name;
    report.backend = info.backend.to_string();
    report.samples = timer.picture().samples();
    report.scene.extend([settings::of_maps(&options)]);
    if let Some(baseline) = &baseline {
        baseline.check_all(&report)?;
    }
    // What was refused at opening is not asked for again.
    let options = EarthOptions {
        samples: report.samples,
        ..options
    };
    let notices = measure(flight, &gpu, &mut timer, &options, &mut report, progress)?;
    outputs.write(&report)?;
    let comparison = match &baseline {
        Some(baseline) if !report.partial => Some(baseline.compare(&report, request.tolerance)?),
        _ => None,
    };
    Ok(BenchRun {
        report,
        comparison,
        notices,
    })
}

/// Fills in rows and features; answers what a reader should know.
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
    let steps = EYE_HEIGHTS.len() * GroundPath::ALL.len() + features.len();
    progress.begin("rows and features", Some(steps as u64));
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
    let (mut floors, mut clears, mut missing_tiles) = (Vec::new(), Vec::new(), 0);
    'rows: for path in GroundPath::ALL {
        for height in &EYE_HEIGHTS {
            let Some(measured) = meter.measure(height, path)? else {
                report.partial = true;
                break 'rows;
            };
            tracing::info!(
                "{}: {:.2} ms, {:.2} x its floor",
                measured.row.name(),
                measured.row.frame_ms.median,
                measured.row.floor_ratio
            );
            floors.push(measured.row.floor_ms);
            clears.push(measured.clear_ms);
            missing_tiles = missing_tiles.max(measured.missing_tiles);
            report.rows.push(measured.row);
            progress.step();
        }
    }
    report.floor_ms = rounded(median(&floors));
    report.clear_ms = rounded(median(&clears));
    for feature in features {
        if report.partial {
            break;
        }
        match features::measure(
            feature,
            flight,
            meter.timer,
            options,
            report.frames,
            progress,
        )? {
            Some(feature) => report.features.push(feature),
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
    if missing_tiles > 0 {
        notices.push(format!(
            "up to {missing_tiles} tiles had not come when a frame was drawn, which was drawn coarser; \
             give them more time (wait_s under [output]) or memory (texture_mb under [earth])"
        ));
    }
    notices
}
