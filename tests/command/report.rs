//! `terrella report`: whole reports, partial ones, and rejections.

use crate::{Place, names, words};
use std::collections::HashMap;
use std::path::Path;
use std::process::{Command, Stdio};

const HEADER: &str = "method,parameter,value,height_km,frame_ms_median,floor_ratio,flip_mean,flip_p99,rmse_linear,\
                      silhouette_px,geolocation_m,geolocation_px,texels_per_px";

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The rows of the table; each must be whole.
fn rows(folder: &Path) -> Vec<Vec<String>> {
    let table = read(&folder.join("measurements.csv"));
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some(HEADER));
    let rows = lines.map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    let rows: Vec<_> = rows.collect();
    for row in &rows {
        assert_eq!(row.len(), 13, "{row:?}");
        for number in &row[3..] {
            assert!(number.parse::<f64>().is_ok(), "{row:?}");
        }
    }
    rows
}

#[test]
#[ignore = "a whole report; run by `.ci/run --always`, or by hand"]
fn a_report_has_its_table_charts_pictures_and_page() {
    let place = Place::new();
    let output = place.succeed(&[
        "report",
        "small.toml",
        "-o",
        "out",
        "--quick",
        "--size",
        "64x36",
        "--repeats",
        "2",
        "--samples",
        "1",
        "--heights",
        "1000,12000",
    ]);
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(said.contains("about") && said.contains("12000"), "{said}");
    assert!(!said.contains("PARTIAL"), "{said}");
    let folder = place.path("out");
    let expected = [
        "index.html",
        "measurements.csv",
        "methods.csv",
        "pictures",
        "plots",
        "spread.csv",
        "stability.csv",
    ];
    assert_eq!(names(&folder), expected);
    let rows = rows(&folder);
    let values = |parameter: &str| -> Vec<&str> {
        let of_it = rows
            .iter()
            .filter(|row| row[1] == parameter && row[3] == "12000");
        of_it.map(|row| row[2].as_str()).collect()
    };
    assert_eq!(values("scene"), ["as it is"]);
    assert_eq!(
        values("subdivision"),
        ["auto", "1", "3", "6", "12", "16", "24", "48"]
    );
    assert_eq!(values("visibility"), ["conservative", "paper"]);
    assert_eq!(values("picture_size"), ["32x18", "64x36"]);
    assert_eq!(values("shading"), ["sunlit", "paper"]);
    assert_eq!(values("atmosphere"), ["billboard", "none"]);
    // A mesh of one cell a block cannot draw the limb; the scene's does.
    let limb = |value: &str| -> f64 {
        let is_it =
            |row: &&Vec<String>| row[1] == "subdivision" && row[2] == value && row[3] == "1000";
        let row = rows.iter().find(is_it).expect("a row");
        row[9].parse().expect("a number")
    };
    assert!(
        limb("1") > 20.0 * limb("24"),
        "{} {}",
        limb("1"),
        limb("24")
    );
    assert_eq!(names(&folder.join("pictures")).len(), 6);
    let page = read(&folder.join("index.html"));
    for part in [
        "12000km_flip.png",
        "<svg",
        "limb",
        "Formulas",
        "measurements.csv",
    ] {
        assert!(page.contains(part), "{part} is not on the page");
    }
    for elsewhere in ["<script", "src=\"http", "href=\"http", "url("] {
        assert!(!page.contains(elsewhere), "{elsewhere} is on the page");
    }
    assert!(!page.contains("Partial"));
    // On a software adapter a sweep that cannot be is reported and not made up.
    if page.contains("llvmpipe") {
        assert!(page.contains("not available on this adapter"));
        assert!(values("anisotropy").is_empty());
    }
    // The same folder again: files are replaced, nothing is left over.
    let hidden = names(&folder.join("plots"));
    assert!(
        hidden.iter().all(|name| name.ends_with(".svg")),
        "{hidden:?}"
    );
}

/// Of a pack, tiles are drawn and compared with its finest maps.
#[test]
fn a_pack_is_reported_by_its_tiles() {
    let place = crate::packs::with_pack();
    let text = "[camera]\nmode = \"geodetic\"\nheight_km = 3000\n[earth]\npack = \"earth\"\natmosphere = \"none\"\n";
    place.scene("pack.toml", text);
    place.succeed(&[
        "report",
        "pack.toml",
        "-o",
        "out",
        "--quick",
        "--size",
        "96x54",
        "--repeats",
        "1",
        "--samples",
        "1",
        "--heights",
        "3000",
        "--sweeps",
        "tile_level",
    ]);
    let rows = rows(&place.path("out"));
    assert!(rows.iter().all(|row| row[1] != "texture_level"));
    let of = |value: &str, column: usize| -> f64 {
        let is_it = |row: &&Vec<String>| row[1] == "tile_level" && row[2] == value;
        let row = rows.iter().find(is_it).expect("a row");
        row[column].parse().expect("a number")
    };
    // Coarser tiles: fewer texels a pixel, farther from the truth.
    assert!(of("4 px", 12) < 0.5 * of("1 px", 12));
    assert!(of("4 px", 8) > 1.5 * of("1 px", 8));
}

