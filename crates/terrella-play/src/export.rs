//! A flight as numbered pictures and as video. While one frame is written the next one is drawn.

use super::basilisk::with_camera_service;
use super::clock::frame_epoch;
use super::error::PlayError;
use super::export_words::{FilmWords, left_words};
use super::film::{
    Existing, FilmFrames, FilmKey, FilmPage, FilmPainter, FrameFolder, FrameRange, FrameRecord,
    KeptFrames, PageHead, PictureSettings, checksum,
};
use super::film_estimate::FilmEstimate;
use super::flight::Flight;
use super::gap_words::gap_words;
use super::outlook::LightOutlook;
use super::output::{OutputError, PendingFile};
use super::progress::Progress;
use super::video::{
    EncoderChoice, FilmFrame, FrameSink, VideoCoding, VideoFormat, check_size, open_video,
};
use super::written::Written;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::mpsc::sync_channel;
use std::time::Instant;
use terrella::GpuContext;
use terrella_files::printable;
use terrella_imagery::tile::TileKey;
use terrella_orbit::basilisk::Meeting;
use terrella_orbit::live::Pacing;

/// Frames that may wait to be written: one in the writer's hands, this many more drawn ahead of it.
const FRAMES_AHEAD: usize = 2;

/// Output of a flight.
#[derive(Clone, Debug, Default)]
pub struct ExportRequest<'r> {
    /// Folder for PNG frames.
    pub frames: Option<&'r Path>,
    /// Handling of existing files in that folder.
    pub existing: Existing,
    /// How pictures are made and kept.
    pub pictures: PictureSettings,
    /// The frames that are wanted.
    pub range: FrameRange,
    /// The MP4 to write.
    pub video: Option<&'r Path>,
    /// Encoder of the video.
    pub encoder: EncoderChoice,
    /// Codec and quality of the video.
    pub coding: VideoCoding,
    /// Width and height, pixels; `None` is the scene's.
    pub size: Option<(u32, u32)>,
    /// Part of the adapter's name; `None` takes the best.
    pub adapter: Option<&'r str>,
}

