//! Scene files: what to draw, when, from where. TOML read with serde; every message names file, line and key.
//!
//! Every table and key may be left out.
//!
//! # Where a key is
//!
//! | file | what of a key |
//! |---|---|
//! | `keys.rs` | its declaration: name, type, unit, range, default, meaning. **Begin here**; `table.rs` explains the form |
//! | `choices.rs` | the words that keys choose from |
//! | `time.rs`, `orbit.rs`, `tracks.rs`, `stations.rs`, `layers.rs`, `camera.rs`, `earth.rs`, `sky.rs`, `output.rs` | a table each: the checked value that hosts read, and its reader |
//! | `globe_keys.rs` | declarations of `[layers]`, `[[geojson]]` and `[[station]]` |
//! | `geojson.rs` | reader of `[[geojson]]` |
//! | `coverage_keys.rs`, `coverage.rs` | declarations and reader of `[coverage]` |
//! | `camera_keys.rs` | `[[camera.keys]]` |
//! | `caption_keys.rs`, `captions.rs` | declarations and reader of `[[caption]]` |
//! | `sensor_keys.rs`, `sensor.rs` | declarations and reader of `[sensor]` |
//! | `orbit_check.rs`, `craft.rs`, `articulations.rs`, `many.rs`, `live.rs`, `basilisk.rs`, `burns.rs` | readers of `[orbit]`, which has the most keys |
//! | `relief.rs`, `surfaces.rs` | readers of the keys of `[earth]` that are about terrain |
//! | `tone.rs`, `grade.rs` | readers of the keys of `[output]` that are about tone, white balance and grain |
//! | `dated_maps.rs` | readers of the keys of `[earth]` that are about maps that change with the date |
//! | `built_in.rs` | no key: the scene that comes with the program, and files of orbits in place of a scene |
//! | `config/iss.toml` | its explanation for users: a test holds that every key stands there |
//!
//! # How a scene is read
//!
//! `text` is the file; `parse` makes the tables of `keys` of it, each value with its place, and turns the TOML reader's
//! complaints into messages of our own; `check` goes through the tables by means of `field` (ranges, names, paths,
//! defaults), which notes in `record` what each key comes to. Once the satellites are opened, [`Scene::check_dates`] and what
//! else `dates` and `satellites` have. `summary` prints the record and says in text what the scene comes to.

mod articulations;
mod basilisk;
mod built_in;
mod burns;
mod camera;
mod camera_keys;
mod caption_keys;
mod captions;
mod check;
mod choices;
mod coverage;
mod coverage_keys;
mod craft;
mod dated_maps;
mod dates;
mod earth;
mod error;
mod field;
mod footprint;
mod geojson;
mod globe_keys;
mod grade;
mod keys;
mod layers;
mod lens;
mod live;
mod look_at;
mod many;
mod meaning;
mod orbit;
mod orbit_check;
mod orbit_keys;
mod orbit_summary;
mod output;
mod parse;
mod record;
#[cfg(test)]
mod reference;
mod relief;
mod satellites;
#[cfg(test)]
mod schema;
mod sensor;
mod sensor_keys;
mod settings;
mod sky;
mod stations;
mod summary;
mod surfaces;
mod table;
mod text;
mod time;
mod tone;
mod track_span;
mod tracks;
mod walker;

use error::MAX_FILE_BYTES;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use terrella_files as files;
use terrella_ground::light::{Aperture, Ghosts};

use record::{KeyText, Record};
use settings::SetText;
use text::SceneText;

