//! `terrella access`: stations agree with `orbit --passes`, satellites with each other, layouts with each other.

use crate::{Place, SMALL, words};

const SCENE: &str = "[time]\nstart = \"2018-01-20T00:00:00Z\"\nduration_s = 1800\n[[orbit]]\n[[orbit]]\n\
                     name = \"polar\"\nsource = \"kepler\"\nsemi_major_axis_km = 7200\ninclination_deg = 98\n\
                     [[station]]\nname = \"Vienna\"\nlat_deg = 48.2\nlon_deg = 16.4\nheight_m = 170\nmin_elevation_deg = 20\n";

#[test]
fn accesses_are_passes_and_the_same_in_every_layout() {
    let place = Place::new();
    place.scene("a.toml", SCENE);
    let ask = |more: &[&str]| {
        let asked = ["access", "a.toml", "--days", "1"];
        place.printed(&[&asked[..], more].concat())
    };
    let csv = ask(&["--crosslinks", "--csv"]);
    let rows: Vec<Vec<&str>> = csv
        .lines()
        .skip(1)
        .map(|row| row.split(',').collect())
        .collect();
    let of = |from: &str, to: &str| rows.iter().filter(|row| row[..2] == [from, to]).count();
    let counts = [
        of("Vienna", "ISS (ZARYA)"),
        of("Vienna", "polar"),
        of("ISS (ZARYA)", "polar"),
    ];
    assert!(counts.iter().all(|count| *count > 1), "{csv}");
    assert_eq!(counts.iter().sum::<usize>(), rows.len());

    let passes = place.printed(&[
        "orbit",
        "a.toml",
        "--passes",
        "48.2,16.4,170",
        "--min-elevation",
        "20",
        "--days",
        "1",
        "--satellite",
        "ISS (ZARYA)",
        "--csv",
    ]);
    let passes: Vec<_> = passes.lines().skip(1).collect();
    assert_eq!(passes.len(), counts[0], "{passes:?}");
    let second = |utc: &str| utc[..19].to_owned();
    for (row, pass) in rows.iter().zip(passes) {
        let begin = pass.split(',').nth(1).expect("a time");
        assert_eq!(second(row[2]), second(begin));
    }

    let json: serde_json::Value =
        serde_json::from_str(&ask(&["--crosslinks", "--json"])).expect("JSON");
    let tables = json.as_array().expect("three tables");
    let listed = tables
        .iter()
        .map(|table| table["accesses"].as_array().map_or(0, Vec::len));
    assert_eq!(listed.collect::<Vec<_>>(), counts);
    let text = ask(&[]);
    for row in rows.iter().filter(|row| row[0] == "Vienna") {
        assert!(text.contains(row[2]) && text.contains(row[4]), "{text}");
    }
    assert!(!text.contains("ISS (ZARYA) to polar"), "{text}");

    // Fewer accesses with a limited range and in sunlight; none without stations.
    let near = ask(&["--max-range", "700", "--sunlit", "--csv"]);
    assert!(near.lines().count() - 1 < counts[0] + counts[1], "{near}");
    place.scene(
        "b.toml",
        &SCENE[..SCENE.find("[[station]]").expect("there")],
    );
    let output = place.run(&["access", "b.toml"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        words(&output).contains("give --crosslinks"),
        "{}",
        words(&output)
    );
}

/// A file of elements has no tables: stations come from the command line.
#[test]
fn places_of_the_command_line_are_stations() {
    let place = Place::new();
    let tle = format!("{}/config/orbits/iss.tle", crate::REPOSITORY);
    let reported = place.fail(2, &["access", &tle]);
    for remedy in ["--place LAT,LON,NAME", "[[station]]", "--crosslinks"] {
        assert!(reported.contains(remedy), "{reported}");
    }
    let ask = |more: &[&str]| {
        let asked = ["access", &tle, "--days", "1"];
        place.printed(&[&asked[..], more].concat())
    };
    let two = ["--place", "48.2,16.4,170,Vienna", "--place", "-33.5,-70.25"];
    let text = ask(&two);
    for head in [
        "Vienna to ISS (ZARYA), more than 5° above",
        "-33.5,-70.25 to ISS (ZARYA), more",
    ] {
        assert!(text.contains(head), "{text}");
    }
    let json = ask(&[&two[..2], &["--min-elevation", "20", "--json"]].concat());
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(json["min_elevation_deg"], 20.0);
    // As a table of the scene.
    place.scene("a.toml", SCENE);
    let of_scene = place.printed(&[
        "access",
        "a.toml",
        "--satellite",
        "ISS (ZARYA)",
        "--days",
        "1",
        "--csv",
    ]);
    let of_place = place.printed(&[
        "access",
        "a.toml",
        "--satellite",
        "ISS (ZARYA)",
        "--days",
        "1",
        "--csv",
        "--place",
        "48.2,16.4,170,Again",
        "--min-elevation",
        "20",
    ]);
    let of = |text: &str, name: &str| -> Vec<String> {
        let rows = text.lines().filter(|row| row.starts_with(name));
        rows.filter_map(|row| Some(row.split_once(',')?.1.to_owned()))
            .collect()
    };
    assert!(!of(&of_scene, "Vienna,").is_empty());
    assert_eq!(of(&of_scene, "Vienna,"), of(&of_place, "Again,"));
    for bad in ["91,0,Vienna", "48.2", "48.2,16.4,", "48.2,16.4,1e9,High"] {
        let reported = place.fail(2, &["access", &tle, "--place", bad]);
        assert!(reported.contains("--place"), "{reported}");
    }
    place.fail(2, &["access", &tle, "--min-elevation", "5"]);
}

/// The table has the numbers of the cells, and a scene draws the map.
#[test]
fn coverage_is_printed_by_latitude_and_by_cell_and_drawn() {
    let place = Place::new();
    place.scene("a.toml", SCENE);
    let ask = |more: &[&str]| {
        let asked = [
            "coverage",
            "a.toml",
            "--days",
            "0.25",
            "--step",
            "15",
            "--min-elevation",
            "10",
        ];
        place.printed(&[&asked[..], more].concat())
    };
    let csv = ask(&["--csv"]);
    let rows: Vec<Vec<f64>> = csv
        .lines()
        .skip(1)
        .map(|row| {
            row.split(',')
                .map(|n| n.parse().unwrap_or(f64::NAN))
                .collect()
        })
        .collect();
    assert!(rows.len() > 100, "{csv}");
    let text = ask(&[
        "--geojson",
        "map.geojson",
        "--satellite",
        "polar",
        "--satellite",
        "ISS (ZARYA)",
    ]);
    let (mut seen, mut all) = (0.0, 0.0);
    for row in &rows {
        let weight = row[0].to_radians().cos() * 360.0 / count_beside(&rows, row[0]);
        all += weight;
        seen += if row[2] > 0.0 { weight } else { 0.0 };
        assert!(
            row[3] + row[4] <= 21_600.1 && (row[2] > 0.0 || row[4] == 21_600.0),
            "{row:?}"
        );
    }
    let last = text.lines().next_back().expect("a row");
    assert!(
        last.contains(&format!("{:.1} %", 100.0 * seen / all)),
        "{last} {seen} {all}"
    );

    let map = std::fs::read_to_string(place.path("map.geojson")).expect("written");
    let map: serde_json::Value = serde_json::from_str(&map).expect("JSON");
    let cells = map["features"].as_array().expect("features");
    assert_eq!(cells.len(), rows.iter().filter(|row| row[2] > 0.0).count());
    let table = "[[geojson]]\nfile = \"map.geojson\"\n";
    place.scene("map.toml", &format!("{SMALL}{table}"));
    let check = place.succeed(&["check", "--strict", "map.toml"]);
    assert!(
        !words(&check).contains("map.geojson: "),
        "{}",
        words(&check)
    );
}

/// Cells of a row.
fn count_beside(rows: &[Vec<f64>], lat_deg: f64) -> f64 {
    rows.iter().filter(|row| row[0] == lat_deg).count() as f64
}
