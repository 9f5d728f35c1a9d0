//! Elevation data from a pack, compared with that of the files.

use super::super::tests::stopped::{Failing, Stopping, contents};
use crate::{BuildError, BuildOptions, Division, build, build_with};
use image::{GrayImage, ImageBuffer, Luma};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicU32;
use tempfile::TempDir;
use terrella_ground::elevation::geoid::VerticalDatum;
use terrella_ground::elevation::{
    Elevation, GridLimits, Ground, HeightSamples, HeightTileKey, HeightTileSource, open_heights,
};
use terrella_imagery::pack::{HeightKind, Pack, PackHeights, verify};
use terrella_imagery::tile::{MapLayer, Storage};

/// Rolling ground of whole metres, −400…900 m, with its ridges at other places for each `salt`.
fn ground_m(column: u32, row: u32, salt: u32) -> u16 {
    let (x, y) = (f64::from(column + salt), f64::from(row));
    let wave = (x * 0.21).sin() * (y * 0.33).cos() + 0.3 * (x * 1.3 + y * 0.7).sin();
    (500.0 + 500.0 * wave) as u16
}

/// Writes a grey PNG of 16 bits and its sidecar.
fn write_heights(dir: &Path, name: &str, size: (u32, u32), place: &str) -> PathBuf {
    let image: ImageBuffer<Luma<u16>, _> =
        ImageBuffer::from_fn(size.0, size.1, |x, y| Luma([ground_m(x, y, size.0)]));
    let path = dir.join(format!("{name}.png"));
    image.save(&path).expect("writable");
    let text = format!(
        "unit = \"metres\"\noffset = -400.0\nattribution = \"who measured {name}\"\n{place}\n"
    );
    std::fs::write(dir.join(format!("{name}.toml")), text).expect("writable");
    path
}

/// A file of the whole Earth, 512 × 256, and one of 8° × 6° over the date line, thirteen times finer.
fn folder() -> (TempDir, Vec<PathBuf>) {
    let folder = day_folder();
    let globe = "bounds = { south_deg = -90, north_deg = 90, west_deg = -180, east_deg = 180 }\nregistration = \"cells\"";
    let inset = "bounds = { south_deg = -3, north_deg = 3, west_deg = 176, east_deg = 184 }\nregistration = \"cells\"";
    let paths = vec![
        write_heights(folder.path(), "globe", (512, 256), globe),
        write_heights(folder.path(), "inset", (152, 114), inset),
    ];
    (folder, paths)
}

/// A folder with a small day map, which every pack has.
pub(super) fn day_folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let day = folder.path().join("day.png");
    GrayImage::new(64, 32).save(day).expect("writable");
    folder
}

pub(super) fn options(dir: &Path, heights: &[PathBuf], out: &str) -> BuildOptions {
    BuildOptions {
        name: Some("heights".to_string()),
        heights: heights.to_vec(),
        storages: vec![Storage::Plain],
        pixels: vec![(MapLayer::Day, vec![16])],
        threads: Some(2),
        ..BuildOptions::new(dir.join("day.png"), dir.join(out))
    }
}

fn ground(paths: &[PathBuf]) -> Ground {
    let open = |path: &PathBuf| {
        open_heights(path, &GridLimits::default())
            .expect("good")
            .grid
    };
    Ground::new(paths.iter().map(|path| Arc::new(open(path))))
}

fn metres(samples: &HeightSamples) -> Vec<f64> {
    match samples {
        HeightSamples::F32(values) => values.iter().map(|value| f64::from(*value)).collect(),
        HeightSamples::I16 {
            values,
            offset_m,
            scale_m,
        } => {
            let metres = |value: &i16| offset_m + scale_m * f64::from(*value);
            values.iter().map(metres).collect()
        }
    }
}

fn read(tiles: &PackHeights, key: HeightTileKey) -> Vec<f64> {
    metres(&tiles.read(key, &|| false).expect("there"))
}

