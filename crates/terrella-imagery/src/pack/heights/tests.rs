//! Elevation tiles and indexes as bytes.

use super::*;

fn entry(kind: HeightKind) -> HeightsEntry {
    HeightsEntry {
        sources: vec!["a formula".into()],
        levels: 2,
        columns: 16,
        side: 16,
        border: 1,
        kind,
        tiles: 130,
        index: TileFile::of(b""),
    }
}

const STEPS: HeightKind = HeightKind::I16 {
    offset_m: 100.0,
    scale_m: 0.5,
};

fn noise(n: usize) -> u32 {
    (n as u32).wrapping_mul(2_654_435_761) ^ (n as u32) << 13
}

#[test]
fn samples_come_back_to_the_last_bit() {
    let entry = entry(STEPS);
    let count = entry.tile_samples();
    let extremes = [i16::MIN, i16::MAX, 0, -1];
    for values in [
        (0..count).map(|n| (n * n / 50) as i16).collect::<Vec<_>>(),
        (0..count).map(|n| noise(n) as i16).collect(),
        (0..count)
            .map(|n| extremes[noise(n) as usize % 4])
            .collect(),
    ] {
        let values = HeightValues::I16(values);
        let bytes = encode_heights(&values, entry.row_samples()).expect("compressed");
        assert!(bytes.len() <= entry.most_file_bytes());
        assert_eq!(decode_heights(&bytes, &entry), Ok(values));
    }
    let entry = HeightsEntry {
        kind: HeightKind::F32,
        ..entry
    };
    let bits = |n: usize| f32::from_bits(noise(n));
    for values in [
        (0..count)
            .map(|n| (n as f32).sin() * 4000.0)
            .collect::<Vec<_>>(),
        (0..count)
            .map(|n| if n % 2 == 0 { -0.0 } else { 1e-40 })
            .collect(),
        (0..count)
            .map(|n| {
                if bits(n).is_finite() {
                    bits(n)
                } else {
                    f32::MIN
                }
            })
            .collect(),
    ] {
        let bytes = encode_heights(&HeightValues::F32(values.clone()), entry.row_samples());
        let Ok(HeightValues::F32(back)) = decode_heights(&bytes.expect("compressed"), &entry)
        else {
            panic!("not read");
        };
        assert!(
            back.iter()
                .zip(&values)
                .all(|(a, b)| a.to_bits() == b.to_bits())
        );
    }
}

#[test]
fn tiles_that_are_none_are_rejected() {
    let steps = entry(STEPS);
    let floats = entry(HeightKind::F32);
    let count = steps.tile_samples();
    let encode = |values: HeightValues| encode_heights(&values, 18).expect("compressed");
    let good = encode(HeightValues::I16(vec![7; count]));
    for (bytes, entry, words) in [
        (
            encode(HeightValues::I16(vec![7; count - 1])),
            &steps,
            "bytes instead of",
        ),
        (
            encode(HeightValues::I16(vec![7; count + 1])),
            &steps,
            "cannot be decompressed",
        ),
        (good.clone(), &floats, "bytes instead of"),
        (
            good[..good.len() - 2].to_vec(),
            &steps,
            "cannot be decompressed",
        ),
        (b"not compressed".to_vec(), &steps, "cannot be decompressed"),
        (vec![0; steps.most_file_bytes() + 1], &steps, "has at most"),
        (
            encode(HeightValues::F32(vec![f32::NAN; count])),
            &floats,
            "no numbers",
        ),
        (
            encode(HeightValues::F32(vec![f32::INFINITY; count])),
            &floats,
            "no numbers",
        ),
    ] {
        let error = decode_heights(&bytes, entry).expect_err("rejected");
        assert!(error.contains(words), "{error}");
    }
    let record = records()[0];
    let values = HeightValues::I16(vec![7; count]);
    assert_eq!(record.check_range(&values, STEPS), Ok(()));
    let beyond = HeightValues::I16([vec![7; count - 1], vec![2000]].concat());
    let error = record.check_range(&beyond, STEPS).expect_err("beyond");
    assert!(
        error.contains("1100 m") && error.contains("the index says"),
        "{error}"
    );
}

