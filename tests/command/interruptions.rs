//! SIGINT, SIGTERM and SIGHUP at any time of every command: no unfinished file is left, and the exit code identifies the signal.

use crate::window::Display;
use crate::{Place, words};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Signals with the exit codes that a shell gives for them.
const SIGNALS: [(&str, i32); 3] = [("-INT", 130), ("-TERM", 143), ("-HUP", 129)];

/// From before there is a scene to amid the work, milliseconds after the start.
const MOMENTS_MS: [u64; 3] = [10, 200, 1000];

/// A command that goes on for longer with success has ignored the signal; each takes longer from most of the moments on.
const FINISHING: Duration = Duration::from_millis(500);

/// An orbit that takes long to integrate.
const LONG: &str = "[time]\nstart = 2018-01-15T12:00:00Z\nduration_s = 864000\n[orbit]\nsource = \"numerical\"\n\
    epoch = 2018-01-15T12:00:00Z\nposition_km = [7000, 0, 0]\nvelocity_km_s = [0, 7.5, 1]\ngravity_degree = 20\n";

fn textures(name: &str) -> String {
    let path = Path::new(crate::REPOSITORY).join("textures");
    path.join(name).display().to_string()
}

fn start(command: &mut Command) -> Child {
    let command = command.stdout(Stdio::null()).stderr(Stdio::piped());
    command.spawn().expect("starts")
}

fn send(signal: &str, child: &Child) {
    let id = child.id().to_string();
    let sent = Command::new("kill").args([signal, &id]).status();
    assert!(sent.expect("kill starts").success());
}

/// Its output, which it must give within a minute.
fn end(mut child: Child) -> Output {
    let deadline = Instant::now() + Duration::from_secs(60);
    while child.try_wait().expect("waits").is_none() {
        if Instant::now() > deadline {
            child.kill().expect("stops");
            panic!(
                "it goes on: {}",
                words(&child.wait_with_output().expect("ends"))
            );
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    child.wait_with_output().expect("ends")
}

/// Everything in a folder and below that a program hides or calls unfinished.
fn unfinished(folder: &Path) -> Vec<String> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path
            .file_name()
            .expect("a name")
            .to_string_lossy()
            .into_owned();
        if name.starts_with('.')
            || name.ends_with(".part")
            || ["scratch", "socket"].contains(&name.as_str())
        {
            found.push(path.display().to_string());
        }
        if path.is_dir() {
            found.extend(unfinished(&path));
        }
    }
    found
}

/// Interrupts a command at every time, with alternating signals, and checks the remaining files.
fn interrupt(arguments: &[&str]) {
    let mut interrupted = 0;
    for (moment_ms, (signal, code)) in MOMENTS_MS.into_iter().zip(SIGNALS.into_iter().cycle()) {
        let place = Place::new();
        place.scene("orbit.toml", LONG);
        let mut child = start(&mut place.command(arguments));
        std::thread::sleep(Duration::from_millis(moment_ms));
        let has_ended = child.try_wait().expect("waits").is_some();
        if !has_ended {
            send(signal, &child);
        }
        let sent = Instant::now();
        let output = end(child);
        // The signal may arrive when the last file has its name and only the process is left to end.
        let had_finished = output.status.success() && sent.elapsed() < FINISHING;
        let reported = format!(
            "{arguments:?}, {signal} after {moment_ms} ms: {}",
            words(&output)
        );
        assert!(!reported.contains("panicked"), "{reported}");
        // Before its handler is installed, the signal itself ends it; and a run that has just finished exits normally.
        use std::os::unix::process::ExitStatusExt;
        let by_signal =
            output.status.signal().map(|number| 128 + number) == Some(code) && moment_ms < 50;
        let is_reported = output.status.code() == Some(code);
        assert!(
            is_reported || by_signal || has_ended || had_finished,
            "{:?}, {reported}",
            output.status
        );
        interrupted += u32::from(is_reported);
        assert_eq!(unfinished(place.folder.path()), [""; 0], "{reported}");
    }
    assert!(
        interrupted >= 2,
        "{arguments:?}: it is too fast for this test: {interrupted}"
    );
}

