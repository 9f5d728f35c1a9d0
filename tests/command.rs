//! The command as a user runs it: exit codes, messages, files that are whole or not there.
//!
//! Tests that draw need an adapter and the maps; without maps (no `textures/`) they say so and fail, because a
//! checkout has both.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::{Duration, Instant};
use tempfile::TempDir;

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
            .env_remove("RUST_LOG")
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

    /// Runs and expects an exit code and a message; answers the message.
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

#[test]
fn every_command_has_help() {
    let place = Place::new();
    for (arguments, must_say) in [
        (
            &["--help"][..],
            &["play", "frame", "check", "doctor", "--adapter"][..],
        ),
        (
            &["play", "--help"],
            &[
                "--frames",
                "--video",
                "--encoder",
                "--for-seconds",
                "--overwrite",
            ],
        ),
        (
            &["frame", "--help"],
            &["--output", "--at", "--size", "--stats"],
        ),
        (&["check", "--help"], &["<SCENE>"]),
        (&["doctor", "--help"], &["adapters"]),
        (&["--version"], &[env!("CARGO_PKG_VERSION")]),
    ] {
        let output = place.succeed(arguments);
        let text = String::from_utf8_lossy(&output.stdout);
        for word in must_say {
            assert!(
                text.contains(word),
                "{arguments:?} does not mention {word}: {text}"
            );
        }
    }
}

#[test]
fn bad_usage_is_2() {
    let place = Place::new();
    for arguments in [
        &["fly", "small.toml"][..],
        &["frame", "small.toml"],
        &["frame", "small.toml", "-o", "a.png", "--size", "0x10"],
        &["frame", "small.toml", "-o", "a.png", "--size", "100000x10"],
        &["frame", "small.toml", "-o", "a.png", "--size", "big"],
        &["frame", "small.toml", "-o", "a.png", "--at", "noon"],
        &[
            "frame",
            "small.toml",
            "-o",
            "a.png",
            "--at",
            "2018-02-30T12:00:00Z",
        ],
        &["play", "small.toml", "--for-seconds", "-1"],
        &["play", "small.toml", "--for-seconds", "inf"],
        &["play", "small.toml", "--overwrite"],
        &["play", "small.toml", "--encoder", "builtin"],
        &[
            "play",
            "small.toml",
            "--video",
            "a.mp4",
            "--encoder",
            "x265",
        ],
        &["check", "small.toml", "-q", "-v"],
    ] {
        place.fail(2, arguments);
    }
    assert_eq!(place.names(), ["small.toml"]);
}

#[test]
fn a_bad_scene_is_2_with_file_line_and_key_and_nothing_written() {
    let place = Place::new();
    for (name, text, must_say) in [
        (
            "wrong.toml",
            "[camera]\nfov_deg = 180\n",
            "wrong.toml:2: [camera] fov_deg",
        ),
        ("typo.toml", "[camera]\nfov_dge = 45\n", "fov_deg"),
        (
            "nan.toml",
            "[time]\nspeed = nan\n",
            "nan.toml:2: [time] speed",
        ),
        (
            "size.toml",
            "[output]\nsize = [0, 720]\n",
            "size.toml:2: [output] size",
        ),
        ("text.toml", "this is no scene", "text.toml:1"),
        // Outside the reach of the built-in elements.
        (
            "late.toml",
            "[time]\nstart = \"2031-01-01T00:00:00Z\"\n",
            "late.toml:2: [time] start",
        ),
    ] {
        place.scene(name, text);
        for arguments in [
            &["check", name][..],
            &["frame", name, "-o", "a.png", "--stats", "a.json"],
            &["play", name, "--frames", "frames", "--video", "a.mp4"],
        ] {
            let words = place.fail(2, arguments);
            assert!(words.contains(must_say), "{arguments:?}: {words}");
        }
        std::fs::remove_file(place.path(name)).expect("removes");
    }
    let words = place.fail(2, &["check", "missing.toml"]);
    assert!(words.contains("missing.toml"), "{words}");
    // A date asked for on the command line, outside the same reach.
    place.scene("iss.toml", "");
    let late = [
        "frame",
        "iss.toml",
        "-o",
        "a.png",
        "--at",
        "2031-01-01T00:00:00Z",
    ];
    assert!(place.fail(2, &late).contains("2031-01-01"));
    assert_eq!(place.names(), ["iss.toml", "small.toml"]);
}

#[test]
fn a_bad_orbit_file_is_named_with_its_line() {
    let place = Place::new();
    let tle = "ISS\n\
        1 25544U 98067A   18019.89808844  .00001500  00000-0  29745-4 0  9990\n\
        2 25544  51.6429  32.1862 0003545  27.4205  72.1893 15.54250478 95378\n";
    place.scene("bad.tle", tle);
    place.scene("bad.toml", "[orbit]\nfile = \"bad.tle\"\n");
    let words = place.fail(1, &["frame", "bad.toml", "-o", "a.png"]);
    assert!(
        words.contains("bad.tle:2") && words.contains("checksum"),
        "{words}"
    );
    assert_eq!(place.names(), ["bad.tle", "bad.toml", "small.toml"]);
}

