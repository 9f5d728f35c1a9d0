//! One picture, and its numbers.

use super::error::PlayError;
use super::film::{FilmPainter, FilmPicture, PictureSettings};
use super::flight::{Flight, Moment};
use super::offscreen::OffscreenRenderer;
use super::output::{OutputError, PendingFile};
use super::progress::Progress;
use super::quality_control::{HeldQuality, scene_quality};
use super::radiance::{Radiance, RadianceFile};
use super::raw::RawFile;
use super::raw_picture::RawPainter;
use super::sensor_bands::{SensorBands, SensorView};
use super::stats::PictureStats;
use super::truth::TruthFolder;
use super::written::written_picture;
use crate::scene::SensorTable;
use hifitime::Unit;
use std::path::Path;
use std::time::Instant;
use terrella::frames::Epoch;
use terrella::{EarthOptions, GpuContext};
use terrella_imagery::tile::TileKey;

/// Which picture is wanted, and where it goes.
#[derive(Clone, Debug)]
pub struct StillRequest<'r> {
    /// The instant; `None` is the scene's start.
    pub epoch: Option<Epoch>,
    /// Width and height, pixels; `None` is the scene's.
    pub size: Option<(u32, u32)>,
    /// Part of the adapter's name; `None` takes the best.
    pub adapter: Option<&'r str>,
    /// The PNG to write.
    pub output: &'r Path,
    /// The file of its light to write, NumPy's or OpenEXR's by its name, if that is wanted.
    pub radiance: Option<&'r Path>,
    /// The file of its sensor's raw frame to write, PNG, TIFF or NumPy's by its name, if that is wanted.
    pub raw: Option<&'r Path>,
    /// The folder to write what is where its pixels look to, if that is wanted.
    pub truth: Option<&'r Path>,
    /// The JSON to write its numbers to, if they are wanted.
    pub stats: Option<&'r Path>,
    /// How the picture is made and kept.
    pub pictures: PictureSettings,
    /// Whether only the edges of the surface's triangles are drawn.
    pub wireframe: bool,
}

