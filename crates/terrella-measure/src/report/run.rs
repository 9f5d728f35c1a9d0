//! Drawing, timing and comparing.

use super::change::{SettingChange, SweepPlan};
use super::geometry::{GeometryKey, GeometryMeter};
use super::rows::SweepRow;
use super::standalone::StandaloneStudy;
use super::truth::{TruePictures, TruthKey};
use super::{ReportError, ReportRequest, Study, write_tables};
use crate::errors::Difference;
use crate::output::OutputFolder;
use crate::{FrameTimer, FrameTimes, GroundPath, Quartiles};
use image::RgbaImage;
use std::time::Instant;
use terrella::frames::Ellipsoid;
use terrella::{EarthOptions, Exposure, EyeView, GpuContext, Sky};
use terrella_play::{Flight, PlayError, Progress};
use terrella_reference::ReferencePicture;

/// Heights that can be looked from, kilometres.
const HEIGHTS_KM: std::ops::RangeInclusive<f64> = 1.0..=1e6;
/// Places on the path that are tried for a Sun of [`SUN_ELEVATION_DEG`].
const PARTS: usize = 360;
/// Elevation of the Sun above the point below the eye: day and dusk are both visible from far away.
const SUN_ELEVATION_DEG: f64 = 40.0;

/// Measures everything that is wanted, or what is complete when it is stopped.
pub(super) fn run(
    flight: &Flight,
    request: &ReportRequest<'_>,
    folder: &OutputFolder,
    progress: &dyn Progress,
    print_line: &dyn Fn(&str),
) -> Result<Study, ReportError> {
    let wrong = |km: &&f64| !HEIGHTS_KM.contains(*km);
    if let Some(height_km) = request.heights_km.iter().flatten().find(wrong) {
        return Err(ReportError::Height(*height_km));
    }
    progress.begin("loading maps", None);
    let gpu = pollster::block_on(GpuContext::open(request.adapter)).map_err(PlayError::from)?;
    let mut options = flight.earth_options(gpu.bc_support())?;
    // One exposure and one gain for all views, so that they can be compared.
    options.exposure = Exposure::Ev(options.exposure.fixed_ev());
    options.light.night_fades_by_day = false;
    progress.end();
    let mut notes = Vec::new();
    // Limb and places are compared with the ellipsoid.
    if options.ground.take().is_some() {
        let note = "The ground's relief is left out: this page is of the smooth Earth. `terrella report --surfaces` compares relief.";
        tracing::warn!("{note}");
        notes.push(note.to_owned());
    }
    let heights_km = request.heights_km.as_deref();
    let mut plan = SweepPlan::new(&gpu, &options, request.size, request.quick, heights_km);
    let sweeps_all = request.sweeps.is_empty();
    if !sweeps_all {
        plan.keep(&request.sweeps);
    }
    let wanted = |change: &SettingChange| plan.heights_of(change, request.size).len();
    let info = gpu.adapter.get_info();
    let mut study = Study {
        scene: match flight.scene().path.file_name() {
            Some(name) => name.to_string_lossy().into_owned(),
            None => flight.scene().path.display().to_string(),
        },
        adapter: format!("{} ({})", info.name, info.backend),
        size: request.size,
        subdivision: options.subdivision,
        repeats: request.repeats,
        samples: request.samples,
        heights_km: plan.heights_km.clone(),
        rows: Vec::new(),
        wanted: plan.changes.iter().map(wanted).sum(),
        unavailable: plan.unavailable.clone(),
        is_stopped: false,
        notes,
        pictured_km: Vec::new(),
        standalone: StandaloneStudy::default(),
    };
    let viewpoints = Viewpoints {
        flight,
        figure: options.figure.ellipsoid(),
        sky: flight.sky_at(flight.scene().time.start),
    };
    let mut truths = TruePictures::new(&options, request.samples, viewpoints.sky, progress);
    let mut meter = RowMeter {
        viewpoints: &viewpoints,
        request,
        options: &options,
        geometry: GeometryMeter::new(&gpu, options.figure),
    };
    progress.begin("measurements", Some(study.wanted as u64));
    'changes: for change in &plan.changes {
        let begin = Instant::now();
        let size = change.size(request.size);
        let mut timer = match FrameTimer::new(&gpu, &change.apply(&options), size) {
            // A size that does not fit is no reason to throw the others away.
            Err(error) if matches!(change, SettingChange::Size(_)) => {
                study.wanted -= wanted(change);
                study
                    .notes
                    .push(format!("Size {}: {error}.", change.value()));
                continue;
            }
            opened => opened?,
        };
        for height_km in plan.heights_of(change, request.size) {
            if progress.cancelled() {
                break 'changes;
            }
            let begin_row = Instant::now();
            let view = viewpoints.view(height_km, size);
            let key = TruthKey::new(change, &options, height_km, request.size);
            let Some(truth) = truths.picture(key, &view)? else {
                break 'changes;
            };
            let true_s = begin_row.elapsed().as_secs_f64();
            let measured = meter.measure(*change, height_km, &mut timer, &truth)?;
            if *change == SettingChange::Scene {
                write_pictures(folder, height_km, &measured, &truth)?;
                study.pictured_km.push(height_km);
            }
            study.rows.push(measured.row);
            progress.step();
            if study.rows.len() == 1 {
                let row_s = begin.elapsed().as_secs_f64() - true_s;
                let pace = Pace { row_s, true_s };
                print_line(&estimate(&plan, request.size, &options, study.wanted, pace));
            }
        }
        // Complete rows are saved immediately.
        write_tables(folder, &study.rows)?;
    }
    progress.end();
    study.notes.append(&mut truths.notes);
    if study.is_complete() && sweeps_all {
        study.standalone = StandaloneStudy::gather(&gpu, request.quick, request.repeats, progress)?;
    }
    study.is_stopped = progress.cancelled();
    Ok(study)
}

