//! Compares windows of spooled heights with grids of the same files, to the last bit.

use super::*;
use crate::elevation::read::HeightFile;
use crate::elevation::{GridError, GridLimits, Joins, open_heights};
use image::{ImageBuffer, Luma};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::atomic::{AtomicU32, Ordering};

/// A host with a given number of free bytes that stops after a given number of rows.
struct Host {
    free: Option<u64>,
    rows: AtomicU32,
}

impl Host {
    fn patient() -> Self {
        Self {
            free: None,
            rows: AtomicU32::new(u32::MAX),
        }
    }
}

impl SpoolHost for Host {
    fn free_bytes(&self, _folder: &Path) -> Option<u64> {
        self.free
    }
    fn begin(&self, _rows: u64) {}
    fn step(&self) {
        self.rows.fetch_sub(1, Ordering::Relaxed);
    }
    fn end(&self) {}
    fn cancelled(&self) -> bool {
        self.rows.load(Ordering::Relaxed) == 0
    }
}

/// Georeference and contents of a file.
struct Case {
    size: (u32, u32),
    place: &'static str,
    /// Metres per step, integer or not.
    scale: f64,
    /// Whether a sample has no data.
    is_hole: fn(u32, u32) -> bool,
}

fn rolling(column: u32, row: u32) -> u16 {
    let (x, y) = (f64::from(column), f64::from(row));
    (2000.0 + 900.0 * (x * 0.37).sin() * (y * 0.23).cos() + 300.0 * (x * 1.3 + y).sin()) as u16
}

/// Writes a grey PNG of 16 bits and its sidecar; holes are 65535.
fn write(dir: &Path, case: &Case) -> PathBuf {
    let sample = |x, y| match (case.is_hole)(x, y) {
        true => 65_535,
        false => rolling(x, y),
    };
    let image: ImageBuffer<Luma<u16>, _> =
        ImageBuffer::from_fn(case.size.0, case.size.1, |x, y| Luma([sample(x, y)]));
    let path = dir.join("heights.png");
    image.save(&path).expect("writable");
    let text = format!(
        "unit = \"metres\"\nscale = {}\nnodata = 65535\n{}\n",
        case.scale, case.place
    );
    std::fs::write(dir.join("heights.toml"), text).expect("writable");
    path
}

const GLOBE: &str = "bounds = { south_deg = -90, north_deg = 90, west_deg = -180, east_deg = 180 }";

fn no_hole(_: u32, _: u32) -> bool {
    false
}

/// A few samples, a wide gap over the seam, a pole and a corner.
fn holes(x: u32, y: u32) -> bool {
    let near = |at: u32, of: u32, radius: u32| at.abs_diff(of) <= radius;
    (x * 7 + y * 13).is_multiple_of(53)
        || near(x, 40, 22) && near(y, 60, 17)
        || !(8..=150).contains(&x) && near(y, 30, 12)
        || y < 3 && x > 70
        || y > 88 && x < 100
}

/// Places inside the bounds, including corners and samples.
fn places(bounds: &Bounds) -> Vec<(f64, f64)> {
    let mut places = Vec::new();
    for n in 0..=24 {
        for m in 0..=24 {
            let (up, along) = (f64::from(n) / 24.0, f64::from(m) / 24.0);
            let lat_rad = bounds.south_rad + up * (bounds.north_rad - bounds.south_rad);
            places.push((lat_rad, bounds.west_rad + along * bounds.width_rad));
        }
    }
    places
}

