//! Random and damaged input: never a panic, never other texels.

use super::fixture::{Fixture, key, tile};
use proptest::prelude::*;
use std::path::Path;
use std::sync::LazyLock;
use terrella_ground::globe::Block;
use terrella_imagery::pack::{Manifest, PackTiles, read_ktx2, write_ktx2};
use terrella_imagery::tile::{MapLayer, Storage, Tile, TileShape, TileSource};

/// A small tile of each format.
static TILES: LazyLock<Vec<Tile>> = LazyLock::new(|| {
    let shape = TileShape::new(16).expect("in range");
    let block = Block { column: 5, row: 2 };
    let layers = [MapLayer::Day, MapLayer::Clouds, MapLayer::Normals];
    let tiles = Storage::ALL.map(|storage| layers.map(|layer| tile(storage, layer, shape, block)));
    tiles.concat()
});

static MANIFEST: LazyLock<String> = LazyLock::new(|| Fixture::shared().manifest.to_toml());

/// A change of a file.
#[derive(Clone, Debug)]
enum Change {
    Set(prop::sample::Index, u8),
    Cut(prop::sample::Index),
    Remove(prop::sample::Index, usize),
    Insert(prop::sample::Index, Vec<u8>),
    Repeat(prop::sample::Index, usize),
}

fn change() -> impl Strategy<Value = Change> {
    let place = any::<prop::sample::Index>;
    prop_oneof![
        4 => (place(), any::<u8>()).prop_map(|(at, byte)| Change::Set(at, byte)),
        1 => place().prop_map(Change::Cut),
        1 => (place(), 1..40usize).prop_map(|(at, len)| Change::Remove(at, len)),
        1 => (place(), prop::collection::vec(any::<u8>(), 1..20)).prop_map(|(at, new)| Change::Insert(at, new)),
        1 => (place(), 1..200usize).prop_map(|(at, len)| Change::Repeat(at, len)),
    ]
}

fn apply(bytes: &mut Vec<u8>, change: &Change) {
    if bytes.is_empty() {
        return;
    }
    let len = bytes.len();
    match change {
        Change::Set(at, byte) => bytes[at.index(len)] = *byte,
        Change::Cut(at) => bytes.truncate(at.index(len)),
        Change::Remove(at, count) => {
            let at = at.index(len);
            bytes.drain(at..(at + count).min(len));
        }
        Change::Insert(at, new) => {
            let at = at.index(len);
            bytes.splice(at..at, new.iter().copied());
        }
        Change::Repeat(at, count) => {
            let at = at.index(len);
            bytes.extend_from_within(at..(at + count).min(len));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn random_bytes_are_no_tile(bytes in prop::collection::vec(any::<u8>(), 0..2000)) {
        for tile in TILES.iter() {
            prop_assert!(read_ktx2(&bytes, tile.format, tile.shape).is_err());
            let mut headed = write_ktx2(tile)[..80].to_vec();
            headed.extend_from_slice(&bytes);
            prop_assert!(read_ktx2(&headed, tile.format, tile.shape).is_err());
        }
    }

    #[test]
    fn a_damaged_tile_is_rejected_or_has_its_texels(
        which in 0..6usize,
        changes in prop::collection::vec(change(), 1..6),
    ) {
        let tile = &TILES[which];
        let mut bytes = write_ktx2(tile);
        for change in &changes {
            apply(&mut bytes, change);
        }
        if let Ok(read) = read_ktx2(&bytes, tile.format, tile.shape) {
            prop_assert_eq!(&read, tile);
        }
    }

    #[test]
    fn random_text_is_no_manifest(text in "(?s).{0,400}") {
        prop_assert!(Manifest::from_toml(&text, Path::new("pack.toml")).is_err());
    }
}

proptest! {
    // A manifest of half a megabyte takes its time.
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn a_damaged_manifest_is_rejected_or_a_good_one(
        changes in prop::collection::vec(change(), 1..4),
        in_head in any::<bool>(),
    ) {
        let mut bytes = MANIFEST.as_bytes().to_vec();
        // Most of it is checksums: half of the changes go to the part before them.
        let tail = if in_head { bytes.split_off(1200) } else { Vec::new() };
        for change in &changes {
            apply(&mut bytes, change);
        }
        bytes.extend_from_slice(&tail);
        if let Ok(text) = std::str::from_utf8(&bytes)
            && let Ok(manifest) = Manifest::from_toml(text, Path::new("pack.toml"))
        {
            let again = Manifest::from_toml(&manifest.to_toml(), Path::new("pack.toml"));
            prop_assert_eq!(again.expect("its own text"), manifest);
        }
    }

    #[test]
    fn a_damaged_file_gives_a_tile_only_if_it_is_unchanged(
        changes in prop::collection::vec(change(), 0..4),
    ) {
        static PACK: LazyLock<Fixture> = LazyLock::new(Fixture::day);
        let tiles = PackTiles::new(PACK.open(), Storage::Bc, true, &[]).expect("good");
        let key = key(MapLayer::Day, 1, 64);
        let path = PACK.path(Storage::Bc, key);
        let shape = TileShape::new(16).expect("in range");
        let good = write_ktx2(&tile(Storage::Bc, MapLayer::Day, shape, key.block()));
        let mut bytes = good.clone();
        for change in &changes {
            apply(&mut bytes, change);
        }
        std::fs::write(&path, &bytes).expect("written");
        prop_assert_eq!(tiles.read(key, &|| false).is_ok(), bytes == good);
    }
}
