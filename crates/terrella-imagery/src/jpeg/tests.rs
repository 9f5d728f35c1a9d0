//! Whole pictures pass; every kind of cut does not. The files of `tests/data/maps` were written by libjpeg.

use super::*;

const BASELINE: &[u8] = include_bytes!("../../../../tests/data/maps/baseline.jpg");
const PROGRESSIVE: &[u8] = include_bytes!("../../../../tests/data/maps/progressive.jpg");
/// A restart marker after every coding unit.
const RESTARTS: &[u8] = include_bytes!("../../../../tests/data/maps/restarts.jpg");

const END: [u8; 2] = [0xFF, 0xD9];

fn said(bytes: &[u8]) -> String {
    match check(bytes) {
        Ok(_) => String::new(),
        Err(Fault::Damaged(cause)) => cause,
        Err(Fault::Read(error)) => panic!("{error}"),
    }
}

/// Offset of the data of the first scan.
fn scan_start(bytes: &[u8]) -> usize {
    let mut at = 2;
    loop {
        let length = usize::from(u16::from_be_bytes([bytes[at + 2], bytes[at + 3]]));
        if bytes[at + 1] == 0xDA {
            return at + 2 + length;
        }
        at += 2 + length;
    }
}

#[test]
fn whole_pictures_pass() {
    for bytes in [BASELINE, PROGRESSIVE, RESTARTS] {
        assert_eq!(said(bytes), "");
        // Bytes after the end marker are ignored.
        assert_eq!(said(&[bytes, b"\0\0rubbish"].concat()), "");
    }
    for name in ["day.jpg", "moon.jpg", "milky_way.jpg"] {
        let path = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
            .join("textures")
            .join(name);
        assert_eq!(said(&std::fs::read(path).expect("a map")), "", "{name}");
    }
}

#[test]
fn a_cut_anywhere_is_found_with_an_end_and_without() {
    for bytes in [BASELINE, PROGRESSIVE, RESTARTS] {
        for keep in 2..bytes.len() - 2 {
            assert_ne!(said(&bytes[..keep]), "", "{keep}");
        }
        // Without its end marker alone.
        assert_ne!(said(&bytes[..bytes.len() - 2]), "");
        for keep in scan_start(bytes)..bytes.len() - 2 {
            let ended = [&bytes[..keep], &END].concat();
            assert_ne!(said(&ended), "", "cut at {keep} of {}", bytes.len());
        }
    }
    let middle = (scan_start(BASELINE) + BASELINE.len()) / 2;
    let ended = [&BASELINE[..middle], &END].concat();
    assert!(said(&ended).contains("data end at row"), "{}", said(&ended));
}

#[test]
fn a_progressive_picture_without_its_last_scans_is_found() {
    let scans: Vec<_> = (0..PROGRESSIVE.len() - 1)
        .filter(|at| PROGRESSIVE[*at..at + 2] == [0xFF, 0xDA])
        .collect();
    assert!(scans.len() > 3, "{scans:?}");
    for scan in &scans[1..] {
        // The segment before it, its table, goes with it or stays.
        let ended = [&PROGRESSIVE[..*scan], &END].concat();
        let said = said(&ended);
        assert!(said.contains("before its last scans"), "{scan}: {said}");
    }
}

#[test]
fn what_is_too_much_or_out_of_order_is_found() {
    let end = BASELINE.len() - 2;
    let more = [&BASELINE[..end], &[0x12, 0x34], &END].concat();
    assert!(
        said(&more).contains("do not end with their last block"),
        "{}",
        said(&more)
    );
    let first = (scan_start(RESTARTS)..RESTARTS.len())
        .find(|at| RESTARTS[*at..at + 2] == [0xFF, 0xD0])
        .expect("a restart marker");
    let mut other = RESTARTS.to_vec();
    other[first + 1] = 0xD3;
    assert!(
        said(&other).contains("restart marker 0"),
        "{}",
        said(&other)
    );
    // The stretch between two markers is gone.
    let second = (first..RESTARTS.len())
        .find(|at| RESTARTS[*at..at + 2] == [0xFF, 0xD1])
        .expect("another");
    let gone = [&RESTARTS[..first], &RESTARTS[second..]].concat();
    assert!(said(&gone).contains("restart marker 0"), "{}", said(&gone));
}

#[test]
fn no_bytes_make_it_panic_or_take_long() {
    let mut state = 88_172_645_463_325_252_u64;
    let mut next = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state
    };
    for bytes in [BASELINE, PROGRESSIVE, RESTARTS] {
        for _ in 0..3000 {
            let mut corrupt = bytes.to_vec();
            for _ in 0..1 + next() % 4 {
                let at = next() as usize % corrupt.len();
                // The size in the header is checked before this.
                let frame = bytes
                    .windows(2)
                    .position(|pair| matches!(pair, [0xFF, 0xC0 | 0xC2]));
                if frame.is_none_or(|frame| !(frame..frame + 9).contains(&at)) {
                    corrupt[at] = next() as u8;
                }
            }
            let _ = check(corrupt.as_slice());
        }
    }
}