/// Draws every frame of a flight and writes them. Nothing is drawn before all files are known to be writable.
pub fn export(
    flight: &Flight,
    request: &ExportRequest<'_>,
    progress: &dyn Progress,
) -> Result<(), PlayError> {
    let begun = Instant::now();
    let scene = flight.scene();
    let is_lockstep = match (flight.simulation(), flight.live_clock()) {
        (Some(simulation), _) => matches!(simulation.options().meeting, Meeting::Listen(_)),
        (None, Some(feed)) => feed.options().pacing == Pacing::Lockstep,
        (None, None) => false,
    };
    if !is_lockstep {
        flight.reject_live(
            "nobody waits for the pictures of a film in broadcast",
            "write pacing = \"lockstep\" in [orbit] and have the simulator ask for each frame (of Basilisk: liveStream, and listen in place of subscribe), or draw one picture with `terrella frame`",
        )?;
    }
    let size = request.size.unwrap_or(scene.output.size.into());
    let count = frames_wanted(flight);
    let frame_count = count.unwrap_or(1);
    let wanted = request.range.of(frame_count)?;
    if is_lockstep && !(request.range.is_all() && request.existing != Existing::Resume) {
        flight.reject_live(
            "which frames there are is the simulator's to say",
            "leave --range and --resume out",
        )?;
    }
    if is_lockstep && request.pictures.shutter.is_some() {
        flight.reject_live("no other instant can be drawn", "leave --shutter out")?;
    }
    FilmPainter::check(flight, &request.pictures)?;
    let mut sinks: Vec<Box<dyn FrameSink>> = Vec::new();
    let mut encoder = None;
    if request.video.is_some() {
        check_size(size)?;
    }
    // The video's file first: it leaves no folder where it is rejected.
    if let Some(path) = request.video {
        let file = PendingFile::create(path, "videos", "mp4")?;
        let format = VideoFormat {
            size,
            frame_rate_hz: scene.time.frame_rate_hz,
            coding: request.coding,
            hdr: request.pictures.hdr(),
        };
        let (sink, name) = open_video(file, format, request.encoder)?;
        sinks.push(sink);
        encoder = Some(name);
    }
    let mut kept = KeptFrames::default();
    let mut folder = None;
    if let Some(path) = request.frames {
        let opened = FrameFolder::open(
            path,
            frame_count,
            request.pictures.format.ending(),
            request.existing,
        )?;
        let film = FilmKey::new(scene, size, request.pictures)?;
        if request.existing == Existing::Resume {
            kept = FilmPage::read_kept(&opened, &film, frame_count, &wanted)?;
        }
        folder = Some((opened, film));
    }
    // Of the frames that are wanted, which may be ten million.
    let kept_frames: BTreeSet<u64> = kept
        .entries
        .range(wanted.clone())
        .map(|(n, _)| *n)
        .collect();
    let lacking = wanted.end - wanted.start - kept_frames.len() as u64;
    if lacking == 0 {
        progress.say("all frames are already rendered");
        if let Some((folder, film)) = folder.filter(|_| kept.is_cut) {
            let adapter = kept.adapter.unwrap_or_default();
            let head = PageHead::new(scene, frame_epoch(&scene.time, 0), film, adapter);
            FilmPage::begin(&folder, &head, kept.entries)?;
        }
        return Ok(());
    }
    let light = match is_lockstep {
        true => None,
        false => Some(LightOutlook::of(flight, wanted.clone())?),
    };
    let words = FilmWords {
        scene,
        video: request.video.zip(encoder.as_deref()),
        pictures: request
            .frames
            .map(|folder| (folder, request.pictures.format)),
        size,
        frames: count.map(|_| (wanted.end - wanted.start, kept_frames.len() as u64)),
        frame_rate_hz: scene.time.frame_rate_hz,
        light: light.as_ref(),
    };
    let gaps = match wanted.is_empty() {
        true => Vec::new(),
        false => {
            let at = |frame| frame_epoch(&scene.time, frame);
            gap_words(flight, (at(wanted.start), at(wanted.end - 1)))
        }
    };
    let lines = words.lines().into_iter().chain(gaps);
    lines.for_each(|line| progress.say(&line));

    progress.begin("loading maps", None);
    let features = FilmPainter::features(&request.pictures);
    let gpu = pollster::block_on(GpuContext::open_with(request.adapter, features))?;
    let options = flight.uploaded_options(&gpu)?;
    progress.end();
    let mut frames = FilmFrames::open(flight, gpu, options, size, request.pictures)?;
    let adapter = frames.painter().renderer().adapter_info().name;
    if let Some(before) = kept.adapter.as_ref().filter(|name| **name != adapter) {
        tracing::warn!(
            "the frames that are kept were rendered by {}, the others will be rendered by {adapter}: they may differ slightly; --overwrite renders all frames again",
            printable(before)
        );
    }
    if let Some((folder, film)) = folder {
        let start = frame_epoch(&scene.time, 0);
        let head = PageHead::new(scene, start, film, adapter.clone());
        sinks.push(Box::new(FrameFiles {
            page: FilmPage::begin(&folder, &head, kept.entries)?,
            folder,
            pictures: request.pictures,
            written: (0, 0),
        }));
    }
    tracing::info!(
        "{} frames of {} × {} on {}",
        count.map_or("as many as there are steps:".to_owned(), |_| lacking
            .to_string()),
        size.0,
        size.1,
        adapter
    );
    if !kept_frames.is_empty() {
        let kept = kept_frames.len();
        tracing::info!("{kept} frames are already rendered and kept");
    }
    progress.begin("frames", count.map(|_| lacking));
    let left = left_words(
        request.frames.is_some(),
        request.video.is_some(),
        is_lockstep,
    );
    let mut missing_tiles = MissingTiles::default();
    if is_lockstep {
        let (written, done) = with_camera_service(flight, request.adapter, || {
            export_lockstep(flight, sinks, frames.painter(), (count, left), progress)
        })?;
        say_written(&written, done, begun, progress);
        return Ok(());
    }
    let written = write_while_drawing(sinks, |push| {
        let mut done = 0;
        let mut estimate = FilmEstimate::default();
        // Where exposure is metered a frame's depends on those before, drawn or not.
        let is_metered = frames.painter().renderer().meters_exposure();
        let first = if is_metered { 0 } else { wanted.start };
        for index in first..wanted.end {
            if progress.cancelled() {
                return Err(PlayError::Interrupted {
                    done,
                    wanted: Some(lacking),
                    left,
                });
            }
            let is_drawn = wanted.contains(&index) && !kept_frames.contains(&index);
            if !is_drawn {
                frames.follow(flight, index)?;
                continue;
            }
            let drawn = frames.draw(flight, index)?;
            missing_tiles.add(index, &drawn.missing);
            let frame = FilmFrame {
                record: drawn.record,
                picture: drawn.picture,
            };
            if !push(frame) {
                break;
            }
            done += 1;
            progress.step();
            if let Some(line) = estimate.frame_done(begun.elapsed(), lacking - done) {
                progress.say(&line);
            }
        }
        Ok(())
    })?;
    progress.end();
    say_written(&written, lacking, begun, progress);
    missing_tiles.warn();
    Ok(())
}

