//! Imagery packs from maps to pictures: built, verified, drawn in both storages; damaged and unfinished ones.

use crate::{Place, png_size, words};
use image::{ImageBuffer, Luma, Rgb, RgbImage};
use std::path::PathBuf;
use terrella_measure::bench::{BenchReport, BenchRow};
use terrella_play::PictureStats;

/// A place with a pack of a map with coasts and waves, in both storages.
pub fn with_pack() -> Place {
    let place = Place::new();
    let map = RgbImage::from_fn(1024, 512, |x, y| {
        let (a, b) = (f64::from(x) / 1024.0, f64::from(y) / 512.0);
        let wave = |angle: f64| (128.0 + 90.0 * angle.sin()) as u8;
        let (a, b) = (a * std::f64::consts::TAU, b * std::f64::consts::PI);
        Rgb([
            wave(23.0 * a),
            wave(17.0 * b),
            if (7.0 * a + 5.0 * b).sin() > 0.0 {
                180
            } else {
                60
            },
        ])
    });
    map.save(place.path("day.png")).expect("writes");
    place.succeed(&[
        "--quiet",
        "pack",
        "build",
        "--day",
        "day.png",
        "--pixels",
        "day=64,32,16",
        "-o",
        "earth",
    ]);
    place
}

fn scene(place: &Place, name: &str, earth: &str) {
    let text = format!(
        "[camera]\nmode = \"geodetic\"\nlat_deg = 22.5\nlon_deg = 45\nheight_km = 3000\n\
         [time]\nstart = \"2018-03-20T09:00:00Z\"\nduration_s = 2\nspeed = 10\nframe_rate_hz = 10\n\
         [earth]\npack = \"earth\"\natmosphere = \"none\"\n{earth}\n[output]\nsize = [160, 90]\ntone = \"neutral\"\n"
    );
    place.scene(name, &text);
}

fn stats(place: &Place, name: &str) -> PictureStats {
    let text = std::fs::read_to_string(place.path(name)).expect("numbers");
    serde_json::from_str(&text).expect("the numbers of a picture")
}

/// A tile that the scene's picture shows, of one storage, at the finest level.
fn shown_tile(place: &Place, storage: &str) -> PathBuf {
    place.path(&format!("earth/tiles/{storage}/day/64/r3c10.ktx2"))
}

#[test]
fn a_pack_is_built_verified_shown_and_drawn_alike_in_both_storages() {
    let place = with_pack();
    let reported = place.succeed(&["pack", "info", "earth"]);
    let reported = String::from_utf8_lossy(&reported.stdout).into_owned();
    assert!(
        reported.contains("day.png") && reported.contains("64"),
        "{reported}"
    );
    place.succeed(&["--quiet", "pack", "verify", "earth"]);
    place.succeed(&["pack", "preview", "earth", "-o", "sheet.png"]);
    assert!(png_size(&place.path("sheet.png")).0 > 100);

    let mut pictures = Vec::new();
    for storage in ["plain", "bc", "auto"] {
        let name = format!("{storage}.toml");
        scene(&place, &name, &format!("storage = \"{storage}\""));
        let (png, json) = (format!("{storage}.png"), format!("{storage}.json"));
        place.succeed(&["--quiet", "frame", &name, "-o", &png, "--stats", &json]);
        let tiles = stats(&place, &json).tiles.expect("numbers of tiles");
        assert!(
            tiles.hits > 0 && tiles.fallbacks == 0 && tiles.missing.is_empty(),
            "{tiles:?}"
        );
        assert!(
            tiles.wanted[0] > 0 && tiles.resident[0] >= tiles.wanted[0],
            "{tiles:?}"
        );
        pictures.push(image::open(place.path(&png)).expect("a picture").to_rgb8());
    }
    let (worst, mean) = difference(&pictures[0], &pictures[1]);
    println!("plain against bc: worst {worst}, mean {mean:.3} of 255");
    assert!(
        worst > 0,
        "the storages must differ, or one of them was not read"
    );
    // Edges of unlike colours are what 4 × 4 blocks hold worst.
    assert!(mean < 2.5 && worst < 40, "{worst} {mean}");
    // The tests draw on a software adapter where there is one: it takes the plain tiles by itself.
    assert!(difference(&pictures[0], &pictures[2]).1 < 1.0);
}

