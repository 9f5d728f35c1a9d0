//! Invalid star files.

use terrella::celestial::{StarCatalogue, StarError};

fn file(count: u32, records: &[[u8; 24]]) -> Vec<u8> {
    let mut bytes = b"TRSTARS1".to_vec();
    bytes.extend(count.to_le_bytes());
    bytes.extend(records.iter().flatten());
    bytes
}

/// Sirius, with some bytes overwritten.
fn record(at: usize, bytes: &[u8]) -> [u8; 24] {
    let mut record = [0; 24];
    record[0..4].copy_from_slice(&32_349_u32.to_le_bytes());
    record[20..22].copy_from_slice(&(-1450_i16).to_le_bytes());
    record[at..at + bytes.len()].copy_from_slice(bytes);
    record
}

#[test]
fn a_good_file_is_read_from_bright_to_faint() {
    let faint = record(20, &6000_i16.to_le_bytes());
    let stars = StarCatalogue::from_bytes(&file(2, &[faint, record(0, &[])])).expect("good");
    assert!(stars.stars()[0].magnitude < stars.stars()[1].magnitude);
    let empty = StarCatalogue::from_bytes(&file(0, &[])).expect("good");
    assert!(empty.stars().is_empty());
}

#[test]
fn what_is_wrong_is_named() {
    let good = record(0, &[]);
    let error = |bytes: &[u8]| {
        StarCatalogue::from_bytes(bytes)
            .expect_err("bad")
            .to_string()
    };
    assert!(error(b"").contains("TRSTARS1"));
    assert!(error(b"TRSTARS1").contains("TRSTARS1"));
    assert!(error(b"\x89PNG and so on").contains("TRSTARS1"));
    assert!(error(&file(2, &[good])).contains("announces 2 stars but has 24 bytes"));
    let mut cut = file(1, &[good]);
    cut.pop();
    assert!(error(&cut).contains("announces 1 stars but has 23 bytes"));
    assert!(error(&file(u32::MAX, &[good])).contains("more than 1000000"));
    for (at, bytes, what) in [
        (8, i32::MAX.to_le_bytes().to_vec(), "declination"),
        (12, i32::MAX.to_le_bytes().to_vec(), "proper motion"),
        (16, i32::MIN.to_le_bytes().to_vec(), "proper motion"),
        (20, i16::MIN.to_le_bytes().to_vec(), "magnitude"),
        (22, i16::MAX.to_le_bytes().to_vec(), "colour index"),
    ] {
        let error = error(&file(2, &[good, record(at, &bytes)]));
        assert!(
            error.contains("star 2 (HIP 32349)") && error.contains(what),
            "{error}"
        );
    }
}

#[test]
fn a_file_that_is_not_there_is_named() {
    let path = std::path::Path::new("/nowhere/stars.bin");
    let error = StarCatalogue::read(path).expect_err("none");
    assert!(matches!(error, StarError::Unreadable { .. }));
    assert!(error.to_string().contains("/nowhere/stars.bin"));
}
