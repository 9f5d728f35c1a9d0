//! The frame-rate harness: what it writes, what it compares, what it rejects.

use crate::{Place, SMALL, words};
use serde_json::Value;
use std::io::{BufRead, BufReader, Read};
use std::time::{Duration, Instant};

/// The keys of a list of objects' first, in their order.
fn keys(of: &Value) -> Vec<&str> {
    let object = of.as_object().expect("an object");
    object.keys().map(String::as_str).collect()
}

fn json(place: &Place, name: &str) -> Value {
    let text = std::fs::read_to_string(place.path(name)).expect("reads");
    serde_json::from_str(&text).expect("JSON")
}

/// Writes a report that was changed.
fn changed(place: &Place, name: &str, report: &Value, change: impl FnOnce(&mut Value)) {
    let mut report = report.clone();
    change(&mut report);
    std::fs::write(place.path(name), report.to_string()).expect("writes");
}

const RUN: [&str; 4] = ["bench", "small.toml", "--frames", "8"];

#[test]
fn a_run_is_written_and_compared_with_an_earlier_one() {
    let place = Place::new();
    let files = [
        "--repeats",
        "2",
        "--json",
        "a.json",
        "--csv",
        "a.csv",
        "--plots",
        "new/plots",
        "-q",
    ];
    let output = place.succeed(&[&RUN[..], &files].concat());
    let reported = String::from_utf8_lossy(&output.stdout).into_owned();
    for word in [
        "frame over floor",
        "378022",
        "51.6 deg",
        "GeForce 6800",
        "clouds",
    ] {
        assert!(reported.contains(word), "no {word:?} in: {reported}");
    }
    assert_eq!(place.names(), ["a.csv", "a.json", "new", "small.toml"]);
    let report = json(&place, "a.json");
    holds_the_keys(&report);
    let rows = report["rows"].as_array().expect("rows");
    for row in rows {
        assert_eq!(row["blocks_lost"], 0, "{row}");
        assert!(row["blocks_visible"].as_u64() >= row["blocks_exact"].as_u64());
        assert!(row["frame_ms"]["median"].as_f64() > Some(0.0), "{row}");
        assert_eq!(row["levels"], Value::Array(Vec::new()));
    }
    assert_eq!(rows[2]["paper_frames_per_s"], 57.0);
    assert_eq!(rows[10]["paper_frames_per_s"], Value::Null);
    let features = report["features"].as_array().expect("features");
    let names: Vec<_> = features.iter().map(|feature| &feature["name"]).collect();
    // Normals, lights and samples are off in this scene. Each is switched off along the flight and both paths.
    let expected = [
        "clouds",
        "water",
        "detail",
        "directional_reflectance",
        "eclipses",
        "atmosphere",
        "composition",
        "stars",
        "sun",
        "moon",
    ];
    assert_eq!(names, expected.map(|name| [name; 3]).concat());
    for features in features.chunks(3) {
        let courses: Vec<_> = features.iter().map(|feature| &feature["course"]).collect();
        assert_eq!(courses, ["flight", "equatorial", "inclined"]);
        for feature in features {
            let runs = feature["runs"].as_array().expect("runs");
            assert_eq!(runs.len(), 2);
            assert_eq!(runs[1]["without_ms"].as_array().map(Vec::len), Some(8));
        }
    }
    if report["adapter"]
        .as_str()
        .is_some_and(|name| name.contains("llvmpipe"))
    {
        assert_eq!(report["unmeasured"][0]["name"], "anisotropy");
        assert!(
            reported.contains("not measured: the adapter is software"),
            "{reported}"
        );
    }
    let arguments = report["arguments"].as_array().expect("arguments");
    assert_eq!(arguments[0], "bench");
    assert_eq!(arguments[1], "small.toml");
    for feature in features {
        let is_more = |key: &str| feature[key].as_i64() > Some(0);
        let without_map = ["directional_reflectance", "eclipses", "stars", "sun"];
        let has_map = !without_map.contains(&feature["name"].as_str().expect("a name"));
        assert_eq!(is_more("texture_bytes"), has_map, "{feature}");
        // Sun and Moon far away are drawn as stars are: without stars that shader stays. In one pass each shader has the tone curve.
        let without_shader = ["composition", "stars"];
        let has_shader = !without_shader.contains(&feature["name"].as_str().expect("a name"));
        assert_eq!(is_more("shader_bytes"), has_shader, "{feature}");
    }
    let csv = std::fs::read_to_string(place.path("a.csv")).expect("reads");
    let columns: Vec<_> = csv.lines().map(|line| line.split(',').count()).collect();
    assert_eq!(columns, [29; 25], "{csv}");
    for name in ["features.svg", "floor_ratio.svg", "frames_per_s.svg"] {
        let svg = std::fs::read_to_string(place.path("new/plots").join(name)).expect("reads");
        assert!(svg.trim_end().ends_with("</svg>"), "{name}");
    }

    let against = |name: &'static str| {
        let baseline = ["--baseline", name, "--smallest-effect", "0.5", "-q"];
        place.run(&[&RUN[..], &baseline].concat())
    };
    // Eight tiny frames on a shared machine have large noise: the baselines' values are far away on either side.
    let ratios = |report: &mut Value, fast: Option<usize>| {
        let rows = report["rows"].as_array_mut().expect("rows");
        for (n, row) in rows.iter_mut().enumerate() {
            let times = if fast == Some(n) { 1e-6 } else { 1e6 };
            row["floor_ratio"] = times.into();
            for run in row["runs"].as_array_mut().expect("runs") {
                for time in run["frame_ms"].as_array_mut().expect("times") {
                    *time = (time.as_f64().expect("a time") * times).into();
                }
            }
        }
    };
    changed(&place, "slow.json", &report, |report| ratios(report, None));
    let faster = against("slow.json");
    assert_eq!(faster.status.code(), Some(0), "{}", words(&faster));
    assert!(String::from_utf8_lossy(&faster.stdout).contains("against the baseline"));
    changed(&place, "fast.json", &report, |report| {
        ratios(report, Some(5))
    });
    let slower = against("fast.json");
    assert_eq!(slower.status.code(), Some(3), "{}", words(&slower));
    let said = words(&slower);
    assert!(
        said.contains("1 of 24 rows") && said.contains("1000 km, equatorial"),
        "{said}"
    );
    assert!(String::from_utf8_lossy(&slower.stdout).contains("SLOWER"));

    rejects_others(&place, &report);
}

