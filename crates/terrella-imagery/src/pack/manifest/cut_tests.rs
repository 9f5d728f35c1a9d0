//! Manifests with levels that are cut into parts: version 2.

use super::tests::{read, rejection};
use super::*;
use crate::tile::{MapLayer, Storage, TileKey, TileShape};

fn file(contents: &str) -> Option<TileFile> {
    Some(TileFile::of(contents.as_bytes()))
}

/// A day map in both storages at 80 (four parts), 40 (two), 20 and 16 texels a block: the finest two of blocks 3 and 28 only, of which 28 has
/// no part 5 at the finest level.
fn manifest() -> Manifest {
    let level = |(place, parts, pixels): (usize, u32, u32)| {
        let shape = TileShape::cut(pixels, parts).expect("in range");
        let mut level = LevelEntry {
            shape,
            tiles: Vec::new(),
        };
        for storage in 0..2 {
            let has = |(block, part): (Block, u16)| {
                let is_in = place >= 2 || [3, 28].contains(&block.index());
                let is_gap = place == 0 && block.index() == 28 && part == 5;
                let name = format!("{place} {storage} {} {part}", block.index());
                (is_in && !is_gap).then(|| file(&name)).flatten()
            };
            level.tiles.push(level.places().map(has).collect());
        }
        level
    };
    Manifest {
        name: "cut".into(),
        attribution: Vec::new(),
        storages: vec![Storage::Plain, Storage::Bc],
        layers: vec![LayerEntry {
            layer: MapLayer::Day,
            source: "a map".into(),
            exaggeration: None,
            levels: [(0, 4, 20), (1, 2, 20), (2, 1, 20), (3, 1, 16)]
                .map(level)
                .into(),
        }],
        heights: None,
    }
}

#[test]
fn a_manifest_with_parts_comes_back_and_absent_blocks_cost_nothing() {
    let manifest = manifest();
    let text = manifest.to_toml();
    assert!(text.contains("\nformat = 2\n"), "{text}");
    assert_eq!(read(&text).expect("a good manifest"), manifest);
    // Two blocks at each of two levels in two storages.
    assert_eq!(text.matches(".block]]").count(), 8);
    let key = |level, block, part| TileKey {
        part,
        ..TileKey::whole(MapLayer::Day, level, block)
    };
    let tile = |key| manifest.tile(Storage::Bc, key);
    let (shape, found) = tile(key(0, 28, 6)).expect("it is there");
    assert_eq!((shape.parts, shape.block_pixels()), (4, 80));
    assert_eq!(Some(found), file("0 1 28 6"));
    for absent in [
        key(0, 28, 5),
        key(0, 28, 16),
        key(0, 4, 0),
        key(1, 3, 4),
        key(2, 3, 1),
    ] {
        assert_eq!(tile(absent), None, "{absent}");
    }
}

#[test]
fn packs_without_parts_stay_what_they_were() {
    let mut manifest = manifest();
    manifest.layers[0].levels.drain(..2);
    let text = manifest.to_toml();
    assert!(
        text.contains("\nformat = 1\n") && !text.contains("parts"),
        "{text}"
    );
    assert_eq!(read(&text).expect("good"), manifest);
    // Version 1 has no parts.
    let as_1 = super::cut_tests::manifest().to_toml();
    let said = rejection(&as_1.replacen("format = 2", "format = 1", 1));
    assert!(said.contains("layer.level.parts: unknown key"), "{said}");
}

#[test]
fn parts_that_cannot_be_are_rejected_with_line_key_and_remedy() {
    let text = manifest().to_toml();
    for (from, to, words) in [
        ("parts = 4", "parts = 3", &["must be 2, 4, 8 or 16"][..]),
        ("parts = 4", "parts = 1", &["from 2 to 16"]),
        ("parts = 4", "parts = 32", &["from 2 to 16"]),
        ("pixels = 80", "pixels = 81", &["must be a multiple of 4"]),
        ("pixels = 80", "pixels = 60", &["from 64 to 8160"]),
        ("pixels = 80", "pixels = 8164", &["from 64 to 8160"]),
        (
            "pixels = 80\nside = 32\nparts = 4",
            "pixels = 84\nside = 32\nparts = 4",
            &["tiles of 20 pixels and the level before has tiles of 21"],
        ),
        (
            "pixels = 80\nside = 32\nparts = 4",
            "pixels = 80\nside = 88",
            &["has 128 items|unknown key|bytes: is missing"],
        ),
        (
            "block = 28",
            "block = 3",
            &[
                "pack.toml:",
                "must be greater than that of the table before",
            ],
        ),
        ("block = 3", "block = 29", &["must be greater than"]),
        ("block = 28", "block = 128", &["from 0 to 127"]),
    ] {
        assert!(text.contains(from), "{from}");
        let said = rejection(&text.replacen(from, to, 1));
        for word in words {
            assert!(
                word.split('|').any(|word| said.contains(word)),
                "{from} → {to}: {said}"
            );
        }
        assert!(said.contains("pack.toml:"), "{said}");
    }
}

#[test]
fn tiles_that_do_not_fit_one_another_are_rejected() {
    let rejected = |change: &dyn Fn(&mut Vec<LevelEntry>), words: &str| {
        let mut manifest = manifest();
        change(&mut manifest.layers[0].levels);
        let said = rejection(&manifest.to_toml());
        assert!(said.contains(words), "{said}");
    };
    rejected(
        &|levels| levels[0].tiles[1][28 * 16 + 6] = None,
        "block 28, part 6, has a tile in one storage and none in the other",
    );
    // The tile that stands in for the parts of a block.
    rejected(
        &|levels| {
            for tiles in &mut levels[2].tiles {
                tiles[28] = None;
            }
        },
        "block 28 of \"day\" has parts of 80 pixels and no tile of 20",
    );
    rejected(&|levels| levels.swap(1, 2), "must be less than 20");
    rejected(
        &|levels| {
            levels.remove(2);
        },
        "tiles of 16 pixels and the level before has tiles of 20",
    );
    rejected(
        &|levels| levels.truncate(3),
        "has levels that are cut and no other but the coarsest",
    );
    rejected(
        &|levels| levels.truncate(2),
        "the coarsest level of \"day\" has 40 pixels and may have at most 256, and no parts",
    );
    // A level finer than those that are cut, of whole blocks.
    rejected(
        &|levels| {
            let shape = TileShape::new(100).expect("in range");
            let tiles = vec![vec![file("x"); 128]; 2];
            levels.insert(0, LevelEntry { shape, tiles });
        },
        "levels that are cut stand first",
    );
    rejected(
        &|levels| {
            for tiles in &mut levels[1].tiles {
                tiles.fill(None);
            }
        },
        "is missing",
    );
    let text = manifest().to_toml();
    let start = text.find("block = 3\n").expect("there");
    let end = start + text[start..].find("\n\n").expect("an end");
    let zeros = ["0"; 16].join(", ");
    let empty = ["\"\""; 16].join(", ");
    let none = format!("block = 3\nbytes = [{zeros}]\nchecksums = [{empty}]");
    let said = rejection(&[&text[..start], &none, &text[end..]].concat());
    assert!(
        said.contains("has no part; a block without any has no table"),
        "{said}"
    );
}