fn difference(a: &RgbImage, b: &RgbImage) -> (u8, f64) {
    let off = || a.iter().zip(b.iter()).map(|(a, b)| a.abs_diff(*b));
    let sum: f64 = off().map(f64::from).sum();
    (off().max().unwrap_or(0), sum / a.len() as f64)
}

#[test]
fn a_damaged_tile_is_named_and_the_picture_is_drawn_coarser_there() {
    let place = with_pack();
    scene(&place, "a.toml", "storage = \"plain\"");
    let good = ["--quiet", "frame", "a.toml", "-o", "good.png"];
    place.succeed(&good);
    let tile = shown_tile(&place, "plain");
    let mut bytes = std::fs::read(&tile).expect("a tile");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(&tile, &bytes).expect("writes");

    let output = place.run(&["--quiet", "pack", "verify", "earth"]);
    assert_eq!(output.status.code(), Some(1));
    let reported = words(&output) + &String::from_utf8_lossy(&output.stdout);
    assert!(
        reported.contains("tiles/plain/day/64/r3c10.ktx2"),
        "{reported}"
    );

    let output = place.succeed(&["frame", "a.toml", "-o", "bad.png", "--stats", "bad.json"]);
    let reported = words(&output);
    assert!(
        reported.contains("r3c10") && reported.contains("pack verify"),
        "{reported}"
    );
    let tiles = stats(&place, "bad.json").tiles.expect("numbers of tiles");
    assert!(tiles.failures > 0 && tiles.fallbacks > 0, "{tiles:?}");
    let open = |name| image::open(place.path(name)).expect("a picture").to_rgb8();
    let (worst, mean) = difference(&open("good.png"), &open("bad.png"));
    assert!(worst > 4, "the block must be drawn with something else");
    // Coarser, not black and not of another place.
    assert!(mean < 8.0, "{mean}");

    // Gone altogether, and the next coarser one too.
    std::fs::remove_file(&tile).expect("removes");
    std::fs::remove_file(place.path("earth/tiles/plain/day/32/r3c10.ktx2")).expect("removes");
    let output = place.run(&["--quiet", "pack", "verify", "earth"]);
    assert_eq!(output.status.code(), Some(1));
    place.succeed(&["--quiet", "frame", "a.toml", "-o", "gone.png"]);
    assert!(difference(&open("good.png"), &open("gone.png")).1 < 16.0);
    // A film goes on too and lists what it lacks.
    let output = place.succeed(&["play", "a.toml", "--frames", "film"]);
    assert!(words(&output).contains("r3c10"), "{}", words(&output));
}

#[test]
fn a_coarsest_tile_that_is_damaged_is_replaced_by_finer_ones() {
    let place = with_pack();
    scene(&place, "a.toml", "levels = \"paper\"");
    std::fs::write(place.path("earth/tiles/plain/day/16/r3c10.ktx2"), b"KTX").expect("writes");
    let output = place.succeed(&["frame", "a.toml", "-o", "a.png"]);
    let reported = words(&output);
    assert!(
        reported.contains("r3c10") && reported.contains("finer"),
        "{reported}"
    );
}