/// Narrow and wide parts of the Earth, over seams and poles.
fn windows() -> Vec<Bounds> {
    let mut windows = vec![Bounds::GLOBE];
    for n in 0..24 {
        let (a, b) = (f64::from(n) * 0.618 % 1.0, f64::from(n) * 0.414 % 1.0);
        let tall_rad = 0.02 + 0.3 * b;
        let south_rad = -FRAC_PI_2 + a * (PI - tall_rad);
        windows.push(Bounds {
            south_rad,
            north_rad: south_rad + tall_rad,
            west_rad: b * TAU - PI + 0.1,
            width_rad: 0.02 + 0.4 * a,
        });
    }
    for (south_deg, north_deg, west_deg, width_deg) in [
        (80.0, 90.0, -10.0, 20.0),
        (-90.0, -84.0, 170.0, 20.0),
        (-5.0, 5.0, 175.0, 10.0),
        (10.0, 30.0, -60.0, 30.0),
        (20.0, 50.0, -20.0, 40.0),
        (44.0, 46.0, 5.0, 1.0),
        (44.0, 48.0, 15.5, 343.0),
    ] {
        windows.push(Bounds {
            south_rad: f64::to_radians(south_deg),
            north_rad: f64::to_radians(north_deg),
            west_rad: f64::to_radians(west_deg),
            width_rad: f64::to_radians(width_deg),
        });
    }
    windows
}

fn spool(path: &Path, dir: &Path) -> HeightSpool {
    HeightSpool::read(path, &dir.join("spool"), None, &Host::patient()).expect("reads")
}

/// Compares them everywhere. Returns how many places had a height, and how many of those had a
/// partial weight.
#[track_caller]
fn compare(file: &HeightFile, spool: &HeightSpool) -> (u32, u32) {
    let (grid, stats) = (&file.grid, file.grid.stats());
    assert_eq!(
        (spool.size(), spool.bounds(), spool.sample_bounds()),
        (grid.size(), grid.bounds(), grid.sample_bounds())
    );
    assert_eq!(
        (spool.range(), spool.quantum_m(), spool.is_flat()),
        (stats.range, stats.quantum_m, grid.is_flat())
    );
    assert_eq!(
        (spool.detail_rad(), spool.finest_spacing_rad()),
        (grid.detail_rad(), grid.finest_spacing_rad())
    );
    let (mut answered, mut in_part) = (0, 0);
    for bounds in windows() {
        let window = spool.window(&bounds).expect("reads");
        for (lat_rad, lon_rad) in places(&bounds) {
            let bits = |of: Option<(f64, f64)>| of.map(|(a, b)| (a.to_bits(), b.to_bits()));
            let right = grid.weighted(lat_rad, lon_rad, 0.0, &Joins::default());
            let got = window.weighted(lat_rad, lon_rad, &Joins::default());
            assert_eq!(
                bits(got),
                bits(right),
                "{got:?} for {right:?} at {lat_rad} {lon_rad} of {bounds:?}"
            );
            answered += u32::from(right.is_some());
            in_part += u32::from(right.is_some_and(|(_, weight)| weight < 1.0));
        }
    }
    (answered, in_part)
}

#[test]
fn windows_answer_what_grids_answer() {
    let cells = "registration = \"cells\"";
    let posts = "registration = \"posts\"";
    let part = "bounds = { south_deg = 35, north_deg = 50, west_deg = -15, east_deg = 20 }";
    let over_date_line =
        "bounds = { south_deg = -8, north_deg = 9, west_deg = 172, east_deg = 187 }";
    let almost_round =
        "bounds = { south_deg = -60, north_deg = 75, west_deg = -346, east_deg = 6 }";
    let band = "bounds = { south_deg = -60, north_deg = 75, west_deg = -340, east_deg = 20 }";
    let mut seen = [0; 2];
    for (place, registration) in [
        (GLOBE, cells),
        (GLOBE, posts),
        (part, cells),
        (part, posts),
        (over_date_line, cells),
        (almost_round, posts),
        (band, cells),
    ] {
        for (scale, is_hole) in [
            (1.0, no_hole as fn(u32, u32) -> bool),
            (1.0, holes),
            (0.1, holes),
            (0.3, no_hole),
        ] {
            let folder = tempfile::tempdir().expect("a folder");
            let place = format!("{place}\n{registration}").leak();
            let case = Case {
                size: (161, 97),
                place,
                scale,
                is_hole,
            };
            let path = write(folder.path(), &case);
            let file = open_heights(&path, &GridLimits::default()).expect("good");
            assert_eq!(file.grid.stats().left_holes > 0, is_hole(40, 60));
            let spool = spool(&path, folder.path());
            let (answered, in_part) = compare(&file, &spool);
            assert!(answered > 600, "{place}: {answered}");
            seen[0] += answered;
            seen[1] += in_part;
            drop(spool);
            let names = std::fs::read_dir(folder.path()).expect("there");
            assert_eq!(names.count(), 2, "scratch files stay");
        }
    }
    assert!(seen[0] > 100_000 && seen[1] > 10_000, "{seen:?}");
}

