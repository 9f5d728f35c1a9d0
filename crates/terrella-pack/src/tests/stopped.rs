//! Builds that are stopped, fail, or find something in their folder.

use super::write_day;
use crate::folder::{Disk, Writer};
use crate::{BuildError, BuildOptions, BuildProgress, Division, build, build_with};
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU32, Ordering};
use tempfile::TempDir;
use terrella_imagery::tile::{MapLayer, Storage};

/// Writes a number of files and then fails; on request leaves a partial file beside the one that fails, as a full disk may.
pub(crate) struct Failing {
    left: AtomicU32,
    leave_half: bool,
}

impl Failing {
    pub(crate) fn after(files: u32) -> Self {
        Self {
            left: AtomicU32::new(files),
            leave_half: files % 2 == 1,
        }
    }
}

impl Writer for Failing {
    fn free_bytes(&self, _folder: &Path) -> Option<u64> {
        None
    }

    fn write(&self, path: &Path, contents: &[u8]) -> io::Result<()> {
        let left = self
            .left
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, |n| n.checked_sub(1));
        if left.is_ok() {
            return Disk.write(path, contents);
        }
        if self.leave_half {
            let part = path.with_file_name(format!(
                ".{}.part",
                path.file_name().unwrap().to_string_lossy()
            ));
            fs::create_dir_all(path.parent().unwrap())?;
            fs::write(part, &contents[..contents.len() / 2])?;
        }
        Err(io::ErrorKind::StorageFull.into())
    }
}

/// Stops after so many rows.
pub(crate) struct Stopping(pub AtomicU32);

impl BuildProgress for Stopping {
    fn begin(&self, _what: &str, _steps: Option<u64>) {}
    fn step(&self) {
        let _ = self
            .0
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, |n| n.checked_sub(1));
    }
    fn end(&self) {}
    fn cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed) == 0
    }
}

/// Keeps what is reported.
#[derive(Default)]
pub(crate) struct Notes(Mutex<Vec<String>>);

impl Notes {
    pub(crate) fn all(self) -> Vec<String> {
        self.0.into_inner().expect("not poisoned")
    }
}

impl BuildProgress for Notes {
    fn begin(&self, _what: &str, _steps: Option<u64>) {}
    fn step(&self) {}
    fn end(&self) {}
    fn note(&self, text: &str) {
        self.0.lock().expect("not poisoned").push(text.to_owned());
    }
}

/// A folder with a day map of noise; packs are built beside it.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    write_day(&folder.path().join("day.png"), 512);
    folder
}

/// A small ladder of both kinds of storage: 512 tiles.
fn options(folder: &Path, out: &str) -> BuildOptions {
    BuildOptions {
        name: Some("noise".to_string()),
        pixels: vec![(MapLayer::Day, vec![40, 16])],
        ..BuildOptions::new(folder.join("day.png"), folder.join(out))
    }
}

/// All files of a folder with their contents.
pub(crate) fn contents(dir: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    fn walk(dir: &Path, root: &Path, found: &mut BTreeMap<PathBuf, Vec<u8>>) {
        for entry in fs::read_dir(dir).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                walk(&path, root, found);
            } else {
                let name = path.strip_prefix(root).unwrap().to_path_buf();
                found.insert(name, fs::read(&path).unwrap());
            }
        }
    }
    let mut found = BTreeMap::new();
    walk(dir, dir, &mut found);
    found
}