/// Interrupted: complete rows stay, marked as partial.
#[cfg(unix)]
#[test]
fn an_interrupted_report_is_whole_rows_and_says_so() {
    use std::io::{BufRead, BufReader, Read};
    let place = Place::new();
    let arguments = [
        "report",
        "small.toml",
        "-o",
        "out",
        "--size",
        "96x54",
        "--repeats",
        "40",
        "--samples",
        "1",
    ];
    let mut child = place
        .command(&arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("starts");
    let mut stdout = BufReader::new(child.stdout.take().expect("piped"));
    // The estimate comes after the first row.
    let mut line = String::new();
    stdout.read_line(&mut line).expect("a line");
    assert!(line.contains("measurements"), "{line}");
    let sent = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(sent.expect("kill starts").success());
    let mut said = String::new();
    stdout.read_to_string(&mut said).expect("reads");
    let output = child.wait_with_output().expect("ends");
    assert_eq!(output.status.code(), Some(130), "{}", words(&output));
    assert!(
        words(&output).contains("interrupted after"),
        "{}",
        words(&output)
    );
    assert!(said.contains("PARTIAL"), "{said}");
    let rows = rows(&place.path("out"));
    assert!((1..200).contains(&rows.len()), "{} rows", rows.len());
    assert!(read(&place.path("out/index.html")).contains("Partial"));
    let left = names(&place.path("out"));
    assert!(left.iter().all(|name| !name.starts_with('.')), "{left:?}");
}

#[test]
fn what_cannot_be_reported_is_reported_before_drawing() {
    let place = Place::new();
    place.scene("a_file", "");
    place.scene("wrong.toml", "[camera]\nfov_deg = 180\n");
    let adapter = ["--adapter", "no such adapter"];
    for (code, arguments, must_say) in [
        (1, &["report", "small.toml", "-o", "a_file"][..], "a_file"),
        (1, &["report", "small.toml", "-o", "a_file/out"], "a_file"),
        (2, &["report", "wrong.toml", "-o", "out"], "wrong.toml:2"),
        (2, &["report", "missing.toml", "-o", "out"], "missing.toml"),
        (2, &["report", "small.toml"], "--output"),
        (
            2,
            &["report", "small.toml", "-o", "out", "--repeats", "0"],
            "--repeats",
        ),
        (
            2,
            &["report", "small.toml", "-o", "out", "--samples", "0"],
            "--samples",
        ),
        (
            2,
            &["report", "small.toml", "-o", "out", "--size", "0x9"],
            "width",
        ),
        (
            2,
            &["report", "small.toml", "-o", "out", "--sweeps", "colour"],
            "must be one of subdivision",
        ),
        (
            2,
            &["report", "small.toml", "-o", "out", "--heights", "0.5"],
            "--heights",
        ),
        (
            2,
            &["report", "small.toml", "-o", "out", "--heights", "nan"],
            "--heights",
        ),
    ] {
        let words = place.fail(code, &[arguments, &adapter].concat());
        assert!(words.contains(must_say), "{arguments:?}: {words}");
    }
    assert_eq!(place.names(), ["a_file", "small.toml", "wrong.toml"]);
    // A folder that nothing can be made in; root may write anywhere.
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        std::fs::create_dir(place.path("shut")).expect("makes");
        let shut = std::fs::Permissions::from_mode(0o555);
        std::fs::set_permissions(place.path("shut"), shut).expect("sets");
        if std::fs::write(place.path("shut/try"), b"").is_err() {
            let arguments = ["report", "small.toml", "-o", "shut"];
            let words = place.fail(1, &[&arguments[..], &adapter].concat());
            assert!(words.contains("shut"), "{words}");
        }
    }
}

/// A table, by the names of its columns.
fn table(path: &Path) -> Vec<HashMap<String, String>> {
    let text = read(path);
    let mut lines = text.lines();
    let columns: Vec<_> = lines.next().expect("a header").split(',').collect();
    let row = |line: &str| {
        let fields: Vec<_> = line.split(',').map(str::to_owned).collect();
        assert_eq!(fields.len(), columns.len(), "{line}");
        columns.iter().map(|c| c.to_string()).zip(fields).collect()
    };
    lines.map(row).collect()
}

fn number(row: &HashMap<String, String>, column: &str) -> f64 {
    let text = row
        .get(column)
        .unwrap_or_else(|| panic!("no column {column}"));
    text.parse().unwrap_or_else(|_| panic!("{column}: {text}"))
}

