//! Errors between a scene and its image.

use super::film::FilmError;
use super::output::OutputError;
use crate::scene::{KernelError, MAX_ELEVATION_FILES, SceneError, ToneError};
use std::path::PathBuf;
use terrella::EarthError;
use terrella::OffscreenError;
use terrella::celestial::CelestialError;
use terrella::frames::EarthOrientationError;
use terrella::internals::gpu::{ContextError, PictureError, TimerError};
use terrella::tracks::TracksError;
use terrella_ground::elevation::{HeightFileError, StreamedGroundError};
use terrella_imagery::ImageryError;
use terrella_imagery::pack::PackError;
use terrella_model::ModelError;
use terrella_orbit::basilisk::RecordingError;
use terrella_orbit::{AttitudeError, OrbitError};
use terrella_sensor::SensorError;

/// Errors between a scene and its image. The messages come from the modules.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum PlayError {
    /// The scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The measured point spread of a scene's sensor.
    #[error(transparent)]
    Kernel(#[from] KernelError),
    /// The measured response of a scene's tone.
    #[error(transparent)]
    Tone(#[from] ToneError),
    /// The orbit's elements, or SGP4 at some instant.
    #[error(transparent)]
    Orbit(#[from] OrbitError),
    /// The attitude of a satellite.
    #[error(transparent)]
    Attitude(#[from] AttitudeError),
    /// The model of a satellite.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The tracks of the scene's satellites.
    #[error(transparent)]
    Tracks(#[from] TracksError),
    /// The sky cannot be drawn.
    #[error(transparent)]
    Celestial(#[from] CelestialError),
    /// The table of the Earth's orientation.
    #[error(transparent)]
    EarthOrientation(#[from] EarthOrientationError),
    /// The maps.
    #[error(transparent)]
    Imagery(#[from] ImageryError),
    /// The imagery pack.
    #[error(transparent)]
    Pack(#[from] PackError),
    /// An elevation file.
    #[error(transparent)]
    Heights(#[from] HeightFileError),
    /// Folders and patterns of elevation files stand for too many.
    #[error(
        "[earth] elevation stands for {count} files; a scene reads at most {MAX_ELEVATION_FILES}: build a pack of them with terrella pack build --heights, and set pack_heights = true"
    )]
    ManyHeights { count: usize },
    /// The elevation data of the scene's pack cannot be used as terrain.
    #[error("elevation data of the pack: {0}")]
    PackHeights(#[from] StreamedGroundError),
    /// The scene requests elevation data that its pack does not have.
    #[error(
        "{}:{line}: [earth] pack_heights: the pack {} has no elevation data; omit it and list files in elevation = [\"FILE\", …], or build \
         the pack with --heights",
        scene.display(), folder.display()
    )]
    NoPackHeights {
        scene: PathBuf,
        line: usize,
        folder: PathBuf,
    },
    /// The scene requests a map that its pack does not have.
    #[error(
        "{}:{line}: [earth] {layer}: the pack {} has no such map; write {layer} = false, leave it out, or build the pack with it",
        scene.display(), folder.display()
    )]
    NoLayer {
        scene: PathBuf,
        line: usize,
        /// Name of the map that is missing.
        layer: &'static str,
        /// The pack's folder.
        folder: PathBuf,
    },
    /// A strict scene, and a map that is not there.
    #[error(
        "{}: [{table}] {layer}: {missing}; add it, write {layer} = false, or leave out strict = true",
        scene.display()
    )]
    MissingLayer {
        scene: PathBuf,
        /// The table of its key.
        table: &'static str,
        /// Name of the map that is missing.
        layer: &'static str,
        missing: String,
    },
    /// A strict scene, and a file of GeoJSON with something wrong in it.
    #[error(
        "{}: [geojson] file: {}: {what}; correct the file, or leave out strict = true",
        scene.display(), file.display()
    )]
    GeoJson {
        scene: PathBuf,
        file: PathBuf,
        what: String,
    },
    /// An image of a caption that cannot be shown.
    #[error(
        "[caption] image: {}: {why}; give a PNG file of at most 4096 × 4096 pixels and 16 MiB",
        file.display()
    )]
    CaptionImage { file: PathBuf, why: String },
    /// The scene requests a storage format that its pack does not have.
    #[error(
        "the pack {} stores its tiles only as {kept}; write storage = \"auto\" in [earth], or build the pack with the other",
        folder.display()
    )]
    NoStorage {
        /// The pack's folder.
        folder: PathBuf,
        /// The storage formats that it has.
        kept: String,
    },
    /// Two maps of a layer that change into each other and are not alike.
    #[error(
        "[earth] {key}: {} and {} are not of one size; maps that pass into each other must be, or write map_fade = false",
        files[0].display(), files[1].display()
    )]
    UnlikeMaps {
        /// The key that names them.
        key: &'static str,
        files: Box<[PathBuf; 2]>,
    },
    /// The thread that reads maps cannot begin.
    #[error("cannot start a thread to read maps: {0}")]
    NoThread(#[source] std::io::Error),
    /// The renderer.
    #[error(transparent)]
    Earth(#[from] EarthError),
    /// Textures and render targets.
    #[error(transparent)]
    Offscreen(#[from] OffscreenError),
    /// The adapter.
    #[error(transparent)]
    Context(#[from] ContextError),
    /// Reading a picture back.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// Times of the device could not be read.
    #[error(transparent)]
    Timer(#[from] TimerError),
    /// Writing files.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A folder of frames.
    #[error(transparent)]
    Film(#[from] FilmError),
    /// Encoding video.
    #[error(transparent)]
    Video(#[from] VideoError),
    /// The window.
    #[error(transparent)]
    Window(#[from] WindowError),
    /// A saved simulation cannot be read any more.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// A camera of a simulation cannot be drawn.
    #[error("no image for the simulation: {cause}")]
    NoCameraPicture { cause: String },
    /// A scene whose satellites do not come from a simulation that runs.
    #[error("{}: there is no simulation to serve; write source = \"basilisk\" in [orbit], without a file", scene.display())]
    NoSimulation { scene: PathBuf },
    /// The work was stopped from outside.
    #[error(
        "interrupted after {done}{} frames; {left}",
        wanted.map_or_else(String::new, |wanted| format!(" of {wanted}"))
    )]
    Interrupted {
        /// Frames drawn.
        done: u64,
        /// Frames wanted, where that is known.
        wanted: Option<u64>,
        /// What is kept, and how to go on with it.
        left: &'static str,
    },
    /// No satellite with the requested name, or no satellite at all.
    #[error("{}: satellite {wanted:?}: {remedy}", scene.display())]
    UnknownSatellite {
        scene: PathBuf,
        /// The name.
        wanted: String,
        /// The remedy.
        remedy: String,
    },
    /// An ephemeris of so many rows.
    #[error(
        "{rows} rows are more than the {limit} that one ephemeris may have; take a larger step or a shorter scene"
    )]
    TooManyRows {
        /// How many it would have.
        rows: u64,
        /// Most rows that are written.
        limit: u64,
    },
    /// States that cannot be written as an ephemeris message.
    #[error("{}: {satellite} cannot be written as an ephemeris: {cause}", path.display())]
    NoEphemeris {
        path: PathBuf,
        satellite: String,
        /// The reason and the remedy.
        cause: String,
    },
    /// Elements are requested of satellites without any.
    #[error("{}: an element message is for satellites with mean elements, of source = \"tle\" or \"omm\"; {satellite} has none: write its states by --oem", path.display())]
    NoElements { path: PathBuf, satellite: String },
    /// A simulator gives the time of a scene, and this work needs another.
    #[error("{}: the time comes from the simulator on {listens_on}: {work}; {remedy}", scene.display())]
    Live {
        scene: PathBuf,
        listens_on: String,
        /// The work that cannot be done.
        work: &'static str,
        /// The remedy.
        remedy: &'static str,
    },
    /// A simulator sent nothing, or nothing more.
    #[error(
        "nothing came from a simulator on {listens_on} {when}; start it, or give it more time by wait_s in [output]"
    )]
    Silent {
        /// The endpoint that listened.
        listens_on: String,
        /// How long, as text.
        when: String,
    },
    /// A camera at a satellite, and no satellite.
    #[error("the scene has no satellite; add an [orbit] table")]
    NoSatellite,
    /// No accesses to look for, or too many.
    #[error(
        "{}: {}",
        scene.display(),
        match found {
            0 => "no ground station; add one by --place LAT,LON,NAME or by a [[station]] table of a scene, or give --crosslinks for two or more satellites".to_owned(),
            _ => format!("{found} pairs of stations and satellites, of at most {most}; choose satellites by --satellite"),
        }
    )]
    Accesses {
        scene: PathBuf,
        /// Pairs of a station and a satellite, and of two satellites.
        found: usize,
        most: usize,
    },
    /// A map of coverage with too many cells.
    #[error(
        "the region has more than {most} cells; choose larger cells (--step, step_deg) or a smaller region (--region, region_deg)"
    )]
    CoverageCells { most: usize },
    /// A view of which there is no picture.
    #[error("there are no truth layers of this view: its eye or projection is not finite")]
    NoTruth,
    /// A raw frame of a scene without a sensor.
    #[error(
        "{}: a raw frame needs a sensor; give the scene a [sensor] table (docs/sensors.md)",
        scene.display()
    )]
    NoSensor { scene: PathBuf },
    /// The scene's sensor, or light for it.
    #[error(transparent)]
    Sensor(#[from] SensorError),
    /// Even one row of the sensor is larger than the adapter draws.
    #[error(
        "[sensor] oversampling = {oversampling}: a row is drawn {wide} pixels wide, and {adapter} draws at most {limit}; {remedy}"
    )]
    SensorTooWide {
        oversampling: u32,
        wide: u32,
        adapter: String,
        limit: u32,
        /// The remedy.
        remedy: String,
    },
    /// The scene's ladder of quality.
    #[error("{}: {problem}; give a ladder.csv that `terrella report SCENE --quality` wrote, or leave `ladder` out of [quality]", path.display())]
    Ladder {
        path: PathBuf,
        /// The error, with its line if there is one.
        problem: String,
    },
    /// The device stopped answering.
    #[error("the graphics device stopped answering: {0}")]
    DeviceLost(String),
    /// A thread that writes frames ended without a message.
    #[error("the thread that writes the frames panicked; this is a bug, please report it")]
    WriterBroke,
}

