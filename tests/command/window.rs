//! The window, on a display of the test's own.

use crate::x11::Keyboard;
use crate::{Place, names, png_size, words};
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A virtual display; it ends with this value.
pub struct Display {
    server: Child,
    pub name: String,
}

/// Set where Xvfb cannot be installed: the window's tests are passed over then, and say so.
const WITHOUT: &str = "TERRELLA_NO_DISPLAY";

impl Display {
    /// `None`, said loudly, where [`WITHOUT`] is set.
    pub fn start() -> Option<Self> {
        if std::env::var_os(WITHOUT).is_some() {
            eprintln!("SKIPPED: {WITHOUT} is set: NO WINDOW IS TESTED");
            return None;
        }
        let started = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "320x240x24"])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let mut server = started.unwrap_or_else(|error| {
            panic!(
                "Xvfb does not start: {error}; `cargo xtask prepare` installs it. Where nothing can be installed, set {WITHOUT}=1"
            )
        });
        // It writes its number when it is ready.
        let mut number = String::new();
        let stdout = server.stdout.take().expect("a pipe");
        BufReader::new(stdout)
            .read_line(&mut number)
            .expect("reads");
        let name = format!(":{}", number.trim());
        Some(Self { server, name })
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        self.server.kill().expect("stops");
        self.server.wait().expect("ends");
    }
}

#[test]
fn a_window_opens_plays_and_closes_by_itself() {
    let Some(display) = Display::start() else {
        return;
    };
    let place = Place::new();
    place.scene("iss.toml", "[output]\nsize = [200, 120]\n");
    for scene in ["small.toml", "iss.toml"] {
        let output = place
            .command(&["play", scene, "--for-seconds", "1", "-v"])
            .env("DISPLAY", &display.name)
            .output()
            .expect("starts");
        let said = words(&output);
        assert_eq!(output.status.code(), Some(0), "{scene}: {said}");
        assert!(said.contains("window on"), "{scene}: {said}");
        assert!(!said.contains("panicked"), "{scene}: {said}");
    }
    assert_eq!(names(place.folder.path()), ["iss.toml", "small.toml"]);
}

/// Looks again and again, for a minute at most.
pub fn wait_for(what: &str, mut is_there: impl FnMut() -> bool) {
    let deadline = Instant::now() + Duration::from_secs(60);
    while !is_there() {
        assert!(Instant::now() < deadline, "{what} does not come");
        std::thread::sleep(Duration::from_millis(50));
    }
}

#[test]
fn keys_that_are_pressed_do_what_the_help_says() {
    let Some(display) = Display::start() else {
        return;
    };
    let place = Place::new();
    place.scene("iss.toml", "[output]\nsize = [200, 120]\n");
    let mut window = place
        .command(&["play", "iss.toml", "--for-seconds", "300"])
        .env("DISPLAY", &display.name)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("starts");
    let mut keyboard = Keyboard::of(&display.name);
    wait_for("the window", || keyboard.focus_window());
    let pictures = || {
        let names = names(place.folder.path()).into_iter();
        let pictures: Vec<_> = names.filter(|name| name.ends_with(".png")).collect();
        pictures
    };
    // S saves a picture. Keys that come before the first frame are lost, so it is pressed until there is one.
    wait_for("a picture by S", || {
        keyboard.focus_window();
        keyboard.press(b's');
        std::thread::sleep(Duration::from_millis(400));
        !pictures().is_empty()
    });
    // Space stops the time: what is saved seconds apart is of one instant, which at 60 times real time nothing else would be.
    keyboard.press(b' ');
    std::thread::sleep(Duration::from_millis(1500));
    let before = pictures();
    let saved = |count: usize| {
        let new = pictures().into_iter().filter(|name| !before.contains(name));
        let new: Vec<_> = new.collect();
        (new.len() >= count).then_some(new)
    };
    keyboard.press(b's');
    wait_for("a picture of the time that stands", || saved(1).is_some());
    std::thread::sleep(Duration::from_millis(1500));
    keyboard.press(b's');
    wait_for("one more", || saved(2).is_some());
    let instants = saved(2).expect("two").into_iter();
    let instants: Vec<_> = instants
        .map(|name| name.split_once('Z').expect("an instant").0.to_owned())
        .collect();
    assert_eq!(instants[0], instants[1], "{:?}", pictures());
    for picture in pictures() {
        assert_eq!(png_size(&place.path(&picture)), (200, 120));
    }
    // Q closes it, long before its time is over.
    keyboard.press(b'q');
    let mut status = None;
    wait_for("the end by Q", || {
        status = window.try_wait().expect("a child");
        status.is_some()
    });
    assert_eq!(status.and_then(|status| status.code()), Some(0));
}