/// Draws and writes one picture, and reports it in one line. Nothing is left behind where that fails.
pub fn write_still(
    flight: &Flight,
    request: &StillRequest<'_>,
    progress: &dyn Progress,
) -> Result<(), PlayError> {
    let begun = Instant::now();
    let scene = flight.scene();
    if request.epoch.is_some() {
        flight.reject_live("no other instant can be drawn", "leave the instant out")?;
    }
    let pictures = &request.pictures;
    if pictures.shutter.is_some() {
        flight.reject_live("no other instant can be drawn", "leave --shutter out")?;
    }
    FilmPainter::check(flight, pictures)?;
    let sensor = scene.sensor.as_ref().map(SensorTable::open).transpose()?;
    if request.raw.is_some() && sensor.is_none() {
        let scene = scene.path.clone();
        return Err(PlayError::NoSensor { scene });
    }
    let epoch = request.epoch.unwrap_or(scene.time.start);
    let size = request.size.unwrap_or(scene.output.size.into());
    let aspect = f64::from(size.0) / f64::from(size.1);
    // The cheapest checks come first: the date, the files, the maps, the adapter.
    let known = match flight.is_timed_by_simulator() {
        false => Some(flight.at(epoch, aspect)?),
        true => None,
    };
    let output = PendingFile::create(request.output, "images", pictures.format.ending())?;
    let stats = match request.stats {
        Some(path) => Some(PendingFile::create(path, "numbers", "json")?),
        None => None,
    };
    let radiance = request.radiance.map(RadianceFile::create).transpose()?;
    let raw = request.raw.map(RawFile::create).transpose()?;
    // Truth is what the sensor sees, where there is one.
    let truth_size = sensor
        .as_ref()
        .map_or(size, |sensor| sensor.lens.size().into());
    let truth = request
        .truth
        .map(|folder| TruthFolder::create(folder, truth_size));
    let truth = truth.transpose()?;

    let mut wanted = wgpu::Features::empty();
    wanted.set(wgpu::Features::POLYGON_MODE_LINE, request.wireframe);
    wanted.set(
        GpuContext::FLOAT_TARGET,
        radiance.is_some() || raw.is_some(),
    );
    wanted |= FilmPainter::features(pictures);
    let gpu = pollster::block_on(GpuContext::open_with(request.adapter, wanted))?;
    progress.begin("loading maps", None);
    let mut options = flight.uploaded_options_at(epoch, &gpu)?;
    options.diagnostics.wireframe = request.wireframe;
    progress.end();
    let for_truth = truth.map(|folder| (folder, gpu.clone(), options.clone()));
    let for_picture = pictures
        .need_light()
        .then(|| (gpu.clone(), options.clone()));
    let is_measured = radiance.is_some() || raw.is_some();
    let for_light = is_measured.then(|| {
        let mut options = options.clone();
        if options.light.detail {
            tracing::info!("the radiance is without made detail");
            // Measurements use data only.
            options.light.detail = false;
        }
        (gpu.clone(), options)
    });
    let for_sensor = match raw.is_some() || for_truth.is_some() {
        true => sensor.map(|sensor| (sensor, gpu.clone())),
        false => None,
    };
    let mut renderer = OffscreenRenderer::open(gpu, options, size)?;
    renderer.show_dated_maps(flight)?;
    renderer.show_models(flight)?;
    renderer.show_sky(flight)?;
    renderer.show_tracks(flight)?;
    renderer.show_captions(flight)?;
    renderer.set_quality(&scene_quality(&scene.quality, *renderer.earth().quality()))?;
    let (moment, asked) = match known {
        Some(moment) => (moment, None),
        // Only now: a simulator that waits does not wait for the maps as well.
        None => {
            progress.begin("waiting for the simulator", None);
            let awaited = flight.await_moment(aspect, &|| progress.cancelled())?;
            progress.end();
            awaited
        }
    };
    progress.begin("drawing", None);
    let (drawn, missing) = renderer.draw_complete(&moment, scene.output.wait());
    warn_of_missing(&missing);
    tracing::info!("exposure {:+.2} EV", drawn.exposure_ev);
    let mut numbers = match &stats {
        Some(_) => {
            let measured = renderer.measure(&moment)?;
            let dropped = flight.dropped_layers()?;
            Some(PictureStats::new(
                &renderer, &moment, &measured, &missing, &dropped,
            ))
        }
        None => None,
    };
    let mut picture = FilmPicture::Shown(renderer.read()?);
    if let Some(numbers) = &mut numbers {
        numbers.quality = HeldQuality::find(&mut renderer, scene, &moment)?;
    }
    drop(renderer);
    if let Some((gpu, options)) = for_picture {
        let mut painter = FilmPainter::open(flight, gpu, options, size, *pictures)?;
        let frame_s = scene.time.speed / scene.time.frame_rate_hz;
        let after = |part: f64| moment.epoch + part * frame_s * Unit::Second;
        let painted = painter.paint(&moment, |part| flight.at(after(part), aspect))?;
        picture = painted.picture;
    }
    let light = match (radiance, &for_light) {
        (Some(file), Some((gpu, options))) => {
            let (gpu, options) = (gpu.clone(), options.clone());
            let pixels = draw_light(flight, gpu, options, size, &moment)?;
            Some((file, pixels))
        }
        _ => None,
    };
    let seen = match for_sensor {
        Some((sensor, gpu)) => {
            let bands = SensorBands::new(flight, &sensor, &moment, aspect, &gpu)?;
            Some(SensorView { sensor, bands })
        }
        None => None,
    };
    let raw = match (raw, &seen, for_light) {
        (Some(file), Some(seen), Some((gpu, options))) => {
            let frame = RawPainter::new(flight, gpu, options)?.draw(seen, &moment)?;
            warn_of_missing(&frame.missing);
            Some((file, frame))
        }
        _ => None,
    };
    let truth = match for_truth {
        Some((folder, gpu, options)) => {
            let missing = match &seen {
                Some(seen) => folder.draw_seen(flight, &gpu, options, seen, &moment)?,
                None => folder.draw(flight, &gpu, options, size, &moment)?,
            };
            warn_of_missing(&missing);
            Some(folder)
        }
        None => None,
    };
    // Nothing can fail from here on but writing.
    let path = output.target().to_owned();
    let file = picture.file(pictures);
    output.write_whole(&file.map_err(|source| OutputError::NotEncoded { path, source })?)?;
    if let Some(asked) = asked {
        asked.drawn();
    }
    progress.end();
    if let Some((file, pixels)) = light {
        let (width, height) = size;
        file.write(Radiance {
            width,
            height,
            pixels: &pixels,
        })?;
    }
    if let (Some((file, picture)), Some(seen)) = (raw, &seen) {
        let manifest = picture.manifest(flight, seen, &moment, file.target());
        file.write(&picture.raw, &manifest)?;
    }
    if let Some(folder) = truth {
        folder.commit()?;
    }
    if let (Some(file), Some(numbers)) = (stats, numbers) {
        file.write_whole(numbers.to_json().as_bytes())?;
    }
    progress.say(&written_picture(request.output, size, begun.elapsed()));
    Ok(())
}

/// Draws the same moment as light. Tracks are no light and are not in it.
fn draw_light(
    flight: &Flight,
    gpu: GpuContext,
    options: EarthOptions,
    size: (u32, u32),
    moment: &Moment,
) -> Result<Vec<[f32; 4]>, PlayError> {
    let mut renderer = OffscreenRenderer::open_for_radiance(gpu, options, size)?;
    renderer.show_dated_maps(flight)?;
    renderer.show_models(flight)?;
    renderer.show_sky(flight)?;
    renderer.draw_complete(moment, flight.scene().output.wait());
    renderer.read_light()
}

/// Most missing tiles that are named.
const MAX_NAMED: usize = 8;

/// Warns of tiles that a picture lacks.
pub(super) fn warn_of_missing(missing: &[TileKey]) {
    if missing.is_empty() {
        return;
    }
    let names: Vec<_> = missing
        .iter()
        .take(MAX_NAMED)
        .map(TileKey::to_string)
        .collect();
    let more = match missing.len().saturating_sub(MAX_NAMED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    tracing::warn!(
        "{} tiles are missing and rendered at a coarser level: {}{more}; increase wait_s under [output] or run `terrella pack verify`",
        missing.len(),
        names.join(", ")
    );
}
