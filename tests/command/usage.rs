//! Help, options, and the commands that draw nothing.

use crate::{Place, words};

#[test]
fn every_command_has_help() {
    let place = Place::new();
    for (arguments, must_say) in [
        (
            &["--help"][..],
            &[
                "play",
                "frame",
                "bench",
                "report",
                "terrain",
                "check",
                "doctor",
                "pack",
                "--adapter",
            ][..],
        ),
        (
            &["play", "--help"],
            &[
                "--frames",
                "--video",
                "--encoder",
                "--for-seconds",
                "--overwrite",
                "--range",
                "--resume",
                "--format",
                "--alpha",
                "--supersample",
                "--shutter",
                "--subframes",
                "--codec",
                "--crf",
            ],
        ),
        (
            &["frame", "--help"],
            &[
                "--output",
                "--at",
                "--size",
                "--radiance",
                "--truth",
                "--stats",
                "--renderer",
                "--samples",
                "--format",
                "--alpha",
                "--supersample",
                "--shutter",
            ],
        ),
        (
            &["bench", "--help"],
            &[
                "--json",
                "--csv",
                "--plots",
                "--baseline",
                "--smallest-effect",
                "--repeats",
                "--frames",
                "--size",
                "0.05",
                "floor",
            ],
        ),
        (
            &["terrain", "--help"],
            &[
                "--csv",
                "--fractal",
                "--memory",
                "--output",
                "--threads",
                "--tolerances",
            ],
        ),
        (&["check", "--help"], &["[SCENE]", "--satellite"]),
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
        &["bench", "small.toml", "--frames", "0"],
        &["bench", "small.toml", "--frames", "many"],
        &["bench", "small.toml", "--size", "0x10"],
        &["bench", "small.toml", "--smallest-effect", "0.2"],
        &[
            "bench",
            "small.toml",
            "--baseline",
            "a.json",
            "--smallest-effect",
            "nan",
        ],
        &["play", "small.toml", "--for-seconds", "-1"],
        &["play", "small.toml", "--for-seconds", "inf"],
        &["play", "small.toml", "--overwrite"],
        &["play", "small.toml", "--resume"],
        &["play", "small.toml", "--range", "0..2"],
        &["play", "small.toml", "--frames", "a", "--range", "2..2"],
        &["play", "small.toml", "--frames", "a", "--range", "two"],
        &["play", "small.toml", "--frames", "a", "--range", "0..5"],
        &[
            "play",
            "small.toml",
            "--frames",
            "a",
            "--resume",
            "--overwrite",
        ],
        &["play", "small.toml", "--encoder", "builtin"],
        &[
            "play",
            "small.toml",
            "--video",
            "a.mp4",
            "--encoder",
            "x265",
        ],
        &["play", "small.toml", "--codec", "h265"],
        &["play", "small.toml", "--crf", "20"],
        &["play", "small.toml", "--video", "a.mp4", "--crf", "52"],
        &[
            "play",
            "small.toml",
            "--video",
            "a.mp4",
            "--crf",
            "64",
            "--codec",
            "av1",
        ],
        &["play", "small.toml", "--video", "a.mp4", "--codec", "vp8"],
        &["check", "small.toml", "-q", "-v"],
    ] {
        place.fail(2, arguments);
    }
    assert_eq!(place.names(), ["small.toml"]);
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
fn play_without_a_display_says_what_to_do_instead() {
    let words = Place::new().fail(1, &["play", "small.toml"]);
    assert!(
        words.contains("--video") && words.contains("--frames"),
        "{words}"
    );
}

/// As a service runs it, or a container: nothing of a desktop in its environment.
#[test]
fn without_a_desktop_the_graphics_stack_says_nothing() {
    let place = Place::new();
    for arguments in [&["doctor"][..], &["frame", "small.toml", "-o", "a.png"]] {
        let mut command = place.command(arguments);
        let output = command
            .env_remove("XDG_RUNTIME_DIR")
            .env_remove("NODEVICE_SELECT")
            .output()
            .expect("starts");
        assert!(output.status.success(), "{}", words(&output));
        assert!(
            !words(&output).contains("XDG_RUNTIME_DIR"),
            "{}",
            words(&output)
        );
    }
}
