//! Orbital elements.

use std::path::Path;
use terrella_orbit::{Feed, TleFeed};

/// Reads any text, as it is and with corrected checksums, because few mutations would pass the checksums otherwise. Valid elements must propagate
/// or return an error.
pub fn run(data: &[u8]) {
    if let Ok(text) = std::str::from_utf8(data) {
        read(text);
        read(&with_checksums(text));
    }
}

fn read(text: &str) {
    match TleFeed::from_text(text, Path::new("fuzz.tle"), None) {
        Ok(feed) => {
            let (first, last) = feed.validity();
            for epoch in [first, feed.epoch(), last] {
                if let Ok(state) = feed.state_at(epoch) {
                    assert!(state.position_itrf_m().is_finite(), "{text}");
                }
            }
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// Replaces column 69 of each line with its checksum: the sum of the digits, plus one for each minus, modulo 10.
fn with_checksums(text: &str) -> String {
    let mut whole = String::new();
    for line in text.split('\n') {
        let end = line.trim_end().len();
        match line.get(..68).filter(|body| body.is_ascii() && end == 69) {
            Some(body) => {
                let worth = |byte: u8| match byte {
                    b'0'..=b'9' => u32::from(byte - b'0'),
                    b'-' => 1,
                    _ => 0,
                };
                let sum: u32 = body.bytes().map(worth).sum();
                whole.push_str(&format!("{body}{}", sum % 10));
            }
            None => whole.push_str(line),
        }
        whole.push('\n');
    }
    whole
}

/// Good inputs to start from.
#[allow(dead_code, reason = "the fuzzer reads its corpus from files")]
pub fn seeds() -> Vec<Vec<u8>> {
    const VERIFICATION: &str = include_str!("../../tests/data/orbit/SGP4-VER.TLE");
    let lines: Vec<&str> = VERIFICATION
        .lines()
        .filter(|l| !l.starts_with('#'))
        .collect();
    let mut seeds: Vec<Vec<u8>> = Vec::new();
    for pair in lines.chunks_exact(2) {
        // After column 69 the file has start, stop and step of the test.
        let cut = pair.iter().map(|line| line.get(..69).unwrap_or(line));
        seeds.push(cut.collect::<Vec<_>>().join("\n").into_bytes());
    }
    let named = [b"0 ISS (ZARYA)\n".as_slice(), &seeds[0]].concat();
    seeds.push(named);
    seeds
}
