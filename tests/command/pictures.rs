//! Stills, their numbers, and frames.

use crate::{Place, names, png_size};

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
