//! Verifying, and the contact sheet.

use super::fixture::{Fixture, key, write};
use std::path::Path;
use terrella_imagery::pack::{PackError, verify};
use terrella_imagery::tile::{MapLayer, Storage};
use terrella_pack::preview;

#[test]
fn a_good_pack_is_good() {
    let fixture = Fixture::shared();
    let mut steps = Vec::new();
    let report = verify(fixture.dir(), |done, total| steps.push((done, total))).expect("a pack");
    assert!(
        report.is_good() && report.strangers.is_empty(),
        "{report:?}"
    );
    assert_eq!(report.tiles, 2 * 5 * 2 * 128);
    assert_eq!(steps.len(), 2561);
    assert!(
        steps
            .iter()
            .enumerate()
            .all(|(n, step)| *step == (n as u64, 2560))
    );
    let files = fixture
        .manifest
        .layers
        .iter()
        .flat_map(|layer| &layer.levels);
    let files = files.flat_map(|level| level.tiles.iter().flatten().flatten());
    assert_eq!(report.bytes, files.map(|file| file.bytes).sum::<u64>());
}

#[test]
fn every_bad_tile_is_named_and_nothing_else() {
    let fixture = Fixture::small();
    let path = |storage, layer, level, block| fixture.path(storage, key(layer, level, block));
    let tampered = path(Storage::Plain, MapLayer::Clouds, 0, 127);
    let mut contents = std::fs::read(&tampered).expect("there");
    let last = contents.len() - 1;
    contents[last] ^= 1;
    write(&tampered, &contents);
    std::fs::remove_file(path(Storage::Plain, MapLayer::Day, 1, 16)).expect("there");
    write(&path(Storage::Bc, MapLayer::Water, 1, 0), &contents[..10]);
    std::fs::remove_dir_all(fixture.dir().join("tiles/bc/normals/33")).expect("there");
    for stranger in [
        "tiles/plain/day/33/.terrella-x.part",
        "tiles/plain/day/33/r0c16.ktx2",
        "tiles/plain/day/99/r0c0.ktx2",
        "tiles/notes.txt",
        "tiles/plain/moon/33/r0c0.ktx2",
    ] {
        write(&fixture.dir().join(stranger), b"");
    }
    write(&fixture.dir().join("README"), b"beside the tiles");

    let report = verify(fixture.dir(), |_, _| {}).expect("a pack");
    assert!(!report.is_good());
    let bad: Vec<_> = report.bad.iter().map(|tile| tile.path.as_path()).collect();
    assert_eq!(bad.len(), 3 + 128);
    assert_eq!(
        bad[..2],
        [
            Path::new("tiles/plain/day/16/r1c0.ktx2"),
            Path::new("tiles/plain/clouds/33/r7c15.ktx2"),
        ]
    );
    assert_eq!(bad[130], Path::new("tiles/bc/water/16/r0c0.ktx2"));
    assert!(
        bad[2..130]
            .iter()
            .all(|path| path.starts_with("tiles/bc/normals/33"))
    );
    let causes: Vec<_> = [0, 1, 2, 130]
        .map(|at| report.bad[at].cause.as_str())
        .into();
    assert_eq!(
        causes[..3],
        [
            "it is missing",
            "its checksum does not match the manifest",
            "it is missing"
        ]
    );
    assert!(
        causes[3].starts_with("it has 10 bytes instead of"),
        "{causes:?}"
    );
    let strangers: Vec<_> = report
        .strangers
        .iter()
        .map(|path| path.to_str().expect("text"))
        .collect();
    assert_eq!(
        strangers,
        [
            "tiles/notes.txt",
            "tiles/plain/day/33/.terrella-x.part",
            "tiles/plain/day/33/r0c16.ktx2",
            "tiles/plain/day/99",
            "tiles/plain/moon",
        ]
    );
    assert_eq!(report.stranger_count, 5);
}

#[test]
fn many_strangers_are_counted_and_not_all_listed() {
    let layers = [(MapLayer::Day, &[16][..])];
    let fixture = Fixture::new(&[Storage::Plain], &layers, |_| false);
    for n in 0..1100 {
        write(&fixture.dir().join(format!("tiles/{n}")), b"");
    }
    let report = verify(fixture.dir(), |_, _| {}).expect("a pack");
    assert_eq!(
        (report.strangers.len(), report.stranger_count),
        (1000, 1100)
    );
    assert!(report.is_good());
}

#[test]
fn what_is_no_pack_is_not_verified() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let error = verify(folder.path(), |_, _| {}).expect_err("no pack");
    assert!(matches!(error, PackError::NoManifest { .. }), "{error}");
}

#[test]
fn the_sheet_shows_maps_and_blocks_where_it_says() {
    let layers = [
        (MapLayer::Day, &[40, 33, 16][..]),
        (MapLayer::Normals, &[16]),
        (MapLayer::Water, &[33, 16]),
    ];
    // The block that is shown, r2c8, has no tile at day's second level.
    let fixture = Fixture::new(&[Storage::Plain], &layers, |key| {
        key.layer == MapLayer::Day && key.level == 1 && key.block == 40
    });
    write(
        &fixture.path(Storage::Plain, key(MapLayer::Water, 0, 40)),
        b"bad",
    );
    let (sheet, errors) = preview(fixture.open(), None).expect("a pack");
    assert_eq!(errors.len(), 1, "{errors:?}");
    assert_eq!(sheet.dimensions(), (5 * 332, 3 * 332 + 12));
    let pixel = |x: u32, y: u32| sheet.get_pixel(x, y).0;
    let texel = |layer, pixels: u32, x, y| super::fixture::texel(layer, pixels * 16, x, y);
    // 640 × 320 pixels of 256 × 128 texels, two and a half pixels to a texel.
    assert_eq!(pixel(12, 12)[..], texel(MapLayer::Day, 16, 0, 0)[..3]);
    assert_eq!(
        pixel(12 + 639, 12 + 319)[..],
        texel(MapLayer::Day, 16, 255, 127)[..3]
    );
    // Blocks: 40 texels in 320 pixels, a gap, 16 texels.
    let left = |level: u32| 664 + level * 332;
    assert_eq!(
        pixel(left(0), 12)[..],
        texel(MapLayer::Day, 40, 320, 80)[..3]
    );
    assert_eq!(
        pixel(left(0) + 319, 12 + 319)[..],
        texel(MapLayer::Day, 40, 359, 119)[..3]
    );
    assert_eq!(pixel(left(1) + 100, 100), [48, 48, 54]);
    assert_eq!(
        pixel(left(2), 12)[..],
        texel(MapLayer::Day, 16, 128, 32)[..3]
    );
    // Water is the third row: its bad tile, then grey.
    let water_top = 12 + 2 * 332;
    assert_eq!(pixel(left(0), water_top), [255, 0, 255]);
    assert_eq!(
        pixel(left(1), water_top),
        [texel(MapLayer::Water, 16, 128, 32)[0]; 3]
    );
    // A frame round the sample on the map, and nothing right of the last picture.
    assert_eq!(pixel(12 + 8 * 40, 12 + 2 * 40), [255, 200, 60]);
    assert_eq!(pixel(left(1), 12 + 332), [24, 24, 28]);
    let error = preview(fixture.open(), Some(Storage::Bc)).expect_err("not kept");
    assert!(matches!(error, PackError::NoStorage { .. }), "{error}");
}