/// Keys of all tiles, the coarsest level first.
fn keys(tiles: &PackHeights) -> Vec<HeightTileKey> {
    let layout = tiles.layout();
    let mut keys = Vec::new();
    for level in (0..layout.levels()).rev() {
        for row in 0..layout.rows(level) {
            let of_row =
                (0..layout.columns(level)).map(|column| HeightTileKey { level, row, column });
            keys.extend(of_row.filter(|key| tiles.range_m(*key).is_some()));
        }
    }
    keys
}

/// Files that name no datum have the one that is given, others their own.
#[test]
fn a_vertical_datum_counts_where_files_name_none() {
    let folder = day_folder();
    let globe = "bounds = { south_deg = -90, north_deg = 90, west_deg = -180, east_deg = 180 }\nregistration = \"cells\"";
    let named = format!("{globe}\nabove = \"sea\"");
    let silent = [write_heights(folder.path(), "silent", (512, 256), globe)];
    let named = [write_heights(folder.path(), "named", (512, 256), &named)];
    let height_m = |paths: &[PathBuf], out: &str, above| {
        let options = BuildOptions {
            heights_above: above,
            ..options(folder.path(), paths, out)
        };
        build(&options, &()).unwrap_or_else(|error| panic!("{out}: {error}"));
        let tiles = Pack::open(&options.out).and_then(|pack| pack.height_tiles());
        let tiles = tiles.expect("a pack");
        let finest = *keys(&tiles).last().expect("tiles");
        (finest, read(&tiles, finest))
    };
    let (key, as_is) = height_m(&silent, "as-is", None);
    let ellipsoid = Some(VerticalDatum::Ellipsoid);
    let (_, held) = height_m(&silent, "held", ellipsoid);
    let (_, own) = height_m(&named, "own", ellipsoid);
    assert_eq!(as_is.len(), held.len());
    let lowered = as_is.iter().zip(&held).map(|(sea, above)| sea - above);
    let (least, most) = lowered.fold((f64::MAX, f64::MIN), |(least, most), by| {
        (least.min(by), most.max(by))
    });
    // The geoid is between 107 m below and 86 m above the ellipsoid, and varies over a tile.
    assert!(least > -108.0 && most < 87.0, "{key:?}: {least} to {most}");
    assert!(most - least > 1.0, "{key:?}: {least} to {most}");
    let most = as_is.iter().zip(&own).map(|(sea, own)| (sea - own).abs());
    assert!(most.fold(0.0, f64::max) < 0.1, "its own datum counts");
}

