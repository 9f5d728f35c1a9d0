//! Pictures by the reference renderer.

use crate::{Place, SMALL, png_size, words};
#[cfg(unix)]
use std::io::{BufRead, BufReader, Read};

/// Four rays a pixel: these pictures are small.
const REFERENCE: [&str; 4] = ["--renderer", "reference", "--samples", "2"];

/// Writes a scene without the air, whose light of all orders takes seconds.
fn airless(place: &Place) {
    let scene = SMALL.replace("[earth]", "[earth]\natmosphere = \"none\"");
    place.scene("airless.toml", &scene);
}

fn arguments<'a>(scene: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&["frame", scene, "-o", "a.png"], more, &REFERENCE].concat()
}

#[test]
fn a_reference_still_looks_like_the_drawn_one_and_tells_its_numbers() {
    let place = Place::new();
    let size = ["--size", "32x18"];
    let more = [&size[..], &["--stats", "a.json"]].concat();
    place.succeed(&arguments("small.toml", &more));
    assert_eq!(png_size(&place.path("a.png")), (32, 18));
    assert_eq!(place.names(), ["a.json", "a.png", "small.toml"]);
    let text = std::fs::read_to_string(place.path("a.json")).expect("reads");
    let stats: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(stats["renderer"], "reference");
    assert_eq!(stats["samples"], 2);
    assert_eq!(stats["size"], serde_json::json!([32, 18]));
    let width = crate::DAY_WIDTH;
    assert_eq!(stats["day_width"], width);
    assert_eq!(
        stats["features_on"],
        serde_json::json!(["clouds", "water", "atmosphere"])
    );
    // Of the day, of clouds, of water.
    let bytes = width * width / 2 * (4 + 1 + 4);
    assert_eq!(stats["map_bytes"], bytes);
    let ground = stats["ground"].as_f64().expect("a number");
    assert!((0.2..0.9).contains(&ground), "{ground}");
    assert!(stats["frame_ms"].as_f64().expect("a number") > 0.0);
    place.succeed(&[&["frame", "small.toml", "-o", "b.png"][..], &size].concat());
    let open = |name| image::open(place.path(name)).expect("opens").to_rgb8();
    let (reference, drawn) = (open("a.png"), open("b.png"));
    let apart = reference.iter().zip(drawn.iter());
    let sum: u64 = apart.map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    let mean = sum as f64 / reference.len() as f64;
    assert!(mean < 6.0, "{mean} of 255 apart");
    assert!(reference.pixels().any(|pixel| pixel[2] > 60));
}

#[test]
fn the_same_still_again_is_the_same_file() {
    let place = Place::new();
    airless(&place);
    let drawn = |name| {
        let arguments = ["frame", "airless.toml", "-o", name, "--size", "32x18"];
        place.succeed(&[&arguments[..], &REFERENCE].concat());
        std::fs::read(place.path(name)).expect("reads")
    };
    assert_eq!(drawn("a.png"), drawn("b.png"));
}

#[test]
fn options_that_mean_nothing_together_are_rejected() {
    let place = Place::new();
    for (more, must_say) in [
        (&["--samples", "2"][..], "--renderer reference"),
        (
            &["--renderer", "gpu", "--samples", "2"],
            "--renderer reference",
        ),
        (&["--renderer", "reference", "--samples", "0"], "--samples"),
        (&["--renderer", "reference", "--samples", "17"], "--samples"),
        (
            &["--renderer", "reference", "--adapter", "llvmpipe"],
            "--adapter",
        ),
        (&["--renderer", "vulkan"], "reference"),
    ] {
        let arguments = [&["frame", "small.toml", "-o", "a.png"], more].concat();
        let words = place.fail(2, &arguments);
        assert!(words.contains(must_say), "{more:?}: {words}");
    }
    assert_eq!(place.names(), ["small.toml"]);
}

#[test]
fn without_any_adapter_the_reference_draws() {
    let place = Place::new();
    // No machine has both of these.
    let nowhere = if cfg!(target_os = "macos") {
        "dx12"
    } else {
        "metal"
    };
    let run = |arguments: &[&str]| {
        let mut command = place.command(arguments);
        command
            .env("WGPU_BACKEND", nowhere)
            .output()
            .expect("the command starts")
    };
    airless(&place);
    let output = run(&["frame", "airless.toml", "-o", "a.png", "--size", "8x4"]);
    assert_eq!(output.status.code(), Some(0), "{}", words(&output));
    assert!(
        words(&output).contains("reference renderer"),
        "{}",
        words(&output)
    );
    assert_eq!(png_size(&place.path("a.png")), (8, 4));
    // An adapter that was requested by name is not replaced.
    let output = run(&["frame", "airless.toml", "-o", "b.png", "--adapter", "any"]);
    assert_eq!(output.status.code(), Some(1), "{}", words(&output));
    assert_eq!(place.names(), ["a.png", "airless.toml", "small.toml"]);
}

