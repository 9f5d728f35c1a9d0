//! The raw frames of a film, as the scene's sensor sees it.

use super::clock::frame_epoch;
use super::error::PlayError;
use super::film::{
    Existing, FilmKey, FilmPage, FrameFolder, FrameRange, FrameRecord, KeptFrames, PageHead,
    PictureSettings, checksum,
};
use super::flight::Flight;
use super::progress::Progress;
use super::raw::RawFile;
use super::raw_format::RawFormat;
use super::raw_picture::RawPainter;
use super::sensor_bands::{SensorBands, SensorView};
use super::still::warn_of_missing;
use super::written::counted;
use std::path::Path;
use std::time::Instant;
use terrella::GpuContext;
use terrella_files::printable;

/// Which raw frames are wanted, and where they go.
#[derive(Clone, Debug)]
pub struct RawFilmRequest<'r> {
    /// The folder for frames and their pages.
    pub folder: &'r Path,
    /// What becomes of what that folder holds already.
    pub existing: Existing,
    /// The format of the frames.
    pub format: RawFormat,
    /// The frames that are wanted.
    pub range: FrameRange,
    /// Part of the adapter's name; `None` takes the best.
    pub adapter: Option<&'r str>,
}

/// Draws the raw frame of the scene's sensor for each frame of its film, and writes it with its page: `frame_00000.tiff` and
/// `frame_00000.json`. The folder's page, `frames.json`, lists them as it does the pictures of a film. Each is the frame that [`write_still`](super::write_still) writes at its instant.
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
    let ending = request.format.ending();
    let folder = FrameFolder::open(request.folder, frame_count, ending, request.existing)?;
    let [width, height] = table.size();
    let film = FilmKey {
        raw: Some(request.format),
        ..FilmKey::new(scene, (width, height), PictureSettings::default())?
    };
    let mut kept = match request.existing {
        Existing::Resume => FilmPage::read_kept(&folder, &film, frame_count, &wanted)?,
        Existing::Reject | Existing::Overwrite => KeptFrames::default(),
    };
    // A frame is whole with its parameters.
    let has_manifest = |index: &u64| folder.path(*index).with_extension("json").is_file();
    kept.entries.retain(|index, _| has_manifest(index));
    let lacking: Vec<u64> = wanted
        .filter(|index| !kept.entries.contains_key(index))
        .collect();
    if lacking.is_empty() && !kept.is_cut {
        progress.say("all raw frames are already there");
        return Ok(());
    }

    let features = GpuContext::FLOAT_TARGET;
    let gpu = pollster::block_on(GpuContext::open_with(request.adapter, features))?;
    progress.begin("loading maps", None);
    let mut options = flight.uploaded_options(&gpu)?;
    // What is measured is what is known.
    options.light.detail = false;
    let mut painter = RawPainter::new(flight, gpu.clone(), options)?;
    progress.end();
    let adapter = gpu.adapter.get_info().name;
    if let Some(before) = kept.adapter.as_ref().filter(|name| **name != adapter) {
        tracing::warn!(
            "the raw frames that are kept were rendered by {}, the others will be rendered by {adapter}: they may differ slightly; --overwrite renders all again",
            printable(before)
        );
    }
    let start = scene.time.start;
    let head = PageHead::new(scene, frame_epoch(&scene.time, 0), film, adapter);
    let mut page = FilmPage::begin(&folder, &head, kept.entries)?;
    let count = lacking.len() as u64;
    progress.begin("raw frames", Some(count));
    let mut missing = Vec::new();
    for (done, index) in (0..).zip(lacking) {
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
        let written = file.write(&frame.raw, &manifest)?;
        // Raw frames have the exposure time of their sensor.
        page.add(&FrameRecord {
            file: folder.name(index),
            bytes: written.len() as u64,
            blake3: checksum(&written),
            ..FrameRecord::new(index, start, moment.epoch, &moment.view, 0.0)
        })?;
        missing.extend(frame.missing);
        progress.step();
    }
    progress.end();
    page.finish()?;
    missing.sort();
    missing.dedup();
    warn_of_missing(&missing);
    progress.say(&format!(
        "{}: {} of {width} × {height} pixels, {:.1} s",
        request.folder.display(),
        counted(count, "raw frame"),
        begun.elapsed().as_secs_f64()
    ));
    Ok(())
}