#[test]
fn samples_are_those_of_the_files_and_coarser_ones_their_means() {
    let (folder, paths) = folder();
    let options = options(folder.path(), &paths, "pack");
    let manifest = build(&options, &()).expect("builds");
    assert_eq!(manifest.format(), 2);
    assert_eq!(
        manifest.attribution,
        ["who measured globe", "who measured inset"]
    );
    let pack = Pack::open(&options.out).expect("a pack");
    assert_eq!(pack.manifest(), &manifest);
    let tiles = pack.height_tiles().expect("it has heights");
    let entry = tiles.entry();
    assert_eq!(
        entry.sources,
        ["globe.png, 512 x 256", "inset.png, 152 x 114"]
    );
    let HeightKind::I16 { scale_m, .. } = entry.kind else {
        panic!("whole metres need no floats");
    };
    // 6840 samples round the Earth, in two levels.
    assert_eq!((entry.levels, entry.side), (2, 214));
    let layout = tiles.layout();
    let (side, border, row) = (214, 1, layout.row_samples());
    let keys = keys(&tiles);
    // All of the coarsest; the finest only about the date line: 11.25° each.
    let finest: Vec<_> = keys.iter().filter(|key| key.level == 0).collect();
    assert_eq!((keys.len(), finest.len()), (128 + 4, 4));
    assert!(
        finest
            .iter()
            .all(|key| [0, 31].contains(&key.column) && [7, 8].contains(&key.row))
    );

    let ground = ground(&paths);
    let mut compared = [0_u32; 2];
    for key in &keys {
        let heights_m = read(&tiles, *key);
        let spacing_rad = layout.spacing_rad(key.level);
        let range = tiles.range_m(*key).expect("there");
        for (n, height_m) in heights_m.iter().enumerate() {
            assert!((range.low_m..=range.high_m).contains(height_m), "{key}");
            let [x, y] = [n % row, n / row].map(|at| at as i64 - border);
            if ![x, y].iter().all(|at| (0..side).contains(at)) {
                continue;
            }
            let quarter = (2 * y / side * 2 + 2 * x / side) as u32;
            let child = key
                .child(quarter)
                .filter(|child| tiles.range_m(*child).is_some());
            let expected_m = match child {
                // Means are compared below.
                Some(_) => continue,
                None => {
                    let column = i64::from(key.column) * side + x;
                    let row = i64::from(key.row) * side + y;
                    let lat_rad = std::f64::consts::FRAC_PI_2 - (row as f64 + 0.5) * spacing_rad;
                    let lon_rad = (column as f64 + 0.5) * spacing_rad - std::f64::consts::PI;
                    ground.height_m(lat_rad, lon_rad, spacing_rad)
                }
            };
            compared[usize::from(key.level)] += 1;
            assert!(
                (height_m - expected_m).abs() <= 0.5 * scale_m + 1e-9,
                "{key} {x} {y}: {height_m} for {expected_m}"
            );
        }
    }
    // Of the coarsest level everything except the quarters under the inset.
    assert_eq!(
        compared,
        [4 * 214 * 214, 124 * 214 * 214 + 4 * 3 * 107 * 107]
    );
    for child in finest {
        let parent = read(&tiles, child.parent());
        let finer = read(&tiles, *child);
        let [left, top] = [child.column % 2, child.row % 2].map(|at| at as usize * 107);
        for (y, x) in (0..107).flat_map(|y| (0..107).map(move |x| (y, x))) {
            let at = |dx: usize, dy: usize| finer[(2 * y + dy + 1) * row + 2 * x + dx + 1];
            let mean_m = 0.25 * (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1));
            let coarse_m = parent[(top + y + 1) * row + left + x + 1];
            assert!(
                (coarse_m - mean_m).abs() <= 0.5 * scale_m + 1e-9,
                "{child} {x} {y}"
            );
        }
        let (own, over) = (tiles.range_m(*child), tiles.range_m(child.parent()));
        let (own, over) = (own.expect("there"), over.expect("there"));
        assert!(
            over.low_m <= own.low_m && over.high_m >= own.high_m,
            "{child}"
        );
    }
}

/// To the last bit, round the date line, over the poles, and beside tiles that are partly means.
#[test]
fn borders_repeat_what_the_neighbours_hold() {
    let (folder, paths) = folder();
    let options = options(folder.path(), &paths, "pack");
    build(&options, &()).expect("builds");
    let tiles = Pack::open(&options.out).and_then(|pack| pack.height_tiles());
    let tiles = tiles.expect("heights");
    let layout = tiles.layout();
    let (side, row) = (layout.side() as usize, layout.row_samples());
    let mut shared = 0;
    for key in keys(&tiles) {
        let own = read(&tiles, key);
        for (east, south) in [(1, 0), (0, 1), (1, 1), (-1, 1)] {
            let Some(beside) = layout.beside(key, east, south) else {
                continue;
            };
            if tiles.range_m(beside).is_none() {
                continue;
            }
            shared += 1;
            let other = read(&tiles, beside);
            // Two samples deep, the border and the outermost own ones, wherever both have them.
            let overlap = |step: i32, at: usize| match step {
                1 => (at < 2).then_some((at + side, at)),
                -1 => (at < 2).then_some((at, at + side)),
                _ => Some((at, at)),
            };
            for y in 0..row {
                for x in 0..row {
                    let (Some((x, other_x)), Some((y, other_y))) =
                        (overlap(east, x), overlap(south, y))
                    else {
                        continue;
                    };
                    assert_eq!(
                        own[y * row + x],
                        other[other_y * row + other_x],
                        "{key} and {beside}"
                    );
                }
            }
        }
        if key.row == 0 {
            let opposite = layout.beside(key, layout.columns(key.level) as i32 / 2, 0);
            let other = read(&tiles, opposite.expect("half a turn away"));
            assert_eq!(own[..row], other[row..2 * row], "{key} over the pole");
        }
    }
    assert!(shared > 400, "{shared}");
}

