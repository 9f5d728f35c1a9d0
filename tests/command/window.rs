//! The window, on a display of the test's own.

use crate::x11::{Keyboard, LEFT, WHEEL_UP};
use crate::{Place, names, png_size, words};
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A virtual display; it ends with this value.
pub struct Display {
    server: Child,
    pub name: String,
}

/// Set if Xvfb cannot be installed: the window's tests are then skipped with a message.
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

/// A window that plays a scene, and the hand of its user.
struct Session {
    place: Place,
    window: Child,
    hand: Keyboard,
    /// Ends after the window.
    _display: Display,
}

impl Drop for Session {
    fn drop(&mut self) {
        // If a test fails the window is still open; if it has ended, this has no effect.
        let _ = self.window.kill();
        let _ = self.window.wait();
    }
}

impl Session {
    /// Opens a scene, stops its time and hides the panel. `None` without a display.
    fn open(scene: &str) -> Option<Self> {
        let display = Display::start()?;
        let place = Place::new();
        place.scene("scene.toml", scene);
        let window = place
            .command(&["play", "scene.toml", "--for-seconds", "300"])
            .env("DISPLAY", &display.name)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("starts");
        let mut hand = Keyboard::of(&display.name);
        wait_for("the window", || hand.focus_window());
        let mut session = Self {
            place,
            window,
            hand,
            _display: display,
        };
        // Keys that come before the first frame are lost.
        wait_for("a picture", || {
            session.hand.focus_window();
            session.hand.press(b's');
            pause();
            !session.pictures().is_empty()
        });
        session.hand.press(b' ');
        session.hand.press(b'p');
        pause();
        Some(session)
    }

    fn pictures(&self) -> Vec<String> {
        let names = names(self.place.folder.path()).into_iter();
        names.filter(|name| name.ends_with(".png")).collect()
    }

    /// The picture as it is now, without the panel.
    fn picture(&mut self) -> image::RgbImage {
        let before = self.pictures();
        self.hand.press(b's');
        let mut saved = None;
        wait_for("a picture", || {
            saved = self
                .pictures()
                .into_iter()
                .find(|name| !before.contains(name));
            saved.is_some()
        });
        let path = self.place.path(&saved.expect("one"));
        // It is there when it is whole.
        image::open(path).expect("a picture").to_rgb8()
    }

    /// Saves pictures until one is as it should be: what keys switch on is made by a thread.
    fn await_picture(&mut self, what: &str, mut is_so: impl FnMut(&image::RgbImage) -> bool) {
        wait_for(what, || is_so(&self.picture()));
    }

    fn click(&mut self) {
        self.hand.button(LEFT, true);
        self.hand.button(LEFT, false);
    }

    fn drag(&mut self, from: (i16, i16), to: (i16, i16)) {
        self.hand.point(from.0, from.1);
        pause();
        self.hand.button(LEFT, true);
        for step in 1..=8 {
            let at = |from: i16, to: i16| from + (to - from) * step / 8;
            self.hand.point(at(from.0, to.0), at(from.1, to.1));
            std::thread::sleep(Duration::from_millis(30));
        }
        self.hand.button(LEFT, false);
        pause();
    }
}

fn pause() {
    std::thread::sleep(Duration::from_millis(400));
}

/// Offset in pixels, right and down, of a patch around `from` in one image relative to `to` in another.
fn offset(
    before: &image::RgbImage,
    after: &image::RgbImage,
    from: (i16, i16),
    to: (i16, i16),
) -> (i16, i16) {
    const HALF: i16 = 12;
    const REACH: i16 = 8;
    let pixel = |picture: &image::RgbImage, x: i16, y: i16| {
        picture.get_pixel(x as u32, y as u32).0.map(i64::from)
    };
    let difference = |right: i16, down: i16| {
        let patch = (-HALF..=HALF).flat_map(|y| (-HALF..=HALF).map(move |x| (x, y)));
        patch
            .map(|(x, y)| {
                let one = pixel(before, from.0 + x, from.1 + y);
                let other = pixel(after, to.0 + right + x, to.1 + down + y);
                let squares = one
                    .iter()
                    .zip(other)
                    .map(|(one, other)| (one - other).pow(2));
                squares.sum::<i64>()
            })
            .sum::<i64>()
    };
    let shifts = (-REACH..=REACH).flat_map(|down| (-REACH..=REACH).map(move |right| (right, down)));
    shifts
        .min_by_key(|(right, down)| difference(*right, *down))
        .expect("shifts")
}

