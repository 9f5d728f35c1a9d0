//! Help, options, and the commands that draw nothing.

use crate::{Place, SMALL, words};

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
        (&["completions", "--help"], &["bash", "zsh", "fish"]),
        (&["man", "--help"], &["--list", "COMMAND"]),
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
fn help_ends_with_examples_and_lists_global_options_apart() {
    let place = Place::new();
    for command in [
        &[][..],
        &["play"],
        &["frame"],
        &["orbit"],
        &["pack", "build"],
    ] {
        let output = place.succeed(&[command, &["--help"]].concat());
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        let at = |words: &str| {
            let found = text.find(words);
            found.unwrap_or_else(|| panic!("{command:?}: no {words}: {text}"))
        };
        let [own, global, adapter, examples] = [
            "\nOptions:\n",
            "\nGlobal options:\n",
            "\n      --adapter",
            "\nExamples:\n",
        ]
        .map(at);
        assert!(
            own < global && global < adapter && adapter < examples,
            "{text}"
        );
        at(&[&["\n  terrella"], command].concat().join(" "));
    }
}

#[test]
fn unknown_options_and_commands_are_answered_by_their_meaning() {
    let place = Place::new();
    let reported = place.fail(2, &["play", "small.toml", "--fps", "24"]);
    assert!(
        reported.contains("frame_rate_hz under [time]"),
        "{reported}"
    );
    let reported = place.fail(2, &["render", "small.toml"]);
    assert!(
        reported.contains("terrella frame SCENE -o OUT.png"),
        "{reported}"
    );
    place.scene("dem.toml", "[earth]\ndem = \"alps.tif\"\n");
    let reported = place.fail(2, &["check", "dem.toml"]);
    assert!(reported.contains("did you mean elevation?"), "{reported}");
}

#[test]
fn completions_and_man_pages_go_to_standard_output() {
    let place = Place::new();
    let printed = |arguments: &[&str]| {
        let output = place.succeed(arguments);
        assert_eq!(words(&output), "", "{arguments:?}");
        String::from_utf8(output.stdout).expect("UTF-8")
    };
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let script = printed(&["completions", shell]);
        for word in ["terrella", "smallest-effect", "min-elevation", "verify"] {
            assert!(script.contains(word), "{shell}: no {word}");
        }
    }
    let list = printed(&["man", "--list"]);
    let commands: Vec<_> = list.lines().collect();
    for name in ["play", "frame", "pack", "pack build", "man"] {
        assert!(commands.contains(&name), "{list}");
    }
    assert!(printed(&["man"]).contains(".TH terrella 1"));
    for name in commands {
        let arguments: Vec<_> = ["man"].into_iter().chain(name.split(' ')).collect();
        let page = printed(&arguments);
        let title = format!(".TH terrella-{} 1", name.replace(' ', "-"));
        assert!(page.contains(&title), "{name}: {page}");
        assert!(
            page.contains(".SH EXAMPLES\n.nf\nterrella ") && page.contains("adapter"),
            "{name}: {page}"
        );
    }
    place.fail(2, &["completions", "tcsh"]);
    let reported = place.fail(1, &["man", "fly"]);
    assert!(reported.contains("terrella man --list"), "{reported}");
}

#[test]
fn internal_names_are_in_the_log_for_those_who_ask() {
    let place = Place::new();
    let log = |more: &str| {
        let frame = [more, "frame", "small.toml", "-o", "a.png"];
        words(&place.succeed(&frame))
    };
    let said = log("-v");
    assert!(said.contains("INFO maps from "), "{said}");
    assert!(!said.contains("terrella_play"), "{said}");
    let said = log("-vv");
    assert!(
        said.contains("INFO terrella_play::maps: maps from "),
        "{said}"
    );
}