/// The files of a height's pictures, as the page names them.
pub(super) fn picture_name(height_km: f64, what: &str) -> String {
    format!("pictures/{height_km}km_{what}.png")
}

fn write_pictures(
    folder: &OutputFolder,
    height_km: f64,
    measured: &MeasuredRow,
    truth: &ReferencePicture,
) -> Result<(), ReportError> {
    let write = |what: &str, picture: &RgbaImage| {
        let file = folder.pending(&picture_name(height_km, what))?;
        file.write_png(picture)
    };
    write("drawn", &measured.picture)?;
    write("true", &truth.to_rgba8())?;
    let map = image::DynamicImage::from(measured.difference.map.clone()).to_rgba8();
    Ok(write("flip", &map)?)
}

/// How long the first measurement took, seconds.
struct Pace {
    /// Without the true picture.
    row_s: f64,
    /// The true picture alone.
    true_s: f64,
}

/// Estimate of the total time from the first measurement.
fn estimate(
    plan: &SweepPlan,
    scene_size: (u32, u32),
    options: &EarthOptions,
    rows: usize,
    pace: Pace,
) -> String {
    let mut keys = Vec::new();
    for change in &plan.changes {
        for height_km in plan.heights_of(change, scene_size) {
            let key = TruthKey::new(change, options, height_km, scene_size);
            if !keys.contains(&key) {
                keys.push(key);
            }
        }
    }
    let pixels = |(width, height): (u32, u32)| f64::from(width) * f64::from(height);
    let true_parts: f64 = keys
        .iter()
        .map(|key| pixels(key.size) / pixels(scene_size))
        .sum();
    let minutes = (true_parts * pace.true_s + rows as f64 * pace.row_s) / 60.0;
    format!(
        "{rows} measurements and {} true pictures, about {:.0} minutes at the first one's pace",
        keys.len(),
        minutes.max(1.0)
    )
}