/// Says of each file of a film of so many frames what it is.
fn say_written(written: &[Written], frames: u64, begun: Instant, progress: &dyn Progress) {
    for file in written {
        progress.say(&file.line(frames, begun.elapsed()));
    }
}

/// Number of frames of a film. A Basilisk simulation determines its own end: without a duration in the scene there is one frame for each of its
/// steps, and the number is unknown.
fn frames_wanted(flight: &Flight) -> Option<u64> {
    let scene = flight.scene();
    let is_given = scene.line("time", "duration_s").is_some();
    (flight.simulation().is_none() || is_given).then(|| scene.time.frame_count())
}

/// One frame for each image that a simulator requests: until the scene's number of frames, until it is silent for the scene's timeout, or until its
/// stream ends. `left` are the words about what an interruption leaves. Returns the written files and the number of frames.
fn export_lockstep(
    flight: &Flight,
    sinks: Vec<Box<dyn FrameSink>>,
    painter: &mut FilmPainter,
    (wanted, left): (Option<u64>, &'static str),
    progress: &dyn Progress,
) -> Result<(Vec<Written>, u64), PlayError> {
    let aspect = painter.aspect();
    let frame_s = 1.0 / flight.scene().time.frame_rate_hz;
    let mut missing_tiles = MissingTiles::default();
    let mut done = 0;
    let written = write_while_drawing(sinks, |push| {
        while wanted.is_none_or(|wanted| done < wanted) {
            let awaited = flight.await_moment(aspect, &|| progress.cancelled());
            if progress.cancelled() {
                return Err(PlayError::Interrupted { done, wanted, left });
            }
            let (moment, asked) = match awaited {
                Ok((moment, Some(asked))) => (moment, asked),
                Err(error @ PlayError::Silent { .. }) if done == 0 => return Err(error),
                Ok((_, None)) | Err(PlayError::Silent { .. }) => break,
                // The simulator has the rejection; the next frame may be a good one.
                Err(error) => {
                    tracing::warn!("a frame was rejected: {error}");
                    continue;
                }
            };
            painter.renderer().follow_light(&moment, frame_s)?;
            let painted = painter.paint(&moment, |_| Ok(moment))?;
            let (start, ev) = (flight.scene().time.start, painted.exposure_ev);
            let frame = FilmFrame {
                record: FrameRecord::new(done, start, moment.epoch, &moment.view, ev),
                picture: painted.picture,
            };
            if !asked.drawn() {
                tracing::warn!(
                    "a frame came too late for the simulator and is left out of the film"
                );
                continue;
            }
            missing_tiles.add(done, &painted.missing);
            if !push(frame) {
                break;
            }
            done += 1;
            progress.step();
        }
        Ok(())
    })?;
    progress.end();
    tracing::info!("{done} frames, as the simulator requested");
    missing_tiles.warn();
    Ok((written, done))
}

/// Frames that lack tiles.
#[derive(Default)]
struct MissingTiles {
    frames: u64,
    first: Option<(u64, TileKey)>,
    tiles: BTreeSet<TileKey>,
}

impl MissingTiles {
    fn add(&mut self, frame: u64, missing: &[TileKey]) {
        self.frames += u64::from(!missing.is_empty());
        self.first = self.first.or(missing.first().map(|key| (frame, *key)));
        self.tiles.extend(missing);
    }

    fn warn(&self) {
        let Some((frame, key)) = self.first else {
            return;
        };
        let tiles: Vec<_> = self.tiles.iter().map(TileKey::to_string).collect();
        tracing::warn!(
            "{} frames lack tiles and are coarser there, first frame {frame} ({key}); give them more time (wait_s \
             under [output]) or run `terrella pack verify`. Missing: {}",
            self.frames,
            tiles.join(", ")
        );
    }
}

/// Runs `produce` on this thread and the sinks on another. `produce` gets a function that takes frames and returns whether more are needed. The
/// sinks are finished only if both sides had no error.
fn write_while_drawing(
    mut sinks: Vec<Box<dyn FrameSink>>,
    produce: impl FnOnce(&mut dyn FnMut(FilmFrame) -> bool) -> Result<(), PlayError>,
) -> Result<Vec<Written>, PlayError> {
    let (sender, receiver) = sync_channel::<FilmFrame>(FRAMES_AHEAD);
    std::thread::scope(|scope| {
        let writer = scope.spawn(move || {
            for frame in receiver {
                for sink in &mut sinks {
                    sink.push(&frame)?;
                }
            }
            Ok::<_, PlayError>(sinks)
        });
        let produced = produce(&mut |frame| sender.send(frame).is_ok());
        drop(sender);
        let sinks = writer.join().map_err(|_| PlayError::WriterBroke)??;
        produced?;
        sinks.into_iter().map(|sink| sink.finish()).collect()
    })
}

/// Files of pictures in a folder, each complete when it appears, and their page.
struct FrameFiles {
    folder: FrameFolder,
    page: FilmPage,
    pictures: PictureSettings,
    /// How many pictures are written, and their bytes.
    written: (u64, u64),
}

impl FrameSink for FrameFiles {
    fn push(&mut self, frame: &FilmFrame) -> Result<(), PlayError> {
        let index = frame.record.index;
        let path = self.folder.path(index);
        let file = frame.picture.file(&self.pictures);
        let file = file.map_err(|source| OutputError::NotEncoded { path, source })?;
        self.folder.pending(index)?.write_whole(&file)?;
        let (pictures, bytes) = self.written;
        self.written = (pictures + 1, bytes + file.len() as u64);
        let record = FrameRecord {
            file: self.folder.name(index),
            bytes: file.len() as u64,
            blake3: checksum(&file),
            ..frame.record.clone()
        };
        self.page.add(&record)
    }

    fn finish(self: Box<Self>) -> Result<Written, PlayError> {
        self.page.finish()?;
        let (pictures, bytes) = self.written;
        Ok(Written {
            path: self.folder.folder().to_owned(),
            bytes,
            pictures: Some(pictures),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::FilmPicture;
    use std::sync::atomic::{AtomicU32, Ordering};

    /// Counts frames, fails at one of them, remembers whether it was finished.
    struct Probe<'p> {
        pushed: &'p AtomicU32,
        finished: &'p AtomicU32,
        fail_at: u32,
    }

    impl FrameSink for Probe<'_> {
        fn push(&mut self, frame: &FilmFrame) -> Result<(), PlayError> {
            let index = self.pushed.fetch_add(1, Ordering::Relaxed);
            assert_eq!(
                u32::from(frame.picture.shown().get_pixel(0, 0)[0]),
                index,
                "out of order"
            );
            if index == self.fail_at {
                return Err(PlayError::DeviceLost("probe".into()));
            }
            Ok(())
        }

        fn finish(self: Box<Self>) -> Result<Written, PlayError> {
            self.finished.fetch_add(1, Ordering::Relaxed);
            Ok(Written {
                path: "probe".into(),
                bytes: 0,
                pictures: None,
            })
        }
    }

    static COUNTS: [AtomicU32; 6] = [const { AtomicU32::new(0) }; 6];

    /// Whether it succeeded, and how many frames were drawn, written and finished.
    fn run(case: usize, fail_at: u32, last: Result<(), PlayError>) -> (bool, usize, u32, u32) {
        let (pushed, finished) = (&COUNTS[2 * case], &COUNTS[2 * case + 1]);
        let probe = Probe {
            pushed,
            finished,
            fail_at,
        };
        let mut drawn = 0_usize;
        let result = write_while_drawing(vec![Box::new(probe)], |push| {
            for index in 0..20 {
                drawn += 1;
                let epoch = terrella::Epoch::from_tai_seconds(0.0);
                let view = terrella::EyeView::itrf(
                    glam::DVec3::X,
                    glam::DVec3::Y,
                    glam::DVec3::Z,
                    1.0,
                    1.0,
                );
                let frame = FilmFrame {
                    record: FrameRecord::new(index.into(), epoch, epoch, &view, 0.0),
                    picture: FilmPicture::Shown(image::RgbaImage::from_pixel(
                        1,
                        1,
                        image::Rgba([index; 4]),
                    )),
                };
                if !push(frame) {
                    break;
                }
            }
            last
        });
        (
            result.is_ok(),
            drawn,
            pushed.load(Ordering::Relaxed),
            finished.load(Ordering::Relaxed),
        )
    }

    #[test]
    fn frames_come_in_order_and_only_success_finishes() {
        assert_eq!(run(0, u32::MAX, Ok(())), (true, 20, 20, 1));
        // The writer fails: the drawing side stops too, at most the waiting frames and the one in hand later.
        let (done, drawn, written, finished) = run(1, 3, Ok(()));
        assert_eq!((done, written, finished), (false, 4, 0));
        assert!(drawn <= 4 + FRAMES_AHEAD + 1, "{drawn} drawn");
        // The drawing side fails after its last frame.
        let broken = Err(PlayError::DeviceLost("drawing".into()));
        assert_eq!(run(2, u32::MAX, broken), (false, 20, 20, 0));
    }
}