/// bash itself reads its script and completes a command and an option with it.
#[cfg(target_os = "linux")]
#[test]
fn bash_completes_with_the_script() {
    let place = Place::new();
    let script = place.succeed(&["completions", "bash"]).stdout;
    std::fs::write(place.path("terrella.bash"), script).expect("writes");
    let complete = "source ./terrella.bash
        answer() { COMP_WORDS=(\"$@\"); COMP_CWORD=$(($# - 1)); COMPREPLY=()
            _terrella terrella \"${COMP_WORDS[COMP_CWORD]}\" \"${COMP_WORDS[COMP_CWORD - 1]}\"; echo \"${COMPREPLY[@]}\"; }
        answer terrella fr
        answer terrella frame --trut
        answer terrella completions ba";
    let output = std::process::Command::new("bash")
        .args(["--norc", "-c", complete])
        .current_dir(place.path("."))
        .output()
        .expect("bash starts");
    let answers = String::from_utf8_lossy(&output.stdout).into_owned();
    let answers: Vec<_> = answers.lines().collect();
    assert_eq!(answers, ["frame", "--truth", "bash"], "{}", words(&output));
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
fn options_without_meaning_are_answered_with_the_usage_of_their_command() {
    let place = Place::new();
    let said = place.fail(
        2,
        &[
            "play",
            "small.toml",
            "--video",
            "a.mp4",
            "--format",
            "png16",
        ],
    );
    for part in [
        "--format png16 is for --frames",
        "leave --format out, or choose pq or hlg",
        "terrella play [OPTIONS]",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
    for arguments in [
        &["frame", "small.toml", "-o", "a.png", "--satellite", "A"][..],
        &["check", "small.toml", "--satellite", "A"],
    ] {
        let said = place.fail(2, arguments);
        let usage = format!("terrella {} [OPTIONS]", arguments[0]);
        assert!(said.contains(&usage), "{said}");
    }
    let said = place.fail(1, &["frame", "small.toml", "-o", "a.exr"]);
    assert!(said.contains("or give --format exr"), "{said}");
}

#[test]
fn keyframes_after_the_end_of_the_film_are_noted() {
    let place = Place::new();
    let keys = |last: f64| {
        let key = |time_s| format!("[[camera.keys]]\ntime_s = {time_s}\nfov_deg = 40\n");
        format!("{SMALL}{}{}", key(0.0), key(last))
    };
    let late = "[camera.keys] keyframe 2, time_s = 4.5: after the end of the film, duration_s = 4";
    for (name, last, is_late) in [("good.toml", 4.0, false), ("late.toml", 4.5, true)] {
        place.scene(name, &keys(last));
        let output = place.succeed(&["check", name]);
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert_eq!(text.contains(late), is_late, "{text}");
        let film = ["play", name, "--frames", &name.replace(".toml", "")];
        let said = words(&place.succeed(&film));
        assert_eq!(said.contains(late), is_late, "{said}");
    }
    let said = words(&place.succeed(&["check", "late.toml", "--set", "time.duration_s=5"]));
    assert!(!said.contains("keyframe"), "{said}");
}

#[test]
fn an_exposure_beside_keyframes_of_it_is_noted() {
    let place = Place::new();
    let key = "[[camera.keys]]\ntime_s = 0\nexposure_ev = 1\n";
    place.scene("keys.toml", &format!("{SMALL}{key}"));
    let noted = "[output] exposure_ev: without effect, as keyframes of the camera set it";
    for (more, is_noted) in [(&[][..], false), (&["--set", "output.exposure_ev=2"], true)] {
        let arguments = [&["check", "keys.toml"][..], more].concat();
        let said = words(&place.succeed(&arguments));
        assert_eq!(said.contains(noted), is_noted, "{said}");
    }
}

#[test]
fn times_are_read_as_people_write_them() {
    let place = Place::new();
    place.scene("iss.toml", "");
    let state = |at: &str| place.succeed(&["orbit", "iss.toml", "--at", at]).stdout;
    let wanted = state("2018-01-16T12:30:00Z");
    for at in [
        "2018-01-16 12:30",
        "2018-01-16T12:30",
        "2018-01-16 12:30:00Z",
    ] {
        assert_eq!(state(at), wanted, "{at}");
    }
    assert_eq!(state("2018-01-16"), state("2018-01-16T00:00:00Z"));
    let said = place.fail(2, &["orbit", "iss.toml", "--at", "16/01/2018"]);
    assert!(said.contains("is not a UTC date"), "{said}");
    for command in ["play", "frame"] {
        let help = place.succeed(&[command, "--help"]).stdout;
        assert!(
            String::from_utf8_lossy(&help).contains("<TIME>"),
            "{command}"
        );
    }
}

#[test]
fn check_says_what_is_used_and_how_long_the_elements_hold() {
    let place = Place::new();
    place.scene("iss.toml", "");
    let output = place.succeed(&["check", "iss.toml"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    for word in ["leaves out", "elements valid", "2018-0"] {
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
                text.contains("used by default") && text.contains("  can "),
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