/// A single height, with filled and with unfilled holes.
#[test]
fn flat_files_have_no_more_detail_than_their_edge() {
    let small = |x: u32, y: u32| x.is_multiple_of(9) && y.is_multiple_of(9);
    for (is_hole, is_uniform) in [
        (no_hole as fn(u32, u32) -> bool, true),
        (small, true),
        (holes, false),
    ] {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("heights.png");
        let image: ImageBuffer<Luma<u16>, _> = ImageBuffer::from_fn(161, 97, |x, y| {
            Luma([if is_hole(x, y) { 65_535 } else { 700 }])
        });
        image.save(&path).expect("writable");
        let text =
            format!("unit = \"metres\"\nnodata = 65535\n{GLOBE}\nregistration = \"cells\"\n");
        std::fs::write(folder.path().join("heights.toml"), text).expect("writable");
        let file = open_heights(&path, &GridLimits::default()).expect("good");
        let spool = spool(&path, folder.path());
        assert_eq!(spool.uniform_m.is_some(), is_uniform);
        assert!(compare(&file, &spool).0 > 10_000);
    }
}

/// Tiles and strips, floats and integers, the southern row first, records of NetCDF.
#[test]
fn files_of_all_formats_are_spooled() {
    let data = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("tests/data/heights");
    let mut count = 0;
    for entry in std::fs::read_dir(&data).expect("there") {
        let path = entry.expect("readable").path();
        let ending = path.extension().unwrap_or_default();
        if !["tif", "nc", "png"].iter().any(|known| ending == *known) {
            continue;
        }
        let folder = tempfile::tempdir().expect("a folder");
        let scratch = folder.path().join("spool");
        let spooled = HeightSpool::read(&path, &scratch, None, &Host::patient());
        match (open_heights(&path, &GridLimits::default()), spooled) {
            (Ok(file), Ok(spool)) => {
                compare(&file, &spool);
                count += 1;
            }
            // Both reject the same files.
            (Err(a), Err(SpoolError::Heights(b))) => assert_eq!(a.to_string(), b.to_string()),
            (a, b) => panic!("{}: {:?} and {:?}", path.display(), a.err(), b.err()),
        }
    }
    assert!(count > 5, "{count} files");
}

