//! Packs of elevation data that is read in parts, compared with those of data held in memory.

use super::super::folder::{Disk, Writer};
use super::super::tests::stopped::{Failing, Notes, Stopping, contents};
use super::tests::{day_folder, options};
use crate::{BuildError, BuildOptions, Division, build, build_with};
use image::{ImageBuffer, Luma};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicU32;
use terrella_imagery::pack::{HeightKind, verify};

/// How many files were read part by part.
fn spooled(notes: Notes) -> usize {
    let all = notes.all();
    all.iter()
        .filter(|note| note.contains("part by part"))
        .count()
}

/// 0…60 000, with ridges at other places for each `salt`.
fn value(column: u32, row: u32, salt: u32) -> u16 {
    let (x, y) = (f64::from(column + salt), f64::from(row));
    let wave = (x * 0.09).sin() * (y * 0.13).cos() + 0.2 * (x * 1.3 + y * 0.7).sin();
    (30_000.0 + 24_000.0 * wave) as u16
}

/// Single samples, a wide hole over the first column, one in the middle, and one at the north.
fn is_hole(x: u32, y: u32) -> bool {
    (x * 5 + y * 11).is_multiple_of(97)
        || !(14..=380).contains(&x) && (100..140).contains(&y)
        || (150..220).contains(&x) && (60..99).contains(&y)
        || (40..90).contains(&x) && y < 5
}

/// Writes a grey PNG of 16 bits and its sidecar.
fn png(dir: &Path, name: &str, size: (u32, u32), has_holes: bool, sidecar: &str) -> PathBuf {
    let image: ImageBuffer<Luma<u16>, _> = ImageBuffer::from_fn(size.0, size.1, |x, y| {
        Luma([match has_holes && is_hole(x, y) {
            true => 65_535,
            false => value(x, y, size.0),
        }])
    });
    let path = dir.join(format!("{name}.png"));
    image.save(&path).expect("writable");
    let text = format!("unit = \"metres\"\nnodata = 65535\n{sidecar}\n");
    std::fs::write(dir.join(format!("{name}.toml")), text).expect("writable");
    path
}

/// Writes NetCDF classic with the southern row first: 400 × 220 posts half a degree apart over the date line, with a hole.
fn south_first(dir: &Path) -> PathBuf {
    let (columns, rows) = (400_u32, 220_u32);
    let mut head = b"CDF\x01\0\0\0\0".to_vec();
    let words = |head: &mut Vec<u8>, words: &[u32]| {
        words.iter().for_each(|n| head.extend(n.to_be_bytes()));
    };
    let name = |head: &mut Vec<u8>, text: &str| {
        head.extend((text.len() as u32).to_be_bytes());
        head.extend(text.bytes());
        head.resize(head.len().next_multiple_of(4), 0);
    };
    words(&mut head, &[10, 2]);
    for (dimension, count) in [("lat", rows), ("lon", columns)] {
        name(&mut head, dimension);
        words(&mut head, &[count]);
    }
    // No attributes of the file; three variables.
    words(&mut head, &[0, 0, 11, 3]);
    let places = [("lat", vec![0]), ("lon", vec![1]), ("z", vec![0, 1])];
    let sizes = [8 * rows, 8 * columns, 2 * rows * columns];
    // After what is written for each below.
    let mut begin = 260;
    for ((variable, dimensions), bytes) in places.into_iter().zip(sizes) {
        name(&mut head, variable);
        words(&mut head, &[dimensions.len() as u32]);
        words(&mut head, &dimensions);
        let (unit, kind) = match variable {
            "lat" => ("degrees_north", 6),
            "lon" => ("degrees_east", 6),
            _ => ("m", 3),
        };
        words(&mut head, &[12, 1]);
        name(&mut head, "units");
        words(&mut head, &[2]);
        name(&mut head, unit);
        words(&mut head, &[kind, bytes, begin]);
        begin += bytes;
    }
    assert_eq!(head.len(), 260);
    (0..rows).for_each(|n| head.extend((-60.0 + 0.5 * f64::from(n)).to_be_bytes()));
    (0..columns).for_each(|n| head.extend((100.0 + 0.5 * f64::from(n)).to_be_bytes()));
    for (y, x) in (0..rows).flat_map(|y| (0..columns).map(move |x| (y, x))) {
        let height = match is_hole(x, y) {
            true => -32_767,
            false => (value(x, y, 3) / 20) as i16,
        };
        head.extend(height.to_be_bytes());
    }
    let path = dir.join("south.nc");
    std::fs::write(&path, head).expect("writable");
    path
}

/// The same with the least sufficient memory: no file of any size is held.
fn little(options: BuildOptions, out: &str) -> BuildOptions {
    let options = BuildOptions {
        out: options.out.with_file_name(out),
        memory_bytes: 60_000_000,
        ..options
    };
    let Err(BuildError::HeightsMemory { needed_mb, .. }) = build(&options, &()) else {
        panic!("60 MB are not enough");
    };
    BuildOptions {
        memory_bytes: needed_mb * 1_000_000,
        // A rejected build is a separate build.
        restart: true,
        ..options
    }
}

