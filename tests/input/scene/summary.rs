//! Dates against an orbit's validity, the summary, and the scenes of `config/`.

use super::{scene, utc};
use std::path::{Path, PathBuf};
use terrella::internals::earth::Shading;
use terrella_ground::air::Atmosphere;
use terrella_ground::globe::{Figure, Subdivision, Visibility};
use terrella_play::scene::Scene;

#[test]
fn dates_outside_the_validity_of_the_orbit_are_rejected() {
    let validity = (utc("2018-01-10T00:00:00Z"), utc("2018-01-20T00:00:00Z"));
    let rejection = |text| match scene(text).check_dates(validity, None) {
        Ok(()) => String::new(),
        Err(error) => error.to_string(),
    };
    for good in [
        "",
        "[time]\nstart = \"2018-01-10T00:00:00Z\"",
        "[time]\nstart = \"2018-01-20T00:00:00Z\"\nspeed = -60",
        "[time]\nstart = \"2018-01-19T00:00:00Z\"\nduration_s = 86400",
    ] {
        assert_eq!(rejection(good), "", "{good}");
    }
    let interval = "from 2018-01-10T00:00:00Z to 2018-01-20T00:00:00Z";
    let cases: [(&str, &str, &[&str]); 4] = [
        (
            "[time]\nstart = \"2019-01-15T12:00:00Z\"",
            "scene.toml:2: [time] start = 2019-01-15T12:00:00Z:",
            &["choose a start", "[orbit]"],
        ),
        (
            "[time]\nstart = \"2018-01-09T23:59:59Z\"",
            "scene.toml:2: [time] start = 2018-01-09T23:59:59Z:",
            &["choose a start"],
        ),
        (
            "[time]\nstart = \"2018-01-19T00:00:00Z\"\nduration_s = 86401",
            "scene.toml:3: [time] duration_s = 86401:",
            &["2018-01-20T00:00:01Z", "at most 86400 seconds"],
        ),
        (
            "[time]\nstart = \"2018-01-10T00:00:10Z\"\nspeed = -1",
            "scene.toml: [time] duration_s = 5580 (default):",
            &["2018-01-09T22:27:10Z", "at most 10 seconds"],
        ),
    ];
    for (text, start, needles) in cases {
        let message = rejection(text);
        assert!(message.starts_with(start), "{message}");
        for needle in needles.iter().chain([&interval]) {
            assert!(message.contains(needle), "{needle:?} is not in: {message}");
        }
    }
}

#[test]
fn the_summary_describes_orbit_and_orientation_plainly() {
    let orbit = |more: &str| {
        let text =
            format!("[orbit]\nsource = \"kepler\"\nname = \"polar\"\nperiapsis_km = 7000\n{more}");
        scene(&text).summary()
    };
    let summary = orbit("");
    for part in [
        "Keplerian orbit: polar\n",
        "UT1 is set to UTC, which rotates the Earth by up to 420 m at the equator",
    ] {
        assert!(summary.contains(part), "{part}: {summary}");
    }
    let drifts = orbit("j2 = true");
    assert!(
        drifts.contains("Keplerian orbit with the drift by J2: polar\n"),
        "{drifts}"
    );
}

#[test]
fn the_summary_tells_values_origins_use_and_what_is_left_out() {
    let text = "[camera]\nfov_deg = 30\n[earth]\nclouds = false\natmosphere = \"none\"";
    let summary = scene(text).summary();
    let has = |words: &[&str]| {
        let mut lines = summary.lines();
        let found = lines.any(|line| words.iter().all(|word| line.contains(word)));
        assert!(found, "no line has all of {words:?}:\n{summary}");
    };
    has(&["scene.toml: good"]);
    has(&["fov_deg", "30", "line 2 of the file"]);
    has(&["speed", "60", "default"]);
    has(&["start", "\"2018-01-15T12:00:00Z\"", "default"]);
    assert!(
        !summary.contains("lat_deg") && !summary.contains("ladder"),
        "{summary}"
    );
    has(&["playback", "2018-01-15T13:33:00Z", "2790 frames", "93.0 s"]);
    has(&["orbit", "built-in", "International Space Station"]);
    has(&["camera", "straight down", "30°"]);
    has(&["layers", "day map, normals, night lights", "starter pack"]);
    has(&["clouds: off: not loaded, not in the shader"]);
    has(&["atmosphere: off: not loaded, not in the shader"]);
    assert!(!summary.contains("night lights: off"), "{summary}");

    let summary = scene("").summary();
    assert!(summary.ends_with("leaves out\n  nothing\n"), "{summary}");
    // Only values in effect: the rest is counted, and listed on request.
    assert!(!summary.contains("not used"), "{summary}");
    let full = scene("").full_summary();
    let has = |words: &[&str]| {
        let mut lines = full.lines();
        lines.any(|line| words.iter().all(|word| line.contains(word)))
    };
    assert!(has(&["lat_deg", "not used", "geodetic"]), "{full}");
    let unused = full.matches("not used: ").count();
    assert!(
        summary.contains(&format!("\n{unused} more keys")),
        "{summary}"
    );
    // A key of the file without effect is reported beside those in force.
    let unused = scene("[tracks]\nmarker = true\n").summary();
    assert!(
        unused.contains("marker             line 2 of the file is not used: it is reported"),
        "{unused}"
    );
    assert!(summary.contains("billboard"), "{summary}");
}

fn config() -> PathBuf {
    Path::new(crate::REPOSITORY).join("config")
}

#[test]
fn all_scenes_of_the_config_folder_are_good() {
    let mut names = Vec::new();
    for entry in std::fs::read_dir(config()).expect("config/") {
        let path = entry.expect("an entry").path();
        if path
            .extension()
            .is_some_and(|extension| extension == "toml")
        {
            match Scene::load(&path) {
                Ok(scene) => println!("{}", scene.summary()),
                Err(error) => panic!("{error}"),
            }
            let stem = path.file_stem().map(|stem| stem.to_string_lossy());
            names.extend(stem.map(|stem| stem.into_owned()));
        }
    }
    for wanted in ["geostationary", "iss", "minimal", "molniya", "paper"] {
        let found = names.iter().any(|name| name == wanted);
        assert!(found, "{wanted} is not in {names:?}");
    }
}

#[test]
fn the_minimal_scene_and_the_scene_of_the_paper_are_what_they_say() {
    let load = |name| Scene::load(&config().join(name)).unwrap_or_else(|error| panic!("{error}"));

    let earth = load("minimal.toml").earth;
    assert!(!earth.clouds && !earth.normals && !earth.night_lights);
    assert_eq!(earth.atmosphere, Atmosphere::None);

    let earth = load("paper.toml").earth;
    assert_eq!(earth.figure, Figure::Sphere);
    assert_eq!(earth.visibility, Visibility::Paper);
    assert_eq!(earth.shading, Shading::Paper);
    assert_eq!(earth.subdivision, Subdivision::Cells(6));
    assert!(earth.clouds && earth.normals);
    assert_eq!(earth.atmosphere, Atmosphere::Billboard);
}