#[test]
fn a_build_that_fails_anywhere_goes_on_to_the_same_bytes() {
    let folder = folder();
    let whole = options(folder.path(), "whole");
    build(&whole, &()).expect("builds");
    let whole = contents(&whole.out);
    assert_eq!(whole.len(), 513);
    // The last fails at the manifest.
    for files in [0, 1, 100, 301, 512] {
        let options = options(folder.path(), &format!("after{files}"));
        let error = build_with(&options, &(), &Failing::after(files), Division::default())
            .expect_err("no room");
        assert!(matches!(error, BuildError::Write { .. }), "{error}");
        assert!(
            error.to_string().contains("run the same command again"),
            "{error}"
        );
        let found = contents(&options.out);
        assert!(!found.contains_key(Path::new("pack.toml")));
        for (name, bytes) in &found {
            if name.extension().is_some_and(|ending| ending == "ktx2") {
                assert_eq!(whole.get(name), Some(bytes), "{}", name.display());
            }
        }
        // Not all over again: what is there is not written a second time.
        let done = found
            .keys()
            .filter(|name| name.extension().is_some_and(|e| e == "ktx2"))
            .count();
        assert_eq!(done as u32, files.min(512));
        let rest = Failing::after(513 - files);
        build_with(&options, &(), &rest, Division::default()).expect("goes on");
        assert_eq!(rest.left.into_inner(), 0);
        assert!(contents(&options.out) == whole, "after {files}");
    }
}

#[test]
fn a_build_that_is_stopped_goes_on_to_the_same_bytes() {
    let folder = folder();
    let whole = options(folder.path(), "whole");
    build(&whole, &()).expect("builds");
    let options = options(folder.path(), "stopped");
    for rows in [0, 60, 200] {
        let error = build(&options, &Stopping(AtomicU32::new(rows))).expect_err("stopped");
        assert!(matches!(error, BuildError::Cancelled), "{error}");
        assert!(!options.out.join("pack.toml").exists());
    }
    build(&options, &()).expect("goes on");
    assert!(contents(&options.out) == contents(&whole.out));
}

#[test]
fn passes_and_threads_do_not_change_a_byte() {
    let folder = folder();
    let first = options(folder.path(), "first");
    build(&first, &()).expect("builds");
    let first = contents(&first.out);
    for (columns, threads) in [(16, 1), (8, 3), (1, 2)] {
        let options = BuildOptions {
            threads: Some(threads),
            ..options(folder.path(), &format!("{columns}x{threads}"))
        };
        build_with(
            &options,
            &(),
            &Disk,
            Division {
                columns: Some(columns),
                ..Division::default()
            },
        )
        .expect("builds");
        assert!(
            contents(&options.out) == first,
            "{columns} columns, {threads} threads"
        );
    }
}

#[test]
fn a_little_memory_gives_the_same_bytes() {
    let folder = folder();
    let ladder = |out: &str, memory_bytes| BuildOptions {
        storages: vec![Storage::Plain],
        pixels: vec![(MapLayer::Day, vec![256, 100])],
        memory_bytes,
        ..options(folder.path(), out)
    };
    let much = ladder("much", 512_000_000);
    build(&much, &()).expect("builds");
    // The bands of all columns take 4 MB; the least sufficient memory is found from the error.
    let little = ladder("little", 1_000_000);
    let Err(BuildError::Memory { needed_mb, .. }) = build(&little, &()) else {
        panic!("a megabyte is not enough");
    };
    assert!(!little.out.exists());
    build(&ladder("little", needed_mb * 1_000_000), &()).expect("builds");
    assert!(contents(&little.out) == contents(&much.out));
}

#[test]
fn bad_tiles_and_cut_journals_are_made_good() {
    let folder = folder();
    let whole = options(folder.path(), "whole");
    build(&whole, &()).expect("builds");
    let whole = contents(&whole.out);
    let options = options(folder.path(), "mended");
    build_with(&options, &(), &Failing::after(300), Division::default()).expect_err("no room");
    let journal = options.out.join("build.journal");
    let text = fs::read_to_string(&journal).unwrap();
    assert_eq!(text.lines().count(), 302);
    // The last line without its end, one in the middle that is nonsense, a tile changed and one gone.
    fs::write(&journal, &text[..text.len() - 3]).unwrap();
    let tiles: Vec<_> = contents(&options.out)
        .into_keys()
        .filter(|name| name.extension().is_some_and(|ending| ending == "ktx2"))
        .collect();
    let mut changed = fs::read(options.out.join(&tiles[0])).unwrap();
    changed[200] ^= 1;
    fs::write(options.out.join(&tiles[0]), changed).unwrap();
    fs::remove_file(options.out.join(&tiles[1])).unwrap();
    build_with(&options, &(), &Failing::after(40), Division::default()).expect_err("no room");
    let text = fs::read_to_string(&journal).unwrap();
    let nonsense = text.replacen("day", "dey", 50).replacen("dey", "day", 49);
    fs::write(&journal, nonsense).unwrap();
    build(&options, &()).expect("goes on");
    assert!(contents(&options.out) == whole);
}

