//! The input of a command: a scene file, an orbit file, or the built-in scene.

use super::reject_usage;
use clap::Args;
use clap::error::ErrorKind;
use std::path::{Path, PathBuf};
use terrella::frames::Epoch;
use terrella_orbit::OrbitError;
use terrella_play::scene::{Scene, SceneError, Setting};
use terrella_play::{Flight, PlayError, Satellite, Selection, select};

/// The scene of a command.
#[derive(Debug, Args)]
pub struct SceneArgs {
    /// Scene file, or orbit file: TLE, OMM, OEM, OPM, CZML, CSV, SP3, STK [default: the built-in scene, config/iss.toml]
    #[arg(value_name = "SCENE")]
    pub path: Option<PathBuf>,
    /// Reject an orbit file that contains any invalid record; by default invalid records are skipped and listed
    #[arg(long)]
    pub strict: bool,
    #[command(flatten)]
    pub settings: SettingArgs,
}

/// Keys that are set in place of the scene's.
#[derive(Debug, Args)]
pub struct SettingArgs {
    /// Override a key of the scene, for example earth.look=full; repeatable. Paths are relative to the scene's folder
    #[arg(long, value_name = "TABLE.KEY=VALUE")]
    pub set: Vec<Setting>,
}

/// Which satellites of a file of orbits are flown.
#[derive(Debug, Args)]
pub struct SatelliteArgs {
    /// Name or catalogue number of a satellite of an orbit file; repeatable, cameras follow the first [default: the only satellite of
    /// the file]
    #[arg(long, value_name = "NAME")]
    pub satellite: Vec<String>,
}

impl SatelliteArgs {
    /// Exits, as clap does for a command of this name, if satellites are selected from a scene file.
    pub fn reject_scenes(&self, command: &str, scene: &Scene) {
        if self.satellite.is_empty() || scene.is_of_orbits() {
            return;
        }
        let message = format!(
            "--satellite is for orbit files, and {} is a scene: set follow under [camera] in it",
            scene.path.display()
        );
        reject_usage(command, ErrorKind::ArgumentConflict, message)
    }
}

impl SceneArgs {
    /// Reads the scene. `satellites` selects satellites of an orbit file.
    pub fn load(&self, satellites: &[String]) -> Result<Scene, SceneError> {
        self.load_with(satellites, &[])
    }

    /// Same as [`Self::load`], with more keys, which override those of `--set`.
    pub fn load_with(&self, satellites: &[String], more: &[Setting]) -> Result<Scene, SceneError> {
        let settings = [&self.settings.set[..], more].concat();
        load(self.path.as_deref(), satellites, self.strict, &settings)
    }
}

/// The satellites of these names, or all that a scene and its files of orbits have where none is named.
#[derive(Debug, Args)]
pub struct SelectionArgs {
    /// Name of a satellite; repeatable [default: all of the scene or orbit file]
    #[arg(long, value_name = "NAME")]
    satellite: Vec<String>,
}

impl SelectionArgs {
    /// Reads the scene with them and makes it ready.
    pub fn open(&self, scene: &SceneArgs) -> anyhow::Result<Flight> {
        self.open_with(scene, |_| ())
    }

    /// Same as [`Self::open`], with a change of the scene.
    pub fn open_with(
        &self,
        scene: &SceneArgs,
        change: impl FnOnce(&mut Scene),
    ) -> anyhow::Result<Flight> {
        let mut scene = scene.load(&self.satellite)?;
        if self.satellite.is_empty() {
            scene.take_all();
        }
        change(&mut scene);
        open_flight(scene, Flight::open_without_listening)
    }

    /// They themselves.
    pub fn select<'f>(&self, flight: &'f Flight) -> Result<Vec<&'f Satellite>, PlayError> {
        let selection = match self.satellite.as_slice() {
            [] => Selection::All,
            names => Selection::Named(names),
        };
        select(flight, selection)
    }
}

/// Reads a scene, or a file of orbits with these satellites; `strict` reads all of its files of orbits as `strict = true` does.
pub fn load(
    path: Option<&Path>,
    satellites: &[String],
    strict: bool,
    settings: &[Setting],
) -> Result<Scene, SceneError> {
    let mut scene = match path {
        Some(path) => Scene::load_or_orbits_with(path, satellites, settings)?,
        None => Scene::shipped_with(settings)?,
    };
    if strict {
        scene.read_strictly();
    }
    Ok(scene)
}

/// Starts a scene at the time of --start. Exits, as clap does, if a simulator sets the time.
pub fn begin(command: &str, scene: &mut Scene, start: Epoch) -> Result<(), SceneError> {
    if scene.is_live() {
        let message = "--start has no effect in this scene: the simulator sets the time";
        reject_usage(command, ErrorKind::ArgumentConflict, message)
    }
    scene.begin(start)
}

/// Opens a scene with `open`. If an orbit file has several satellites, the error names the option that selects one.
pub fn open_flight(
    scene: Scene,
    open: impl FnOnce(Scene) -> Result<Flight, PlayError>,
) -> anyhow::Result<Flight> {
    let is_of_orbits = scene.is_of_orbits();
    open(scene).map_err(|error| match &error {
        // No name selects a satellite if the file itself must be changed.
        PlayError::Orbit(OrbitError::Ambiguous { remedy, .. })
            if is_of_orbits && (remedy.starts_with("name ") || remedy.starts_with("give the ")) =>
        {
            let text = format!("{error}, by --satellite");
            anyhow::Error::from(error).context(text)
        }
        _ => error.into(),
    })
}
