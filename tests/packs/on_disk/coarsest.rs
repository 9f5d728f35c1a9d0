//! The coarsest level as whole maps.

use super::fixture::{Fixture, key, texel, write};
use std::time::Instant;
use terrella_imagery::LayerImage;
use terrella_imagery::pack::{PackError, PackTiles};
use terrella_imagery::tile::{MapLayer, Storage, TileError, TileShape};

fn tiles(fixture: &Fixture, storage: Storage, decode: bool) -> PackTiles {
    let layers: Vec<_> = fixture.manifest.layers.iter().map(|l| l.layer).collect();
    PackTiles::new(fixture.open(), storage, decode, &layers).expect("good")
}

fn texel_of(map: &LayerImage, column: u32, row: u32) -> &[u8] {
    let bytes = map.format.texel_bytes();
    let at = (row as usize * map.width as usize + column as usize) * bytes;
    &map.levels[0][at..at + bytes]
}

#[test]
fn every_texel_is_where_the_map_has_it() {
    let fixture = Fixture::shared();
    let (maps, errors) = tiles(fixture, Storage::Plain, false)
        .coarsest_maps()
        .expect("good");
    assert!(errors.is_empty(), "{errors:?}");
    for (layer, map) in [
        (MapLayer::Day, Some(&maps.day)),
        (MapLayer::Clouds, maps.clouds.as_ref()),
        (MapLayer::Normals, maps.normals.as_ref()),
        (MapLayer::NightLights, maps.night_lights.as_ref()),
        (MapLayer::Water, maps.water.as_ref()),
    ] {
        let map = map.expect("asked for");
        assert_eq!((map.width, map.height), (256, 128));
        map.check().expect("all mip levels");
        for row in 0..128 {
            for column in 0..256 {
                assert_eq!(
                    texel_of(map, column, row),
                    texel(layer, 256, column, row),
                    "{layer:?} {column} {row}"
                );
            }
        }
    }
    let only_day = PackTiles::new(fixture.open(), Storage::Plain, false, &[]).expect("good");
    let (maps, _) = only_day.coarsest_maps().expect("good");
    assert!(maps.clouds.is_none() && maps.water.is_none() && maps.normals.is_none());
}

/// Whole maps are plain, whether the tiles are given compressed or not.
#[test]
fn compressed_levels_become_plain_maps() {
    let fixture = Fixture::shared();
    for decode in [false, true] {
        let (maps, _) = tiles(fixture, Storage::Bc, decode)
            .coarsest_maps()
            .expect("good");
        // Border of four texels: blocks of 4 × 4 begin at the tile's own first texel.
        for (column, row) in [(0, 0), (255, 127), (100, 60), (17, 33)] {
            let first = |at: u32| at / 16 * 16 + at % 16 / 4 * 4;
            assert_eq!(
                texel_of(&maps.day, column, row),
                texel(MapLayer::Day, 256, first(column), first(row))
            );
            let normals = maps.normals.as_ref().expect("asked for");
            assert_eq!(
                texel_of(normals, column, row),
                texel(MapLayer::Normals, 256, first(column), first(row))
            );
        }
    }
}

