//! `terrella orbit` of several satellites, of spoilt files, of falls, and of dates that satellites do not answer for.

use crate::{Place, words};
use std::path::Path;
use terrella_orbit::{Ephemerides, Feed};
use terrella_play::scene::Scene;

fn printed(place: &Place, arguments: &[&str]) -> String {
    String::from_utf8(place.succeed(arguments).stdout).expect("UTF-8")
}

const KEPLER: &str = "source = \"kepler\"\nperiapsis_km = 7000\n";

#[test]
fn several_satellites_come_in_one_table() {
    let place = Place::new();
    let scene = format!(
        "[time]\nduration_s = 600\n[[orbit]]\n[[orbit]]\nname = \"Two, high\"\n{KEPLER}[[orbit]]\nname = \"Three\"\n{KEPLER}"
    );
    place.scene("three.toml", &scene);
    let csv = printed(&place, &["orbit", "three.toml", "--csv", "--all"]);
    assert_eq!(csv.matches("epoch_utc").count(), 1);
    let read = Ephemerides::from_text(&csv, Path::new("three.csv"), true).expect("a table");
    let names: Vec<_> = read.feeds.iter().map(Feed::name).collect();
    assert_eq!(names, ["ISS (ZARYA)", "Two, high", "Three"]);
    let two = ["--satellite", "three", "--satellite", "two, high"];
    let json = printed(
        &place,
        &[&["orbit", "three.toml", "--json"], &two[..]].concat(),
    );
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(
        (&json[0]["name"], &json[1]["name"]),
        (&"Three".into(), &"Two, high".into())
    );
    // One alone is an object, and every row is of it.
    let one = printed(
        &place,
        &["orbit", "three.toml", "--json", "--satellite", "Three"],
    );
    let one: serde_json::Value = serde_json::from_str(&one).expect("JSON");
    assert_eq!(one["name"], "Three");
    let told = place.succeed(&[&["orbit", "three.toml", "--oem", "two.oem"], &two[..]].concat());
    assert!(
        words(&told).contains("Three: 11 states"),
        "{}",
        words(&told)
    );
    let oem = Ephemerides::from_file(&place.path("two.oem"), true).expect("an OEM");
    assert_eq!(oem.feeds.len(), 2);
    let passes = printed(
        &place,
        &[
            "orbit",
            "three.toml",
            "--all",
            "--csv",
            "--passes",
            "0,0",
            "--days",
            "1",
        ],
    );
    for name in ["\nISS (ZARYA),", "\n\"Two, high\",", "\nThree,"] {
        assert!(passes.contains(name), "{passes}");
    }
    place.fail(2, &["orbit", "three.toml", "--all", "--satellite", "Three"]);
}

/// A scene that flies an ephemeris of ten minutes with error estimates, and in it one date that is none.
fn spoilt(place: &Place) {
    place.scene(
        "made.toml",
        &format!("[time]\nduration_s = 600\n[orbit]\n{KEPLER}"),
    );
    place.succeed(&["orbit", "made.toml", "--oem", "sat.oem"]);
    let covariance = "COVARIANCE_START\nEPOCH = 2018-01-15T12:00:00\n1e-4\n0 1e-4\n0 0 1e-4\n0 0 0 0\n0 0 0 0 0\n0 0 0 0 0 0\nCOVARIANCE_STOP\n";
    let good = std::fs::read_to_string(place.path("sat.oem")).expect("an OEM");
    let bad = good.replacen("\n2018-01-15T12:04:", "\n2018-01-15T12:xx:", 1) + covariance;
    assert_ne!(bad.len(), good.len());
    std::fs::write(place.path("sat.oem"), bad).expect("writes");
    place.scene(
        "flown.toml",
        "[time]\nduration_s = 600\n[orbit]\nsource = \"oem\"\nfile = \"sat.oem\"\n",
    );
}

#[test]
fn a_bad_line_is_told_and_refused_only_when_strict() {
    let place = Place::new();
    spoilt(&place);
    let output = place.succeed(&["orbit", "flown.toml", "--json"]);
    let told = words(&output);
    assert!(
        told.contains("passed over: ") && told.contains("sat.oem:22:1: "),
        "{told}"
    );
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(json["states"].as_array().map(Vec::len), Some(11));
    let check = printed(&place, &["check", "flown.toml"]);
    assert!(
        check.contains("passed over") && check.contains("sat.oem:22:1: "),
        "{check}"
    );
    for arguments in [
        &["orbit", "flown.toml", "--strict"],
        &["check", "flown.toml", "--strict"],
    ] {
        let refusal = place.fail(1, arguments);
        assert!(refusal.contains("sat.oem:22:1: "), "{refusal}");
    }
}

#[test]
fn the_source_s_own_error_is_shown() {
    let place = Place::new();
    spoilt(&place);
    // √3 · 10 m.
    let text = printed(&place, &["orbit", "flown.toml"]);
    assert!(
        text.lines().skip(1).all(|row| row.ends_with("±17.3 m")),
        "{text}"
    );
    let csv = printed(&place, &["orbit", "flown.toml", "--csv"]);
    let error_m = csv
        .lines()
        .nth(1)
        .and_then(|row| row.rsplit(',').next()?.parse::<f64>().ok());
    assert!(
        error_m.is_some_and(|m| (m - 17.320_508).abs() < 1e-5),
        "{csv}"
    );
    place.succeed(&[
        "frame",
        "flown.toml",
        "-o",
        "a.png",
        "--stats",
        "a.json",
        "--size",
        "32x18",
    ]);
    let stats = std::fs::read_to_string(place.path("a.json")).expect("numbers");
    let stats: serde_json::Value = serde_json::from_str(&stats).expect("JSON");
    let error_m = stats["satellite"]["error_m"].as_f64();
    assert!(
        error_m.is_some_and(|m| (m - 17.320_508).abs() < 1e-5),
        "{stats}"
    );
    // Where nothing is known of it nothing is said.
    let json = printed(&place, &["orbit", "made.toml", "--json"]);
    assert!(json.contains("\"error_m\": null"), "{json}");
}