#[test]
fn bad_maps_are_named_and_nothing_is_written() {
    let place = Place::new();
    std::fs::create_dir(place.path("maps")).expect("makes");
    place.scene(
        "own.toml",
        &format!("{SMALL}\n[earth.x]\n").replace("[earth.x]", ""),
    );
    let text = SMALL.replace("[earth]", "[earth]\ntextures = \"maps\"");
    place.scene("own.toml", &text);
    let arguments = ["frame", "own.toml", "-o", "a.png", "--stats", "a.json"];
    let missing = place.fail(1, &arguments);
    assert!(missing.contains("day"), "{missing}");
    std::fs::write(place.path("maps/day.jpg"), b"not a picture").expect("writes");
    let garbage = place.fail(1, &arguments);
    assert!(garbage.contains("day.jpg"), "{garbage}");
    place.fail(1, &["play", "own.toml", "--video", "a.mp4"]);
    assert_eq!(place.names(), ["maps", "own.toml", "small.toml"]);
}

/// Finding out takes no drawing: far below the time that maps and adapter need.
#[test]
fn what_cannot_be_written_is_told_before_drawing() {
    let place = Place::new();
    place.scene("a_file", "");
    // The adapter that is asked for does not exist: a message about the file shows that it was looked at first.
    let adapter = ["--adapter", "no such adapter"];
    for (arguments, must_say) in [
        (
            &["frame", "small.toml", "-o", "missing/a.png"][..],
            "missing",
        ),
        (&["frame", "small.toml", "-o", "a_file/a.png"], "a_file"),
        (&["frame", "small.toml", "-o", "."], "folder"),
        (&["frame", "small.toml", "-o", "a.jpg"], "a.png"),
        (
            &[
                "frame",
                "small.toml",
                "-o",
                "a.png",
                "--stats",
                "missing/a.json",
            ],
            "missing",
        ),
        (
            &["play", "small.toml", "--video", "missing/a.mp4"],
            "missing",
        ),
        (&["play", "small.toml", "--video", "a.avi"], "a.mp4"),
        (&["play", "small.toml", "--frames", "a_file"], "a_file"),
        (&["play", "small.toml", "--frames", "."], "--overwrite"),
        (
            &["play", "small.toml", "--video", "a.mp4", "--size", "65x36"],
            "66 × 36",
        ),
    ] {
        let begin = Instant::now();
        let words = place.fail(1, &[arguments, &adapter].concat());
        assert!(words.contains(must_say), "{arguments:?}: {words}");
        assert!(
            begin.elapsed() < Duration::from_secs(5),
            "{arguments:?} took its time"
        );
    }
    assert_eq!(place.names(), ["a_file", "small.toml"]);
}

#[test]
fn an_adapter_that_is_not_there_leaves_no_half_file() {
    let place = Place::new();
    let adapter = ["--adapter", "no such adapter"];
    for arguments in [
        &["frame", "small.toml", "-o", "a.png", "--stats", "a.json"][..],
        &["play", "small.toml", "--video", "a.mp4"],
        &[
            "play",
            "small.toml",
            "--video",
            "a.mp4",
            "--encoder",
            "builtin",
        ],
    ] {
        let words = place.fail(1, &[arguments, &adapter].concat());
        assert!(words.contains("adapter"), "{words}");
    }
    assert_eq!(place.names(), ["small.toml"]);
}

#[test]
fn play_without_a_display_says_what_to_do_instead() {
    let words = Place::new().fail(1, &["play", "small.toml"]);
    assert!(
        words.contains("--video") && words.contains("--frames"),
        "{words}"
    );
}

