//! New scenes, and keys that are set for the commands that measure.

use crate::{Place, names, words};

#[test]
fn a_new_scene_explains_every_key_and_is_never_overwritten() {
    let place = Place::new();
    let said = place.printed(&["new", "mission"]);
    assert!(said.contains("mission.toml: edit it"), "{said}");
    let text = std::fs::read_to_string(place.path("mission.toml")).expect("written");
    assert!(text.contains("terrella play mission.toml") && !text.contains("config/iss.toml"));
    for key in [
        "# graticule = ",
        "# [[caption]]",
        "# [[geojson]]",
        "start = ",
    ] {
        assert!(text.contains(key), "{key}");
    }
    let check = place.printed(&["check", "mission.toml"]);
    assert!(check.starts_with("mission.toml: good"), "{check}");

    std::fs::write(place.path("mission.toml"), "mine").expect("written");
    for name in ["mission", "mission.toml"] {
        let said = place.fail(1, &["new", name]);
        assert!(said.contains("mission.toml: it exists already"), "{said}");
    }
    let kept = std::fs::read_to_string(place.path("mission.toml")).expect("kept");
    assert_eq!(kept, "mine");
    for (name, expected) in [
        (
            "mission.toml/a.toml",
            "mission.toml/a.toml: its folder cannot be created",
        ),
        ("a.json", "a.json: scenes are TOML"),
        ("..", "..: it is a folder"),
    ] {
        let said = place.fail(1, &["new", name]);
        assert!(said.contains(expected), "{said}");
    }
    assert_eq!(names(place.folder.path()), ["mission.toml", "small.toml"]);
    place.succeed(&["--quiet", "new", "second.toml"]);
    place.succeed(&["new", "none/deep/a"]);
    assert_eq!(names(&place.path("none/deep")), ["a.toml"]);
}

/// A setting that is wrong is rejected before anything is measured, by its own name.
#[test]
fn keys_are_set_for_bench_report_and_serve() {
    let place = Place::new();
    for command in [
        &["bench", "small.toml"][..],
        &["report", "small.toml", "-o", "out"],
        &["serve"],
    ] {
        let wrong = [command, &["--set", "output.samples=3"]].concat();
        let said = place.fail(2, &wrong);
        assert!(said.contains("--set: [output] samples = 3"), "{said}");
    }
    let bench = ["bench", "small.toml", "--frames", "1", "--json", "a.json"];
    let output = place.succeed(&[&bench[..], &["--set", "camera.fov_deg=33"]].concat());
    let json = std::fs::read_to_string(place.path("a.json")).expect("written");
    assert!(
        json.contains("\"fov_deg\": \"33\""),
        "{}{json}",
        words(&output)
    );
}
