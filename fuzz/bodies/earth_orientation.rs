//! Tables of the Earth's orientation.

use std::path::Path;
use terrella::frames::{Duration, EarthOrientation};

/// Reads any text. A valid table has values within its span, and none after it.
pub fn run(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else {
        return;
    };
    match EarthOrientation::from_finals2000a(text, Path::new("fuzz")) {
        Ok(table) => {
            let (first, last) = table.span();
            let middle = first + (last - first) * 0.37;
            for epoch in [first, middle, last] {
                let orientation = table.at(epoch).expect("within its span");
                assert!(orientation.ut1_minus_utc_s.abs() < 3.0);
                assert!(orientation.x_pole_rad.is_finite() && orientation.y_pole_rad.is_finite());
            }
            assert!(table.at(last + Duration::from_seconds(1.0)).is_none());
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// Good inputs to start from.
#[allow(dead_code, reason = "the fuzzer reads its corpus from files")]
pub fn seeds() -> Vec<Vec<u8>> {
    const EXTRACT: &str = include_str!("../../tests/data/orbit/finals2000A.extract");
    let few: String = EXTRACT
        .lines()
        .skip(14)
        .take(4)
        .map(|line| format!("{line}\n"))
        .collect();
    vec![EXTRACT.as_bytes().to_vec(), few.into_bytes()]
}