#[test]
fn check_says_what_is_used_and_how_long_the_elements_hold() {
    let place = Place::new();
    place.scene("iss.toml", "");
    let output = place.succeed(&["check", "iss.toml"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    for word in ["leaves out", "elements hold", "2018-0"] {
        assert!(text.contains(word), "no {word:?} in: {text}");
    }
    let output = place.succeed(&["check", "small.toml"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("night lights: off"), "{text}");
    assert!(
        place
            .succeed(&["check", "-q", "small.toml"])
            .stdout
            .is_empty()
    );
}

#[test]
fn doctor_lists_adapters_or_says_what_to_install() {
    let output = Place::new().run(&["doctor"]);
    match output.status.code() {
        Some(0) => {
            let text = String::from_utf8_lossy(&output.stdout).into_owned();
            assert!(
                text.contains("taken by default") && text.contains("  can "),
                "{text}"
            );
        }
        Some(1) => assert!(words(&output).contains("install"), "{}", words(&output)),
        code => panic!("{code:?}: {}", words(&output)),
    }
}

#[test]
fn a_still_has_its_size_and_exactly_the_numbers_of_the_contract() {
    let place = Place::new();
    let at = "2018-03-20T12:00:00Z";
    place.succeed(&[
        "frame",
        "small.toml",
        "-o",
        "a.png",
        "--stats",
        "a.json",
        "--size",
        "80x50",
        "--at",
        at,
    ]);
    assert_eq!(png_size(&place.path("a.png")), (80, 50));
    assert_eq!(place.names(), ["a.json", "a.png", "small.toml"]);
    let text = std::fs::read_to_string(place.path("a.json")).expect("reads");
    let stats: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let mut keys: Vec<_> = stats
        .as_object()
        .expect("a table")
        .keys()
        .cloned()
        .collect();
    keys.sort();
    assert_eq!(
        keys,
        [
            "adapter",
            "backend",
            "blocks_drawn",
            "blocks_visible",
            "draw_calls",
            "epoch",
            "eye",
            "features_off",
            "features_on",
            "frame_ms",
            "prepare_ms",
            "size",
            "sun",
            "texture_bytes",
            "triangles",
        ]
    );
    assert_eq!(stats["size"], serde_json::json!([80, 50]));
    let number = |value: &serde_json::Value| value.as_f64().expect("a number");
    assert!((number(&stats["eye"]["lat_deg"]) - 20.0).abs() < 1e-9);
    assert!((number(&stats["eye"]["lon_deg"]) - 15.0).abs() < 1e-9);
    assert!((number(&stats["eye"]["height_km"]) - 12_000.0).abs() < 1e-6);
    // The day of the equinox, 16:15 UTC: the Sun over the equator, and near 0° E at noon.
    assert!(number(&stats["sun"]["lat_deg"]).abs() < 0.5);
    assert!(number(&stats["sun"]["lon_deg"]).abs() < 4.0);
    assert_eq!(stats["epoch"], "2018-03-20T12:00:00.000Z");
    assert!(number(&stats["frame_ms"]) >= number(&stats["prepare_ms"]));
    let (visible, drawn) = (
        number(&stats["blocks_visible"]),
        number(&stats["blocks_drawn"]),
    );
    assert!(visible >= drawn && drawn > 0.0, "{visible} {drawn}");
    assert_eq!(
        stats["features_on"],
        serde_json::json!(["clouds", "atmosphere"])
    );
    assert_eq!(
        stats["features_off"],
        serde_json::json!(["normals", "night_lights"])
    );
}

#[test]
fn the_same_still_twice_is_the_same_file() {
    let place = Place::new();
    place.succeed(&["frame", "small.toml", "-o", "a.png"]);
    place.succeed(&["frame", "small.toml", "-o", "b.png"]);
    let read = |name| std::fs::read(place.path(name)).expect("reads");
    assert_eq!(read("a.png"), read("b.png"));
    // Not a black picture.
    let picture = image::open(place.path("a.png")).expect("opens").to_rgb8();
    assert!(picture.pixels().any(|pixel| pixel[2] > 60));
}

#[test]
fn frames_are_numbered_whole_and_not_mixed_with_others() {
    let place = Place::new();
    let arguments = ["play", "small.toml", "--frames", "out/frames"];
    place.succeed(&arguments);
    let frames = place.path("out/frames");
    let expected = [
        "frame_00000.png",
        "frame_00001.png",
        "frame_00002.png",
        "frame_00003.png",
    ];
    assert_eq!(names(&frames), expected);
    for name in expected {
        assert_eq!(png_size(&frames.join(name)), (64, 36));
    }
    let words = place.fail(1, &arguments);
    assert!(words.contains("--overwrite"), "{words}");
    place.succeed(&[&arguments[..], &["--overwrite"]].concat());
    assert_eq!(names(&frames), expected);
}

/// Types of the boxes of an MP4 file, in their order, and the contents of one of them.
fn boxes(file: &[u8]) -> Vec<(String, &[u8])> {
    let mut rest = file;
    let mut found = Vec::new();
    while let Some((head, _)) = rest.split_first_chunk::<8>() {
        let [a, b, c, d, kind @ ..] = *head;
        let length = u32::from_be_bytes([a, b, c, d]) as usize;
        assert!(
            (8..=rest.len()).contains(&length),
            "a box of {length} bytes"
        );
        found.push((
            String::from_utf8_lossy(&kind).into_owned(),
            &rest[8..length],
        ));
        rest = &rest[length..];
    }
    assert!(rest.is_empty(), "{} bytes after the last box", rest.len());
    found
}

fn check_video(path: &Path) {
    let file = std::fs::read(path).expect("reads");
    let boxes = boxes(&file);
    let kinds: Vec<_> = boxes.iter().map(|(kind, _)| kind.as_str()).collect();
    assert_eq!(kinds.first(), Some(&"ftyp"));
    let place = |wanted| kinds.iter().position(|kind| *kind == wanted).expect(wanted);
    assert!(
        place("moov") < place("mdat"),
        "the index comes first: {kinds:?}"
    );
    let moov = boxes[place("moov")].1;
    // The sample size table: version and flags, one size for all (0: each its own), and how many there are.
    let table = moov
        .windows(4)
        .position(|kind| kind == b"stsz")
        .expect("stsz")
        + 4;
    assert_eq!(
        moov[table + 8..table + 12],
        4_u32.to_be_bytes(),
        "four frames"
    );
    let asked = Command::new("ffprobe")
        .args(["-v", "error", "-count_frames", "-show_entries"])
        .arg("stream=codec_name,width,height,color_space,nb_read_frames")
        .args(["-of", "default=noprint_wrappers=1:nokey=1"])
        .arg(path)
        .output();
    match asked {
        Ok(answer) => {
            let text = String::from_utf8_lossy(&answer.stdout).into_owned();
            let values: Vec<_> = text.lines().collect();
            assert_eq!(
                values,
                ["h264", "64", "36", "bt709", "4"],
                "{}",
                words(&answer)
            );
        }
        Err(error) => eprintln!("not checked with ffprobe: {error}"),
    }
}

#[test]
fn the_built_in_encoder_writes_a_video() {
    let place = Place::new();
    place.succeed(&[
        "play",
        "small.toml",
        "--video",
        "a.mp4",
        "--encoder",
        "builtin",
    ]);
    assert_eq!(place.names(), ["a.mp4", "small.toml"]);
    check_video(&place.path("a.mp4"));
}

#[test]
fn ffmpeg_writes_a_video_where_it_is_installed() {
    let place = Place::new();
    let arguments = [
        "play",
        "small.toml",
        "--video",
        "a.mp4",
        "--encoder",
        "ffmpeg",
    ];
    let output = place.run(&arguments);
    let said = words(&output);
    if said.contains("--encoder builtin") {
        eprintln!("not checked with ffmpeg: {said}");
        assert_eq!(output.status.code(), Some(1));
        assert_eq!(place.names(), ["small.toml"]);
        return;
    }
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert_eq!(place.names(), ["a.mp4", "small.toml"]);
    check_video(&place.path("a.mp4"));
}

/// Without ffmpeg on the search path the built-in encoder is taken, and asking for ffmpeg is refused.
#[test]
fn without_ffmpeg_the_built_in_encoder_is_taken() {
    let place = Place::new();
    let empty = place.path("empty");
    std::fs::create_dir(&empty).expect("makes");
    let arguments = ["play", "small.toml", "--video", "a.mp4"];
    let output = place
        .command(&arguments)
        .env("PATH", &empty)
        .output()
        .expect("starts");
    assert_eq!(output.status.code(), Some(0), "{}", words(&output));
    check_video(&place.path("a.mp4"));
    let asked = [&arguments[..], &["--encoder", "ffmpeg"]].concat();
    let output = place
        .command(&asked)
        .env("PATH", &empty)
        .output()
        .expect("starts");
    assert_eq!(output.status.code(), Some(1));
    assert!(words(&output).contains("install it"), "{}", words(&output));
}

/// A film of many frames, stopped in the middle the hard way: nothing stands under a final name.
#[cfg(unix)]
#[test]
fn a_film_that_is_stopped_leaves_nothing_under_its_name() {
    let place = Place::new();
    place.scene(
        "long.toml",
        &SMALL.replace("duration_s = 4", "duration_s = 100000"),
    );
    for encoder in ["builtin", "auto"] {
        let video = ["--video", "a.mp4", "--encoder", encoder];
        let frames = ["--frames", encoder];
        let mut child = place
            .command(&[&["play", "long.toml"][..], &video, &frames].concat())
            .spawn()
            .expect("starts");
        // Until it is in the middle of it.
        let second = place.path(encoder).join("frame_00001.png");
        let begin = Instant::now();
        while !second.exists() {
            assert!(
                begin.elapsed() < Duration::from_secs(60),
                "no frame in a minute"
            );
            assert!(
                child.try_wait().expect("asks").is_none(),
                "it ended by itself"
            );
            std::thread::sleep(Duration::from_millis(20));
        }
        child.kill().expect("stops");
        child.wait().expect("ends");
        assert!(!place.path("a.mp4").exists());
        let shown = names(&place.path(encoder));
        for name in shown.iter().filter(|name| !name.starts_with('.')) {
            assert_eq!(
                png_size(&place.path(encoder).join(name)),
                (64, 36),
                "{name}"
            );
        }
    }
}
