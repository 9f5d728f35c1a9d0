//! Errors are reported with their place, and no files are left behind.

use crate::{Place, SMALL};
use std::time::{Duration, Instant};

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
        // Outside the reach of the elements.
        (
            "late.toml",
            concat!(
                "[time]\nstart = \"2031-01-01T00:00:00Z\"\n[orbit]\nfile = \"",
                env!("CARGO_MANIFEST_DIR"),
                "/../../config/orbits/iss.tle\"\n"
            ),
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
    // A date requested on the command line, outside the same validity.
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
fn a_bad_star_file_is_named_and_left_out_unless_strict() {
    let place = Place::new();
    std::fs::create_dir(place.path("sky")).expect("a folder");
    std::fs::write(place.path("sky/stars.bin"), b"TRSTARS1\x02\0\0\0short").expect("a file");
    let sky = "[output]\nsize = [32, 32]\n[sky]\nfolder = \"sky\"\n";
    place.scene("sky.toml", sky);
    let reported = place.succeed(&["check", "sky.toml"]);
    let reported = String::from_utf8_lossy(&reported.stdout);
    for words in [
        "stars.bin: it announces 2 stars but has 5 bytes",
        "moon.jpg is missing",
    ] {
        assert!(reported.contains(words), "{reported}");
    }
    let drawn = place.succeed(&["frame", "sky.toml", "-o", "a.png", "--stats", "a.json"]);
    let drawn = String::from_utf8_lossy(&drawn.stderr);
    assert!(drawn.contains("stars left out"), "{drawn}");
    let stats = std::fs::read_to_string(place.path("a.json")).expect("numbers");
    assert!(stats.contains("\"layers_missing\""), "{stats}");
    place.scene("strict.toml", &format!("[earth]\nstrict = true\n{sky}"));
    let rejected = place.fail(2, &["frame", "strict.toml", "-o", "b.png"]);
    assert!(
        rejected.contains("[sky] stars") && !place.path("b.png").exists(),
        "{rejected}"
    );
}

#[test]
fn what_cannot_be_written_is_reported_before_drawing() {
    let place = Place::new();
    place.scene("a_file", "");
    // The requested adapter does not exist: an error about the file shows that it was checked first.
    let adapter = ["--adapter", "no such adapter"];
    for (arguments, must_say) in [
        (&["frame", "small.toml", "-o", "a_file/a.png"][..], "a_file"),
        (&["frame", "small.toml", "-o", "."], "folder"),
        (&["frame", "small.toml", "-o", "a.jpg"], "a.png"),
        (
            &[
                "frame",
                "small.toml",
                "-o",
                "a.png",
                "--stats",
                "a_file/a.json",
            ],
            "a_file",
        ),
        (&["play", "small.toml", "--video", "a_file/a.mp4"], "a_file"),
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
        &[
            "frame",
            "small.toml",
            "-o",
            "new/deep/a.png",
            "--stats",
            "new/a.json",
        ],
        &["play", "small.toml", "--video", "new/deep/a.mp4"],
    ] {
        let words = place.fail(1, &[arguments, &adapter].concat());
        assert!(words.contains("adapter"), "{words}");
    }
    assert_eq!(place.names(), ["small.toml"]);
}
