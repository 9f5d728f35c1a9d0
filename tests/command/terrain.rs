//! `terrella terrain`: its tables.

use crate::{Place, names, png_size, words};
use std::process::Output;

/// Small and without drawing it in more than a moment.
const MADE: &[&str] = &["terrain", "--fractal", "129", "--tolerances", "20"];

fn with<'a>(more: &[&'a str]) -> Vec<&'a str> {
    MADE.iter().chain(more).copied().collect()
}

/// The table that begins with this, up to the next empty line.
fn table(output: &Output, head: &str) -> String {
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let from = text
        .find(head)
        .unwrap_or_else(|| panic!("no {head}: {text}"));
    text[from..]
        .split("\n\n")
        .next()
        .expect("a part")
        .to_owned()
}

const STORAGE: &str = "ground,size,\"tolerance, m\",raw";

#[test]
fn the_tables_say_what_is_asked_for() {
    let place = Place::new();
    let output = place.succeed(&with(&["--threads", "1,3", "--output", "out", "--csv"]));
    let said = words(&output);
    assert!(said.is_empty(), "{said}");
    let storage = table(&output, STORAGE);
    let row: Vec<_> = storage.lines().nth(1).expect("a row").split(',').collect();
    // Ground, size, tolerance, and two bytes a sample.
    assert_eq!(row[..4], ["made-1", "129x129", "20", "33282"]);
    let number = |k: usize| row[k].parse::<f64>().expect("a number");
    assert!(number(4) < 33_282.0 && number(5) > 0.0 && number(6) > 0.0);
    // A contour's middle, and a patch, are off by the tolerance at most where they end before single cells.
    assert!(number(8) <= 20.0, "{row:?}");
    let builds = table(&output, "ground,size,tree");
    assert_eq!(builds.lines().count(), 4);
    assert!(
        builds.contains("\"1 thread, s\",\"3 threads, s\""),
        "{builds}"
    );
    assert_eq!(table(&output, "ground,size,order").lines().count(), 6);
    // q = 1 is the Bernstein basis itself: 10⁰.
    let condition = table(&output, "q,degree 1,degree 2");
    assert_eq!(condition.lines().count(), 14);
    let plain = format!("1e0{}", ",0.0".repeat(12));
    assert!(condition.lines().any(|line| line == plain), "{condition}");
    let files = ["builds.csv", "condition.csv", "lebesgue.csv", "orders.csv"];
    let out = names(&place.path("out"));
    for file in files.iter().chain(&["rates.csv", "storage.csv"]) {
        assert!(out.iter().any(|name| name == file), "no {file} in {out:?}");
    }
    let written = std::fs::read_to_string(place.path("out/storage.csv")).expect("reads");
    assert_eq!(written.trim_end(), storage);
    let rates = std::fs::read_to_string(place.path("out/rates.csv")).expect("reads");
    let row: Vec<_> = rates.lines().last().expect("a row").split(',').collect();
    let saved = |k: usize| row[k].parse::<f64>().expect("a number");
    assert!(0.0 <= saved(2) && saved(2) <= saved(3) && saved(3) <= saved(4) && saved(4) < 100.0);
    // With an adapter, which tests have: frames, and a picture of ground below a sky.
    assert!(
        row[10..]
            .iter()
            .all(|rate| rate.parse::<f64>().is_ok_and(|r| r > 0.0)),
        "{row:?}"
    );
    let picture = place.path("out/pictures/made-1.png");
    assert_eq!(png_size(&picture), (640, 480));
    let picture = image::open(picture).expect("reads").to_rgb8();
    assert_eq!(picture.get_pixel(320, 5).0, [0; 3]);
    assert!(picture.get_pixel(320, 470).0[0] > 20);
    // A table to read.
    let output = place.succeed(&with(&["-q"]));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        text.contains("| ground |") && text.contains("λ = 300"),
        "{text}"
    );
    assert_eq!(place.names(), ["out", "small.toml"]);
}

#[test]
fn bad_input_is_reported_before_anything_is_built() {
    let place = Place::new();
    for bad in [
        &["terrain"][..],
        &["terrain", "--fractal", "100"],
        &["terrain", "--fractal", "129", "--tolerances", "-1"],
        &["terrain", "--fractal", "129", "--tolerances", "5,nan"],
        &["terrain", "--fractal", "129", "--threads", "0"],
        &["terrain", "a.tif", "--seed", "3"],
        &["terrain", "a.tif", "--memory", "0"],
    ] {
        place.fail(2, bad);
    }
    let said = place.fail(2, &["terrain", "--fractal", "129", "--tolerances", "-1"]);
    assert!(
        said.contains("--tolerances") && said.contains("0 to 100000"),
        "{said}"
    );
    let said = place.fail(1, &["terrain", "missing.tif"]);
    assert!(said.contains("missing.tif"), "{said}");
    // A grid of NAD27 in place of WGS84: EPSG 4267 for 4326.
    let mut tiff = include_bytes!("../data/heights/gdal_u16.tif").to_vec();
    let code = tiff.windows(2).position(|two| two == [0xe6, 0x10]);
    let code = code.expect("the code of WGS84");
    tiff[code..code + 2].copy_from_slice(&4267u16.to_le_bytes());
    std::fs::write(place.path("nad27.tif"), tiff).expect("writes");
    let said = place.fail(1, &["terrain", "nad27.tif"]);
    assert!(
        said.contains("nad27.tif") && said.contains("gdalwarp"),
        "{said}"
    );
    // More than a quarter of the way round the Earth.
    for (name, bytes) in [
        (
            "globe.png",
            &include_bytes!("../data/heights/globe_u16.png")[..],
        ),
        (
            "globe.toml",
            include_bytes!("../data/heights/globe_u16.toml"),
        ),
    ] {
        std::fs::write(place.path(name), bytes).expect("writes");
    }
    let said = place.fail(1, &["terrain", "globe.png"]);
    assert!(
        said.contains("globe.png") && said.contains("gdal_translate"),
        "{said}"
    );
    let said = place.fail(1, &["terrain", "--fractal", "513", "--memory", "1"]);
    assert!(said.contains("made-1") && said.contains("allow"), "{said}");
}
