//! Scene files: what to draw, when, from where. TOML read with serde; every message names file, line and key.
//!
//! A scene is read in three steps: `raw` (the text as tables and keys, each value with its
//! place), `check`, `orbits` and `live` (ranges, names, paths, defaults, by means of `field`) and, once the orbit's elements are read, [`Scene::check_dates`] and what else `satellites` has.
//! `locate` turns the TOML reader's complaints into messages of our own; `summary` and `orbit_summary` tell what a scene comes to.
//!
//! Every table and key may be left out. [`limits`] holds every range and default.

mod check;
mod dates;
mod error;
mod field;
pub mod limits;
mod live;
mod locate;
mod motion;
mod orbit_summary;
mod orbits;
mod raw;
mod relief;
mod satellites;
mod summary;
mod surfaces;
mod tracks;

use crate::air::Atmosphere;
use crate::frames::Epoch;
use crate::globe::{Figure, LevelRule, Shading, Subdivision, Visibility};
use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};

pub use error::{Place, SceneError};
pub use motion::{Forces, Motion, Orbit, OrbitSource, Start, StartForm};
pub use relief::ReliefTable;
pub use tracks::{Footprint, Track, TrackSpan};

/// A checked scene: every value is in range and every default filled in.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The file it was read from.
    pub path: PathBuf,
    /// `[time]`
    pub time: Time,
    /// `[orbit]`, or each `[[orbit]]`; none where the camera needs no satellite.
    pub orbits: Vec<Orbit>,
    /// `[tracks] width_px`: width of lines, pixels. What else stands in `[tracks]` is in each satellite's [`Orbit::track`].
    pub track_px: f64,
    /// `[camera]`
    pub camera: Camera,
    /// `[earth]`
    pub earth: EarthTable,
    /// `[output]`
    pub output: Output,
    /// `[quality]`; `None` draws everything however long it takes.
    pub quality: Option<QualityTable>,
    /// Which keys the file gave, and where; of satellites, the first's.
    lines: Lines,
    /// The same of each satellite.
    orbit_lines: Vec<Lines>,
}

impl Scene {
    /// Reads and checks a scene file. Paths in it are relative to its folder.
    ///
    /// # Errors
    /// A file that cannot be read, has more than [`limits::MAX_FILE_BYTES`], is not UTF-8, or holds anything
    /// that [`Scene::from_toml`] refuses.
    pub fn load(path: &Path) -> Result<Self, SceneError> {
        let unreadable = |source| SceneError::Read {
            path: path.to_owned(),
            source,
        };
        let too_large = || SceneError::TooLarge {
            path: path.to_owned(),
        };
        let file = std::fs::File::open(path).map_err(unreadable)?;
        let found = file.metadata().map_err(unreadable)?;
        if found.is_dir() {
            return Err(SceneError::Folder {
                path: path.to_owned(),
            });
        }
        if found.len() > limits::MAX_FILE_BYTES {
            return Err(too_large());
        }
        // The length is not to be trusted (a pipe has none, a file may grow), so the reading is bounded too.
        let mut bytes = Vec::new();
        file.take(limits::MAX_FILE_BYTES + 1)
            .read_to_end(&mut bytes)
            .map_err(unreadable)?;
        if bytes.len() as u64 > limits::MAX_FILE_BYTES {
            return Err(too_large());
        }
        let text = std::str::from_utf8(&bytes).map_err(|error| {
            let good = bytes.iter().take(error.valid_up_to());
            SceneError::NotUtf8 {
                path: path.to_owned(),
                line: good.filter(|byte| **byte == b'\n').count() + 1,
            }
        })?;
        Self::from_toml(text, path)
    }

    /// Reads and checks the text of a scene; `path` is the file that messages name and whose folder the
    /// paths in it are relative to. The empty text is a scene: every default.
    ///
    /// # Errors
    /// Text that is not TOML, unknown tables and keys, values of the wrong type or out of range, values in
    /// conflict, files and folders that are not there: the first of them.
    pub fn from_toml(text: &str, path: &Path) -> Result<Self, SceneError> {
        let source = locate::Source { path, text };
        check::check(source, source.parse()?)
    }

    /// The line, from 1, on which the file gives a key; `None` where it does not.
    pub fn line(&self, table: &str, key: &str) -> Option<usize> {
        let lines = &self.lines.0;
        lines
            .iter()
            .find(|((t, k), _)| *t == table && *k == key)
            .map(|(_, line)| *line)
    }

    /// The line, from 1, on which the file gives a key of the satellite of that place in [`Self::orbits`].
    pub fn orbit_line(&self, orbit: usize, key: &str) -> Option<usize> {
        let lines = self.orbit_lines.get(orbit)?.0.iter();
        lines
            .filter(|((_, k), _)| *k == key)
            .map(|(_, line)| *line)
            .next()
    }
}