#[test]
fn heights_that_are_stopped_go_on_to_the_same_bytes() {
    let (folder, paths) = folder();
    let whole = options(folder.path(), &paths, "whole");
    build(&whole, &()).expect("builds");
    let report = verify(&whole.out, |_, _| {}).expect("a pack");
    assert!(report.is_good() && report.stranger_count == 0, "{report:?}");
    assert_eq!(report.tiles, 128 + 132 + 1);
    let whole = contents(&whole.out);
    let stopped = options(folder.path(), &paths, "stopped");
    // The files are two steps, the finest tiles four.
    for steps in [1, 5, 60] {
        let error = build(&stopped, &Stopping(AtomicU32::new(steps))).expect_err("stopped");
        assert!(matches!(error, BuildError::Cancelled), "{error}");
        assert!(!stopped.out.join("pack.toml").exists());
    }
    let noted = std::fs::read_to_string(stopped.out.join("build.journal")).expect("a journal");
    assert!(noted.matches("\nheights 1 ").count() > 20, "{noted}");
    // One changed and one gone: both are made again, the others not.
    let tile = |name: &str| stopped.out.join(format!("heights/3424/r0/{name}.heights"));
    std::fs::write(tile("c0"), b"changed").expect("writable");
    std::fs::remove_file(tile("c1")).expect("there");
    let made = |path: &Path| std::fs::metadata(path).and_then(|known| known.modified());
    let before = made(&tile("c2")).expect("there");
    build(&stopped, &()).expect("goes on");
    assert_eq!(made(&tile("c2")).expect("there"), before);
    assert!(contents(&stopped.out) == whole);

    let full = options(folder.path(), &paths, "full");
    let error = build_with(&full, &(), &Failing::after(70), Division::default());
    assert!(matches!(error, Err(BuildError::Write { .. })));
    let one_thread = BuildOptions {
        threads: Some(1),
        ..full
    };
    build(&one_thread, &()).expect("goes on");
    assert!(contents(&one_thread.out) == whole);
    let restart = BuildOptions {
        heights: Vec::new(),
        restart: true,
        ..one_thread
    };
    build(&restart, &()).expect("builds again");
    assert!(!restart.out.join("heights").exists());
}

