//! The window, on a display of the test's own where Xvfb is installed.

use crate::{Place, names, words};
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};

/// A virtual display; it ends with this value.
pub struct Display {
    server: Child,
    pub name: String,
}

impl Display {
    /// `None` where Xvfb is not installed.
    pub fn start() -> Option<Self> {
        let started = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "320x240x24"])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let mut server = match started {
            Ok(server) => server,
            Err(error) => {
                eprintln!("the window is not checked: Xvfb does not start: {error}");
                return None;
            }
        };
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
