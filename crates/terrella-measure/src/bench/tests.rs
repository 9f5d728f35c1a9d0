use super::*;
use crate::{GroundPath, Quantiles};
use std::path::Path;

fn row(height_km: f64, floor_ratio: f64) -> BenchRow {
    let times = Quantiles {
        median: 2.0,
        p95: Some(3.0),
        p99: None,
    };
    // Frames that differ by a tenth, over a floor of one millisecond.
    let frames = |from: u32| -> Vec<f64> {
        (from..from + 24)
            .map(|n| floor_ratio * (1.0 + 0.004 * f64::from(n * 7 % 24)))
            .collect()
    };
    let run = |from: u32| RowTimes {
        prepare_ms: vec![0.1; 24],
        frame_ms: frames(from),
        floor_ms: vec![1.0; 24],
        clear_ms: vec![0.2; 24],
    };
    BenchRow {
        height_km,
        path: GroundPath::Inclined,
        blocks_visible: 6,
        blocks_drawn: 4,
        blocks_paper_rule: 5,
        blocks_exact: 6,
        blocks_lost: 0,
        blocks_lost_paper_rule: 1,
        levels: vec![1, 2],
        triangles: 290,
        draw_calls: 5,
        uploaded_bytes: 2700,
        prepare_ms: times,
        gpu_ms: [("surface".to_owned(), 1.5)].into(),
        frame_ms: times,
        jank_ms: 0.5,
        floor_ms: 1.0,
        clear_ms: 0.2,
        floor_ratio,
        floor_ratio_spread: Some(0.02),
        frames_per_s: 500.0,
        paper_frames_per_s: None,
        runs: vec![run(0), run(1), run(2)],
    }
}

fn report() -> BenchReport {
    let scene = [("fov_deg", "45"), ("maps", "day 64x32")];
    BenchReport {
        version: VERSION,
        partial: false,
        date: "2026-11-23T06:43:12Z".into(),
        arguments: vec!["bench".into(), "a.toml".into()],
        commit: "unknown".into(),
        adapter: "a card".into(),
        backend: "vulkan".into(),
        driver: "a driver 1.2".into(),
        cpu: "a processor, 2 processors".into(),
        os: "a system".into(),
        size: [64, 36],
        samples: 4,
        frames: 24,
        repeats: 3,
        scene: scene
            .map(|(key, value)| (key.to_owned(), value.to_owned()))
            .into(),
        floor_ms: 1.0,
        clear_ms: 0.2,
        rows: vec![row(100.0, 1.0), row(200.0, 2.0)],
        features: vec![Feature {
            name: "clouds".into(),
            course: Course::Inclined,
            frame_ms_with: 2.0,
            frame_ms_without: 1.8,
            frame_ratio: 1.1,
            frame_ratio_spread: None,
            texture_bytes: 2_800_000,
            shader_bytes: 338,
            runs: vec![FeatureTimes {
                with_ms: vec![2.0],
                without_ms: vec![1.8],
            }],
        }],
        unmeasured: vec![Unmeasured {
            name: "anisotropy".into(),
            why: "the adapter is software and ignores it".into(),
        }],
    }
}

/// The report as a file's text, read again.
fn load(text: &str) -> Result<Baseline, BenchError> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("old.json");
    std::fs::write(&path, text).expect("writes");
    Baseline::load(&path)
}

fn baseline(change: impl FnOnce(&mut BenchReport)) -> Baseline {
    let mut report = report();
    change(&mut report);
    load(&report.to_json()).expect("a good baseline")
}

#[test]
fn a_report_is_read_back_as_it_was_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.json");
    std::fs::write(&path, report().to_json()).expect("writes");
    assert_eq!(BenchReport::load(&path).expect("reads"), report());
}

