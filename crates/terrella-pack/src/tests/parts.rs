//! Builds with levels that are cut into parts. Levels are cut from 20 texels a block on here, so that maps are small.

use super::stopped::{Notes, Stopping, contents};
use super::write_day;
use crate::folder::Disk;
use crate::{BuildError, BuildOptions, BuildProgress, Division, Relief, build_with};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicU32;
use tempfile::TempDir;
use terrella_imagery::pack::{Manifest, Pack, PackTiles, verify};
use terrella_imagery::tile::{MapLayer, Storage, TILE_BORDER, Tile, TileKey, TileSource};

const CUT: Division = Division {
    columns: None,
    most_pixels: 20,
};

fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    write_day(&folder.path().join("map.png"), 512);
    folder
}

/// Colours and slopes at 80, 40, 20 and 16 texels a block.
fn options(folder: &Path, out: &str) -> BuildOptions {
    let map = folder.join("map.png");
    BuildOptions {
        name: Some("noise".to_string()),
        relief: Some(Relief::Normals(map.clone())),
        storages: vec![Storage::Plain],
        pixels: [MapLayer::Day, MapLayer::Normals]
            .map(|layer| (layer, vec![80, 40, 20, 16]))
            .into(),
        ..BuildOptions::new(map, folder.join(out))
    }
}

fn cut(options: &BuildOptions, progress: &dyn BuildProgress) -> Result<Manifest, BuildError> {
    build_with(options, progress, &Disk, CUT)
}

fn tiles(options: &BuildOptions) -> PackTiles {
    let pack = Arc::new(Pack::open(&options.out).expect("a pack"));
    let storage = options.storages[0];
    PackTiles::new(pack, storage, false, &[MapLayer::Normals]).expect("has it")
}

/// Rows of texels, border included.
fn rows(tile: &Tile) -> Vec<&[u8]> {
    let row_bytes = tile.shape.side() as usize * tile.format.unit_bytes() as usize;
    tile.mip(0).chunks_exact(row_bytes).collect()
}

#[test]
fn parts_hold_the_texels_of_the_level_that_is_not_cut() {
    let folder = folder();
    let in_parts = options(folder.path(), "parts");
    let manifest = cut(&in_parts, &()).expect("builds");
    let shapes = |manifest: &Manifest| {
        let levels = manifest.layers[1].levels.iter();
        let shapes = levels.map(|level| (level.shape.pixels, level.shape.parts));
        shapes.collect::<Vec<_>>()
    };
    assert_eq!(shapes(&manifest), [(20, 4), (20, 2), (20, 1), (16, 1)]);
    assert_eq!(manifest.format(), 2);
    let whole = options(folder.path(), "whole");
    let manifest = build_with(&whole, &(), &Disk, Division::default()).expect("builds");
    assert_eq!(shapes(&manifest), [(80, 1), (40, 1), (20, 1), (16, 1)]);
    assert_eq!(manifest.format(), 1);
    let (in_parts, whole) = (tiles(&in_parts), tiles(&whole));
    for (layer, texel_bytes) in [(MapLayer::Day, 4), (MapLayer::Normals, 2)] {
        for (level, parts) in [(0, 4), (1, 2), (2, 1)] {
            for block in 0..128 {
                let key = TileKey::whole(layer, level, block);
                let whole = whole.read(key, &|| false).expect("there");
                for part in 0..parts * parts {
                    let key = TileKey {
                        part: part as u16,
                        ..key
                    };
                    let tile = in_parts.read(key, &|| false).expect("there");
                    // Own texels and border are those of the block's tile there; the padding may extend beyond it.
                    let (top, left) = (part / parts * 20, part % parts * 20);
                    let width = 20 + 2 * TILE_BORDER as usize;
                    for (y, texels) in rows(&tile).iter().take(width).enumerate() {
                        let of_block = &rows(&whole)[top + y][left * texel_bytes..];
                        let len = width * texel_bytes;
                        assert_eq!(texels[..len], of_block[..len], "{key} row {y}");
                    }
                }
            }
        }
    }
}

#[test]
fn stops_passes_threads_and_little_memory_do_not_change_a_byte() {
    let folder = folder();
    // Without the finest level, which has three quarters of the tiles.
    let options = |folder: &Path, out: &str| {
        let mut options = options(folder, out);
        for (_, pixels) in &mut options.pixels {
            pixels.retain(|pixels| *pixels < 80);
        }
        options
    };
    let whole = options(folder.path(), "whole");
    cut(&whole, &()).expect("builds");
    let report = verify(&whole.out, |_, _| {}).expect("a pack");
    assert!(report.is_good() && report.stranger_count == 0);
    assert_eq!(report.tiles, 2 * 128 * (4 + 1 + 1));
    let whole = contents(&whole.out);

    let stopped = options(folder.path(), "stopped");
    for rows in [90, 250] {
        let error = cut(&stopped, &Stopping(AtomicU32::new(rows))).expect_err("stopped");
        assert!(matches!(error, BuildError::Cancelled), "{error}");
    }
    let noted = std::fs::read_to_string(stopped.out.join("build.journal")).expect("a journal");
    assert!(noted.contains("plain day 40/2 0/1 "), "{noted}");
    // A recorded and complete tile is not made again: its modification time stays.
    let first = stopped.out.join("tiles/plain/day/40/r0c1.ktx2");
    let made = |path: &Path| std::fs::metadata(path).and_then(|known| known.modified());
    let before = made(&first).expect("there");
    cut(&stopped, &()).expect("goes on");
    assert_eq!(made(&first).expect("there"), before);
    assert!(contents(&stopped.out) == whole);

    for (columns, threads) in [(1, 2), (4, 1)] {
        let options = BuildOptions {
            threads: Some(threads),
            ..options(folder.path(), &format!("{columns}x{threads}"))
        };
        let division = Division {
            columns: Some(columns),
            ..CUT
        };
        build_with(&options, &(), &Disk, division).expect("builds");
        assert!(contents(&options.out) == whole, "{columns} columns");
    }
    let little = |memory_bytes| BuildOptions {
        memory_bytes,
        ..options(folder.path(), "little")
    };
    let Err(BuildError::Memory { needed_mb, .. }) = cut(&little(1), &()) else {
        panic!("a byte is not enough");
    };
    let little = little(needed_mb * 1_000_000);
    cut(&little, &()).expect("builds");
    assert!(contents(&little.out) == whole);
}

#[test]
fn detail_that_no_level_holds_is_reported() {
    let folder = folder();
    let options = BuildOptions {
        relief: None,
        pixels: vec![(MapLayer::Day, vec![20, 16])],
        ..options(folder.path(), "pack")
    };
    let notes = Notes::default();
    cut(&options, &notes).expect("builds");
    let notes = notes.all();
    let reported = "map.png: has 512 texels round the Earth and the finest day level 320; finer detail is averaged, --pixels day=40,20,16 keeps 640";
    assert!(
        notes.iter().any(|note| note.ends_with(reported)),
        "{notes:?}"
    );
}