#[test]
fn what_cannot_be_spooled_is_reported_and_nothing_stays() {
    let folder = tempfile::tempdir().expect("a folder");
    let case = Case {
        size: (161, 97),
        place: GLOBE.to_owned().leak(),
        scale: 1.0,
        is_hole: holes,
    };
    let read = |free, rows| {
        let host = Host {
            free,
            rows: AtomicU32::new(rows),
        };
        let path = folder.path().join("heights.png");
        HeightSpool::read(&path, &folder.path().join("spool"), None, &host)
    };
    let path = write(folder.path(), &case);
    let error = read(None, 100).expect_err("no registration");
    assert!(matches!(error, SpoolError::Heights(_)), "{error}");
    std::fs::write(
        path.with_extension("toml"),
        format!("unit = \"metres\"\nnodata = 65535\n{GLOBE}\nregistration = \"cells\"\n"),
    )
    .expect("writable");
    // 2 bytes per sample, and 4 per mean.
    assert!(read(Some(2 * 161 * 97), 1000).is_ok());
    let error = read(Some(2 * 161 * 97 - 1), 1000).expect_err("no room");
    assert!(
        matches!(&error, SpoolError::NoRoom { path, needed_bytes: 31_234, .. } if path.ends_with("spool-rows")),
        "{error}"
    );
    for rows in [1, 96] {
        let error = read(None, rows).expect_err("stopped");
        assert!(matches!(error, SpoolError::Stopped), "{error}");
    }
    let place = folder.path().join("none/spool");
    let error = HeightSpool::read(&path, &place, None, &Host::patient()).expect_err("no folder");
    assert!(
        matches!(&error, SpoolError::Scratch { path, .. } if path.ends_with("none/spool-rows")),
        "{error}"
    );
    let bytes = std::fs::read(&path).expect("there");
    std::fs::write(&path, &bytes[..bytes.len() / 2]).expect("writable");
    let error = read(None, 1000).expect_err("truncated");
    assert!(
        matches!(error, SpoolError::Heights(HeightFileError::Damaged { .. })),
        "{error}"
    );
    // No data, and heights outside the Earth's range.
    for (value, is_empty) in [(65_535, true), (60_000, false)] {
        let image: ImageBuffer<Luma<u16>, _> = ImageBuffer::from_pixel(161, 97, Luma([value]));
        image.save(&path).expect("writable");
        let error = read(None, 1000).expect_err("rejected");
        let SpoolError::Heights(HeightFileError::Grid { source, .. }) = error else {
            panic!("{error}");
        };
        assert_eq!(matches!(source, GridError::Empty), is_empty, "{source}");
        assert_eq!(matches!(source, GridError::NotEarth { .. }), !is_empty);
    }
    let names = std::fs::read_dir(folder.path()).expect("there");
    assert_eq!(names.count(), 2, "scratch files stay");
}

/// Ten thousand files of a degree are inspected and joined by their headers alone.
#[test]
fn many_files_are_looked_at_in_seconds() {
    let folder = tempfile::tempdir().expect("a folder");
    for n in 0..10_000_i32 {
        let (lat, lon) = (n / 200 - 25, n % 200 - 100);
        let sign = |number: i32, signs: [char; 2]| signs[usize::from(number < 0)];
        let name = format!(
            "{}{:02}{}{:03}.hgt",
            sign(lat, ['N', 'S']),
            lat.abs(),
            sign(lon, ['E', 'W']),
            lon.abs()
        );
        // A sparse file without blocks.
        let file = std::fs::File::create(folder.path().join(name)).expect("made");
        file.set_len(2 * 1201 * 1201).expect("grows");
    }
    let start = cpu_time::ThreadTime::now();
    let files = crate::elevation::height_set(folder.path()).expect("files");
    let needs: Vec<_> = files.iter().map(|file| look(file).expect("good")).collect();
    let placements: Vec<_> = needs.iter().map(|needs| &needs.place).collect();
    let joins = Joins::of(&placements);
    let took = start.elapsed();
    println!(
        "10 000 files of a degree opened in {:.1} s",
        took.as_secs_f64()
    );
    // Comparing each with each would take many times longer.
    assert!(took.as_secs_f64() < 20.0, "{took:?}");
    assert_eq!((files.len(), joins.len()), (10_000, 10_000));
    // In the middle of all, on a seam, only the upper one counts.
    let inside: Vec<_> = placements
        .iter()
        .zip(&joins)
        .map(|(place, joins)| {
            let (row, column) = place
                .lattice
                .locate(0.3_f64.to_radians(), 3f64.to_radians());
            joins.inside(place, row, column)
        })
        .filter(|weight| *weight > 0.0)
        .collect();
    assert_eq!(inside, [1.0]);
}