#[test]
fn a_file_that_no_run_writes_is_rejected_with_the_reason() {
    let text = report().to_json();
    let with = |from: &str, to: &str| {
        assert!(text.contains(from), "{from} is not in {text}");
        text.replacen(from, to, 1)
    };
    for (bad, must_say) in [
        (String::new(), "EOF"),
        ("[]".into(), "line 1"),
        (text[..text.len() / 2].to_owned(), "EOF"),
        (with("\"version\": 2", "\"version\": 9"), "version 9"),
        // As earlier versions of the program wrote, without the times of single frames.
        (
            "{\"version\": 1, \"partial\": false, \"adapter\": \"a card\"}".into(),
            "its layout is version 1, this program's is 2",
        ),
        (
            with("\"partial\": false", "\"partial\": true"),
            "interrupted",
        ),
        (
            with("\"version\": 2", "\"version\": 2, \"colour\": 2"),
            "colour",
        ),
        (with("\"floor_ratio\": 1.0,", ""), "floor_ratio"),
        (
            with("\"floor_ratio\": 1.0", "\"floor_ratio\": -1.0"),
            "100 km, 51.6 deg",
        ),
        (
            with("\"floor_ratio\": 1.0", "\"floor_ratio\": 0.0"),
            "more than 0",
        ),
        (with("\"floor_ratio\": 1.0", "\"floor_ratio\": NaN"), "line"),
        (
            with("\"floor_ratio\": 1.0", "\"floor_ratio\": 1e999"),
            "out of range",
        ),
        (with("\"clear_ms\": 0.2", "\"clear_ms\": -0.2"), "clear_ms"),
        (with("\"jank_ms\": 0.5", "\"jank_ms\": -0.5"), "jank_ms"),
        (
            with("\"height_km\": 200.0", "\"height_km\": 100.0"),
            "two rows",
        ),
        (
            with("\"path\": \"inclined\"", "\"path\": \"straight\""),
            "straight",
        ),
        (with("\"size\"", "\"size\": [1, 2], \"size\""), "duplicate"),
        (
            with("\"runs\": [", "\"runs\": [], \"nothing\": ["),
            "nothing",
        ),
        (with("            0.1,\n", ""), "not as many"),
        (
            with("            0.1,\n", "            -0.1,\n"),
            "a time is -0.1",
        ),
        (" ".repeat((64 << 20) + 1), "larger than"),
        ("[".repeat(100_000), "line 1 column 1"),
    ] {
        let error = load(&bad).expect_err(must_say).to_string();
        assert!(error.contains(must_say), "{must_say}: {error}");
        assert!(
            error.contains("old.json") && error.contains("--json"),
            "{error}"
        );
    }
    let missing = Baseline::load(Path::new("no/such/file.json")).expect_err("missing");
    assert!(missing.to_string().contains("no/such/file.json"));
}

#[test]
fn a_baseline_of_something_else_is_rejected_with_the_difference() {
    type Spoil = fn(&mut BenchReport);
    let spoils: [(Spoil, &str); 9] = [
        (
            |r| r.adapter = "another".into(),
            "adapter is \"another\" there and \"a card\" here",
        ),
        (|r| r.backend = "gl".into(), "backend"),
        (|r| r.size = [64, 37], "64 × 37"),
        (|r| r.samples = 1, "samples"),
        (|r| r.frames = 25, "frames is 25 there and 24 here"),
        (
            |r| drop(r.scene.insert("fov_deg".into(), "46".into())),
            "fov_deg is \"46\"",
        ),
        (|r| drop(r.scene.remove("maps")), "\"not given\" there"),
        (
            |r| drop(r.scene.insert("new".into(), "1".into())),
            "\"not given\" here",
        ),
        (|r| drop(r.rows.pop()), "list of rows"),
    ];
    for (spoil, must_say) in spoils {
        let error = baseline(spoil).compare(&report(), 0.1).expect_err(must_say);
        let error = error.to_string();
        assert!(error.contains(must_say), "{must_say}: {error}");
    }
}

/// Settings that are unknown before the adapter is opened are not compared then.
#[test]
fn settings_are_compared_before_the_adapter_is_known() {
    let mut run = report();
    (run.adapter, run.backend, run.samples) = (String::new(), String::new(), 0);
    run.scene.remove("maps");
    run.rows.clear();
    let baseline = baseline(|_| {});
    baseline.check_settings(&run).expect("all the same so far");
    run.size = [1, 1];
    baseline.check_settings(&run).expect_err("another size");
}

/// The report with other ratios of its two rows.
fn report_of(ratios: [f64; 2]) -> BenchReport {
    BenchReport {
        rows: vec![row(100.0, ratios[0]), row(200.0, ratios[1])],
        ..report()
    }
}