#[test]
fn what_is_no_pack_is_rejected_with_advice() {
    let place = with_pack();
    scene(&place, "a.toml", "");
    let draw = ["frame", "a.toml", "-o", "a.png"];
    let manifest = place.path("earth/pack.toml");
    let text = std::fs::read_to_string(&manifest).expect("a manifest");

    std::fs::write(&manifest, text.replace("pixels = 64", "pixels = 65")).expect("writes");
    let reported = place.fail(1, &draw);
    assert!(reported.contains("pack.toml"), "{reported}");

    std::fs::remove_file(&manifest).expect("removes");
    let reported = place.fail(1, &draw);
    assert!(reported.contains("pack build"), "{reported}");
    // Known before anything is drawn.
    assert_eq!(place.fail(1, &["check", "a.toml"]), reported);

    std::fs::write(&manifest, &text).expect("writes");
    scene(&place, "a.toml", "clouds = true");
    let reported = place.fail(2, &draw);
    assert!(
        reported.contains("a.toml:14") && reported.contains("clouds"),
        "{reported}"
    );

    place.succeed(&[
        "--quiet",
        "pack",
        "build",
        "--day",
        "day.png",
        "--pixels",
        "day=32,16",
        "--storage",
        "bc",
        "-o",
        "earth2",
    ]);
    let text = std::fs::read_to_string(place.path("a.toml")).expect("a scene");
    let text = text
        .replace("\"earth\"", "\"earth2\"")
        .replace("clouds = true", "");
    place.scene(
        "b.toml",
        &text.replace("atmosphere", "storage = \"plain\"\natmosphere"),
    );
    let reported = place.fail(2, &["frame", "b.toml", "-o", "a.png"]);
    assert!(reported.contains("only as bc"), "{reported}");
    // Without being forced it is decoded and drawn.
    place.scene("b.toml", &text);
    place.succeed(&["--quiet", "frame", "b.toml", "-o", "b.png"]);
    assert!(!place.names().contains(&"a.png".to_owned()));
}

#[test]
fn a_pack_without_time_to_read_it_is_drawn_coarse_and_said_so() {
    let place = with_pack();
    scene(&place, "a.toml", "");
    let text = std::fs::read_to_string(place.path("a.toml")).expect("a scene");
    place.scene("a.toml", &(text + "wait_s = 0\n"));
    let output = place.succeed(&["frame", "a.toml", "-o", "a.png", "--stats", "a.json"]);
    // The first frame cannot have a tile: none was requested before.
    assert!(words(&output).contains("wait_s"), "{}", words(&output));
    assert!(
        !stats(&place, "a.json")
            .tiles
            .expect("tiles")
            .missing
            .is_empty()
    );
}

/// Levels are counted, and each map and the tiles themselves are switched off one after another.
#[test]
fn a_pack_is_measured_with_its_levels() {
    let place = with_pack();
    scene(&place, "a.toml", "");
    place.succeed(&[
        "-q", "bench", "a.toml", "--frames", "1", "--size", "64x36", "--json", "a.json",
    ]);
    let text = std::fs::read_to_string(place.path("a.json")).expect("a report");
    let report: BenchReport = serde_json::from_str(&text).expect("a report");
    // Along the scene's flight and on both paths.
    let names: Vec<_> = report.features.iter().map(|f| f.name.as_str()).collect();
    let features = [
        "detail",
        "directional_reflectance",
        "eclipses",
        "tiles",
        "multisampling",
        "composition",
        "stars",
        "sun",
        "moon",
    ];
    let courses: Vec<_> = features.iter().flat_map(|name| [*name; 3]).collect();
    assert_eq!(names, courses);
    let tiles = &report.features[9];
    assert!(
        tiles.texture_bytes > 0 && tiles.shader_bytes > 0,
        "{tiles:?}"
    );
    assert_eq!(report.scene["maps"], "day 256x128");
    let most = |row: &BenchRow| row.levels.iter().sum::<u32>();
    for row in &report.rows {
        assert!(most(row) <= row.blocks_drawn, "{row:?}");
        assert!(row.levels.len() <= 3, "{row:?}");
    }
    // From far away the coarsest level suffices.
    let far = report.rows.iter().find(|row| row.height_km > 1e5);
    let far = far.expect("the Moon's distance");
    assert!(
        far.levels.len() == 3 && far.levels[..2] == [0, 0],
        "{far:?}"
    );
    assert!(report.rows.iter().map(most).max() > Some(20));
}

