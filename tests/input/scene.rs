//! Scene files: what is rejected and in which words, what is taken, what the defaults are.

mod any_text;
mod captions;
mod geojson;
mod lines;
mod orbits;
mod pages;
mod rejections;
mod relief;
mod summary;
mod tracks;
mod values;

use std::path::{Path, PathBuf};
use terrella::frames::{Epoch, utc_from_rfc3339};
use terrella_play::scene::{Scene, SceneError};

/// A folder with the files of these tests' scenes: `sat.tle` and `maps/`.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        let dir = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(dir.path().join("sat.tle"), "elements").expect("a file");
        std::fs::create_dir(dir.path().join("maps")).expect("a folder");
        Self(dir)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn load(&self, bytes: impl AsRef<[u8]>) -> Result<Scene, SceneError> {
        let path = self.path("scene.toml");
        std::fs::write(&path, bytes).expect("a scene file");
        Scene::load(&path)
    }

    /// Holds that each scene is rejected where it is wrong, in one line that has the words.
    fn rejects(&self, bad: &[Bad]) {
        let file = self.path("scene.toml").display().to_string();
        let mut wrong = Vec::new();
        for (text, line, needles) in bad {
            let error = match self.load(text) {
                Ok(_) => {
                    wrong.push(format!("taken: {text:?}"));
                    continue;
                }
                Err(error) => error,
            };
            let message = error.to_string();
            println!("{}", message.replace(&file, "scene.toml"));
            let start = format!("{file}:{line}:");
            let mut lacks: Vec<&str> = needles.to_vec();
            lacks.retain(|needle| !message.contains(needle));
            if !message.starts_with(&start) || error.line() != Some(*line) {
                lacks.push(&start);
            }
            if message.chars().any(char::is_control) {
                lacks.push("one printable line");
            }
            if !lacks.is_empty() {
                wrong.push(format!("{text:?}\n  says {message}\n  without {lacks:?}"));
            }
            assert_eq!(error.path(), self.path("scene.toml"), "{error}");
        }
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    }
}

/// A scene without a file.
fn scene(text: &str) -> Scene {
    match Scene::from_toml(text, Path::new("scene.toml")) {
        Ok(scene) => scene,
        Err(error) => panic!("rejected: {error}"),
    }
}

fn utc(text: &str) -> Epoch {
    utc_from_rfc3339(text).unwrap_or_else(|error| panic!("{error}"))
}

/// Text, the expected line, and the expected parts of the message: key, value, remedy.
type Bad = (&'static str, usize, &'static [&'static str]);