#[test]
fn only_a_row_whose_whole_interval_is_slower_fails() {
    let verdict = |now: [f64; 2], effect: f64| {
        let compared = baseline(|_| {}).compare(&report_of(now), effect);
        compared.expect("the same rows").verdict()
    };
    verdict([1.0, 2.0], 0.0).expect("as it was");
    verdict([0.1, 0.1], 0.0).expect("faster is no failure");
    verdict([1.2, 2.4], 0.25).expect("a smaller effect than counts");
    // Frames differ by a tenth: 26 % more is not surely more than 25.
    verdict([1.26, 2.52], 0.25).expect("within the noise");
    let error = verdict([1.2, 2.6], 0.25).expect_err("30 % slower");
    assert!(error.is_slower() && !error.is_bad_scene());
    let words = error.to_string();
    for word in [
        "1 of 2 rows",
        "200 km, 51.6 deg",
        "+30 %",
        "25 %",
        "from 2.00 to 2.60",
    ] {
        assert!(words.contains(word), "no {word:?} in: {words}");
    }
    let both = verdict([2.0, 2.6], 0.25).expect_err("both slower");
    let both = both.to_string();
    assert!(
        both.contains("2 of 2 rows") && both.contains("100 km"),
        "{both}"
    );
}

#[test]
fn another_machine_and_few_runs_are_reported() {
    let same = baseline(|_| {}).notices(&report());
    assert!(same.is_empty(), "{same:?}");
    let notices = baseline(|r| {
        r.cpu = "another".into();
        r.driver = "a driver 1.3".into();
        r.repeats = 1;
    })
    .notices(&report());
    let words = notices.join("\n");
    assert_eq!(notices.len(), 3, "{words}");
    for word in ["\"another\"", "a driver 1.3", "1 and 3", "--repeats"] {
        assert!(words.contains(word), "no {word:?} in: {words}");
    }
}

#[test]
fn the_spread_of_runs_is_that_of_their_medians() {
    use super::report::{ratios, spread};
    let runs = [vec![1.0, 1.1, 9.0], vec![1.3, 1.2, 1.25]];
    let found = spread(&runs, 1.2).expect("two runs");
    assert!((found - (1.25 - 1.1) / 1.2).abs() < 1e-12, "{found}");
    assert_eq!(spread(&runs[..1], 1.2), None);
    assert_eq!(ratios(&[3.0, 8.0], &[2.0, 4.0]), [1.5, 2.0]);
    assert_eq!(row(1.0, 2.0).ratios().len(), 3);
}

#[test]
fn what_the_adapter_leaves_out_is_unmeasured() {
    let options = terrella::EarthOptions {
        anisotropy: 16,
        samples: 4,
        ..terrella::EarthOptions::new(terrella::EarthLayers {
            day: terrella::LayerImage::from_rgba8(2, 1, vec![0; 8]).expect("a map"),
            clouds: None,
            normals: None,
            night_lights: None,
            water: None,
        })
    };
    let names = |samples, is_software| -> Vec<String> {
        let all = super::features::unmeasured(&options, samples, is_software);
        all.into_iter().map(|one| one.name).collect()
    };
    assert_eq!(names(4, true), ["anisotropy"]);
    assert_eq!(names(1, false), ["multisampling"]);
    assert_eq!(names(4, false), [""; 0]);
}

#[test]
fn the_text_of_a_run_tells_headline_rows_and_costs() {
    let outcome = BenchRun {
        comparison: Some(baseline(|_| {}).compare(&report(), 0.25).expect("compares")),
        report: report(),
        notices: vec!["a notice".into()],
    };
    outcome.verdict().expect("as it was");
    let text = outcome.to_table();
    for word in [
        "worst 2.00 at 200 km, 51.6 deg",
        "clouds",
        "+10%",
        "338 B",
        "[1, 2]",
        "note: a notice",
        "baseline",
        "anisotropy     not measured: the adapter is software and ignores it",
        "24 frames a row in 3 runs",
        "a driver 1.2; a processor, 2 processors; a system; commit unknown",
    ] {
        assert!(text.contains(word), "no {word:?} in:\n{text}");
    }
    let mut partial = outcome.clone();
    partial.report.partial = true;
    partial.report.rows.clear();
    assert!(partial.to_table().contains("INTERRUPTED"));
    let error = partial.verdict().expect_err("partial").to_string();
    assert!(error.contains("0 of 24 rows"), "{error}");
}