pub use articulations::{Articulation, ArticulationTarget, ArticulationTurn};
pub use camera::Camera;
pub use camera_keys::CameraKey;
pub use captions::{CaptionContent, CaptionPart, CaptionTable, CaptionTimes, CaptionValue};
pub use choices::{
    CameraMode, CameraUp, CaptionPlace, CoverageShow, Look, OrbitSource, StorageChoice,
};
pub use coverage::CoverageTable;
pub use craft::{AttitudeName, AttitudeSource, CraftModel, CraftOptions, ModelAxes, Spin};
pub use dated_maps::{BetweenMaps, DatedLayer, DatedMaps, MapTimes};
pub use dates::Ending;
pub use earth::{EarthTable, PackTable};
pub use error::{KeyLocation, SceneError};
pub use footprint::Footprint;
pub use geojson::GeojsonTable;
#[cfg(feature = "window")]
pub use keys::{DEFAULT_TOLERANCE_PX, EDGE_SAMPLES};
pub(crate) use keys::{MAX_ELEVATION_FILES, YEARS};
pub use layers::{LayersTable, LineLook};
pub use look_at::LookAt;
pub use many::Many;
pub use orbit::{ForceOptions, InitialState, Motion, Orbit, OrbitParameters};
pub use output::{Output, QualityTable};
pub use relief::ReliefTable;
pub use sensor::{KernelError, SensorTable};
pub use settings::Setting;
pub use sky::SkyTable;
pub use stations::StationTable;
pub use time::{StartSource, Time};
pub use tone::{ToneError, ToneTable};
pub use track_span::TrackSpan;
pub use tracks::Track;
pub use walker::Walker;

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
    /// Each `[[station]]`.
    pub stations: Vec<StationTable>,
    /// Each `[[geojson]]`.
    pub geojson: Vec<GeojsonTable>,
    /// `[layers]`
    pub layers: LayersTable,
    /// `[coverage]`, if a map of it is drawn.
    pub coverage: Option<CoverageTable>,
    /// `[camera]`
    pub camera: Camera,
    /// `[sensor]`, if the scene gives one.
    pub sensor: Option<SensorTable>,
    /// `[earth]`
    pub earth: EarthTable,
    /// `[sky]`
    pub sky: SkyTable,
    /// `[lens]`: the aperture, where its diffraction is drawn.
    pub aperture: Option<Aperture>,
    /// The same table: the lens's ghosts.
    pub ghosts: Option<Ghosts>,
    /// Each `[[caption]]`.
    pub captions: Vec<CaptionTable>,
    /// `[output]`
    pub output: Output,
    /// `[quality]`
    pub quality: QualityTable,
    /// What is flown otherwise than the scene's defaults say, as satellites do not answer for those: a sentence each.
    pub notices: Vec<String>,
    /// What the keys of each table came to, and where the file gives them.
    records: BTreeMap<&'static str, Record>,
    /// The same of each `[[orbit]]`.
    orbit_records: Vec<Record>,
    /// For each of `orbits` the place of its table; empty where each has its own.
    orbit_tables: Vec<usize>,
    /// The records of each `[[station]]` and of each other table of a list but `[[orbit]]`.
    lists: BTreeMap<&'static str, Vec<Record>>,
    /// The text that it was made of, where that is no file's.
    text: Option<String>,
    /// Keys that were set in place of the file's.
    settings: Vec<Setting>,
}

impl Scene {
    /// Largest scene file, bytes.
    pub const MAX_FILE_BYTES: u64 = MAX_FILE_BYTES;

    /// Reads and checks a scene file. Paths in it are relative to its folder.
    ///
    /// # Errors
    /// A file that cannot be read, has more than [`Self::MAX_FILE_BYTES`], is not UTF-8, or holds anything
    /// that [`Scene::from_toml`] rejects.
    pub fn load(path: &Path) -> Result<Self, SceneError> {
        Self::load_with(path, &[])
    }

    /// The same with keys set in place of the file's.
    ///
    /// # Errors
    /// As [`Self::load`]; of a setting they name `--set` in place of the file.
    pub fn load_with(path: &Path, settings: &[Setting]) -> Result<Self, SceneError> {
        let unreadable = |source: std::io::Error| match source.kind() {
            std::io::ErrorKind::IsADirectory => SceneError::Folder {
                path: path.to_owned(),
            },
            _ => SceneError::Read {
                path: path.to_owned(),
                source,
            },
        };
        let too_large = || SceneError::TooLarge {
            path: path.to_owned(),
        };
        let bytes = files::read(path, MAX_FILE_BYTES).map_err(unreadable)?;
        let bytes = bytes.ok_or_else(too_large)?;
        if let Some(packing) = files::packing(&bytes) {
            return Err(SceneError::Packed {
                path: path.to_owned(),
                packing,
            });
        }
        let text = std::str::from_utf8(&bytes).map_err(|error| {
            let good = bytes.iter().take(error.valid_up_to());
            SceneError::NotUtf8 {
                path: path.to_owned(),
                line: good.filter(|byte| **byte == b'\n').count() + 1,
            }
        })?;
        Self::from_toml_with(text, path, settings)
    }

