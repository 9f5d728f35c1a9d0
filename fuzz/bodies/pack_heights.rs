//! Elevation data of a pack: a byte that selects the reader, then the bytes of an index or of a tile.

use terrella_imagery::pack::{
    HeightKind, HeightPlace, HeightRecord, HeightValues, HeightsEntry, TileFile, decode_heights,
    decode_index, encode_heights, encode_index,
};

/// Small tiles, 16 × 16 with a border of 1, at two levels.
fn entry(kind: HeightKind, tiles: u32) -> HeightsEntry {
    HeightsEntry {
        sources: vec!["a formula".into()],
        levels: 2,
        columns: 16,
        side: 16,
        border: 1,
        kind,
        tiles,
        index: TileFile::of(b""),
    }
}

const STEPS: HeightKind = HeightKind::I16 {
    offset_m: 0.0,
    scale_m: 0.5,
};

/// Reads any bytes. Accepted data must be equal after it is written and read again.
pub fn run(data: &[u8]) {
    is_good(data);
}

/// Whether these bytes are a valid index or tile.
pub fn is_good(data: &[u8]) -> bool {
    let [what, bytes @ ..] = data else {
        return false;
    };
    match what % 3 {
        0 => is_tile(bytes, STEPS),
        1 => is_tile(bytes, HeightKind::F32),
        _ => is_index(bytes),
    }
}

fn is_tile(bytes: &[u8], kind: HeightKind) -> bool {
    let entry = entry(kind, 128);
    let Ok(values) = decode_heights(bytes, &entry) else {
        return false;
    };
    let (low_m, high_m) = values.range_m(kind).expect("it has samples");
    assert!(low_m.is_finite() && low_m <= high_m);
    let again = encode_heights(&values, entry.row_samples()).expect("compressed");
    assert_eq!(decode_heights(&again, &entry), Ok(values));
    true
}

fn is_index(bytes: &[u8]) -> bool {
    let count = bytes.get(8..12).and_then(<[u8]>::first_chunk);
    let entry = entry(STEPS, count.map_or(0, |count| u32::from_le_bytes(*count)));
    let Ok(index) = decode_index(bytes, &entry) else {
        return false;
    };
    assert_eq!(encode_index(index.records()), bytes);
    for record in index.records() {
        assert!(record.low_m <= record.high_m && entry.contains(record.place));
        assert_eq!(index.get(record.place), Some(record));
    }
    true
}

/// Good inputs to start from.
#[allow(dead_code, reason = "the fuzzer reads its corpus from files")]
pub fn seeds() -> Vec<Vec<u8>> {
    let with = |what: u8, bytes: Vec<u8>| [vec![what], bytes].concat();
    let tile = |values| encode_heights(&values, 18).expect("compressed");
    let record = |level, row, column| HeightRecord {
        place: HeightPlace { level, row, column },
        file: TileFile::of(b"tile"),
        low_m: -10.0,
        high_m: 10.0,
    };
    let coarsest = (0..128).map(|n| record(1, n / 16, n % 16));
    let index: Vec<_> = [record(0, 3, 30)].into_iter().chain(coarsest).collect();
    vec![
        with(0, tile(HeightValues::I16((0..324).collect()))),
        with(
            1,
            tile(HeightValues::F32(
                (0..324).map(|n| n as f32 * 0.3).collect(),
            )),
        ),
        with(2, encode_index(&index)),
    ]
}
