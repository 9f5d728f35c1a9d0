//! The raw frames of a film, as the scene's sensor sees it.

use super::clock::frame_epoch;
use super::error::PlayError;
use super::export_words::left_words;
use super::film::{
    Existing, FilmKey, FilmPage, FrameFolder, FrameRange, FrameRecord, KeptFrames, PageHead,
    PictureSettings, checksum,
};
use super::flight::{Flight, Moment};
use super::gap_words::gap_words;
use super::progress::Progress;
use super::raw::RawFile;
use super::raw_format::RawFormat;
use super::raw_picture::RawPainter;
use super::sensor_bands::{SensorBands, SensorView};
use super::still::warn_of_missing;
use super::written::counted;
use hifitime::{Duration, Unit};
use std::path::Path;
use std::time::Instant;
use terrella::GpuContext;
use terrella::frames::Epoch;
use terrella_files::printable;
use terrella_orbit::Feed;
use terrella_sensor::Sensor;

/// Which raw frames are wanted, and where they go.
#[derive(Clone, Debug)]
pub struct RawFilmRequest<'r> {
    /// The folder for frames and their pages.
    pub folder: &'r Path,
    /// Handling of existing files in that folder.
    pub existing: Existing,
    /// The format of the frames.
    pub format: RawFormat,
    /// The frames that are wanted.
    pub range: FrameRange,
    /// Part of the adapter's name; `None` takes the best.
    pub adapter: Option<&'r str>,
}

/// The instants of a film's raw frames.
struct RawTimes<'f> {
    flight: &'f Flight,
    aspect: f64,
    /// Time from the first row to the last.
    readout: Duration,
    /// Instants after which the satellite is not known for a time, or ever.
    ends: Vec<Epoch>,
}

impl<'f> RawTimes<'f> {
    fn new(flight: &'f Flight, sensor: &Sensor, aspect: f64) -> Self {
        let feed = flight.feed();
        let of_gaps = |feed: &dyn Feed| feed.gaps().into_iter().map(|(from, _)| from).collect();
        let mut ends: Vec<_> = feed.map(of_gaps).unwrap_or_default();
        ends.extend(feed.map(|feed| feed.validity().1));
        Self {
            flight,
            aspect,
            readout: sensor.shutter.readout_s(sensor.lens.size()[1]) * Unit::Second,
            ends,
        }
    }

    /// The moment of a frame's first row: that of the film's frame, or earlier if the last row would otherwise be after the end of the validity.
    /// All rows are then exposed at the times in the frame's page.
    fn at(&self, index: u64) -> Result<Moment, PlayError> {
        let epoch = frame_epoch(&self.flight.scene().time, index);
        let is_cut = |end: &&Epoch| epoch <= **end && epoch + self.readout > **end;
        let end = self.ends.iter().find(is_cut);
        let first_row = end.map_or(epoch, |end| *end - self.readout);
        self.flight.at(first_row, self.aspect)
    }
}

/// Draws the raw frame of the scene's sensor for each frame of its film, and writes it with its page: `frame_00000.tiff` and
/// `frame_00000.json`. The folder's page, `frames.json`, lists them as it does the pictures of a film. Each is the frame that [`write_still`](super::write_still) writes at its instant.
///
/// Times at which the satellite is not known are left out, as in films; a frame whose readout would reach into one begins earlier.
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
    let times = RawTimes::new(flight, &sensor, aspect);
    // The satellite's validity is checked before the maps are loaded.
    let ends = [times.at(wanted.start)?, times.at(wanted.end - 1)?];
    let [first, last] = ends.map(|moment| moment.epoch);
    let gaps = gap_words(flight, (first, last));
    gaps.iter().for_each(|line| progress.say(line));
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
    let options = flight.uploaded_options(&gpu)?;
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
            let left = left_words(true, false, false);
            return Err(PlayError::Interrupted { done, wanted, left });
        }
        let moment = times.at(index)?;
        let seen = SensorView {
            bands: SensorBands::new(flight, &sensor, &moment, aspect, &gpu)?,
            sensor: sensor.clone(),
        };
        let frame = painter.draw(&seen, &moment)?;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap_words::tests::with_gap;
    use crate::scene::Scene;
    use terrella::frames::rfc3339;

    /// Known from minute 0 to 10 and from 12 to 20, with a readout of 49.9 s.
    #[test]
    fn rows_of_a_raw_frame_stay_before_gaps_and_the_end() {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("gap.oem"), with_gap()).expect("written");
        let open = |minute: u32, speed: i32| {
            let text = format!(
                "[time]\nstart = \"2026-03-01T00:{minute:02}:15Z\"\nduration_s = 840\nspeed = {speed}\nframe_rate_hz = 1\n\
                [[orbit]]\nsource = \"oem\"\nfile = \"gap.oem\"\n[sensor]\nsize = [64, 500]\nfocal_length_mm = 12\n\
                pixel_pitch_um = 5\nf_number = 2.8\nexposure_s = 0.002\nfull_well_e = 20000\nshutter = \"rolling\"\nline_time_us = 100000\n"
            );
            let scene =
                Scene::from_toml(&text, &folder.path().join("s.toml")).expect("a good scene");
            Flight::open(scene).expect("opens")
        };
        let mut moved = Vec::new();
        for (minute, speed) in [(5, 30), (19, -30)] {
            let flight = open(minute, speed);
            let time = &flight.scene().time;
            let sensor = flight.scene().sensor.as_ref().expect("a sensor");
            let sensor = sensor.open().expect("a good sensor");
            let times = RawTimes::new(&flight, &sensor, 1.5);
            for n in 0..time.frame_count() {
                let first = times.at(n).expect("known").epoch;
                assert!(flight.at(first + times.readout, 1.5).is_ok(), "frame {n}");
                if first != frame_epoch(time, n) {
                    moved.push(rfc3339(first)[11..].to_owned());
                }
            }
        }
        // Those of 9:15 and 9:45 forwards, and that of 19:15, with which the reversed film starts.
        let [gap, end] = ["00:09:10.100Z", "00:19:10.100Z"];
        assert_eq!(moved, [gap, gap, end, gap, gap]);
    }
}