/// The contract with programs that read the file.
fn holds_the_keys(report: &Value) {
    let expected = [
        "version",
        "partial",
        "date",
        "arguments",
        "commit",
        "adapter",
        "backend",
        "driver",
        "cpu",
        "os",
        "size",
        "samples",
        "frames",
        "repeats",
        "scene",
        "floor_ms",
        "clear_ms",
        "rows",
        "features",
        "unmeasured",
    ];
    assert_eq!(keys(report), expected);
    assert_eq!(report["size"], serde_json::json!([64, 36]));
    assert_eq!(report["partial"], false);
    let rows = report["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 24);
    for row in rows {
        let expected = [
            "height_km",
            "path",
            "blocks_visible",
            "blocks_drawn",
            "blocks_paper_rule",
            "blocks_exact",
            "blocks_lost",
            "blocks_lost_paper_rule",
            "levels",
            "triangles",
            "draw_calls",
            "uploaded_bytes",
            "prepare_ms",
            "gpu_ms",
            "frame_ms",
            "jank_ms",
            "floor_ms",
            "clear_ms",
            "floor_ratio",
            "floor_ratio_spread",
            "frames_per_s",
            "paper_frames_per_s",
            "runs",
        ];
        assert_eq!(keys(row), expected);
        let runs = row["runs"].as_array().expect("runs");
        assert_eq!(runs.len(), 2);
        for run in runs {
            let times = ["prepare_ms", "frame_ms", "floor_ms", "clear_ms"];
            assert_eq!(keys(run), times);
            assert!(
                times
                    .iter()
                    .all(|key| run[key].as_array().map(Vec::len) == Some(8))
            );
        }
        assert!(row["floor_ratio_spread"].as_f64() >= Some(0.0));
        // Sixteen frames: too few for either.
        assert_eq!(row["frame_ms"]["p95"], Value::Null);
        assert_eq!(row["frame_ms"]["p99"], Value::Null);
        assert_eq!(keys(&row["prepare_ms"]), ["median", "p95", "p99"]);
        assert_eq!(keys(&row["frame_ms"]), ["median", "p95", "p99"]);
        let passes = keys(&row["gpu_ms"]);
        let drawn = ["air", "development", "surface"];
        assert!(passes.is_empty() || passes == drawn, "{row}");
    }
    for feature in report["features"].as_array().expect("features") {
        let expected = [
            "name",
            "course",
            "frame_ms_with",
            "frame_ms_without",
            "frame_ratio",
            "frame_ratio_spread",
            "texture_bytes",
            "shader_bytes",
            "runs",
        ];
        assert_eq!(keys(feature), expected);
    }
}

/// A baseline of something else is rejected with the difference, and before anything is measured.
fn rejects_others(place: &Place, report: &Value) {
    let adapter = report["adapter"].as_str().expect("a name");
    changed(place, "adapter.json", report, |report| {
        report["adapter"] = "Another \u{1b}[31madapter".into();
    });
    changed(place, "maps.json", report, |report| {
        report["scene"]["maps"] = "day 2x1".into();
    });
    changed(place, "key.json", report, |report| {
        report["scene"]["colour"] = "red".into();
    });
    place.scene(
        "wide.toml",
        &SMALL.replace("lat_deg", "fov_deg = 60\nlat_deg"),
    );
    let run = |scene: &'static str, baseline: &'static str, more: &[&'static str]| {
        let given = [
            "-q",
            "bench",
            scene,
            "--baseline",
            baseline,
            "--json",
            "b.json",
        ];
        let frames: &[_] = if more.contains(&"--frames") {
            &[]
        } else {
            &["--frames", "8"]
        };
        place.fail(1, &[&given[..], frames, more].concat())
    };
    for (words, must_say) in [
        (
            run("small.toml", "adapter.json", &[]),
            &[adapter, "Another"][..],
        ),
        (run("small.toml", "maps.json", &[]), &["maps", "day 2x1"]),
        (run("small.toml", "key.json", &[]), &["colour", "red"]),
        (
            run("small.toml", "a.json", &["--size", "32x18"]),
            &["64 × 36", "32 × 18"],
        ),
        (
            run("small.toml", "a.json", &["--frames", "3"]),
            &["frames is 8 there and 3 here"],
        ),
        (run("wide.toml", "a.json", &[]), &["fov_deg", "45", "60"]),
    ] {
        for word in must_say {
            assert!(words.contains(word), "no {word:?} in: {words}");
        }
        assert!(!words.contains('\u{1b}'), "{words:?}");
    }
    assert!(!place.path("b.json").exists());
}

#[test]
fn what_cannot_be_written_or_read_is_reported_before_measuring() {
    let place = Place::new();
    place.scene("a_file", "");
    place.scene("garbage.json", "not a report");
    place.scene("other.json", "{\"adapter\": \"x\"}");
    place.scene("old.json", "{\"version\": 1, \"adapter\": \"x\"}");
    let large = std::fs::File::create(place.path("large.json")).expect("makes");
    large.set_len(65 << 20).expect("grows");
    let before = place.names();
    // The requested adapter does not exist: another error shows that the file was checked first.
    let adapter = ["--adapter", "no such adapter"];
    for (arguments, must_say) in [
        (["--json", "missing/a.json"], "no such adapter"),
        (["--json", "a.csv"], "a.json"),
        (["--csv", "a_file/a.csv"], "a_file"),
        (["--csv", "."], "folder"),
        (["--plots", "a_file"], "a_file"),
        (["--baseline", "missing.json"], "missing.json"),
        (["--baseline", "."], "cannot be read"),
        (["--baseline", "garbage.json"], "line 1 column"),
        (["--baseline", "other.json"], "--json"),
        (["--baseline", "old.json"], "version 1"),
        (["--baseline", "large.json"], "larger than"),
        (["--repeats", "100"], "no such adapter"),
        (["--csv", "a.csv"], "no such adapter"),
    ] {
        let begin = Instant::now();
        let words = place.fail(1, &[&RUN[..], &arguments, &adapter].concat());
        assert!(words.contains(must_say), "{arguments:?}: {words}");
        assert!(begin.elapsed() < Duration::from_secs(5), "{arguments:?}");
    }
    let many = ["bench", "small.toml", "--frames", "10000", "--repeats", "2"];
    let words = place.fail(1, &[&many[..], &adapter].concat());
    assert!(words.contains("fewer --frames or --repeats"), "{words}");
    assert_eq!(place.names(), before);
}

#[test]
fn a_bad_scene_is_2() {
    let place = Place::new();
    place.scene("wrong.toml", "[camera]\nfov_deg = 180\n");
    let words = place.fail(2, &["bench", "wrong.toml", "--json", "a.json"]);
    assert!(words.contains("wrong.toml:2: [camera] fov_deg"), "{words}");
    assert_eq!(place.names(), ["small.toml", "wrong.toml"]);
}

/// Stopped by Ctrl-C after a row: the files have the complete rows, are marked as partial, and cannot be a baseline.
#[cfg(unix)]
#[test]
fn a_run_that_is_interrupted_keeps_its_complete_rows() {
    let place = Place::new();
    let arguments = [
        "bench",
        "small.toml",
        "-v",
        "--frames",
        "100",
        "--json",
        "a.json",
        "--csv",
        "a.csv",
        "--plots",
        "plots",
    ];
    let mut child = place
        .command(&arguments)
        .stderr(std::process::Stdio::piped())
        .stdout(std::process::Stdio::piped())
        .spawn()
        .expect("starts");
    let mut said = BufReader::new(child.stderr.take().expect("piped"));
    let mut line = String::new();
    while !line.contains("x its floor") {
        line.clear();
        assert!(
            said.read_line(&mut line).expect("reads") > 0,
            "it ended by itself"
        );
    }
    let sent = std::process::Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(sent.expect("kill starts").success());
    let mut rest = String::new();
    said.read_to_string(&mut rest).expect("reads");
    let output = child.wait_with_output().expect("ends");
    assert_eq!(output.status.code(), Some(130), "{rest}");
    assert!(rest.contains("interrupted after"), "{rest}");
    assert!(String::from_utf8_lossy(&output.stdout).contains("INTERRUPTED"));
    let report = json(&place, "a.json");
    assert_eq!(report["partial"], true);
    let rows = report["rows"].as_array().expect("rows").len();
    assert!((1..24).contains(&rows), "{rows}");
    let csv = std::fs::read_to_string(place.path("a.csv")).expect("reads");
    assert_eq!(csv.lines().count(), 1 + rows);
    assert_eq!(place.names(), ["a.csv", "a.json", "plots", "small.toml"]);
    let words = place.fail(1, &["bench", "small.toml", "--baseline", "a.json"]);
    assert!(words.contains("interrupted"), "{words}");
}
