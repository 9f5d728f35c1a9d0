//! `terrella orbit` with several satellites, corrupt files, impacts, and dates outside the validity.

use crate::{Place, words};
use std::path::Path;
use terrella_orbit::{Ephemerides, Feed};
use terrella_play::scene::Scene;

const KEPLER: &str = "source = \"kepler\"\nperiapsis_km = 7000\n";

#[test]
fn several_satellites_come_in_one_table() {
    let place = Place::new();
    let scene = format!(
        "[time]\nduration_s = 600\n[[orbit]]\n[[orbit]]\nname = \"Two, high\"\n{KEPLER}[[orbit]]\nname = \"Three\"\n{KEPLER}"
    );
    place.scene("three.toml", &scene);
    let csv = place.printed(&["orbit", "three.toml", "--csv", "--all"]);
    assert_eq!(csv.matches("epoch_utc").count(), 1);
    let read = Ephemerides::from_text(&csv, Path::new("three.csv"), true).expect("a table");
    let names: Vec<_> = read.feeds.iter().map(Feed::name).collect();
    assert_eq!(names, ["ISS (ZARYA)", "Two, high", "Three"]);
    let two = ["--satellite", "three", "--satellite", "two, high"];
    let json = place.printed(&[&["orbit", "three.toml", "--json"], &two[..]].concat());
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(
        (&json[0]["name"], &json[1]["name"]),
        (&"Three".into(), &"Two, high".into())
    );
    // One alone is an object, and every row is of it.
    let one = place.printed(&["orbit", "three.toml", "--json", "--satellite", "Three"]);
    let one: serde_json::Value = serde_json::from_str(&one).expect("JSON");
    assert_eq!(one["name"], "Three");
    let reported =
        place.succeed(&[&["orbit", "three.toml", "--oem", "two.oem"], &two[..]].concat());
    assert!(
        words(&reported).contains("Three: 11 states"),
        "{}",
        words(&reported)
    );
    let oem = Ephemerides::from_file(&place.path("two.oem"), true).expect("an OEM");
    assert_eq!(oem.feeds.len(), 2);
    let passes = place.printed(&[
        "orbit",
        "three.toml",
        "--all",
        "--csv",
        "--passes",
        "0,0",
        "--days",
        "1",
    ]);
    for name in ["\nISS (ZARYA),", "\n\"Two, high\",", "\nThree,"] {
        assert!(passes.contains(name), "{passes}");
    }
    place.fail(2, &["orbit", "three.toml", "--all", "--satellite", "Three"]);
}

