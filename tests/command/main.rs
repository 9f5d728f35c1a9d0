//! The command as a user runs it: exit codes, messages, files that are whole or not there.
//!
//! Tests that draw need an adapter and the maps of the starter pack, which a checkout has.

mod access;
mod bad_input;
mod basilisk;
mod bench;
mod captions;
mod dated_maps;
mod events;
mod film_inputs;
mod film_light;
mod films;
mod geojson;
mod goldens;
mod hdr;
/// The repository's root.
const REPOSITORY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

#[cfg(target_os = "linux")]
mod interruptions;
mod light_gains;
mod live;
mod memory;
mod new;
#[cfg(unix)]
mod openers;
mod opm;
mod orbit;
mod packs;
#[cfg(unix)]
mod pages;
mod passes;
mod pictures;
mod quality;
mod reference;
mod report;
mod seasons;
mod sensor;
mod several;
mod shaders;
mod shipped;
mod simulators;
#[path = "../common/small_maps.rs"]
mod small_maps;
mod start;
mod states;
mod terrain;
mod truth;
mod usage;
mod video;
#[cfg(target_os = "linux")]
mod window;
#[cfg(target_os = "linux")]
mod x11;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// Texels round the Earth of the day map that the command finds in the tests. Clouds have as many, water twice as many.
const DAY_WIDTH: u32 = 1024;

/// A scene of four small frames that needs no orbit.
const SMALL: &str = r#"
[time]
duration_s = 4
speed = 10
frame_rate_hz = 10
[camera]
mode = "geodetic"
lat_deg = 20
lon_deg = 15
height_km = 12000
[earth]
normals = false
night_lights = false
[output]
size = [64, 36]
samples = 1
"#;

/// A folder to run in, with the small scene in it.
struct Place {
    folder: TempDir,
}

impl Place {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(folder.path().join("small.toml"), SMALL).expect("writes");
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn scene(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).expect("writes");
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_terrella"));
        command
            .args(arguments)
            .current_dir(self.folder.path())
            .env("TERRELLA_TEXTURES", small_maps::folder())
            .env_remove("RUST_LOG")
            // Without one, graphics libraries complain on standard error, which tests read.
            .env("XDG_RUNTIME_DIR", self.folder.path())
            .env_remove("DISPLAY")
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("WAYLAND_SOCKET");
        command
    }

    fn run(&self, arguments: &[&str]) -> Output {
        self.command(arguments)
            .output()
            .expect("the command starts")
    }

    /// Runs and expects success.
    fn succeed(&self, arguments: &[&str]) -> Output {
        let output = self.run(arguments);
        assert_eq!(
            output.status.code(),
            Some(0),
            "{arguments:?}: {}",
            words(&output)
        );
        output
    }

    /// Runs, expects success and returns the output.
    fn printed(&self, arguments: &[&str]) -> String {
        String::from_utf8(self.succeed(arguments).stdout).expect("UTF-8")
    }

    /// Runs and expects an exit code and a message; returns the message.
    fn fail(&self, code: i32, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        let words = words(&output);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {words}");
        assert!(
            output.stdout.is_empty(),
            "{arguments:?} wrote to standard output"
        );
        assert!(!words.contains("panicked"), "{arguments:?}: {words}");
        words
    }

    /// Names of everything in the folder, hidden files too.
    fn names(&self) -> Vec<String> {
        names(self.folder.path())
    }
}

/// The pictures of a film's folder, without the page that it keeps of them.
fn frame_names(folder: &Path) -> Vec<String> {
    let mut names = names(folder);
    assert_eq!(names.pop().as_deref(), Some("frames.json"));
    names
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut names: Vec<_> = entries
        .map(|entry| {
            entry
                .expect("an entry")
                .file_name()
                .to_string_lossy()
                .into_owned()
        })
        .collect();
    names.sort();
    names
}

fn words(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn png_size(path: &Path) -> (u32, u32) {
    let picture = image::open(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    (picture.width(), picture.height())
}
