//! `terrella pack build` as a user runs it, and killed.

use super::maps::{png, rgb_map};
use crate::program::{run, terrella};
use image::ExtendedColorType;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::{Duration, Instant};

/// All files of a folder with their contents.
fn contents(dir: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![dir.to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(dir).expect("inside").to_path_buf();
                found.insert(name, fs::read(&path).expect("a file"));
            }
        }
    }
    found
}

#[test]
fn a_build_that_is_killed_goes_on_to_the_same_bytes() {
    let folder = tempfile::tempdir().expect("a folder");
    let texels: Vec<u8> = (0..1024 * 512 * 3_u32)
        .map(|n| (n.wrapping_mul(2_654_435_761) >> 24) as u8)
        .collect();
    let map = png(1024, 512, ExtendedColorType::Rgb8, &texels);
    fs::write(folder.path().join("day.png"), map).expect("writable");
    let build = |out: &'static str| {
        let ladder = "day=100,64,16";
        [
            "pack", "build", "--day", "day.png", "--name", "x", "--pixels", ladder, "-o", out,
        ]
    };
    let (code, _, complaint) = run(&build("whole"), folder.path());
    assert_eq!(code, Some(0), "{complaint}");
    let journal = folder.path().join("killed/build.journal");
    let mut kills = 0;
    for lines in [20, 150, 400] {
        let mut child = terrella(&build("killed"), folder.path())
            .stderr(Stdio::null())
            .spawn()
            .expect("the program runs");
        let start = Instant::now();
        loop {
            let noted = fs::read_to_string(&journal).map_or(0, |text| text.lines().count());
            if noted >= lines {
                child.kill().expect("can be killed");
                kills += 1;
                break;
            }
            if child.try_wait().expect("a child").is_some() {
                break;
            }
            assert!(
                start.elapsed() < Duration::from_secs(60),
                "no {lines} lines"
            );
            std::thread::sleep(Duration::from_millis(2));
        }
        child.wait().expect("a child");
    }
    assert!(
        kills >= 1,
        "the builds were over before they could be killed"
    );
    let (code, _, complaint) = run(&build("killed"), folder.path());
    // If the last one was over too, its pack is finished.
    assert!(
        code == Some(0) || complaint.contains("finished pack"),
        "{complaint}"
    );
    assert!(contents(&folder.path().join("killed")) == contents(&folder.path().join("whole")));
    let (code, reported, _) = run(&["pack", "verify", "killed"], folder.path());
    assert_eq!(code, Some(0), "{reported}");
}

#[test]
fn notes_and_errors_are_reported_and_nothing_else() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(
        folder.path().join("map.png"),
        png(64, 32, ExtendedColorType::Rgb8, &rgb_map()),
    )
    .expect("writable");
    let build = |more: &[&'static str]| {
        let mut arguments = vec!["pack", "build", "--day", "map.png"];
        arguments.extend_from_slice(more);
        run(&arguments, folder.path())
    };
    let (code, reported, complaint) = build(&[
        "--clouds",
        "map.png",
        "--storage",
        "plain",
        "--attribution",
        "one",
        "--attribution",
        "two",
        "--pixels",
        "day=16",
        "-o",
        "pack",
    ]);
    assert_eq!((code, reported.as_str()), (Some(0), ""), "{complaint}");
    assert!(
        complaint.contains("note: map.png: is in colour; its luminance"),
        "{complaint}"
    );
    assert!(
        complaint.contains("750, 375, 250, 150 are left out"),
        "{complaint}"
    );
    let (_, info, _) = run(&["pack", "info", "pack"], folder.path());
    for part in ["pack\n", "one", "two", "from map.png, 64 x 32"] {
        assert!(info.contains(part), "{part}: {info}");
    }

    for (more, word, exit) in [
        (&["-o", "pack"][..], "--restart", 1),
        (&["-o", "new", "--pixels", "day=0"], "16 to", 1),
        (&["-o", "new", "--pixels", "moon=16"], "there is no map", 2),
        (
            &["-o", "new", "--pixels", "water=16"],
            "not among the maps",
            1,
        ),
        (&["-o", "new", "--memory", "0"], "--memory", 2),
        (&["-o", "new", "--memory", "20"], "megabytes|needs", 1),
        (&["-o", "new", "--exaggeration", "2"], "--elevation", 2),
        (
            &[
                "-o",
                "new",
                "--normals",
                "map.png",
                "--elevation",
                "map.png",
            ],
            "cannot be used with",
            2,
        ),
        (&["-o", "new", "--water", "none.png"], "none.png", 1),
        (&["-o", "map.png"], "map.png", 1),
    ] {
        let (code, _, complaint) = build(more);
        assert_eq!(code, Some(exit), "{more:?}: {complaint}");
        assert!(
            word.split('|').any(|word| complaint.contains(word)),
            "{more:?}: {complaint}"
        );
        assert!(!complaint.contains("panicked"), "{complaint}");
        assert!(!folder.path().join("new").exists(), "{more:?}");
    }
    let (code, _, complaint) = build(&["-o", "pack", "--restart", "--quiet"]);
    assert_eq!((code, complaint.as_str()), (Some(0), ""));
}
