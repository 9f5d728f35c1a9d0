//! Files of SQLite and of the reference implementation of PMTiles, as `tests/data/gdal/make_archives.py` makes them.

use super::super::archive_part::archive_tiles;
use super::super::{Mosaic, TileSet};
use super::*;
use crate::source::{Extent, RowSource, SourceLimits, read_extent};
use std::io::Cursor;
use std::path::PathBuf;

const LIMITS: SourceLimits = SourceLimits {
    buffer_bytes: 32 << 20,
};

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../tests/data/gdal")
        .join(name)
}

/// The colour of a tile of make_archives.py.
fn colour(level: u8, column: u32, row: u32) -> [u8; 3] {
    [30 * level, 17 * column as u8, 23 * row as u8]
}

/// The colour of a tile's file.
fn colour_in(bytes: Vec<u8>) -> [u8; 3] {
    let source = read_extent(Cursor::new(bytes), Path::new("tile"), LIMITS, Extent::Piece);
    let mut source = source.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((source.info().width, source.info().height), (32, 32));
    let mut row = vec![0; source.info().row_bytes()];
    source.next_row(&mut row).expect("a row");
    [row[0], row[1], row[2]]
}

fn set(name: &str) -> TileSet {
    let (set, _) = archive_tiles(&data(name)).unwrap_or_else(|error| panic!("{error}"));
    set
}

#[test]
fn each_tile_is_found_at_its_place() {
    for (name, level, columns, rows) in [
        ("table.mbtiles", 3, 0..8, 0..8),
        ("tiles.pmtiles", 3, 0..8, 0..8),
        ("two_tables.mbtiles", 2, 1..3, 1..4),
    ] {
        let set = set(name);
        assert_eq!(
            (set.tile_size, set.archive_level),
            (32, Some(level)),
            "{name}"
        );
        assert_eq!((&set.columns, &set.rows), (&columns, &rows), "{name}");
        let mut archive = Archive::open(&data(name)).expect("open");
        for (row, column) in rows.flat_map(|row| columns.clone().map(move |column| (row, column))) {
            let tile = archive.tile(row, column).expect("read");
            match (name, row, column) {
                ("table.mbtiles" | "tiles.pmtiles", 2, 5) => assert_eq!(tile, None, "{name}"),
                _ => {
                    let tile = tile.unwrap_or_else(|| panic!("{name}: no tile {row} {column}"));
                    assert_eq!(
                        colour_in(tile),
                        colour(level, column, row),
                        "{name} {row} {column}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_file_of_tiles_is_a_mosaic() {
    for name in ["table.mbtiles", "tiles.pmtiles"] {
        let mosaic = Mosaic::open(&data(name), None, LIMITS).expect("a mosaic");
        let info = mosaic.info();
        let mut rows = mosaic.rows(LIMITS);
        let mut row = vec![0; info.row_bytes()];
        let mut all: Vec<u8> = Vec::new();
        for _ in 0..info.height {
            rows.next_row(&mut row).expect("a row");
            all.extend_from_slice(&row);
        }
        // The middle of tile 6, 3: 112.5 degrees east, 20.6 degrees north.
        let at = |lat_deg: f64, lon_deg: f64| {
            let y = ((90.0 - lat_deg) / 180.0 * f64::from(info.height)) as usize;
            let x = ((lon_deg + 180.0) / 360.0 * f64::from(info.width)) as usize;
            let n = (y * info.width as usize + x) * info.channels;
            [all[n], all[n + 1], all[n + 2]]
        };
        assert_eq!(at(20.6, 112.5), colour(3, 6, 3), "{name}");
        // Tile 1, 6, in the south.
        assert_eq!(at(-74.0, -112.5), colour(3, 1, 6), "{name}");
        let notes = rows.notes().join(" ");
        assert!(
            notes.contains("1 tiles are not there") && notes.contains("3/5/2"),
            "{notes}"
        );
    }
}

#[test]
fn numbers_of_tiles_are_those_of_the_specification() {
    // Examples of the specification, and of the reference implementation's tests.
    for (level, column, row, id) in [
        (0, 0, 0, 0),
        (1, 0, 0, 1),
        (1, 0, 1, 2),
        (1, 1, 1, 3),
        (1, 1, 0, 4),
        (2, 0, 0, 5),
        (12, 3423, 1763, 19_078_479),
    ] {
        assert_eq!(
            pmtiles::tile_id(level, column, row),
            id,
            "{level} {column} {row}"
        );
    }
}

#[test]
fn what_is_not_read_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let said = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).expect("written");
        let error = Archive::open(&path).err().map(|error| error.to_string());
        error.unwrap_or_else(|| panic!("{name} is accepted"))
    };
    let pmtiles = std::fs::read(data("tiles.pmtiles")).expect("a file");
    for (at, value, words) in [
        (7, 2, "PMTiles of version 2"),
        (97, 3, "directories compressed by Brotli"),
        (98, 4, "tiles compressed by ZSTD"),
        (99, 1, "holds vector tiles"),
        (99, 5, "AVIF"),
        (101, 60, "levels 0 to 60"),
        (0, b'X', "is neither MBTiles nor PMTiles"),
    ] {
        let mut other = pmtiles.clone();
        other[at] = value;
        let said = said("a.pmtiles", &other);
        assert!(said.contains(words), "{said}");
    }
    let mbtiles = std::fs::read(data("table.mbtiles")).expect("a file");
    let mut other = mbtiles.clone();
    other[59] = 2;
    assert!(said("a.mbtiles", &other).contains("UTF-16"));
    other = mbtiles.clone();
    let at = other
        .windows(9)
        .position(|bytes| bytes == b"tile_data")
        .expect("a column");
    other[at] = b'x';
    assert!(said("b.mbtiles", &other).contains("no table of tiles"));
    std::fs::write(folder.path().join("c.mbtiles-wal"), "x").expect("written");
    assert!(said("c.mbtiles", &mbtiles).contains("a log beside it"));
}

#[test]
fn changed_files_are_errors_or_other_tiles_but_no_panics() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut wrong, mut right) = (0, 0);
    for name in ["table.mbtiles", "two_tables.mbtiles", "tiles.pmtiles"] {
        let whole = std::fs::read(data(name)).expect("a file");
        let path = folder.path().join(name);
        let mut read = |bytes: &[u8]| {
            std::fs::write(&path, bytes).expect("written");
            let Ok(mut archive) = Archive::open(&path) else {
                wrong += 1;
                return;
            };
            for (row, column) in (0..8).flat_map(|row| (0..8).map(move |column| (row, column))) {
                match archive.tile(row, column) {
                    Ok(_) => right += 1,
                    Err(_) => wrong += 1,
                }
            }
        };
        for n in (0..whole.len()).step_by(whole.len() / 200) {
            let mut other = whole.clone();
            other[n] ^= 0xFF;
            read(&other);
            read(&whole[..n]);
        }
    }
    assert!(wrong > 100 && right > 1000, "{wrong} {right}");
}
