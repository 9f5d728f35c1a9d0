//! The raw frames of a film, as the scene's sensor sees it.

use super::clock::frame_epoch;
use super::error::PlayError;
use super::film::{Existing, FilmError, FrameFolder, FrameRange};
use super::flight::Flight;
use super::progress::Progress;
use super::raw::{RawFile, RawFormat};
use super::raw_picture::RawPainter;
use super::sensor_bands::{SensorBands, SensorView};
use super::still::warn_of_missing;
use super::written::counted;
use std::path::Path;
use std::time::Instant;
use terrella::GpuContext;

/// Which raw frames are wanted, and where they go.
#[derive(Clone, Debug)]
pub struct RawFilmRequest<'r> {
    /// The folder for frames and their pages.
    pub folder: &'r Path,
    /// Whether a folder that is not empty is accepted and frames of the same number are replaced.
    pub overwrite: bool,
    /// The format of the frames.
    pub format: RawFormat,
    /// The frames that are wanted.
    pub range: FrameRange,
    /// Part of the adapter's name; `None` takes the best.
    pub adapter: Option<&'r str>,
}

/// Draws the raw frame of the scene's sensor for each frame of its film, and writes it with its page: `frame_00000.tiff` and
/// `frame_00000.json`. Each is the frame that [`write_still`](super::write_still) writes at its instant.
///
/// # Errors
/// A scene without a sensor or with a simulator's time, instants at which the satellite is not known, a folder that cannot be written to.
pub fn write_raw_film(
    flight: &Flight,
    request: &RawFilmRequest<'_>,
    progress: &dyn Progress,
) -> Result<(), PlayError> {
    let begun = Instant::now();
    let scene = flight.scene();
    flight.reject_live(
        "raw frames of a film are drawn at instants of the scene",
        "draw one with `terrella frame --raw`",
    )?;
    let Some(table) = &scene.sensor else {
        let scene = scene.path.clone();
        return Err(PlayError::NoSensor { scene });
    };
    let sensor = table.open()?;
    let frame_count = scene.time.frame_count();
    let wanted = request.range.of(frame_count)?;
    let aspect = f64::from(scene.output.size[0]) / f64::from(scene.output.size[1]);
    let at = |index| flight.at(frame_epoch(&scene.time, index), aspect);
    // Whether the satellite is known is found before the maps are loaded.
    at(wanted.start)?;
    at(wanted.end - 1)?;
    let existing = match request.overwrite {
        true => Existing::Overwrite,
        false => Existing::Reject,
    };
    let ending = request.format.ending();
    let folder = FrameFolder::open(request.folder, frame_count, ending, existing);
    let folder = folder.map_err(|error| match error {
        // Raw frames are not resumed.
        PlayError::Film(FilmError::NotEmpty { path }) => FilmError::RawNotEmpty { path }.into(),
        other => other,
    })?;

    let features = GpuContext::FLOAT_TARGET;
    let gpu = pollster::block_on(GpuContext::open_with(request.adapter, features))?;
    progress.begin("loading maps", None);
    let mut options = flight.uploaded_options(&gpu)?;
    // What is measured is what is known.
    options.light.detail = false;
    let mut painter = RawPainter::new(flight, gpu.clone(), options)?;
    progress.end();
    let count = wanted.end - wanted.start;
    progress.begin("raw frames", Some(count));
    let mut missing = Vec::new();
    for (done, index) in (0..).zip(wanted) {
        if progress.cancelled() {
            let wanted = Some(count);
            return Err(PlayError::Interrupted { done, wanted });
        }
        let moment = at(index)?;
        let seen = SensorView {
            bands: SensorBands::new(flight, &sensor, &moment, aspect, &gpu)?,
            sensor: sensor.clone(),
        };
        let frame = painter.draw(flight, &seen, &moment)?;
        let file = RawFile::create(&folder.path(index))?;
        let manifest = frame.manifest(flight, &seen, &moment, file.target());
        file.write(&frame.raw, &manifest)?;
        missing.extend(frame.missing);
        progress.step();
    }
    progress.end();
    missing.sort();
    missing.dedup();
    warn_of_missing(&missing);
    let [width, height] = table.size();
    progress.say(&format!(
        "{}: {} of {width} × {height} pixels, {:.1} s",
        request.folder.display(),
        counted(count, "raw frame"),
        begun.elapsed().as_secs_f64()
    ));
    Ok(())
}
