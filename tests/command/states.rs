//! `terrella orbit`: rows and columns of tables of states, and the length of all tables.

use crate::{Place, words};
use terrella_orbit::{Feed, Sgp4Feed};

/// The default scene from its start, half an hour.
const STATION: &str = "[time]\nduration_s = 1800\nspeed = 60\n";

#[test]
fn csv_has_the_light_of_the_text() {
    let place = Place::new();
    // A revolution.
    place.scene("iss.toml", "[time]\nduration_s = 6000\n");
    let csv = place.printed(&["orbit", "iss.toml", "--csv"]);
    let text = place.printed(&["orbit", "iss.toml"]);
    let light = |row: &str| row.rsplit([',', ' ']).next().map(str::to_owned);
    let [csv, text] = [&csv, &text].map(|all| all.lines().skip(1).map(light).collect::<Vec<_>>());
    assert_eq!(csv, text);
    for expected in ["umbra", "sunlit"] {
        assert!(csv.contains(&Some(expected.to_owned())), "{csv:?}");
    }
}

#[test]
fn rows_are_on_the_grid_and_as_long_as_days_say() {
    let place = Place::new();
    place.scene("iss.toml", STATION);
    let ask = |more: &[&str]| {
        let output = place.succeed(&[&["orbit", "iss.toml"], more].concat());
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        let rows: Vec<_> = text.lines().skip(1).map(str::to_owned).collect();
        (rows, words(&output))
    };
    // Half an hour in steps of 700 s: 0, 700 and 1400 s, and the end for those who ask for it.
    let (rows, reported) = ask(&["--every", "700"]);
    assert_eq!(rows.len(), 3, "{rows:?}");
    assert!(!reported.contains("end at"), "{reported}");
    let (rows, _) = ask(&["--every", "700", "--include-end"]);
    assert_eq!(rows.len(), 4, "{rows:?}");
    assert!(rows[3].starts_with("2018-01-15T12:30:00"), "{rows:?}");
    let (rows, reported) = ask(&["--every", "3600", "--days", "1"]);
    assert_eq!(rows.len(), 25, "{rows:?}");
    assert!(!reported.contains("end at"), "{reported}");
    let (_, end) = Sgp4Feed::built_in_iss().expect("built in").validity();
    for more in [
        &["--every", "3600"][..],
        &["--passes", "48.2,16.4"],
        &["--events"],
    ] {
        let (rows, reported) = ask(&[&["--days", "40"], more].concat());
        assert!(rows.len() > 100, "{rows:?}");
        let end = terrella::frames::rfc3339(end);
        assert!(
            reported.contains(&format!("the elements end at {end}")),
            "{reported}"
        );
    }
    for bad in [&["--at", "now"][..], &["--names"]] {
        place.fail(2, &[&["orbit", "iss.toml", "--days", "1"], bad].concat());
    }
}