/// Writes the elevations of some mountains, 300 × 300 samples over 5.9° × 5.9°, whole metres from 0 to 6000 m; an elevation pack of 18 432 samples
/// around the Earth has samples at the same places.
fn mountains(place: &Place) {
    let heights: ImageBuffer<Luma<u16>, _> = ImageBuffer::from_fn(300, 300, |x, y| {
        let (x, y) = (f64::from(x), f64::from(y));
        let ridges = (x * 0.11).sin() * (y * 0.083).cos();
        Luma([(3000.0 * (1.0 + ridges)) as u16])
    });
    heights.save(place.path("alps.png")).expect("writes");
    let text = "bounds = { south_deg = 42.1875, north_deg = 48.046875, west_deg = 42.1875, east_deg = 48.046875 }\n\
                registration = \"cells\"\nunit = \"metres\"\n";
    std::fs::write(place.path("alps.toml"), text).expect("writes");
}

/// Terrain from a pack's elevation data equals that from the original file.
#[test]
fn heights_of_a_pack_are_drawn_as_those_of_their_file() {
    let place = Place::new();
    RgbImage::from_pixel(256, 128, Rgb([150, 140, 120]))
        .save(place.path("day.png"))
        .expect("writes");
    mountains(&place);
    let build = "--quiet pack build --day day.png --heights alps.png --pixels day=16 --storage plain -o earth";
    place.succeed(&build.split(' ').collect::<Vec<_>>());
    let mut pictures = Vec::new();
    for (name, ground) in [
        ("pack", "pack_heights = true"),
        ("file", "elevation = [\"alps.png\"]"),
        ("none", ""),
    ] {
        let text = format!(
            "[camera]\nmode = \"geodetic\"\nlat_deg = 43\nlon_deg = 45\nheight_km = 40\nheading_deg = 0\npitch_deg = -25\n\
             [time]\nstart = \"2018-03-20T05:00:00Z\"\nduration_s = 2\nspeed = 10\nframe_rate_hz = 10\n\
             [earth]\npack = \"earth\"\natmosphere = \"none\"\ndetail = false\n{ground}\n[output]\nsize = [256, 144]\n"
        );
        let (scene, png) = (format!("{name}.toml"), format!("{name}.png"));
        place.scene(&scene, &text);
        let output = place.succeed(&["frame", &scene, "-o", &png]);
        // All tiles were waited for.
        assert!(!words(&output).contains("wait_s"), "{}", words(&output));
        pictures.push(image::open(place.path(&png)).expect("a picture").to_rgb8());
    }
    let (worst, mean) = difference(&pictures[0], &pictures[1]);
    let (_, without) = difference(&pictures[0], &pictures[2]);
    println!(
        "pack against file: worst {worst}, mean {mean:.4}; against none: mean {without:.2} of 255"
    );
    // Triangles differ: coarser elevations of a pack are means of the finer ones, those of a file are also smoothed.
    assert!(mean < 1.5, "worst {worst}, mean {mean}");
    assert!(without > 5.0, "{without}");
}

#[test]
fn a_scene_that_wants_heights_of_a_pack_without_is_rejected() {
    let place = with_pack();
    scene(
        &place,
        "a.toml",
        "surface = \"quadtree\"\npack_heights = true",
    );
    let reported = place.fail(2, &["frame", "a.toml", "-o", "a.png"]);
    for word in [
        "a.toml:15: [earth] pack_heights: ",
        "the pack earth has no elevation data",
        "elevation = [",
        "--heights",
    ] {
        assert!(reported.contains(word), "{reported}");
    }
    // Known before anything is drawn.
    assert_eq!(place.fail(2, &["check", "a.toml"]), reported);
    assert!(!place.names().contains(&"a.png".to_owned()));
}
