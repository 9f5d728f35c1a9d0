//! Levels that are cut into parts, on disk.

use super::fixture::{Fixture, key, part_tile, write};
use std::path::Path;
use terrella_imagery::pack::{Manifest, Pack, PackTiles, verify};
use terrella_imagery::tile::{MapLayer, Storage, TileError, TileKey, TileShape, TileSource};

fn shape(pixels: u32, parts: u32) -> TileShape {
    TileShape::cut(pixels, parts).expect("in range")
}

/// A day map at 80 (four parts), 40 (two), 20 and 16 texels a block, in both storages: parts of blocks 0, 31 and 112 only, of 31 at the
/// finest level but two.
fn fixture() -> Fixture {
    let shapes = vec![shape(20, 4), shape(20, 2), shape(20, 1), shape(16, 1)];
    Fixture::of_shapes(&Storage::ALL, &[(MapLayer::Day, shapes)], |key| {
        let has_parts = [0, 31, 112].contains(&key.block);
        let is_gap = key.block == 31 && ![3, 12].contains(&key.part);
        match key.level {
            0 => !has_parts || is_gap,
            1 => !has_parts,
            // The base may lack what has no parts.
            2 => key.block == 5,
            _ => false,
        }
    })
}

#[test]
fn parts_are_read_where_they_are_and_absent_where_they_are_not() {
    let fixture = fixture();
    assert_eq!(fixture.manifest.format(), 2);
    for storage in Storage::ALL {
        let tiles = PackTiles::new(fixture.open(), storage, false, &[]).expect("good");
        let layout = &tiles.layers()[0];
        assert_eq!(layout.cut_levels(), 2);
        let counts: Vec<u32> = layout.levels.iter().map(|l| l.present.len()).collect();
        assert_eq!(counts, [34, 12, 127, 128]);
        for (level, entry) in (0..).zip(&layout.levels) {
            for block in 0..128 {
                for part in 0..entry.shape.tiles_of_block() {
                    let key = TileKey {
                        part,
                        ..key(MapLayer::Day, level, block)
                    };
                    match tiles.read(key, &|| false) {
                        Ok(tile) => {
                            assert!(entry.present.contains(block, part), "{key}");
                            assert_eq!(tile, part_tile(storage, entry.shape, key), "{key}");
                        }
                        Err(TileError::Absent(absent)) => {
                            assert!(
                                !entry.present.contains(block, part) && absent == key,
                                "{key}"
                            );
                        }
                        Err(error) => panic!("{error}"),
                    }
                }
            }
        }
        let beyond = TileKey {
            part: 16,
            ..key(MapLayer::Day, 0, 0)
        };
        assert!(matches!(
            tiles.read(beyond, &|| false),
            Err(TileError::Absent(_))
        ));
        let (maps, errors) = tiles.coarsest_maps().expect("good");
        assert!(errors.is_empty() && maps.day.width == 256);
    }
}

#[test]
fn bad_parts_and_strangers_among_them_are_named() {
    let fixture = fixture();
    let report = verify(fixture.dir(), |_, _| {}).expect("a pack");
    assert!(report.is_good(), "{:?}", report.bad);
    assert_eq!(
        (report.tiles, report.stranger_count),
        (2 * (34 + 12 + 127 + 128), 0)
    );
    // Block 112 is column 0 of row 7: its part 15 is row 31, column 3 of the level.
    let bad = Path::new("tiles/plain/day/80/r31c3.ktx2");
    let missing = Path::new("tiles/bc/day/40/r0c1.ktx2");
    write(&fixture.dir().join(bad), b"not a tile");
    std::fs::remove_file(fixture.dir().join(missing)).expect("there");
    // Block 1 has no parts.
    let stranger = Path::new("tiles/plain/day/80/r0c4.ktx2");
    write(&fixture.dir().join(stranger), b"not listed");
    let report = verify(fixture.dir(), |_, _| {}).expect("a pack");
    let named: Vec<_> = report.bad.iter().map(|tile| tile.path.as_path()).collect();
    assert_eq!(named, [bad, missing]);
    assert_eq!(report.strangers, [stranger]);
}