const GLOBE: &str = "bounds = { south_deg = -90, north_deg = 90, west_deg = -180, east_deg = 180 }";

#[test]
fn tiles_do_not_tell_how_their_files_were_read() {
    let cells = format!("{GLOBE}\nregistration = \"cells\"\nscale = 0.1\noffset = -1000");
    let posts = format!("{GLOBE}\nregistration = \"posts\"\nscale = 0.13\noffset = -100");
    let at = |bounds: &str, registration: &str| {
        format!(
            "bounds = {{ {bounds} }}\nregistration = \"{registration}\"\nscale = 0.1\noffset = -900"
        )
    };
    let date_line = at(
        "south_deg = -3, north_deg = 4, west_deg = 176, east_deg = 185",
        "posts",
    );
    let north = at(
        "south_deg = 66, north_deg = 90, west_deg = -30, east_deg = 75",
        "cells",
    );
    type Make<'a> = &'a dyn Fn(&Path) -> Vec<PathBuf>;
    let makes: [(&str, Make<'_>, bool); 5] = [
        (
            "cells",
            &|dir| vec![png(dir, "a", (500, 251), false, &cells)],
            false,
        ),
        (
            "posts and floats",
            &|dir| vec![png(dir, "a", (501, 251), true, &posts)],
            true,
        ),
        (
            "over the date line and over another",
            &|dir| {
                vec![
                    png(dir, "a", (400, 200), true, &cells),
                    png(dir, "b", (400, 300), true, &date_line),
                ]
            },
            false,
        ),
        (
            "a pole",
            &|dir| vec![png(dir, "a", (400, 300), true, &north)],
            false,
        ),
        (
            "the southern row first, in whole metres, under and over others",
            &|dir| {
                vec![
                    png(dir, "a", (512, 256), false, &cells),
                    south_first(dir),
                    png(dir, "b", (400, 300), true, &date_line),
                ]
            },
            false,
        ),
    ];
    for (name, make, is_float) in makes {
        let folder = day_folder();
        let paths = make(folder.path());
        let much = options(folder.path(), &paths, "held");
        let reported = Notes::default();
        let manifest = build(&much, &reported).expect("builds");
        assert_eq!(spooled(reported), 0, "{name}: held");
        let kind = manifest.heights.as_ref().expect("heights").kind;
        assert_eq!(kind == HeightKind::F32, is_float, "{name}: {kind:?}");
        let little = little(much.clone(), "parts");
        let reported = Notes::default();
        build(&little, &reported).expect("builds");
        assert_eq!(spooled(reported), paths.len(), "{name}: none is held");
        let (held, parts) = (contents(&much.out), contents(&little.out));
        assert!(held.len() > 128 + 128);
        for (file, bytes) in &held {
            assert!(parts.get(file) == Some(bytes), "{name}: {}", file.display());
        }
        assert_eq!(held.len(), parts.len(), "{name}");
        let report = verify(&little.out, |_, _| {}).expect("a pack");
        assert!(report.is_good() && report.stranger_count == 0, "{report:?}");
    }
}

/// A disk with little room.
struct Full;

impl Writer for Full {
    fn write(&self, path: &Path, contents: &[u8]) -> io::Result<()> {
        Disk.write(path, contents)
    }

    fn free_bytes(&self, _folder: &Path) -> Option<u64> {
        Some(1_000)
    }
}

#[test]
fn builds_with_scratch_files_go_on_and_leave_none() {
    let folder = day_folder();
    let cells = format!("{GLOBE}\nregistration = \"cells\"\nscale = 0.1");
    let paths = [png(folder.path(), "a", (500, 250), true, &cells)];
    let much = options(folder.path(), &paths, "held");
    build(&much, &()).expect("builds");
    let held = contents(&much.out);
    let little = little(much, "parts");
    let out = little.out.clone();
    let error = build_with(&little, &(), &Full, Division::default()).expect_err("no room");
    let words = error.to_string();
    for word in [
        "scratch/heights-0-rows: ",
        "1 MB",
        "0 MB are free",
        "make room",
    ] {
        assert!(words.contains(word), "{words}");
    }
    assert!(matches!(error, BuildError::ScratchRoom { .. }));
    assert!(!out.join("scratch").exists());
    let going_on = BuildOptions {
        restart: false,
        ..little
    };
    // While the file is read, and among the tiles.
    for steps in [1, 100, 300, 340] {
        let error = build(&going_on, &Stopping(AtomicU32::new(steps))).expect_err("stopped");
        assert!(matches!(error, BuildError::Cancelled), "{error}");
        assert!(!out.join("scratch").exists());
    }
    let error = build_with(&going_on, &(), &Failing::after(9), Division::default());
    assert!(matches!(error, Err(BuildError::Write { .. })));
    // As after a kill: a partial file, and an unknown one.
    let scratch = out.join("scratch");
    std::fs::create_dir(&scratch).expect("writable");
    for name in ["heights-0-rows", "heights-7-means-3"] {
        std::fs::write(scratch.join(name), b"half").expect("writable");
    }
    build(&going_on, &()).expect("goes on");
    assert!(contents(&out) == held);
    assert!(!scratch.exists());
}