/// The line of every key that the file gave, by table and key.
#[derive(Clone, Debug, Default)]
struct Lines(BTreeMap<(&'static str, &'static str), usize>);

impl Lines {
    fn insert(&mut self, table: &'static str, key: &'static str, line: usize) {
        self.0.insert((table, key), line);
    }
}

/// `[time]`: when the flight starts and how it is played.
#[derive(Clone, Debug, PartialEq)]
pub struct Time {
    /// UTC instant of the first frame.
    pub start: Epoch,
    /// Simulated seconds that are played, > 0.
    pub duration_s: f64,
    /// Simulated seconds per second of playback; negative plays backwards, never 0.
    pub speed: f64,
    /// Frames per second of playback.
    pub frame_rate_hz: f64,
    /// Table of the Earth's orientation by date; `None` takes UT1 as UTC and leaves polar motion out.
    pub orientation: Option<PathBuf>,
}

/// Where the eye looks from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum CameraMode {
    /// At the satellite, straight down.
    Nadir,
    /// At the satellite, forward along the track with the horizon in the upper third.
    Horizon,
    /// Behind and above the satellite, looking at it, the Earth below.
    Chase,
    /// Above a place on the ground, straight down, north up.
    Geodetic,
}

/// What is upwards on screen when the eye looks straight down from a satellite.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum CameraUp {
    /// The direction of flight.
    #[default]
    Flight,
    /// North.
    North,
}

/// `[camera]`
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Where the eye looks from.
    pub mode: CameraMode,
    /// The name of the satellite that cameras fly with; `None` is the first.
    pub follow: Option<String>,
    /// Nadir mode: what is upwards on screen.
    pub up: CameraUp,
    /// Vertical field of view, degrees.
    pub fov_deg: f64,
    /// Geodetic mode: latitude, degrees.
    pub lat_deg: f64,
    /// Geodetic mode: longitude east, degrees, −180…180.
    pub lon_deg: f64,
    /// Geodetic mode: height above the ellipsoid, kilometres.
    pub height_km: f64,
    /// Geodetic mode: where the eye looks to, or what is upwards on screen if it looks straight down: degrees clockwise
    /// from north.
    pub heading_deg: f64,
    /// Geodetic mode: how far above the horizontal the eye looks, degrees; −90 is straight down.
    pub pitch_deg: f64,
}

/// `[earth]`
#[derive(Clone, Debug, PartialEq)]
pub struct EarthTable {
    /// The figure.
    pub figure: Figure,
    /// Cells per block edge.
    pub subdivision: Subdivision,
    /// Which blocks are drawn.
    pub visibility: Visibility,
    /// How the surface is shaded.
    pub shading: Shading,
    /// Cloud layer.
    pub clouds: bool,
    /// Terrain normals.
    pub normals: bool,
    /// City lights.
    pub night_lights: bool,
    /// The air.
    pub atmosphere: Atmosphere,
    /// Folder of the maps; `None` is the starter pack. Not looked at where there is a pack.
    pub textures: Option<PathBuf>,
    /// The imagery pack; `None` draws whole maps.
    pub pack: Option<PackTable>,
    /// Ground with relief; `None` draws the smooth ellipsoid.
    pub relief: Option<ReliefTable>,
}

/// The keys of `[earth]` that say how an imagery pack is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct PackTable {
    /// The pack's folder.
    pub folder: PathBuf,
    /// Whether the sea glints, if the pack has a water map.
    pub water: bool,
    /// How the level of a block is chosen.
    pub levels: LevelRule,
    /// `levels = "screen"`: most screen pixels that a texel may cover.
    pub texel_px: f64,
    /// Which of the pack's storages is read.
    pub storage: StorageChoice,
    /// Textures of maps and tiles, megabytes.
    pub texture_mb: f64,
    /// Tiles uploaded in one frame, megabytes.
    pub upload_mb: f64,
}

/// Which of a pack's storages is read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum StorageChoice {
    /// Compressed on graphics hardware that reads it, plain on software adapters; whichever there is otherwise.
    #[default]
    Auto,
    /// Plain texels.
    Plain,
    /// BC7, BC5 and BC4.
    Bc,
}

/// `[output]`
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Output {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Samples per pixel, 1 or 4.
    pub samples: u32,
    /// How long a picture that is kept waits for the tiles of its pack, and for its satellite's simulator, seconds.
    pub wait_s: f64,
}

/// `[quality]`: a frame time that the window holds by giving up quality. Pictures that are kept are drawn in full.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QualityTable {
    /// Most milliseconds that a frame may cost.
    pub target_ms: f64,
}

impl Output {
    /// [`Self::wait_s`] as a duration.
    pub fn wait(&self) -> std::time::Duration {
        // Bounds of scene files: a finite number that is not negative.
        std::time::Duration::try_from_secs_f64(self.wait_s).unwrap_or_default()
    }
}