    /// Reads and checks the text of a scene; `path` is the file that messages name and whose folder the
    /// paths in it are relative to. The empty text is a scene: every default. `start = "now"` is read off the system's clock here.
    ///
    /// # Errors
    /// Text that is not TOML, unknown tables and keys, values of the wrong type or out of range, values in
    /// conflict, files and folders that are not there: the first of them.
    pub fn from_toml(text: &str, path: &Path) -> Result<Self, SceneError> {
        Self::from_toml_with(text, path, &[])
    }

    /// The same with keys set in place of the text's.
    ///
    /// # Errors
    /// As [`Self::from_toml`]; of a setting they name `--set` in place of the file.
    pub fn from_toml_with(
        text: &str,
        path: &Path,
        settings: &[Setting],
    ) -> Result<Self, SceneError> {
        let set = SetText::new(text, settings);
        let source = SceneText {
            path,
            text: &set.text,
            line_starts: &set.line_starts,
        };
        let read = source.parse().and_then(|raw| check::check(source, raw));
        let mut scene = read.map_err(|error| settings::of_setting(error, settings))?;
        if !settings.is_empty() {
            scene.settings = settings.to_vec();
            scene.text = Some(set.text);
        }
        Ok(scene)
    }

    /// The keys that were set in place of the file's.
    pub fn settings(&self) -> &[Setting] {
        &self.settings
    }

    /// Whether its one satellite is the built-in space station, of which the file says nothing: a geodetic camera would go without it.
    pub fn has_unnamed_satellite(&self) -> bool {
        let [orbit] = &*self.orbits else {
            return false;
        };
        let is_given = self
            .orbit_records
            .iter()
            .any(|one| one.first_line().is_some());
        orbit.source == OrbitSource::Tle && orbit.file.is_none() && !is_given
    }

    /// Whether a key was set in place of the file's.
    fn is_set(&self, table: &str, key: &str) -> bool {
        self.settings
            .iter()
            .any(|setting| setting.is_of(table, key))
    }

    /// The line, from 1, on which the file gives a key, of `[orbit]` the first satellite's; `None` where it does not.
    pub fn line(&self, table: &str, key: &str) -> Option<usize> {
        match table {
            "orbit" => self.orbit_line(0, key),
            table => match self.lists.get(table) {
                Some(records) => records.first()?.line(key),
                None => self.records.get(table)?.line(key),
            },
        }
    }

    /// The line, from 1, on which the file gives a key of the satellite of that place in [`Self::orbits`].
    pub fn orbit_line(&self, orbit: usize, key: &str) -> Option<usize> {
        self.orbit_records.get(self.orbit_table(orbit))?.line(key)
    }

    /// Reads all of its files of orbits as `strict = true` does.
    pub fn read_strictly(&mut self) {
        for (orbit, record) in self.orbits.iter_mut().zip(&mut self.orbit_records) {
            if orbit.file.is_some() {
                orbit.strict = true;
                record.set("strict", Ok(true.to_string()));
            }
        }
    }

    /// Changes what a key comes to.
    fn set(&mut self, table: &'static str, key: &'static str, text: KeyText) {
        self.records.entry(table).or_default().set(key, text);
    }

    /// The text that it was made of, where that is not its file's ([`Self::shipped`], [`Self::of_orbits`]).
    pub fn own_text(&self) -> Option<&str> {
        self.text.as_deref()
    }

    /// Whether a simulator gives the time.
    pub fn is_live(&self) -> bool {
        let is_met = |orbit: &Orbit| orbit.live.is_some() || orbit.basilisk.is_some();
        self.orbits.iter().any(is_met)
    }
}

/// The keys that name files or folders, each with its table.
#[cfg(test)]
pub(crate) fn path_keys() -> impl Iterator<Item = (&'static str, &'static str)> {
    keys::TABLES.iter().flat_map(|table| {
        let paths = table.keys.iter().filter(|key| {
            use table::Shape::{DatedMaps, Path, Paths, Tone};
            matches!((key.about.shape)(), Path | Paths | DatedMaps | Tone)
        });
        paths.map(move |key| (table.name, key.name))
    })
}
