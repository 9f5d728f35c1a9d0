//! Builds that several processes share.

use super::write_day;
use crate::journal::share_journal_file;
use crate::{BuildError, BuildOptions, BuildShare, begin_shares, build, build_share};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use terrella_imagery::tile::{MapLayer, Storage};

fn options(folder: &Path, out: &str) -> BuildOptions {
    let image = folder.join("day.png");
    if !image.exists() {
        write_day(&image, 640);
    }
    BuildOptions {
        name: Some("noise".to_string()),
        pixels: vec![(MapLayer::Day, vec![40, 16])],
        storages: vec![Storage::Plain],
        water: Some(image.clone()),
        ..BuildOptions::new(image, folder.join(out))
    }
}

fn contents(dir: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![dir.to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).expect("a folder").flatten() {
            match entry.path() {
                path if path.is_dir() => folders.push(path),
                path => {
                    let name = path.strip_prefix(dir).expect("inside").to_path_buf();
                    found.insert(name, fs::read(&path).expect("reads"));
                }
            }
        }
    }
    found
}

#[test]
fn shares_give_the_files_of_one_build() {
    let folder = tempfile::tempdir().expect("a folder");
    let whole = options(folder.path(), "whole");
    build(&whole, &()).expect("builds");
    let shared = options(folder.path(), "shared");
    for workers in [3, 1] {
        let plan = begin_shares(&shared, workers, &()).expect("begins");
        assert_eq!(plan.tiles as usize + 1, contents(&whole.out).len());
        let missing: u64 = plan.shares.iter().map(|share| share.missing).sum();
        let costs: Vec<_> = plan.shares.iter().map(|share| share.cost).collect();
        assert!(costs.is_sorted_by(|a, b| a >= b), "{costs:?}");
        if workers == 3 {
            assert_eq!(missing, plan.tiles);
            assert!(plan.shares.len() > 3, "{:?}", plan.shares);
            // Not all of them: the run ends here, and the next has another number of workers.
            for share in &plan.shares[..3] {
                let made = |_| build_share(&shared, share, &()).expect("makes it");
                assert_eq!([0, 1].map(made), [share.missing, 0]);
            }
        } else {
            assert!(0 < missing && missing < plan.tiles);
        }
    }
    // The build makes the shares that no process has made.
    build(&shared, &()).expect("goes on");
    assert!(contents(&shared.out) == contents(&whole.out));
    let again = begin_shares(&shared, 2, &()).expect_err("a finished pack");
    assert!(matches!(again, BuildError::Finished { .. }), "{again}");
    let share = share(MapLayer::Day, 0, 16);
    let again = build_share(&shared, &share, &()).expect_err("a finished pack");
    assert!(matches!(again, BuildError::Finished { .. }), "{again}");
    let again = BuildOptions {
        restart: true,
        ..shared.clone()
    };
    let plan = begin_shares(&again, 2, &()).expect("begins again");
    let missing: u64 = plan.shares.iter().map(|share| share.missing).sum();
    assert_eq!(missing, plan.tiles);
}

fn share(layer: MapLayer, start: u32, end: u32) -> BuildShare {
    BuildShare {
        layer,
        columns: start..end,
        cost: 0,
        missing: 0,
    }
}

#[test]
fn colours_cost_more_than_water() {
    // The same picture is both maps, and water has the more texels: still it is the day that is divided among two.
    let folder = tempfile::tempdir().expect("a folder");
    let options = BuildOptions {
        pixels: vec![(MapLayer::Day, vec![40, 16]), (MapLayer::Water, vec![48])],
        ..options(folder.path(), "shared")
    };
    let plan = begin_shares(&options, 2, &()).expect("begins");
    let counts = [MapLayer::Day, MapLayer::Water].map(|layer| {
        let of = plan.shares.iter().filter(|share| share.layer == layer);
        of.count()
    });
    assert_eq!(counts, [2, 1], "{:?}", plan.shares);
}

#[test]
fn shares_of_other_builds_and_shares_that_are_not_there_are_rejected() {
    let folder = tempfile::tempdir().expect("a folder");
    let shared = options(folder.path(), "shared");
    begin_shares(&shared, 2, &()).expect("begins");
    let (start, end) = (8, 4);
    for bad in [
        share(MapLayer::Clouds, 0, 16),
        share(MapLayer::Day, 0, 17),
        share(MapLayer::Day, start, end),
    ] {
        let error = build_share(&shared, &bad, &()).expect_err("no such share");
        assert!(matches!(error, BuildError::Option { .. }), "{error}");
    }
    let good = share(MapLayer::Day, 0, 8);
    build_share(&shared, &good, &()).expect("makes it");
    let other = BuildOptions {
        attribution: vec!["another".to_string()],
        ..shared.clone()
    };
    let error = build_share(&other, &good, &()).expect_err("another build");
    assert!(matches!(error, BuildError::OtherBuild { .. }), "{error}");
    // A share is locked by the process that makes it, and a new build waits.
    let name = share_journal_file("day-0-8");
    let held = fs::File::open(shared.out.join(&name)).expect("a journal");
    held.try_lock().expect("free");
    for error in [
        build_share(&shared, &good, &()).expect_err("held"),
        build(&shared, &()).expect_err("held"),
    ] {
        assert!(matches!(error, BuildError::Busy { .. }), "{error}");
    }
    drop(held);
    build(&shared, &()).expect("builds");
    assert!(!shared.out.join(name).exists());
}