#[test]
fn bad_scenes_and_outputs_are_reported_as_ever() {
    let place = Place::new();
    place.scene("bad.toml", "[camera]\nfov_deg = 0\n");
    let words = place.fail(2, &arguments("bad.toml", &[]));
    assert!(words.contains("bad.toml:2"), "{words}");
    place.scene("far.toml", "[orbit]\n");
    place.fail(2, &arguments("far.toml", &["--at", "2030-01-01T00:00:00Z"]));
    let words = place.fail(1, &arguments("small.toml", &["--stats", "far.toml/a.json"]));
    assert!(words.contains("far.toml"), "{words}");
    let words = place.fail(1, &arguments("small.toml", &["--size", "16384x16384"]));
    assert!(
        words.contains("MiB") && words.contains("smaller"),
        "{words}"
    );
    assert_eq!(place.names(), ["bad.toml", "far.toml", "small.toml"]);
}

#[test]
fn what_is_left_out_is_named() {
    let place = Place::new();
    place.scene(
        "chase.toml",
        "[camera]\nmode = \"chase\"\n[orbit]\n[tracks]\nmarker = true\n[earth]\natmosphere = \"none\"\nclouds = false\nnormals = false\nnight_lights = false\n[output]\nsize = [16, 9]\n",
    );
    let output = place.succeed(&arguments("chase.toml", &["--stats", "a.json"]));
    assert!(
        words(&output).contains("made detail, tracks, stars, sun, moon, spacecraft"),
        "{}",
        words(&output)
    );
    let text = std::fs::read_to_string(place.path("a.json")).expect("reads");
    let stats: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(
        stats["left_out"],
        serde_json::json!([
            "made detail",
            "tracks",
            "stars",
            "sun",
            "moon",
            "spacecraft"
        ])
    );
    // An eclipse is named while there is one.
    for (date, is_named) in [("2024-04-08", true), ("2024-04-09", false)] {
        let at = format!("{date}T18:17:20Z");
        place.scene(
            "plain.toml",
            "[camera]\nmode = \"geodetic\"\n[earth]\natmosphere = \"none\"\nclouds = false\nnormals = false\nnight_lights = false\n[output]\nsize = [16, 9]\n",
        );
        let more = ["--stats", "b.json", "--at", at.as_str()];
        let output = place.succeed(&arguments("plain.toml", &more));
        assert_eq!(words(&output).contains("eclipse"), is_named, "{date}");
    }
}

#[test]
fn ground_with_relief_is_drawn() {
    let place = Place::new();
    // Along the Andes from the Pacific, and the same without terrain.
    let scene = |earth: &str| {
        format!(
            "[time]\nstart = \"2018-07-15T15:00:00Z\"\n[camera]\nlat_deg = -33\nlon_deg = -72\nheight_km = 5\nheading_deg = 90\n\
             pitch_deg = -3\nfov_deg = 40\n[earth]\natmosphere = \"none\"\nclouds = false\n{earth}[output]\nsize = [32, 18]\n"
        )
    };
    let elevation = format!(
        "elevation = [\"{}/textures/elevation.png\"]\n",
        crate::REPOSITORY
    );
    place.scene("hills.toml", &scene(&elevation));
    place.scene("smooth.toml", &scene(""));
    let ground = |scene: &str| {
        place.succeed(&arguments(scene, &["--stats", "a.json"]));
        let text = std::fs::read_to_string(place.path("a.json")).expect("reads");
        let stats: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        let left_out = serde_json::json!(["made detail", "stars", "sun", "moon"]);
        assert_eq!(stats["left_out"], left_out);
        let is_on = stats["features_on"].as_array().expect("a list").iter();
        let has_relief = is_on.clone().any(|feature| feature == "relief");
        assert_eq!(has_relief, scene == "hills.toml");
        stats["ground"].as_f64().expect("a number")
    };
    let (hills, smooth) = (ground("hills.toml"), ground("smooth.toml"));
    assert!(hills > smooth + 0.01, "{hills} {smooth}");
}

#[cfg(unix)]
#[test]
fn an_interrupt_leaves_nothing_behind() {
    let place = Place::new();
    airless(&place);
    let mut command = place.command(&[
        "frame",
        "airless.toml",
        "-o",
        "a.png",
        "--size",
        "2000x2000",
        "--renderer",
        "reference",
        "--samples",
        "16",
        "-v",
    ]);
    let mut child = command
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("the command starts");
    let mut reported = BufReader::new(child.stderr.take().expect("piped"));
    let mut line = String::new();
    while !line.contains("rays a pixel") {
        line.clear();
        let read = reported.read_line(&mut line).expect("reads");
        assert!(read > 0, "it ends without drawing");
    }
    assert_eq!(place.names().len(), 3, "the unfinished file");
    let kill = std::process::Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(kill.expect("kill").success());
    let begin = std::time::Instant::now();
    while child.try_wait().expect("waits").is_none() {
        if begin.elapsed().as_secs() >= 30 {
            child.kill().expect("kills");
            panic!("it goes on");
        }
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let mut rest = String::new();
    reported.read_to_string(&mut rest).expect("reads");
    let status = child.wait().expect("ends");
    assert_eq!(status.code(), Some(130), "{rest}");
    assert!(rest.contains("interrupted"), "{rest}");
    assert_eq!(place.names(), ["airless.toml", "small.toml"]);
}
