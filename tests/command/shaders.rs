//! Shaders that are read from a folder.

use crate::{Place, words};
use std::path::Path;
use terrella::internals::gpu::SHADER_FILES;

/// The last shader file drawn, and its modification by the tests.
const LAST: &str = "earth/fragment.wgsl";
const DRAWN: &str = "    return drawn(vec4f(color, 1.0), at);";
const RED: &str = "    return drawn(vec4f(9.0, 0.0, 0.0, 1.0), at);";
const BROKEN: &str = "    return drawn(vec4f(colour, 1.0), at);";

/// Writes all files, with the last line of the last shader replaced. Returns the number of that line.
fn write_shaders(folder: &Path, last: &str) -> usize {
    let mut changed = 0;
    for (name, text) in SHADER_FILES {
        let path = folder.join(name);
        std::fs::create_dir_all(path.parent().expect("in the folder")).expect("makes it");
        if *name == LAST {
            let at = text.lines().position(|line| line == DRAWN);
            changed = at.expect("the line is there") + 1;
        }
        let text = match *name {
            LAST => text.replace(DRAWN, last),
            _ => (*text).to_owned(),
        };
        std::fs::write(path, text).expect("writes");
    }
    changed
}

#[test]
fn pictures_are_drawn_with_the_shaders_of_a_folder() {
    let place = Place::new();
    let folder = place.path("shaders");
    let draw = |name: &str| {
        let mut command = place.command(&["frame", "small.toml", "-o", name]);
        command.env("TERRELLA_SHADERS", &folder);
        let output = command.output().expect("starts");
        match output.status.success() {
            true => Ok(std::fs::read(place.path(name)).expect("a picture")),
            false => Err(words(&output)),
        }
    };
    write_shaders(&folder, DRAWN);
    let same = draw("same.png").expect("draws");
    place.succeed(&["frame", "small.toml", "-o", "own.png"]);
    assert_eq!(
        same,
        std::fs::read(place.path("own.png")).expect("a picture")
    );
    write_shaders(&folder, RED);
    draw("red.png").expect("draws");
    let red = image::open(place.path("red.png"))
        .expect("a picture")
        .into_rgb8();
    assert_eq!(
        red.get_pixel(red.width() / 2, red.height() / 2).0,
        [255, 0, 0]
    );
    let line = write_shaders(&folder, BROKEN);
    let message = draw("broken.png").expect_err("is rejected");
    assert!(
        message.contains(&format!("shaders/{LAST}:{line}: ")),
        "{message}"
    );
    assert!(
        message.contains("colour") && !message.contains("panicked"),
        "{message}"
    );
    std::fs::remove_file(folder.join(LAST)).expect("removes");
    let message = draw("missing.png").expect_err("is rejected");
    assert!(
        message.contains(&format!("shaders/{LAST}:0: cannot be read")),
        "{message}"
    );
}

#[test]
fn a_film_with_changed_shaders_is_another() {
    let place = Place::new();
    let folder = place.path("shaders");
    let play = |more: &[&str]| {
        let arguments = ["play", "small.toml", "--frames", "f", "--range", "0..2"];
        let mut command = place.command(&[&arguments, more].concat());
        let output = command
            .env("TERRELLA_SHADERS", &folder)
            .output()
            .expect("starts");
        (output.status.success(), words(&output))
    };
    write_shaders(&folder, DRAWN);
    let (is_drawn, message) = play(&[]);
    assert!(is_drawn, "{message}");
    assert!(play(&["--resume"]).0, "the same shaders");
    write_shaders(&folder, RED);
    let (is_drawn, message) = play(&["--resume"]);
    assert!(!is_drawn);
    assert!(message.contains("with the shaders"), "{message}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_window_follows_changed_shaders_and_keeps_its_own_where_they_are_wrong() {
    use crate::window::{Display, wait_for};
    let Some(display) = Display::start() else {
        return;
    };
    let place = Place::new();
    let folder = place.path("shaders");
    write_shaders(&folder, DRAWN);
    let log = place.path("log");
    let mut window = place
        .command(&["play", "small.toml", "--for-seconds", "300", "-v"])
        .env("DISPLAY", &display.name)
        .env("TERRELLA_SHADERS", &folder)
        .stderr(std::fs::File::create(&log).expect("a file"))
        .spawn()
        .expect("starts");
    let has = |what: &str| {
        let said = std::fs::read_to_string(&log).expect("a log");
        assert!(!said.contains("panicked"), "{said}");
        said.contains(what)
    };
    wait_for("the window", || has("window on"));
    let line = write_shaders(&folder, BROKEN);
    let place_of_error = format!("the shaders stay as they were: shaders/{LAST}:{line}: ");
    wait_for("the reason", || has(&place_of_error));
    assert_eq!(window.try_wait().expect("a child"), None, "it plays on");
    write_shaders(&folder, RED);
    wait_for("the new shaders", || has("drawn with the new shaders"));
    assert_eq!(window.try_wait().expect("a child"), None, "it plays on");
    window.kill().expect("stops");
    window.wait().expect("ends");
}
