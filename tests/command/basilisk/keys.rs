//! Keys of the window that go to the script.

use super::{PATIENCE, Simulator, messages, scene};
use crate::window::Display;
use crate::x11::Keyboard;
use crate::{Place, names};
use std::net::SocketAddr;
use std::process::Stdio;
use std::time::{Duration, Instant};

#[test]
fn a_key_that_the_script_listens_to_is_the_scripts_and_no_others() {
    let Some(display) = Display::start() else {
        return;
    };
    let place = Place::new();
    let port = super::free_port();
    let listen = format!("listen = \"tcp://127.0.0.1:{port}\"");
    place.scene("basilisk.toml", &scene(&listen, "mode = \"nadir\""));
    let mut window = place
        .command(&["play", "basilisk.toml", "--for-seconds", "300"])
        .env("DISPLAY", &display.name)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("starts");
    let mut simulator = Simulator::connect(SocketAddr::from(([127, 0, 0, 1], port)));
    let mut keyboard = Keyboard::of(&display.name);
    let begun = Instant::now();
    for frame in 1.. {
        assert!(begun.elapsed() < PATIENCE, "no key comes");
        // S would save an image if the script did not listen to it.
        let settings = messages::bytes(7, &messages::bytes(52, b"s"));
        let step = [messages::step(frame, frame as f64), settings].concat();
        assert!(simulator.update(&step));
        let input = simulator.ask(&[b"REQUEST_INPUT"]).expect("an answer");
        if input[1].ends_with(b"\x0a\x01s") {
            break;
        }
        if keyboard.focus_window() {
            keyboard.press(b's');
        }
        std::thread::sleep(Duration::from_millis(200));
    }
    let names = names(place.folder.path());
    assert!(
        !names.iter().any(|name| name.ends_with(".png")),
        "{names:?}"
    );
    // Q belongs to the window, as usual.
    while window.try_wait().expect("a child").is_none() {
        assert!(begun.elapsed() < PATIENCE, "Q does nothing");
        keyboard.focus_window();
        keyboard.press(b'q');
        std::thread::sleep(Duration::from_millis(200));
    }
    let status = window.wait().expect("a child");
    assert_eq!(status.code(), Some(0));
}