const FALL: &str = "[orbit]\nsource = \"numerical\"\nname = \"Fall\"\nsemi_major_axis_km = 6538\narea_m2 = 80\nmass_kg = 500\ninclination_deg = 51.6\n";

#[test]
fn an_impact_is_told_with_its_time_and_place() {
    let place = Place::new();
    // A duration that is asked for is refused, with what ends it.
    place.scene("asked.toml", &format!("[time]\nduration_s = 20000\n{FALL}"));
    let refusal = place.fail(2, &["orbit", "asked.toml"]);
    for needle in [
        "asked.toml:2: [time] duration_s",
        "the satellite meets the ground at 2018-01-15T",
        "° ",
        "make it at most",
    ] {
        assert!(refusal.contains(needle), "{needle} is not in {refusal}");
    }
    // One that is not is shortened.
    place.scene("usual.toml", FALL);
    let output = place.succeed(&["orbit", "usual.toml", "--json"]);
    let told = words(&output);
    assert!(
        told.contains("is shortened from its default, 5580,"),
        "{told}"
    );
    assert!(told.contains("meets the ground at"), "{told}");
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let (states, impact) = (json["states"].as_array().expect("states"), &json["impact"]);
    let last = states.last().expect("a state");
    assert!(
        last["height_km"].as_f64().is_some_and(|km| km.abs() < 0.5),
        "{last}"
    );
    let apart = |key: &str| {
        (last[key].as_f64().unwrap_or(99.0) - impact[key].as_f64().unwrap_or(0.0)).abs()
    };
    assert!(
        apart("lat_deg") < 0.01 && apart("lon_deg") < 0.01,
        "{impact} {last}"
    );
    let text = printed(&place, &["orbit", "usual.toml", "-q"]);
    let row = text.lines().last().expect("a row");
    assert!(row.starts_with("meets the ground at 2018-01-15T"), "{row}");
    // An instant behind it.
    let refusal = place.fail(2, &["orbit", "usual.toml", "--at", "2018-01-15T13:32:59Z"]);
    assert!(
        refusal.contains("Fall meets the ground at") && refusal.contains("° "),
        "{refusal}"
    );
}

#[test]
fn the_usual_duration_is_shortened_to_what_an_ephemeris_holds() {
    let place = Place::new();
    spoilt(&place);
    let orbit = "[orbit]\nsource = \"oem\"\nfile = \"sat.oem\"\n";
    place.scene("short.toml", orbit);
    let output = place.succeed(&["check", "short.toml"]);
    for text in [
        words(&output),
        String::from_utf8_lossy(&output.stdout).into_owned(),
    ] {
        assert!(
            text.contains(
                "duration_s is shortened from its default, 5580, to 600: the orbit answers from"
            ),
            "{text}"
        );
    }
    // Backwards from its end, and from its very end forwards, where nothing is left.
    place.scene(
        "back.toml",
        &format!("[time]\nstart = 2018-01-15T12:05:00Z\nspeed = -60\n{orbit}"),
    );
    let told = printed(&place, &["check", "back.toml"]);
    assert!(told.contains("to 300:"), "{told}");
    place.scene(
        "end.toml",
        &format!("[time]\nstart = 2018-01-15T12:10:00Z\n{orbit}"),
    );
    place.fail(2, &["check", "end.toml"]);
    place.scene("long.toml", &format!("[time]\nduration_s = 601\n{orbit}"));
    let refusal = place.fail(2, &["check", "long.toml"]);
    assert!(
        refusal.contains("long.toml:2: [time] duration_s"),
        "{refusal}"
    );
}

#[test]
fn a_scene_of_another_year_flies_a_stand_in() {
    let place = Place::new();
    place.scene("today.toml", "[time]\nstart = 2026-07-01T00:00:00Z\n");
    let output = place.succeed(&["orbit", "today.toml", "--json"]);
    let told = words(&output);
    assert!(
        told.contains("ISS stand-in is not where the International Space Station is at 2026-07-01"),
        "{told}"
    );
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(json["name"], "ISS stand-in");
    let states = json["states"].as_array().expect("states");
    let all = |key: &str| -> Vec<f64> { states.iter().filter_map(|s| s[key].as_f64()).collect() };
    let (heights, lats) = (all("height_km"), all("lat_deg"));
    assert!(
        heights.iter().all(|km| (390.0..440.0).contains(km)),
        "{heights:?}"
    );
    let highest = lats.iter().copied().fold(0.0, f64::max);
    assert!((51.0..52.0).contains(&highest), "{highest}");
    // Its elements are nobody's: they are not given out as the station's.
    let refusal = place.fail(2, &["orbit", "today.toml", "--omm", "iss.omm"]);
    assert!(refusal.contains("ISS stand-in"), "{refusal}");
    // Where the station's own reach, they are flown.
    place.scene("then.toml", "[time]\nstart = 2018-01-16T00:00:00Z\n");
    let then = printed(&place, &["orbit", "then.toml"]);
    assert!(then.starts_with("ISS (ZARYA),"), "{then}");
    let scene = Scene::load(&place.path("today.toml")).expect("a scene");
    assert!(scene.notices.is_empty());
}