impl PlayError {
    /// Whether the error is in the scene, or a requested date, and not on the machine.
    pub fn is_bad_scene(&self) -> bool {
        if matches!(
            self,
            Self::Film(
                FilmError::NoSuchFrames { .. }
                    | FilmError::NoLight { .. }
                    | FilmError::NoOverlay { .. }
                    | FilmError::PeakWithoutPq
                    | FilmError::Peak { .. }
                    | FilmError::HdrAlpha,
            )
        ) {
            return true;
        }
        matches!(
            self,
            Self::Scene(_)
                | Self::Kernel(_)
                | Self::Tone(_)
                | Self::NoSatellite
                | Self::Accesses { .. }
                | Self::NoSensor { .. }
                | Self::SensorTooWide { .. }
                | Self::NoLayer { .. }
                | Self::ManyHeights { .. }
                | Self::NoPackHeights { .. }
                | Self::MissingLayer { .. }
                | Self::CaptionImage { .. }
                | Self::GeoJson { .. }
                | Self::NoStorage { .. }
                | Self::UnknownSatellite { .. }
                | Self::TooManyRows { .. }
                | Self::Live { .. }
                | Self::NoElements { .. }
                | Self::Ladder { .. }
                | Self::Orbit(
                    OrbitError::OutsideValidity { .. }
                        | OrbitError::NotCovered { .. }
                        | OrbitError::Impact { .. }
                )
        )
    }
}

