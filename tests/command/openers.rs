//! A pipe, a device and a folder in place of every file that a command reads: an error immediately, never a wait.

use crate::{Place, words};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// How each command is given a file that it reads.
const READERS: &[(&str, &[&str])] = &[
    ("scene", &["check", "@"]),
    ("baseline", &["bench", "small.toml", "--baseline", "@"]),
    ("terrain", &["terrain", "@"]),
    ("day", &["pack", "build", "-o", "out", "--day", "@"]),
    (
        "elevation",
        &[
            "pack",
            "build",
            "-o",
            "out",
            "--day",
            "day.png",
            "--elevation",
            "@",
        ],
    ),
    (
        "heights",
        &[
            "pack",
            "build",
            "-o",
            "out",
            "--day",
            "day.png",
            "--heights",
            "@",
        ],
    ),
    ("source", &["pack", "fetch", "@", "-o", "out", "--dry-run"]),
    (
        "certificates",
        &["pack", "fetch", "blue_marble", "-o", "out", "--ca", "@"],
    ),
    (
        "mosaic",
        &["pack", "build", "-o", "out", "--day", "mosaic.toml"],
    ),
    ("pack", &["pack", "info", "pack"]),
];

/// Scenes that name a file.
const SCENES: &[&str] = &[
    "[orbit]\nsource = \"tle\"\nfile = \"@\"\n",
    "[orbit]\nsource = \"omm\"\nfile = \"@\"\n",
    "[orbit]\nsource = \"oem\"\nfile = \"@\"\n",
    "[orbit]\nsource = \"czml\"\nfile = \"@\"\n",
    "[orbit]\nsource = \"csv\"\nfile = \"@\"\n",
    "[orbit]\nsource = \"basilisk\"\nfile = \"@\"\n",
    "[time]\norientation = \"@\"\n",
    "[earth]\nelevation = [\"@\"]\n",
    "[quality]\ntarget_ms = 30\nladder = \"@\"\n",
];

/// Its error message, within some seconds.
fn rejection(place: &Place, arguments: &[&str]) -> String {
    let mut command = place.command(arguments);
    let mut child = command
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("starts");
    let deadline = Instant::now() + Duration::from_secs(20);
    while child.try_wait().expect("waits").is_none() {
        if Instant::now() > deadline {
            child.kill().expect("stops");
            child.wait().expect("ends");
            panic!("{arguments:?} waits");
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    let output = child.wait_with_output().expect("ends");
    let said = words(&output);
    assert!(
        matches!(output.status.code(), Some(1 | 2)),
        "{arguments:?}: {said}"
    );
    said
}

#[test]
fn what_is_no_file_is_rejected_by_every_reader() {
    let place = Place::new();
    let made = Command::new("mkfifo").arg(place.path("pipe.toml")).status();
    assert!(made.expect("mkfifo starts").success());
    std::os::unix::fs::symlink("/dev/zero", place.path("zero.toml")).expect("links");
    std::fs::create_dir(place.path("folder.toml")).expect("made");
    image::RgbImage::new(64, 32)
        .save(place.path("day.png"))
        .expect("saved");
    for (name, what) in [
        ("pipe.toml", "pipe"),
        ("zero.toml", "device"),
        ("folder.toml", "folder"),
    ] {
        place.scene(
            "mosaic.toml",
            &format!("[[part]]\nfile = \"{name}\"\nbounds_deg = [-180, -90, 180, 90]\n"),
        );
        let _ = std::fs::remove_dir_all(place.path("pack"));
        std::fs::create_dir(place.path("pack")).expect("made");
        std::os::unix::fs::symlink(place.path(name), place.path("pack/pack.toml")).expect("links");
        for (reader, arguments) in READERS {
            // A folder of maps is a mosaic, and empty here.
            let is_mosaic = what == "folder" && ["day", "elevation"].contains(reader);
            let arguments: Vec<_> = arguments
                .iter()
                .map(|word| if *word == "@" { name } else { word })
                .collect();
            let said = rejection(&place, &arguments);
            assert!(is_mosaic || said.contains(what), "{reader}, {name}: {said}");
        }
        for scene in SCENES {
            place.scene("scene.toml", &scene.replace('@', name));
            let said = rejection(&place, &["check", "scene.toml"]);
            assert!(said.contains(what), "{scene}, {name}: {said}");
        }
    }
}

/// A sidecar is found beside a file without being named.
#[test]
fn a_sidecar_that_is_a_pipe_is_rejected() {
    let place = Place::new();
    let textures = std::path::Path::new(crate::REPOSITORY).join("textures");
    std::fs::copy(textures.join("elevation.png"), place.path("dem.png")).expect("copied");
    let made = Command::new("mkfifo").arg(place.path("dem.toml")).status();
    assert!(made.expect("mkfifo starts").success());
    let said = rejection(&place, &["terrain", "dem.png"]);
    assert!(said.contains("dem.toml") && said.contains("pipe"), "{said}");
    place.scene("scene.toml", "[earth]\nelevation = [\"dem.png\"]\n");
    let said = rejection(&place, &["check", "scene.toml"]);
    assert!(said.contains("dem.toml") && said.contains("pipe"), "{said}");
}