/// Viewpoints of the scene's camera.
struct Viewpoints<'r> {
    flight: &'r Flight,
    figure: Ellipsoid,
    sky: Sky,
}

impl Viewpoints<'_> {
    /// The scene's camera at a height, over a point of the inclined path where the Sun's elevation is [`SUN_ELEVATION_DEG`].
    fn view(&self, height_km: f64, size: (u32, u32)) -> EyeView {
        let (path, figure) = (GroundPath::Inclined, &self.figure);
        let camera = &self.flight.scene().camera;
        let (height_m, fov_rad) = (height_km * 1e3, camera.fov_deg.to_radians());
        let aspect = f64::from(size.0) / f64::from(size.1);
        let wanted = SUN_ELEVATION_DEG.to_radians().sin();
        let off = |part: f64| {
            let at = path.motion(figure, height_m, part).position_itrf_m;
            let place = figure.geodetic_from_itrf(at);
            let up = Ellipsoid::normal(place.lat_rad, place.lon_rad);
            (up.dot(self.sky.sun_itrf) - wanted).abs()
        };
        let parts = (0..PARTS).map(|n| n as f64 / PARTS as f64);
        let part = parts.min_by(|a, b| off(*a).total_cmp(&off(*b)));
        path.view(
            figure,
            height_m,
            part.unwrap_or(0.0),
            camera.mode,
            fov_rad,
            aspect,
        )
    }
}

/// Inputs of a row's measurement besides the setting.
struct RowMeter<'r> {
    viewpoints: &'r Viewpoints<'r>,
    request: &'r ReportRequest<'r>,
    /// Options of the scene's Earth, before a setting is changed.
    options: &'r EarthOptions,
    geometry: GeometryMeter<'r>,
}

/// A row and the pictures that it was measured on.
struct MeasuredRow {
    row: SweepRow,
    picture: RgbaImage,
    difference: Difference,
}

impl RowMeter<'_> {
    fn measure(
        &mut self,
        change: SettingChange,
        height_km: f64,
        timer: &mut FrameTimer,
        truth: &ReferencePicture,
    ) -> Result<MeasuredRow, ReportError> {
        let size = change.size(self.request.size);
        let (view, sky) = (self.viewpoints.view(height_km, size), &self.viewpoints.sky);
        let wait = self.viewpoints.flight.scene().output.wait();
        let picture = timer.draw(&view, sky, wait)?;
        let difference = Difference::between(&picture, truth);
        // The first fills caches.
        let cells = timer.time_frame_and_floor(&view, sky)?.stats.subdivision;
        let key = GeometryKey {
            height_km,
            subdivision: cells,
            visibility: match change {
                SettingChange::Visibility(rule) => rule,
                _ => self.options.visibility,
            },
            size,
        };
        let geometry = self.geometry.measure(key, &view)?;
        let times = (0..self.request.repeats.max(1))
            .map(|_| timer.time_frame_and_floor(&view, sky))
            .collect::<Result<Vec<FrameTimes>, _>>()?;
        let quartiles = |of: fn(&FrameTimes) -> f64| Quartiles::of(times.iter().map(of));
        let stats = times.last().map(|last| last.stats).unwrap_or_default();
        let row = SweepRow {
            change,
            height_km,
            frame_ms: quartiles(|times| times.frame_ms),
            floor_ms: quartiles(|times| times.floor_ms),
            floor_ratio: quartiles(|times| times.frame_ms / times.floor_ms),
            prepare_ms: quartiles(|times| times.prepare_ms).median,
            flip_mean: difference.flip_mean,
            flip_p99: difference.flip_p99,
            rmse_linear: difference.rmse_linear,
            silhouette: geometry.silhouette,
            geolocation: geometry.geolocation,
            texels_per_px: stats.texels_per_pixel,
            triangles: stats.triangles,
        };
        Ok(MeasuredRow {
            row,
            picture,
            difference,
        })
    }
}