#[test]
#[ignore = "a whole report; run by `.ci/run --always`, or by hand"]
fn surfaces_are_compared() {
    let place = Place::new();
    let of_all = [
        "report",
        "small.toml",
        "-o",
        "out",
        "--size",
        "64x36",
        "--surfaces",
        "--quick",
    ];
    let output = place.succeed(
        &[
            &of_all[..],
            &["--only", "blocks", "--flights", "low", "--places", "2"],
        ]
        .concat(),
    );
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(said.contains("globe, low flight: blocks"), "{said}");
    let folder = place.path("out");
    // Two terrains, as the scene names no elevation data.
    let errors = table(&folder.join("surfaces_errors.csv"));
    assert_eq!(errors.len(), 2);
    for row in &errors {
        // A quarter of a minute at 60 frames a second.
        assert_eq!((number(row, "frames"), number(row, "holes")), (900.0, 0.0));
        assert!(
            number(row, "error_px_most") >= number(row, "worst_frame_px"),
            "{row:?}"
        );
        assert!(
            number(row, "worst_frame_px") >= number(row, "error_px_p99"),
            "{row:?}"
        );
        assert!(
            (0.0..=100.0).contains(&number(row, "elsewhere_percent")),
            "{row:?}"
        );
        assert_eq!(row["reported_px_most"], "", "blocks know no bound");
    }
    let times = table(&folder.join("surfaces_times.csv"));
    assert_eq!(times.len(), 4, "each frame that was timed");
    for row in &times {
        // Blocks beside blocks.
        let ratio = number(row, "frame_ms") / number(row, "blocks_ms");
        assert!(
            (0.02..50.0).contains(&ratio) && number(row, "floor_ms") > 0.0,
            "{row:?}"
        );
    }
    assert_eq!(table(&folder.join("surfaces_settling.csv")).len(), 2);
    let page = read(&folder.join("surfaces.html"));
    assert!(
        page.contains("worst case, low flight")
            && page.contains(".svg")
            && page.contains("After a jump")
    );

    // Later measurements are added; repeated ones replace the old.
    let again = [
        "--parts",
        "errors",
        "--grounds",
        "worst case",
        "--flights",
        "low",
    ];
    place.succeed(&[&of_all[..], &again, &["--only", "blocks,projected-grid"]].concat());
    let both = table(&folder.join("surfaces_errors.csv"));
    assert_eq!(both.len(), 3);
    // Errors belong to the frames and not to the moment they were drawn in.
    let deterministic = |row: &HashMap<String, String>| -> Vec<(String, String)> {
        let mut fields: Vec<_> = row
            .clone()
            .into_iter()
            .filter(|(name, _)| !name.starts_with("prepare_ms"))
            .collect();
        fields.sort();
        fields
    };
    let (first, second) = (deterministic(&errors[1]), deterministic(&both[1]));
    assert_eq!(first, second);
    std::fs::write(
        folder.join("surfaces_errors.csv"),
        "data,path\nglobe,orbit\n",
    )
    .expect("written");
    let said = place.fail(1, &[&of_all[..], &again].concat());
    assert!(
        said.contains("surfaces_errors.csv in the output folder") && said.contains("move it away"),
        "{said}"
    );
}

#[test]
fn surfaces_that_there_are_not_are_rejected() {
    let place = Place::new();
    for (words, why) in [
        (&["--surfaces", "--only", "spheres"][..], "unknown surface"),
        (&["--only", "blocks"], "--surfaces"),
        (&["--surfaces", "--places", "0"], "0 is not in 1..=1000"),
        (
            &["--surfaces", "--parts", "all"],
            "one of errors, times, settling",
        ),
        (
            &["--surfaces", "--flights", "up"],
            "one of orbit, descent, low, horizon",
        ),
    ] {
        let mut all = vec!["report", "small.toml", "-o", "out"];
        all.extend(words);
        let said = place.fail(2, &all);
        assert!(said.contains(why), "{said}");
    }
}

#[test]
fn relief_is_left_out_with_a_word() {
    let place = Place::new();
    let scene = format!(
        "[camera]\nmode = \"geodetic\"\n[earth]\nclouds = false\nelevation = [\"{}/textures/elevation.png\"]\n[sky]\nstars = false\n",
        crate::REPOSITORY
    );
    place.scene("hills.toml", &scene);
    let output = place.succeed(&[
        "report",
        "hills.toml",
        "-o",
        "out",
        "--quick",
        "--size",
        "48x27",
        "--repeats",
        "1",
        "--samples",
        "1",
        "--heights",
        "1000",
        "--sweeps",
        "shading",
    ]);
    assert!(words(&output).contains("--surfaces"), "{}", words(&output));
    let page = read(&place.path("out/index.html"));
    assert!(page.contains("relief is left out"));
    let rows = rows(&place.path("out"));
    let settings: Vec<_> = rows.iter().map(|row| row[1].as_str()).collect();
    assert_eq!(settings, ["scene", "shading", "shading"]);
    // Formulas and extreme views are no settings of the scene.
    assert_eq!(read(&place.path("out/methods.csv")).lines().count(), 1);
}