/// Why there is no window.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WindowError {
    /// No display, or no reply from it.
    #[error(
        "no window can be opened: {0}; without a display, write a film with --video FILE.mp4 or --frames FOLDER, or \
         one picture with `terrella frame`"
    )]
    NoDisplay(String),
    /// The thread that times frames cannot be started.
    #[error("frames cannot be timed: {0}; leave target_ms out of the scene's [quality]")]
    NoThread(std::io::Error),
    /// The thread that looks for passes cannot be started.
    #[error("the thread that looks for passes cannot be started: {0}")]
    NoPasses(std::io::Error),
    /// The thread that makes pictures of other layers cannot be started.
    #[error("the thread that makes images of other layers cannot be started: {0}; free memory")]
    NoPictures(std::io::Error),
    /// No thread for the map of coverage.
    #[error("no thread for the map of coverage: {0}; free memory, or leave [coverage] out")]
    NoCoverage(std::io::Error),
    /// The window's surface takes no 8-bit sRGB colour.
    #[error(
        "the window's surface offers no 8-bit sRGB colour, only {present:?}; choose another adapter with --adapter, or \
         write --video or --frames"
    )]
    NoFormat {
        /// The formats that it offers.
        present: Vec<wgpu::TextureFormat>,
    },
}

/// Why a video could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum VideoError {
    /// An odd width or height.
    #[error(
        "a video of {width} × {height} pixels is not possible: H.264 video needs an even width and height; \
         take {even_width} × {even_height}, or write --frames"
    )]
    OddSize {
        width: u32,
        height: u32,
        /// An even width near it.
        even_width: u32,
        /// An even height near it.
        even_height: u32,
    },
    /// Smaller than the encoder of AV1 takes.
    #[error(
        "the encoder of AV1 writes videos from 64 × 64 pixels on, not {width} × {height}; take a larger size, or --codec h264"
    )]
    Av1Size { width: u32, height: u32 },
    /// Larger than the built-in encoder takes.
    #[error(
        "the built-in encoder writes videos from 16 × 16 to 3840 × 2160 pixels (or upright), not {width} × {height}; \
         install ffmpeg, or write --frames"
    )]
    BuiltinSize { width: u32, height: u32 },
    /// More data than the built-in MP4 writer takes.
    #[error(
        "{}: the video has grown over {limit_mib} MiB, the most that the built-in encoder writes; install ffmpeg, or \
         make the film shorter or smaller", path.display()
    )]
    BuiltinLength { path: PathBuf, limit_mib: u64 },
    /// The built-in encoder failed.
    #[error("{}: the built-in encoder failed: {cause}", path.display())]
    Builtin {
        path: PathBuf,
        /// Its words.
        cause: String,
    },
    /// `ffmpeg` is requested and not installed.
    #[error(
        "ffmpeg was not found on the search path; install it (on Debian and Ubuntu `apt-get install ffmpeg`), or \
         {remedy}"
    )]
    NoFfmpeg {
        /// The way without it.
        remedy: String,
    },
    /// `ffmpeg` is there without the encoder.
    #[error(
        "the installed ffmpeg has no {encoder}; install one that has, choose another --codec, or {remedy}"
    )]
    NoEncoder {
        encoder: &'static str,
        /// The way without ffmpeg.
        remedy: String,
    },
    /// A codec or quality that the built-in encoder does not have.
    #[error(
        "the built-in encoder writes H.264 of one quality; leave --codec and --crf out, or choose --encoder ffmpeg"
    )]
    BuiltinCoding,
    /// High dynamic range in H.264.
    #[error(
        "--format pq and hlg need 10 bits, and most players decode only 8 bits of H.264; choose --codec h265 or av1, or write frames with --frames"
    )]
    HdrCodec,
    /// `ffmpeg` stopped.
    #[error("{}: ffmpeg failed ({status}): {words}", path.display())]
    Ffmpeg {
        path: PathBuf,
        /// How it ended.
        status: String,
        /// The end of its output.
        words: String,
    },
}