#[test]
fn other_maps_and_finished_packs_need_restart() {
    let folder = folder();
    let options = options(folder.path(), "pack");
    build_with(&options, &(), &Failing::after(100), Division::default()).expect_err("no room");
    let other = BuildOptions {
        pixels: vec![(MapLayer::Day, vec![32, 16])],
        ..options.clone()
    };
    let error = build(&other, &()).expect_err("another ladder");
    assert!(matches!(error, BuildError::OtherBuild { .. }), "{error}");
    // The same command with another map: it is detected by time or content.
    let map = folder.path().join("day.png");
    let before = fs::read(&map).unwrap();
    write_day(&map, 256);
    let error = build(&options, &()).expect_err("another map");
    assert!(matches!(error, BuildError::OtherBuild { .. }), "{error}");
    fs::write(&map, before).unwrap();

    let restart = BuildOptions {
        restart: true,
        ..other.clone()
    };
    build(&restart, &()).expect("builds again");
    let names: Vec<_> = contents(&options.out).into_keys().collect();
    assert!(
        !names
            .iter()
            .any(|name| name.to_string_lossy().contains("/40/"))
    );
    assert!(!names.contains(&PathBuf::from("build.journal")));
    for options in [&other, &options] {
        let error = build(options, &()).expect_err("a finished pack");
        assert!(matches!(error, BuildError::Finished { .. }), "{error}");
    }
    build(&restart, &()).expect("builds again");
}

#[test]
fn a_folder_of_something_else_is_left_alone() {
    let folder = folder();
    for (name, is_folder) in [("notes.txt", false), ("tiles", true), ("pack.toml", true)] {
        let options = BuildOptions {
            restart: true,
            ..options(folder.path(), &format!("has {name}"))
        };
        let thing = options.out.join(name);
        fs::create_dir_all(&options.out).unwrap();
        if is_folder {
            fs::create_dir(&thing).unwrap();
        } else {
            fs::write(&thing, "mine").unwrap();
        }
        let error = build(&options, &()).expect_err("not ours");
        assert!(
            matches!(&error, BuildError::NotEmpty { found, .. } if found == name),
            "{error}"
        );
        assert!(thing.exists());
        assert_eq!(fs::read_dir(&options.out).unwrap().count(), 1);
    }
    let options = BuildOptions {
        out: folder.path().join("day.png"),
        ..options(folder.path(), "x")
    };
    let error = build(&options, &()).expect_err("a file");
    assert!(error.to_string().contains("day.png"), "{error}");
}

#[test]
fn two_builds_in_one_folder_are_distinguished() {
    let folder = folder();
    let options = options(folder.path(), "pack");
    build_with(&options, &(), &Failing::after(10), Division::default()).expect_err("no room");
    let held = fs::File::open(options.out.join("build.journal")).unwrap();
    held.try_lock().expect("free");
    let error = build(&options, &()).expect_err("busy");
    assert!(matches!(error, BuildError::Busy { .. }), "{error}");
    drop(held);
    build(&options, &()).expect("goes on");
}

#[test]
fn a_map_that_breaks_is_an_error_and_nothing_is_finished() {
    let folder = folder();
    let map = folder.path().join("day.png");
    let bytes = fs::read(&map).unwrap();
    fs::write(&map, &bytes[..bytes.len() * 2 / 3]).unwrap();
    let options = options(folder.path(), "pack");
    let error = build(&options, &()).expect_err("truncated");
    assert!(
        matches!(&error, BuildError::Damaged { path, .. } if *path == map),
        "{error}"
    );
    assert!(!options.out.join("pack.toml").exists());
}