/// A scene that flies an ephemeris of ten minutes with error estimates, with one invalid date in it.
fn corrupt(place: &Place) {
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
fn a_bad_line_is_reported_and_rejected_only_when_strict() {
    let place = Place::new();
    corrupt(&place);
    let output = place.succeed(&["orbit", "flown.toml", "--json"]);
    let reported = words(&output);
    assert!(
        reported.contains("skipped: ") && reported.contains("sat.oem:22:1: "),
        "{reported}"
    );
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(json["states"].as_array().map(Vec::len), Some(11));
    let check = place.printed(&["check", "flown.toml"]);
    assert!(
        check.contains("skipped") && check.contains("sat.oem:22:1: "),
        "{check}"
    );
    for arguments in [
        &["orbit", "flown.toml", "--strict"],
        &["check", "flown.toml", "--strict"],
    ] {
        let rejection = place.fail(1, arguments);
        assert!(rejection.contains("sat.oem:22:1: "), "{rejection}");
    }
}

#[test]
fn the_source_s_own_error_is_shown() {
    let place = Place::new();
    corrupt(&place);
    // √3 · 10 m.
    let text = place.printed(&["orbit", "flown.toml"]);
    assert!(
        text.lines().skip(1).all(|row| row.ends_with("±17.3 m")),
        "{text}"
    );
    let csv = place.printed(&["orbit", "flown.toml", "--csv"]);
    let error_m = csv
        .lines()
        .nth(1)
        .and_then(|row| row.rsplit(',').nth(1)?.parse::<f64>().ok());
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
    // Unknown values are omitted.
    let json = place.printed(&["orbit", "made.toml", "--json"]);
    assert!(json.contains("\"error_m\": null"), "{json}");
}

const FALL: &str = "[orbit]\nsource = \"numerical\"\nname = \"Fall\"\nsemi_major_axis_km = 6538\narea_m2 = 80\nmass_kg = 500\ninclination_deg = 51.6\n";

#[test]
fn an_impact_is_reported_with_its_time_and_place() {
    let place = Place::new();
    // An explicit duration is rejected, with the event that limits the validity.
    place.scene("asked.toml", &format!("[time]\nduration_s = 20000\n{FALL}"));
    let rejection = place.fail(2, &["orbit", "asked.toml"]);
    for needle in [
        "asked.toml:2: [time] duration_s",
        "the satellite meets the ground at 2018-01-15T",
        "° ",
        "make it at most",
    ] {
        assert!(rejection.contains(needle), "{needle} is not in {rejection}");
    }
    // One that is not is shortened.
    place.scene("usual.toml", FALL);
    let output = place.succeed(&["orbit", "usual.toml", "--json"]);
    let reported = words(&output);
    assert!(
        reported.contains("is shortened from its default, 5580,"),
        "{reported}"
    );
    assert!(reported.contains("meets the ground at"), "{reported}");
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
    let text = place.printed(&["orbit", "usual.toml", "-q"]);
    let row = text.lines().last().expect("a row");
    assert!(row.starts_with("meets the ground at 2018-01-15T"), "{row}");
    // An instant behind it.
    let rejection = place.fail(2, &["orbit", "usual.toml", "--at", "2018-01-15T13:32:59Z"]);
    assert!(
        rejection.contains("Fall meets the ground at") && rejection.contains("° "),
        "{rejection}"
    );
}

#[test]
fn the_usual_duration_is_shortened_to_what_an_ephemeris_holds() {
    let place = Place::new();
    corrupt(&place);
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
    let reported = place.printed(&["check", "back.toml"]);
    assert!(reported.contains("to 300:"), "{reported}");
    place.scene(
        "end.toml",
        &format!("[time]\nstart = 2018-01-15T12:10:00Z\n{orbit}"),
    );
    place.fail(2, &["check", "end.toml"]);
    place.scene("long.toml", &format!("[time]\nduration_s = 601\n{orbit}"));
    let rejection = place.fail(2, &["check", "long.toml"]);
    assert!(
        rejection.contains("long.toml:2: [time] duration_s"),
        "{rejection}"
    );
}

#[test]
fn a_scene_of_another_year_flies_a_stand_in() {
    let place = Place::new();
    place.scene("today.toml", "[time]\nstart = 2026-07-01T00:00:00Z\n");
    let output = place.succeed(&["orbit", "today.toml", "--json"]);
    let reported = words(&output);
    assert!(
        reported
            .contains("ISS stand-in is not where the International Space Station is at 2026-07-01"),
        "{reported}"
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
    // Its elements belong to a stand-in: they are not written as the station's.
    let rejection = place.fail(2, &["orbit", "today.toml", "--omm", "iss.omm"]);
    assert!(rejection.contains("ISS stand-in"), "{rejection}");
    // Where the station's own reach, they are flown.
    place.scene("then.toml", "[time]\nstart = 2018-01-16T00:00:00Z\n");
    let then = place.printed(&["orbit", "then.toml"]);
    assert!(then.starts_with("ISS (ZARYA),"), "{then}");
    let scene = Scene::load(&place.path("today.toml")).expect("a scene");
    assert!(scene.notices.is_empty());
}

/// Sets of two constellations, 150 and 5 satellites; one of them twice.
fn catalogue() -> String {
    let checked = |line: String| {
        let sum: u32 = line
            .chars()
            .map(|c| c.to_digit(10).unwrap_or(u32::from(c == '-')))
            .sum();
        format!("{line}{}\n", sum % 10)
    };
    let set = |number: u32, name: &str| {
        let anomaly = f64::from(number % 360);
        let one =
            format!("1 {number:05}U 20001A   26060.50000000  .00000100  00000-0  10000-3 0  999");
        let two = format!(
            "2 {number:05}  53.0000 120.0000 0010000  90.0000 {anomaly:8.4} 15.06000000    1",
        );
        format!("{name}\n{}{}", checked(one), checked(two))
    };
    let chain = (0..150).map(|k| set(44_713 + k, &format!("CHAIN-{k}")));
    let others = (0..5).map(|k| set(50_000 + k, &format!("OTHER {k}")));
    let all: String = chain.chain(others).collect();
    all + &set(44_713, "CHAIN-0")
}

#[test]
fn one_table_flies_many_satellites_of_a_file() {
    let place = Place::new();
    place.scene("sets.tle", &catalogue());
    let names = |scene: &str| {
        let output = place.succeed(&["orbit", scene, "--names", "--csv"]);
        let text = String::from_utf8(output.stdout).expect("UTF-8");
        let rows = text.lines().skip(1);
        let names = rows.filter_map(|row| Some(row.split(',').next()?.to_owned()));
        names.collect::<Vec<_>>()
    };
    assert_eq!(names("sets.tle").len(), 155);
    let orbit = "[orbit]\nfile = \"sets.tle\"\nmarker = true\n";
    for (all, count, first) in [
        ("true", 155, "CHAIN-0"),
        ("\"other*\"", 5, "OTHER 0"),
        ("\"44720..44729\"", 10, "CHAIN-7"),
        ("\"CHAIN-1?\"", 10, "CHAIN-10"),
    ] {
        place.scene("many.toml", &format!("{orbit}all = {all}\n"));
        let found = names("many.toml");
        assert_eq!((found.len(), found[0].as_str()), (count, first), "{all}");
    }
    // Another table beside it is one satellite, which cameras follow by name.
    let beside = "[[orbit]]\nfile = \"sets.tle\"\nall = \"CHAIN*\"\nmarker = true\n[[orbit]]\nfile = \"sets.tle\"\nname = \"OTHER 3\"\nmarker = true\n[camera]\nfollow = \"OTHER 3\"\n";
    place.scene("beside.toml", beside);
    assert_eq!(names("beside.toml").len(), 151);
    let output = place.succeed(&["check", "beside.toml"]);
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    for reported in [
        "satellites that match \"CHAIN*\" of sets.tle: 150",
        "OTHER 3 of sets.tle",
        "151 satellites in all; terrella orbit --names lists them",
    ] {
        assert!(text.contains(reported), "{reported}: {text}");
    }
    assert_eq!(text.matches("[[orbit]]").count(), 2, "{text}");
    assert!(text.lines().count() < 400, "{text}");
    // States of all satellites of a file.
    let output = place.succeed(&[
        "orbit",
        "sets.tle",
        "--all",
        "--at",
        "2026-03-01T13:00:00Z",
        "--csv",
    ]);
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    assert_eq!(text.lines().count(), 156);

    for (keys, reported) in [
        (
            "all = \"NONE*\"",
            "sets.tle has no such satellite; terrella orbit sets.tle --names",
        ),
        ("all = \"9..1\"", "write the smaller number first"),
        ("all = 7", "must be true, false, a pattern"),
        ("all = true\nname = \"CHAIN-1\"", "leave one out"),
    ] {
        place.scene("bad.toml", &format!("{orbit}{keys}\n"));
        let error = words(&place.run(&["check", "bad.toml"]));
        assert!(
            error.contains("bad.toml:4: [orbit] all") && error.contains(reported),
            "{error}"
        );
    }
}