#[test]
fn stills() {
    interrupt(&[
        "frame",
        "small.toml",
        "-o",
        "a.png",
        "--size",
        "2000x1000",
        "--truth",
        "truth/of/it",
        "--radiance",
        "a.npy",
        "--stats",
        "a.json",
    ]);
    interrupt(&[
        "frame",
        "small.toml",
        "-o",
        "a.png",
        "--renderer",
        "reference",
        "--samples",
        "16",
        "--size",
        "640x360",
    ]);
}

#[test]
fn films() {
    let size = "1280x720";
    interrupt(&["play", "small.toml", "--size", size, "--frames", "frames"]);
    interrupt(&["play", "small.toml", "--size", size, "--video", "a.mp4"]);
    interrupt(&[
        "play",
        "small.toml",
        "--size",
        size,
        "--video",
        "a.mp4",
        "--encoder",
        "builtin",
    ]);
}

#[test]
fn measurements() {
    interrupt(&[
        "bench",
        "small.toml",
        "--json",
        "a.json",
        "--csv",
        "a.csv",
        "--plots",
        "plots",
    ]);
    for part in [&["--quick"][..], &["--quick", "--surfaces"], &["--quality"]] {
        interrupt(
            &[
                &["report", "small.toml", "-o", "report", "--size", "64x36"][..],
                part,
            ]
            .concat(),
        );
    }
    interrupt(&[
        "terrain",
        "--fractal",
        "1025",
        "--threads",
        "1",
        "-o",
        "out",
    ]);
}

#[test]
fn ephemerides() {
    interrupt(&["orbit", "orbit.toml", "--every", "1", "--oem", "a.oem"]);
    interrupt(&["orbit", "orbit.toml", "--every", "1"]);
}

#[test]
fn packs() {
    let (day, heights) = (textures("day.jpg"), textures("elevation.png"));
    // So little memory that elevation data goes through scratch files.
    interrupt(&[
        "pack",
        "build",
        "--day",
        &day,
        "--heights",
        &heights,
        "--memory",
        "100",
        "-o",
        "pack",
    ]);
}

#[test]
fn servers() {
    interrupt(&["serve", "--listen", "ipc://socket"]);
}

/// The second signal does not wait for the frame, the row or the page, and leaves nothing either.
#[test]
fn a_second_signal_ends_at_once() {
    let place = Place::new();
    let film = [
        "play",
        "small.toml",
        "--size",
        "1280x720",
        "--frames",
        "frames",
        "--supersample",
        "4",
    ];
    let child = start(&mut place.command(&film));
    std::thread::sleep(Duration::from_millis(1500));
    send("-INT", &child);
    send("-TERM", &child);
    let output = end(child);
    let code = output.status.code();
    assert!(
        matches!(code, Some(130 | 143)),
        "{code:?}: {}",
        words(&output)
    );
    assert_eq!(unfinished(place.folder.path()), [""; 0]);
}

/// As `nohup` starts programs: they are not ended when the terminal is closed.
#[cfg(target_os = "linux")]
#[test]
fn an_ignored_signal_stays_ignored() {
    let place = Place::new();
    let film = ["frame", "small.toml", "-o", "a.png"];
    let inner = place.command(&film);
    let mut shell = Command::new("sh");
    shell.args(["-c", "trap '' HUP; exec \"$0\" \"$@\""]);
    shell.arg(inner.get_program()).args(inner.get_args());
    shell
        .current_dir(place.folder.path())
        .env("XDG_RUNTIME_DIR", place.folder.path());
    let child = start(&mut shell);
    std::thread::sleep(Duration::from_millis(200));
    send("-HUP", &child);
    let output = end(child);
    assert_eq!(output.status.code(), Some(0), "{}", words(&output));
    assert!(place.path("a.png").exists());
}

#[cfg(target_os = "linux")]
#[test]
fn a_window_closes() {
    let Some(display) = Display::start() else {
        return;
    };
    for (signal, code) in SIGNALS {
        let place = Place::new();
        place.scene("window.toml", crate::SMALL);
        let mut command = place.command(&["play", "window.toml"]);
        let child = start(command.env("DISPLAY", &display.name));
        std::thread::sleep(Duration::from_millis(2500));
        send(signal, &child);
        let output = end(child);
        assert_eq!(
            output.status.code(),
            Some(code),
            "{signal}: {}",
            words(&output)
        );
        assert_eq!(words(&output), "", "{signal}");
        assert_eq!(unfinished(place.folder.path()), [""; 0]);
    }
}