#[test]
fn a_bad_block_is_made_of_the_next_finer_level() {
    let ladder = [64, 33, 16];
    let layers = [MapLayer::Day, MapLayer::Normals].map(|layer| (layer, &ladder[..]));
    let fixture = Fixture::new(&[Storage::Plain], &layers, |_| false);
    let tiles = tiles(&fixture, Storage::Plain, false);
    let (whole, _) = tiles.coarsest_maps().expect("good");

    // One block from the level of 33 (no integer ratio), one from that of 64, one of the normals.
    write(
        &fixture.path(Storage::Plain, key(MapLayer::Day, 2, 20)),
        b"bad",
    );
    for level in [1, 2] {
        std::fs::remove_file(fixture.path(Storage::Plain, key(MapLayer::Day, level, 41))).unwrap();
    }
    write(
        &fixture.path(Storage::Plain, key(MapLayer::Normals, 2, 127)),
        b"",
    );
    let (mended, errors) = tiles.coarsest_maps().expect("mended");
    let said: Vec<_> = errors.iter().map(ToString::to_string).collect();
    assert_eq!(said.len(), 4, "{said:?}");
    for (said, part) in said.iter().zip([
        "day/16/r1c4",
        "day/16/r2c9",
        "day/33/r2c9",
        "normals/16/r7c15",
    ]) {
        assert!(said.contains(part), "{said}");
    }
    let blocks = |column: u32, row: u32| row / 16 * 16 + column / 16;
    let linear = |code: u8| {
        let v = f64::from(code) / 255.0;
        if v <= 0.04045 {
            v / 12.92
        } else {
            ((v + 0.055) / 1.055).powf(2.4)
        }
    };
    // Mean of the finer texels over a coarse texel's area, in linear light.
    let mean = |pixels: u32, column: u32, row: u32, channel: usize| {
        let ratio = f64::from(pixels) / 16.0;
        let span = |at: u32| (f64::from(at) * ratio, f64::from(at + 1) * ratio);
        let ((left, right), (top, bottom)) = (span(column), span(row));
        let mut sum = 0.0;
        for y in top as u32..bottom.ceil() as u32 {
            for x in left as u32..right.ceil() as u32 {
                let cover = |at: u32, from: f64, to: f64| {
                    (f64::from(at + 1).min(to) - f64::from(at).max(from)).max(0.0)
                };
                let weight = cover(x, left, right) * cover(y, top, bottom);
                sum += weight * linear(texel(MapLayer::Day, pixels * 16, x, y)[channel]);
            }
        }
        sum / (ratio * ratio)
    };
    let mut compared = 0;
    for row in 0..128 {
        for column in 0..256 {
            let (before, after) = (
                texel_of(&whole.day, column, row),
                texel_of(&mended.day, column, row),
            );
            let pixels = match blocks(column, row) {
                20 => 33,
                41 => 64,
                _ => {
                    assert_eq!(before, after);
                    continue;
                }
            };
            for (channel, code) in after[..3].iter().enumerate() {
                let (found, expected) = (linear(*code), mean(pixels, column, row, channel));
                // Half a code of sRGB.
                assert!(
                    (found - expected).abs() < 0.0047,
                    "{column} {row}: {found} {expected}"
                );
            }
            assert_eq!(after[3], 255);
            compared += 1;
        }
    }
    assert_eq!(compared, 2 * 256);
    let (before, after) = (
        whole.normals.expect("there"),
        mended.normals.expect("there"),
    );
    let slope = |map: &LayerImage, x, y| f64::from(texel_of(map, x, y)[0] as i8);
    for (column, row) in [(240, 112), (255, 127), (250, 120)] {
        let difference = slope(&before, column, row) - slope(&after, column, row);
        assert!(difference.abs() < 20.0, "{difference}");
    }
    assert_eq!(texel_of(&before, 0, 0), texel_of(&after, 0, 0));
}

#[test]
fn only_a_block_without_any_good_level_is_lost() {
    let layers = [(MapLayer::Day, &[33, 16][..])];
    let fixture = Fixture::new(&[Storage::Plain], &layers, |key| {
        key.level == 0 && key.block == 5
    });
    let tiles = tiles(&fixture, Storage::Plain, false);
    assert!(tiles.coarsest_maps().is_ok());
    write(
        &fixture.path(Storage::Plain, key(MapLayer::Day, 1, 5)),
        b"bad",
    );
    let error = tiles.coarsest_maps().expect_err("lost");
    assert!(
        matches!(
            error,
            PackError::BlockLost {
                source: TileError::Corrupt { .. },
                ..
            }
        ),
        "{error}"
    );
    let said = error.to_string();
    assert!(
        said.contains("no level of day level 2 block r0c5") && said.contains("day/16/r0c5"),
        "{said}"
    );
}

/// Five maps of the paper's coarsest levels in well under half a second, for the first picture waits for them.
#[test]
fn the_papers_coarsest_level_is_read_in_no_time() {
    let layers = MapLayer::ALL.map(|layer| (layer, &layer.paper_pixels()[4..]));
    for storage in Storage::ALL {
        let fixture = Fixture::new(&[storage], &layers, |_| false);
        let tiles = tiles(&fixture, storage, false);
        let mut best = f64::INFINITY;
        for _ in 0..3 {
            let start = Instant::now();
            let (maps, errors) = tiles.coarsest_maps().expect("good");
            best = best.min(start.elapsed().as_secs_f64());
            assert!(errors.is_empty());
            assert_eq!(
                maps.day.width,
                TileShape::new(135).expect("in range").map_width()
            );
        }
        eprintln!(
            "coarsest maps from {} tiles: {:.0} ms",
            storage.name(),
            best * 1e3
        );
        // Generous, for the machine may be busy and the build is not the fast one.
        assert!(best < 1.5, "{best} s");
    }
}