#[test]
fn damaged_heights_are_named() {
    let (folder, paths) = folder();
    let options = options(folder.path(), &paths[..1], "pack");
    build(&options, &()).expect("builds");
    let path = |name: &str| options.out.join("heights").join(name);
    let good = std::fs::read(path("512/r3/c9.heights")).expect("there");
    let key = HeightTileKey {
        level: 0,
        row: 3,
        column: 9,
    };
    let tiles = Pack::open(&options.out).and_then(|pack| pack.height_tiles());
    let tiles = tiles.expect("heights");
    for bad in [&good[..good.len() - 1], &[&good[..], b"x"].concat(), &[]] {
        std::fs::write(path("512/r3/c9.heights"), bad).expect("writable");
        let error = tiles.read(key, &|| false).expect_err("damaged").to_string();
        assert!(
            error.contains("r3/c9.heights") && error.contains("terrella pack verify"),
            "{error}"
        );
    }
    std::fs::write(path("512/r3/c10.strange"), b"x").expect("writable");
    let report = verify(&options.out, |_, _| {}).expect("a pack");
    assert_eq!(report.bad.len(), 1);
    assert_eq!(report.bad[0].path, Path::new("heights/512/r3/c9.heights"));
    assert_eq!(report.strangers, [Path::new("heights/512/r3/c10.strange")]);
    std::fs::write(path("512/r3/c9.heights"), &good).expect("writable");

    let index = std::fs::read(path("index.bin")).expect("there");
    let mut changed = index.clone();
    changed[100] ^= 1;
    for bad in [&index[..index.len() - 1], &changed] {
        std::fs::write(path("index.bin"), bad).expect("writable");
        let pack = Pack::open(&options.out).expect("the manifest is good");
        let error = pack.height_tiles().expect_err("damaged").to_string();
        assert!(
            error.contains("heights/index.bin: ") && error.contains("build the pack again"),
            "{error}"
        );
        let report = verify(&options.out, |_, _| {}).expect("a pack");
        assert_eq!(report.bad[0].path, Path::new("heights/index.bin"));
    }
    std::fs::remove_file(path("index.bin")).expect("there");
    let report = verify(&options.out, |_, _| {}).expect("a pack");
    assert_eq!(report.bad[0].cause, "it is missing");
}

#[test]
fn what_cannot_be_built_is_rejected_with_what_to_do() {
    let (folder, _) = folder();
    let rejected = |options: &BuildOptions, words: &[&str]| {
        let error = build(options, &()).expect_err("rejected").to_string();
        for word in words {
            assert!(error.contains(word), "{error}");
        }
    };
    let none = options(folder.path(), &[folder.path().join("none.tif")], "none");
    rejected(&none, &["none.tif"]);
    let day = options(folder.path(), &[folder.path().join("day.png")], "day");
    rejected(&day, &["day.png", "has no bounds"]);
    // Less than the program itself needs plus reading a file in parts.
    let globe = "bounds = { south_deg = -90, north_deg = 90, west_deg = -180, east_deg = 180 }\nregistration = \"cells\"";
    let large = write_heights(folder.path(), "large", (2048, 1024), globe);
    let large = BuildOptions {
        memory_bytes: 60_000_000,
        threads: Some(1),
        ..options(folder.path(), &[large], "large")
    };
    rejected(
        &large,
        &[
            "--memory 60: ",
            "large.png has 2048 x 1024 heights and needs 7",
            "MB at least to be read part by part",
            "gdal_translate -co TILED=YES",
        ],
    );
    assert!(!large.out.join("scratch").exists());
}

#[test]
fn a_folder_of_tiles_is_its_files() {
    let (folder, _) = folder();
    let tiles = folder.path().join("tiles");
    std::fs::create_dir(&tiles).expect("made");
    let place = |west: u32| {
        format!(
            "bounds = {{ south_deg = 40, north_deg = 50, west_deg = {west}, east_deg = {} }}\nregistration = \"posts\"",
            west + 10
        )
    };
    let files: Vec<_> = [0, 10, 20]
        .map(|west| write_heights(&tiles, &format!("tile{west:02}"), (61, 61), &place(west)))
        .to_vec();
    let by_files = options(folder.path(), &files, "files");
    build(&by_files, &()).expect("built");
    for (given, out) in [
        (tiles.clone(), "folder"),
        (tiles.join("tile*.png"), "pattern"),
    ] {
        let by_set = options(folder.path(), &[given], out);
        build(&by_set, &()).expect("built");
        assert_eq!(contents(&by_set.out), contents(&by_files.out), "{out}");
    }
    let none = options(folder.path(), &[tiles.join("*.hgt")], "none");
    let said = build(&none, &()).expect_err("none").to_string();
    assert!(said.contains("matches no elevation file"), "{said}");
}
