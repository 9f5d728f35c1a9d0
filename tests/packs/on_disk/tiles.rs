//! Tiles read from disk.

use super::fixture::{Fixture, key, tile, write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use terrella_ground::globe::Block;
use terrella_imagery::pack::{
    CoarsestMap, MANIFEST_FILE, MAX_OVERHEAD_BYTES, Pack, PackError, PackTiles, TileFile,
    decode_tile,
};
use terrella_imagery::tile::{MapLayer, Storage, Tile, TileError, TileKey, TileSet, TileSource};

fn never() -> bool {
    false
}

fn corrupt(read: Result<Tile, TileError>, path: &Path) -> String {
    match read {
        Err(TileError::Corrupt { path: named, cause }) => {
            assert_eq!(named, path);
            cause
        }
        other => panic!("not rejected as corrupt: {other:?}"),
    }
}

#[test]
fn every_tile_is_read_as_it_was_written() {
    let fixture = Fixture::shared();
    for storage in Storage::ALL {
        let tiles = PackTiles::new(fixture.open(), storage, false, &MapLayer::ALL).expect("good");
        let plain = PackTiles::new(fixture.open(), storage, true, &MapLayer::ALL).expect("good");
        assert_eq!(tiles.layers().len(), 5);
        for (layout, decoded) in tiles.layers().iter().zip(plain.layers()) {
            assert_eq!(layout.format, layout.layer.tile_format(storage));
            assert_eq!(decoded.format, layout.format.decoded());
            for (level, entry) in (0..).zip(&layout.levels) {
                assert_eq!(entry.present, TileSet::all(entry.shape));
                for block in Block::all().step_by(13) {
                    let key = key(layout.layer, level, block.index() as u8);
                    let written = tile(storage, layout.layer, entry.shape, block);
                    assert_eq!(tiles.read(key, &never).expect("good"), written);
                    let read = plain.read(key, &never).expect("good");
                    assert_eq!(read.format, decoded.format);
                    assert_eq!(read, decode_tile(written));
                }
            }
        }
    }
}

/// As a web page does, which has no files.
#[test]
fn a_host_reads_the_files_itself() {
    let fixture = Fixture::shared();
    let bytes = std::fs::read(fixture.dir().join(MANIFEST_FILE)).expect("a manifest");
    let address = Path::new("https://tiles.example/earth");
    let pack = Arc::new(Pack::from_manifest(address, bytes).expect("good"));
    for (storage, decode) in [
        (Storage::Plain, false),
        (Storage::Bc, false),
        (Storage::Bc, true),
    ] {
        let of_host = PackTiles::new(pack.clone(), storage, decode, &MapLayer::ALL).expect("good");
        let of_disk =
            PackTiles::new(fixture.open(), storage, decode, &MapLayer::ALL).expect("good");
        assert_eq!(of_host.layers(), of_disk.layers());
        for layout in of_disk.layers() {
            for level in 0..layout.levels.len() as u8 {
                let key = key(layout.layer, level, 77);
                let (path, length) = of_host.file(key).expect("there");
                let inside = path.strip_prefix(address).expect("below the address");
                let bytes = std::fs::read(fixture.dir().join(inside)).expect("a file");
                assert_eq!(bytes.len() as u64, length);
                let tile = of_host.tile_of(key, &bytes).expect("good");
                assert_eq!(tile, of_disk.read(key, &never).expect("good"));
                for (bad, must_say) in [
                    (&bytes[1..], "bytes instead of"),
                    (&[&bytes[..], &[0]].concat(), "is longer than"),
                    (&[&[bytes[0] ^ 1], &bytes[1..]].concat(), "its checksum"),
                ] {
                    let cause = corrupt(of_host.tile_of(key, bad), &path);
                    assert!(cause.contains(must_say), "{cause}");
                }
            }
            let (maps, _) = of_disk.coarsest_maps().expect("good");
            let mut map = CoarsestMap::new(layout);
            let level = layout.levels.len() as u8 - 1;
            for block in Block::all() {
                let block = block.index() as u8;
                let tile = of_disk.read(key(layout.layer, level, block), &never);
                map.add(block, tile.expect("good"));
            }
            assert_eq!(Some(&map.finish().expect("levels")), maps.get(layout.layer));
        }
    }
    let absent = key(MapLayer::Day, 9, 0);
    assert!(
        matches!(fixture_tiles(&pack).file(absent), Err(TileError::Absent(key)) if key == absent)
    );
    let error = Pack::from_manifest(address, b"format = 1\n".to_vec()).expect_err("no pack");
    let words = error.to_string();
    assert!(
        words.starts_with("https://tiles.example/earth/pack.toml: columns: is missing"),
        "{words}"
    );
}

fn fixture_tiles(pack: &Arc<Pack>) -> PackTiles {
    PackTiles::new(pack.clone(), Storage::Plain, false, &[]).expect("good")
}

/// Blocks of equal texels decode to just these; at every mip level, though sides are no multiples of four.
#[test]
fn compressed_texels_are_those_of_their_blocks() {
    for layer in MapLayer::ALL {
        let shape = terrella_imagery::tile::TileShape::new(33).expect("in range");
        let block = Block { column: 15, row: 7 };
        let compressed = tile(Storage::Bc, layer, shape, block);
        let plain = tile(Storage::Plain, layer, shape, block);
        let decoded = decode_tile(compressed);
        assert_eq!(decoded.texels.len(), plain.texels.len());
        let texel_bytes = plain.format.unit_bytes() as usize;
        for mip in 0..4 {
            let side = shape.mip_side(mip) as usize;
            for (at, texel) in decoded.mip(mip).chunks_exact(texel_bytes).enumerate() {
                let (x, y) = (at % side / 4 * 4, at / side / 4 * 4);
                let first = (y * side + x) * texel_bytes;
                let expected = &plain.mip(mip)[first..first + texel_bytes];
                assert_eq!(texel, expected, "{layer:?} mip {mip} texel {at}");
            }
        }
    }
}

#[test]
fn only_what_was_asked_for_is_there() {
    let layers = [(MapLayer::Day, &[33, 16][..]), (MapLayer::Water, &[16])];
    let fixture = Fixture::new(&[Storage::Plain], &layers, |key| {
        key.layer == MapLayer::Day && key.level == 0 && key.block % 2 == 1
    });
    let error = PackTiles::new(fixture.open(), Storage::Bc, false, &[]).expect_err("no BC");
    assert!(
        error.to_string().contains("has no bc tiles, only plain"),
        "{error}"
    );
    let wanted = [MapLayer::Clouds];
    let error = PackTiles::new(fixture.open(), Storage::Plain, false, &wanted);
    let error = error.expect_err("no clouds");
    assert!(
        matches!(
            error,
            PackError::NoLayer {
                layer: MapLayer::Clouds,
                ..
            }
        ),
        "{error}"
    );

    let tiles = PackTiles::new(fixture.open(), Storage::Plain, false, &[]).expect("good");
    assert_eq!(tiles.layers().len(), 1, "the day map always");
    assert_eq!(tiles.layers()[0].levels[0].present.len(), 64);
    let absent =
        |key: TileKey| matches!(tiles.read(key, &never), Err(TileError::Absent(k)) if k == key);
    assert!(absent(key(MapLayer::Day, 0, 1)), "a gap");
    assert!(absent(key(MapLayer::Day, 2, 0)), "no such level");
    assert!(absent(key(MapLayer::Day, 1, 128)), "no such block");
    assert!(absent(key(MapLayer::Water, 0, 0)), "not asked for");
    assert!(absent(key(MapLayer::Clouds, 0, 0)), "not in the pack");
    assert!(tiles.read(key(MapLayer::Day, 0, 2), &never).is_ok());
}

#[test]
fn a_file_that_is_not_as_listed_gives_no_tile() {
    let fixture = Fixture::day();
    let tiles = PackTiles::new(fixture.open(), Storage::Plain, true, &[]).expect("good");
    let key = key(MapLayer::Day, 1, 77);
    let path = fixture.path(Storage::Plain, key);
    let good = std::fs::read(&path).expect("there");
    let read = || tiles.read(key, &never);

    for len in [0, 1, 79, 200, good.len() - 1] {
        write(&path, &good[..len]);
        let cause = corrupt(read(), &path);
        assert_eq!(
            cause,
            format!("it has {len} bytes instead of {}", good.len())
        );
    }
    write(&path, &[&good[..], b"x"].concat());
    assert_eq!(
        corrupt(read(), &path),
        format!("it is longer than {} bytes", good.len())
    );
    // Of a file that has become endless no more is read than can be valid.
    let file = std::fs::File::create(&path).expect("made");
    file.set_len(1 << 40).expect("a long file of nothing");
    assert!(corrupt(read(), &path).contains("it is longer"));
    // Every seventh byte: a file takes longer to write than to hash.
    for at in (0..good.len()).step_by(7) {
        let mut bad = good.clone();
        bad[at] ^= 0x10;
        write(&path, &bad);
        assert_eq!(
            corrupt(read(), &path),
            "its checksum does not match the manifest"
        );
    }
    // Another good tile in its place.
    let other = fixture.path(Storage::Plain, TileKey { block: 78, ..key });
    std::fs::copy(&other, &path).expect("copied");
    assert!(!corrupt(read(), &path).is_empty());

    std::fs::remove_file(&path).expect("removed");
    let error = read().expect_err("missing");
    assert!(matches!(error, TileError::Unreadable { .. }), "{error}");
    assert!(error.to_string().contains("r4c13.ktx2"), "{error}");
    std::fs::create_dir(&path).expect("made");
    assert_eq!(corrupt(read(), &path), "it is a folder, not a file");
    std::fs::remove_dir(&path).expect("removed");
    write(&path, &good);
    assert!(read().is_ok());
}

/// The manifest vouches for the file, and still the file is not what it must be.
#[test]
fn a_checksum_does_not_make_a_tile_good() {
    let mut fixture = Fixture::day();
    let key = key(MapLayer::Day, 1, 3);
    let path = fixture.path(Storage::Plain, key);
    let good = std::fs::read(&path).expect("there");
    let wrong_shape = std::fs::read(fixture.path(Storage::Plain, TileKey { level: 0, ..key }));
    let wrong_format = std::fs::read(fixture.path(Storage::Bc, key));
    for (contents, part) in [
        (good[..320].to_vec(), "it ends within mip level 0"),
        (b"hello".to_vec(), "it ends within its header"),
        (
            wrong_shape.expect("there"),
            "the width is 48 and must be 24",
        ),
        (
            wrong_format.expect("there"),
            "the Vulkan format is 146 and must be 43",
        ),
    ] {
        write(&path, &contents);
        fixture.manifest.layers[0].levels[1].tiles[0][3] = Some(TileFile::of(&contents));
        fixture.write_manifest(&fixture.manifest);
        let tiles = PackTiles::new(fixture.open(), Storage::Plain, false, &[]).expect("good");
        let cause = corrupt(tiles.read(key, &never), &path);
        assert!(cause.contains(part), "{cause}");
    }
    assert!(good.len() < MAX_OVERHEAD_BYTES);
}

/// A file rewritten between any two steps of the reading: the old texels or an error.
#[test]
fn a_file_replaced_while_it_is_read_never_gives_other_texels() {
    let fixture = Fixture::day();
    let tiles = PackTiles::new(fixture.open(), Storage::Plain, true, &[]).expect("good");
    let key = key(MapLayer::Day, 1, 9);
    let path = fixture.path(Storage::Plain, key);
    let good = std::fs::read(&path).expect("there");
    let expected = tiles.read(key, &never).expect("good");
    let other = std::fs::read(fixture.path(Storage::Plain, TileKey { block: 10, ..key }));
    let same_length = vec![0; good.len()];
    let mut outcomes = [0, 0];
    for contents in [
        other.expect("there"),
        same_length,
        good[..100].to_vec(),
        Vec::new(),
    ] {
        for step in 0..6 {
            write(&path, &good);
            let asked = AtomicUsize::new(0);
            let rewrite = || {
                if asked.fetch_add(1, Ordering::Relaxed) == step {
                    write(&path, &contents);
                }
                false
            };
            match tiles.read(key, &rewrite) {
                Ok(tile) => {
                    assert_eq!(tile, expected);
                    outcomes[0] += 1;
                }
                Err(TileError::Corrupt { .. }) => outcomes[1] += 1,
                Err(error) => panic!("step {step}: {error}"),
            }
        }
    }
    assert!(outcomes.iter().all(|count| *count >= 4), "{outcomes:?}");
}

#[test]
fn reading_ends_at_any_step_once_it_is_cancelled() {
    let fixture = Fixture::day();
    let tiles = PackTiles::new(fixture.open(), Storage::Bc, true, &[]).expect("good");
    let key = key(MapLayer::Day, 0, 0);
    let mut steps = 0;
    loop {
        let asked = AtomicUsize::new(0);
        let read = tiles.read(key, &|| asked.fetch_add(1, Ordering::Relaxed) == steps);
        match read {
            Err(TileError::Cancelled) => assert_eq!(asked.into_inner(), steps + 1),
            Ok(_) => break,
            Err(error) => panic!("{error}"),
        }
        steps += 1;
    }
    assert_eq!(
        steps, 5,
        "before opening, reading, hashing, decompressing and decoding"
    );
}

#[cfg(unix)]
#[test]
fn a_pipe_in_place_of_a_tile_is_not_waited_for() {
    let fixture = Fixture::day();
    let tiles = PackTiles::new(fixture.open(), Storage::Plain, false, &[]).expect("good");
    let key = key(MapLayer::Day, 1, 0);
    let path = fixture.path(Storage::Plain, key);
    std::fs::remove_file(&path).expect("removed");
    let made = std::process::Command::new("mkfifo").arg(&path).status();
    assert!(made.expect("mkfifo").success());
    let cause = corrupt(tiles.read(key, &never), &path);
    assert_eq!(cause, "it is a pipe, not a file");
}
