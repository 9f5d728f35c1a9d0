//! An object that is wanted and cannot be used is named with its fault, in every format of ephemerides; and messages of one object in one file.

use crate::oem::{epoch, every_minute, kvn, meta};
use std::path::Path;
use terrella_frames::TimeScale;
use terrella_orbit::{Ephemerides, Feed};

fn read(text: &str) -> Ephemerides {
    Ephemerides::from_text(text, Path::new("orbits"), false).unwrap_or_else(|e| panic!("{e}"))
}

/// A message of an object, over the minutes from `first` to `last`.
fn message(name: &str, first: u32, last: u32) -> String {
    let (from, to) = (f64::from(first) * 60.0, f64::from(last) * 60.0);
    let meta = meta(TimeScale::Utc, from, to)
        .with("OBJECT_NAME", name)
        .with("OBJECT_ID", "2026-001A");
    kvn(&meta, &every_minute(first, last))
}

#[test]
fn a_wanted_object_that_is_wrong_is_named() {
    let czml = r#"[{"id":"document","version":"1.0"},
{"id":"1","name":"GOOD","position":{"epoch":"2026-03-01T00Z","cartesian":[0,7e6,0,0,60,7e6,4e5,0]}},
{"id":"2","name":"WANTED","position":{"epoch":"2026-03-01T00Z","referenceFrame":"MOON","cartesian":[0,7e6,0,0]}},
{"id":"3","name":"LOST","position":{"reference":"NOPE#position"}}]"#;
    let csv = "# frame = GCRF\nname,epoch_utc,x_km,y_km,z_km\nGOOD,2026-03-01T00:00:00Z,7000,0,0\n\
               WANTED,2026-03-01T00:00:00Z,7_0,0,0\nGOOD,2026-03-01T00:01:00Z,7000,400,0\n";
    let sp3 = "#dP2020  6 24  0  0  0.00000000       2 ORBIT IGS14 HLM  IGS\n*  2020  6 24  0  0  0.00000000\n\
               PG01  20000.000000  10000.000000      0.000000\nPE03  20000.00x000  10000.000000      0.000000\n\
               *  2020  6 24  0 15  0.00000000\nPG01  20000.000000  11000.000000      0.000000\nEOF\n";
    let oem = [
        message("GOOD", 0, 10),
        message("WANTED", 0, 10).replace("REF_FRAME", "REF_FRAMED"),
    ]
    .concat();
    for (text, wanted, says) in [
        (czml, "WANTED", "orbits:3:"),
        (czml, "2", "orbits:3:"),
        (czml, "lost", "no object has this id"),
        (csv, "WANTED", "orbits:4:"),
        (sp3, "E03", "orbits:4:1: x is"),
        (&oem, "WANTED", "REF_FRAME"),
    ] {
        let error = read(text).into_one(Path::new("orbits"), Some(wanted));
        let error = error.expect_err("rejected").to_string();
        assert!(error.contains(says), "{error}");
        let end = format!("; {wanted:?} has no other record in the file");
        assert!(error.ends_with(&end), "{error}");
    }
}

#[test]
fn successive_messages_of_an_object_are_one_ephemeris() {
    let header_and_rest = |first, last| message("A", first, last);
    let two = read(&[header_and_rest(10, 20), header_and_rest(0, 10)].concat());
    let feed = two.into_one(Path::new("orbits"), None).expect("one object");
    assert_eq!(feed.validity(), (epoch(0.0), epoch(1200.0)));
    assert_eq!(feed.segments().len(), 2);
    // The same times twice: which are meant is open.
    let twice = read(&[header_and_rest(0, 10), header_and_rest(5, 15)].concat());
    let error = twice.into_one(Path::new("orbits"), None).unwrap_err();
    assert!(
        error.to_string().ends_with("keep one of them in the file"),
        "{error}"
    );
}

#[test]
fn packed_files_are_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.oem.zip");
    std::fs::write(&path, b"PK\x03\x04\x14\x00\x00").expect("writes");
    let error = Ephemerides::from_file(&path, false).unwrap_err();
    let wanted = "is packed by zip; unpack it first, or pack it by gzip";
    assert!(error.to_string().ends_with(wanted), "{error}");
}
