//! No text and no bytes panic: each makes a scene that has a summary, or one line of message.

use super::Folder;
use proptest::prelude::*;
use std::path::Path;
use terrella_play::scene::Scene;

/// Pieces from which texts are made that reach past the TOML reader.
#[rustfmt::skip]
const PIECES: &[&str] = &[
    "[time]", "[orbit]", "[camera]", "[earth]", "[output]", "[[time]]", "[time.start]", "start", "duration_s",
    "speed", "frame_rate_hz", "source", "file", "name", "mode", "fov_deg", "lat_deg", "lon_deg", "height_km",
    "figure", "subdivision", "clouds", "size", "samples", "=", ".", ",", "{", "}", "[", "]", "\n", "\n",
    "\"nadir\"", "\"tle\"", "true", "nan", "-inf", "1e308", "-1e-308", "0", "-9223372036854775808",
    "99999999999999999999", "0xff", "2018-01-15T12:00:00Z", "0001-01-01T00:00:00+23:59", "12:00:00",
    "\"9999-12-31T23:59:60.9999999999Z\"", "#", "\"\"\"", "\u{feff}", "é",
];

/// Table and key, known and unknown.
#[rustfmt::skip]
const KEYS: &[&str] = &[
    "time.start", "time.duration_s", "time.speed", "time.frame_rate_hz", "orbit.file", "orbit.name",
    "camera.mode", "camera.fov_deg", "camera.lat_deg", "camera.lon_deg", "camera.height_km", "earth.figure",
    "earth.subdivision", "earth.clouds", "earth.textures", "output.size", "output.samples", "time.zone", "sky.stars",
];

fn piece() -> impl Strategy<Value = String> {
    prop_oneof![
        8 => proptest::sample::select(PIECES).prop_map(str::to_owned),
        1 => any::<f64>().prop_map(|number| number.to_string()),
        1 => "\\PC{0,6}",
    ]
}

/// One key and one value: nearly always TOML.
fn assignment() -> impl Strategy<Value = String> {
    // Mostly real dates, some not.
    let date =
        || "[0-9]{4}-(0[1-9]|1[0-2])-[0-2][0-9]T[01][0-9]:[0-5][0-9]:[0-6][0-9](\\.[0-9]{1,12})?";
    let value = prop_oneof![
        any::<f64>().prop_map(|number| format!("{number:e}")),
        any::<i64>().prop_map(|number| number.to_string()),
        (any::<i64>(), any::<i64>()).prop_map(|(a, b)| format!("[{a}, {b}]")),
        "[a-z]{0,8}".prop_map(|word| format!("\"{word}\"")),
        date().prop_map(|date| format!("\"{date}Z\"")),
        date().prop_map(|date| format!("\"{date}+05:30\"")),
        date().prop_map(|date| format!("{date}Z")),
    ];
    (proptest::sample::select(KEYS), value).prop_map(|(key, value)| format!("{key} = {value}\n"))
}

/// Invariants for any text: no panic, and either a scene with a summary or a one-line message.
fn holds(text: &str) -> Result<(), TestCaseError> {
    match Scene::from_toml(text, Path::new("scene.toml")) {
        Ok(scene) => {
            prop_assert!(scene.summary().contains("leaves out"));
            prop_assert!(scene.time.frame_count() >= 1);
            let start = scene.time.start;
            // It may be rejected here, but must not panic.
            let _ = scene.check_dates((start, start), None);
        }
        Err(error) => {
            let message = error.to_string();
            prop_assert!(message.starts_with("scene.toml:"), "{}", message);
            prop_assert!(error.line().is_some(), "{}", message);
            prop_assert!(!message.chars().any(char::is_control), "{:?}", message);
        }
    }
    Ok(())
}

proptest! {
    // A failure is printed with its smallest text; nothing is left in the repository.
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_text_panics(text in any::<String>()) {
        holds(&text)?;
    }

    #[test]
    fn no_mixture_of_pieces_panics(
        pieces in proptest::collection::vec(piece(), 0..40),
        gap in "[ \n]?",
    ) {
        holds(&pieces.join(&gap))?;
    }

    #[test]
    fn no_assignment_panics(lines in proptest::collection::vec(assignment(), 1..4)) {
        holds(&lines.concat())?;
    }

    #[test]
    fn no_bytes_panic(bytes in proptest::collection::vec(any::<u8>(), 0..64)) {
        let _ = Folder::new().load(bytes);
    }
}