/// Africa and Europe by day, without clouds.
const GLOBE: &str = r#"
[time]
start = "2018-06-21T11:00:00Z"
duration_s = 60
[camera]
mode = "geodetic"
lat_deg = 30
lon_deg = 15
height_km = 9000
fov_deg = 45
[earth]
clouds = false
[output]
size = [300, 200]
"#;

/// The scene is without clouds and lines: what its keys switch on is loaded or made first.
#[test]
fn layers_that_are_off_are_made_by_their_keys_and_hidden_again() {
    let Some(mut session) = Session::open(GLOBE) else {
        return;
    };
    let bare = session.picture();
    let differing = |one: &image::RgbImage, other: &image::RgbImage| {
        let pairs = one.pixels().zip(other.pixels());
        pairs.filter(|(one, other)| one != other).count()
    };
    // So often pressed it is as before: there are five tone curves.
    for (key, least, presses) in [
        (b'g', 1500, 2),
        (b'm', 500, 2),
        (b'd', 8000, 2),
        (b'v', 8000, 5),
        (b'k', 8000, 2),
    ] {
        session.hand.press(key);
        let what = format!("the layer of {}", char::from(key));
        session.await_picture(&what, |changed| differing(&bare, changed) > least);
        for _ in 1..presses {
            session.hand.press(key);
            pause();
        }
        let what = format!("the picture before {}", char::from(key));
        session.await_picture(&what, |again| differing(&bare, again) == 0);
    }
}

#[test]
fn a_drag_turns_the_globe_with_the_place_under_the_pointer() {
    let Some(mut session) = Session::open(GLOBE) else {
        return;
    };
    let before = session.picture();
    let (from, to) = ((140, 90), (190, 120));
    session.drag(from, to);
    let after = session.picture();
    let unmoved = offset(&before, &after, from, from);
    let moved = offset(&before, &after, from, to);
    assert!(
        moved.0.abs() <= 2 && moved.1.abs() <= 2,
        "{moved:?} px away"
    );
    assert_ne!(before, after, "nothing moves; {unmoved:?}");

    // The wheel comes closer, and the place under the pointer stays there.
    let dark = |picture: &image::RgbImage| {
        let pixels = picture.pixels();
        pixels
            .filter(|pixel| pixel.0.iter().all(|value| *value < 8))
            .count()
    };
    let space = dark(&after);
    for _ in 0..2 {
        session.hand.button(WHEEL_UP, true);
        session.hand.button(WHEEL_UP, false);
    }
    pause();
    let near = session.picture();
    assert!(
        dark(&near) < space,
        "{} and {space} dark pixels",
        dark(&near)
    );

    // Back to the scene's camera: the picture is the first one again.
    session.hand.press(b'c');
    pause();
    let again = session.picture();
    let same = before.pixels().zip(again.pixels()).all(|(one, other)| {
        one.0
            .iter()
            .zip(other.0)
            .all(|(one, other)| one.abs_diff(other) <= 2)
    });
    assert!(same, "C does not lead back");
}

#[test]
fn a_double_click_brings_the_place_into_the_middle() {
    let Some(mut session) = Session::open(GLOBE) else {
        return;
    };
    let before = session.picture();
    let at = (180, 120);
    session.hand.point(at.0, at.1);
    pause();
    // A single click selects, and moves nothing.
    session.click();
    pause();
    pause();
    assert_eq!(session.picture(), before);
    session.click();
    session.click();
    pause();
    let after = session.picture();
    let moved = offset(&before, &after, at, (150, 100));
    assert!(
        moved.0.abs() <= 2 && moved.1.abs() <= 2,
        "{moved:?} px away"
    );
    assert_ne!(before, after);
}

#[test]
fn esc_closes_the_help_and_not_the_window() {
    let Some(mut session) = Session::open(GLOBE) else {
        return;
    };
    session.hand.press(b'h');
    pause();
    session.hand.escape();
    pause();
    session.picture();
    // Esc once more opens the question, and Esc again closes it.
    session.hand.escape();
    pause();
    session.hand.escape();
    pause();
    session.picture();
    assert_eq!(session.window.try_wait().expect("a child"), None);
}
