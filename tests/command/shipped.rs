//! Every scene that is shipped goes through the commands that take one.

use crate::Place;
use std::path::{Path, PathBuf};

/// Those that wait for a simulator.
const WAITING: [&str; 2] = ["basilisk.toml", "live.toml"];

/// Those of `config/`, but the ones that wait.
fn scenes() -> Vec<PathBuf> {
    let folder = Path::new(crate::REPOSITORY).join("config");
    let files = std::fs::read_dir(folder).expect("a folder");
    let files = files.map(|file| file.expect("a file").path());
    let is_scene = |path: &PathBuf| {
        path.extension()
            .is_some_and(|extension| extension == "toml")
    };
    let mut scenes: Vec<_> = files.filter(is_scene).collect();
    scenes.sort();
    assert!(scenes.len() > 20);
    scenes.retain(|path| !WAITING.iter().any(|name| path.ends_with(name)));
    scenes
}

/// Whether `goldens.rs` draws a scene of `config/`: its image there has no scene beside it.
fn has_golden(scene: &Path) -> bool {
    let name = Path::new(scene.file_name().expect("a file"));
    let goldens = Path::new(crate::REPOSITORY).join("tests/goldens");
    goldens.join(name.with_extension("png")).exists() && !goldens.join(name).exists()
}

#[test]
fn every_scene_is_checked_and_drawn_with_something_in_its_picture() {
    let place = Place::new();
    for path in scenes() {
        let scene = path.to_str().expect("UTF-8");
        place.succeed(&["-q", "check", scene]);
        if has_golden(&path) {
            continue;
        }
        place.succeed(&["-q", "frame", scene, "-o", "a.png", "--size", "32x18"]);
        let picture = image::open(place.path("a.png"))
            .expect("a picture")
            .to_rgb8();
        std::fs::remove_file(place.path("a.png")).expect("removed");
        // Something is in it, and it is not one colour: the Earth and space, or the Earth's own differences.
        let brightest = picture.pixels().flat_map(|pixel| pixel.0).max();
        assert!(brightest > Some(24), "{scene}: {brightest:?}");
        let first = picture.get_pixel(0, 0);
        assert!(picture.pixels().any(|pixel| pixel != first), "{scene}");
    }
}

#[test]
fn scenes_that_wait_for_a_simulator_are_checked() {
    let folder = Path::new(crate::REPOSITORY).join("config");
    for name in WAITING {
        let scene = folder.join(name);
        Place::new().succeed(&["-q", "check", scene.to_str().expect("UTF-8")]);
    }
}

/// By hand, some minutes: `cargo test --release --test command shipped -- --ignored`.
#[test]
#[ignore = "takes minutes"]
fn every_scene_is_measured() {
    let place = Place::new();
    for scene in scenes() {
        let name = scene
            .file_stem()
            .expect("a name")
            .to_string_lossy()
            .into_owned();
        let scene = scene.to_str().expect("UTF-8");
        place.succeed(&[
            "-q",
            "frame",
            scene,
            "-o",
            "b.png",
            "--size",
            "16x9",
            "--renderer",
            "reference",
            "--samples",
            "1",
        ]);
        place.succeed(&["-q", "bench", scene, "--frames", "1", "--size", "64x36"]);
        place.succeed(&[
            "-q",
            "report",
            scene,
            "-o",
            &name,
            "--quick",
            "--size",
            "48x27",
            "--repeats",
            "1",
            "--samples",
            "1",
            "--heights",
            "1000",
        ]);
    }
}