/// All of the coarsest of two levels, and two finer tiles.
fn records() -> Vec<HeightRecord> {
    let record = |level, row, column| HeightRecord {
        place: HeightPlace { level, row, column },
        file: TileFile::of(&[level, row as u8, column as u8]),
        low_m: -10.0 * f32::from(level) - 50.0,
        high_m: 1000.0 + f32::from(level),
    };
    let mut records = vec![record(0, 3, 30), record(0, 15, 31)];
    records.extend((0..128).map(|n| record(1, n / 16, n % 16)));
    records
}

#[test]
fn an_index_comes_back_and_finds_its_tiles() {
    let (entry, records) = (entry(STEPS), records());
    let bytes = encode_index(&records);
    assert_eq!(bytes.len() as u64, index_bytes(130));
    let index = decode_index(&bytes, &entry).expect("good");
    assert_eq!(index.records(), records);
    for record in &records {
        assert_eq!(index.get(record.place), Some(record));
    }
    let absent = HeightPlace {
        level: 0,
        row: 3,
        column: 31,
    };
    assert_eq!(index.get(absent), None);
}

/// Takes a tile of the coarsest level away.
fn drop_tile(records: &mut Vec<HeightRecord>, row: u32, column: u32) {
    let place = HeightPlace {
        level: 1,
        row,
        column,
    };
    records.retain(|record| record.place != place);
}

#[test]
fn indexes_that_cannot_be_are_rejected() {
    let rejected = |change: &dyn Fn(&mut Vec<HeightRecord>), words: &str| {
        let mut records = records();
        change(&mut records);
        let entry = HeightsEntry {
            tiles: records.len() as u32,
            ..entry(STEPS)
        };
        let error = decode_index(&encode_index(&records), &entry).expect_err("rejected");
        assert!(error.contains(words), "{error}");
    };
    rejected(&|r| r.swap(0, 1), "not in the order");
    rejected(&|r| r[1] = r[0], "not in the order");
    rejected(&|r| r[1].place.column = 32, "where there is none");
    rejected(&|r| r[129].place.level = 2, "where there is none");
    rejected(&|r| r[5].file.bytes = 0, "has 0 bytes");
    rejected(&|r| r[5].file.bytes = 1 << 30, "bytes");
    rejected(&|r| r[5].low_m = f32::NAN, "heights from NaN m");
    rejected(&|r| r[5].high_m = f32::INFINITY, "to inf m");
    rejected(&|r| r[5].high_m = -60.1, "heights from");
    rejected(&|r| r[0].low_m = -61.0, "beyond those of the coarser one");
    rejected(&|r| r[0].high_m = 1002.0, "beyond those of the coarser one");
    rejected(&|r| drop_tile(r, 4, 4), "has 127 of 128");
    rejected(
        &|r| r.retain(|record| record.place.column != 15),
        "no coarser one over it",
    );
    let (entry, bytes) = (entry(STEPS), encode_index(&records()));
    for (bytes, words) in [
        (&bytes[..bytes.len() - 1], "bytes instead of"),
        (&bytes[..11], "manifest says 130"),
        (&[][..], "other first bytes"),
        (&[&bytes[..], b"x"].concat(), "bytes instead of"),
    ] {
        let error = decode_index(bytes, &entry).expect_err("rejected");
        assert!(error.contains(words), "{error}");
    }
    let other = HeightsEntry {
        tiles: 131,
        ..entry
    };
    assert!(decode_index(&bytes, &other).is_err());
}

#[test]
fn paths_lie_in_the_pack_and_tell_level_row_and_column() {
    let place = HeightPlace {
        level: 0,
        row: 3,
        column: 30,
    };
    let path = entry(STEPS).path(place);
    assert_eq!(path, Path::new("heights/512/r3/c30.heights"));
}