/// Only a tile of the whole block stands in for a block; nothing is lost while there is one.
#[test]
fn whole_blocks_stand_in_for_the_coarsest_level_and_parts_do_not() {
    let fixture = fixture();
    let path = |level| fixture.path(Storage::Plain, key(MapLayer::Day, level, 31));
    write(&path(3), b"bad");
    let tiles = PackTiles::new(fixture.open(), Storage::Plain, false, &[]).expect("good");
    let (maps, errors) = tiles.coarsest_maps().expect("block 31 from 20 texels");
    assert_eq!((errors.len(), maps.day.width), (1, 256));
    write(&path(2), b"bad");
    let lost = tiles
        .coarsest_maps()
        .expect_err("no whole tile of block 31");
    assert!(
        lost.to_string()
            .contains("no level of day level 4 block r1c15"),
        "{lost}"
    );
}

/// Every line of a manifest with parts taken out, doubled or changed: read as a good one or rejected with words, never a panic.
#[test]
fn damaged_manifests_with_parts_are_rejected_with_line_or_key() {
    let fixture = fixture();
    let text = fixture.manifest.to_toml();
    let lines: Vec<&str> = text.lines().collect();
    let path = Path::new("pack.toml");
    let mut rejected = 0;
    for (at, line) in lines.iter().enumerate() {
        // Lists have hundreds of like lines.
        if line.starts_with("    ") && at % 29 != 0 {
            continue;
        }
        let changed = line.replacen(|c: char| c.is_ascii_digit(), "7", 1);
        for new in ["", &format!("{line}\n{line}"), &changed] {
            let mut all = lines.clone();
            all[at] = new;
            match Manifest::from_toml(&all.join("\n"), path) {
                Ok(manifest) => {
                    let again = Manifest::from_toml(&manifest.to_toml(), path);
                    assert_eq!(again.expect("its own text"), manifest);
                }
                Err(error) => {
                    rejected += 1;
                    let said = error.to_string();
                    assert!(said.starts_with("pack.toml:"), "{said}");
                    assert!(said.contains([';', '(']) || said.contains("must"), "{said}");
                }
            }
        }
    }
    assert!(rejected > 100, "{rejected}");
    assert!(Pack::open(fixture.dir()).is_ok());
}

#[test]
fn the_contact_sheet_shows_parts_at_their_places() {
    use terrella_pack::preview;
    // The block that is shown is 40.
    let shapes = vec![shape(20, 4), shape(20, 1), shape(16, 1)];
    let fixture = Fixture::of_shapes(&[Storage::Plain], &[(MapLayer::Day, shapes)], |key| {
        key.level == 0 && (key.block != 40 || key.part == 6)
    });
    let (sheet, errors) = preview(fixture.open(), None).expect("good");
    assert!(errors.is_empty());
    let texel = |part: u16, x: u32, y: u32| {
        let key = TileKey {
            part,
            ..key(MapLayer::Day, 0, 40)
        };
        let tile = part_tile(Storage::Plain, shape(20, 4), key);
        let at = 4 * ((y + 4) * tile.shape.side() + x + 4) as usize;
        [tile.texels[at], tile.texels[at + 1], tile.texels[at + 2]]
    };
    let (left, top) = (2 * (320 + 12), 12);
    for part in 0..16_u16 {
        // Four pixels a texel.
        let place = [u32::from(part) % 4, u32::from(part) / 4].map(|at| at * 80);
        for (x, y) in [(0, 0), (19, 0), (7, 11), (19, 19)] {
            let shown = sheet
                .get_pixel(left + place[0] + 4 * x + 1, top + place[1] + 4 * y + 2)
                .0;
            let expected = if part == 6 {
                [48, 48, 54]
            } else {
                texel(part, x, y)
            };
            assert_eq!(shown, expected, "part {part} {x} {y}");
        }
    }
}
