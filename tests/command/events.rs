//! `terrella orbit --events`: eclipses, nodes and apsides of every source.

use crate::Place;
use std::path::Path;
use terrella::frames::{Epoch, utc_from_rfc3339};

/// Umbra and penumbra of the space station by skyfield 1.55 and DE421, as in `tests/orbit/eclipses.rs`.
const CONTACTS: [(&str, &str); 12] = [
    ("umbra ends", "2018-01-20T20:23:08.557Z"),
    ("penumbra ends", "2018-01-20T20:23:18.630Z"),
    ("penumbra begins", "2018-01-20T21:21:39.307Z"),
    ("umbra begins", "2018-01-20T21:21:49.375Z"),
    ("umbra ends", "2018-01-20T21:55:50.601Z"),
    ("penumbra ends", "2018-01-20T21:56:00.675Z"),
    ("penumbra begins", "2018-01-20T22:54:21.466Z"),
    ("umbra begins", "2018-01-20T22:54:31.536Z"),
    ("umbra ends", "2018-01-20T23:28:32.655Z"),
    ("penumbra ends", "2018-01-20T23:28:42.730Z"),
    ("penumbra begins", "2018-01-21T00:27:03.617Z"),
    ("umbra begins", "2018-01-21T00:27:13.689Z"),
];

fn config(name: &str) -> String {
    let path = Path::new(crate::REPOSITORY).join("config").join(name);
    path.display().to_string()
}

fn epoch(text: &str) -> Epoch {
    utc_from_rfc3339(text).expect("a date")
}

#[test]
fn eclipses_of_elements_are_those_of_skyfield() {
    let place = Place::new();
    let tle = config("orbits/iss.tle");
    let start = "2018-01-20T20:00:00Z";
    let ask = |more: &[&str]| {
        let asked = [
            "orbit", &tle, "--start", start, "--events", "--days", "0.19",
        ];
        place.printed(&[&asked[..], more].concat())
    };
    let csv = ask(&["--csv"]);
    assert_eq!(csv.lines().next(), Some("name,epoch_utc,event"));
    let rows = csv.lines().skip(1).map(|row| row.split(',').collect());
    let rows: Vec<Vec<&str>> = rows.collect();
    let shadow = rows
        .iter()
        .filter(|row| row[2].contains("umbra"))
        .collect::<Vec<_>>();
    assert_eq!(shadow.len(), CONTACTS.len(), "{csv}");
    for (row, (event, time)) in shadow.iter().zip(CONTACTS) {
        assert_eq!((row[0], row[2]), ("ISS (ZARYA)", event));
        let late = (epoch(row[1]) - epoch(time)).to_seconds();
        assert!(late.abs() < 0.1, "{event} at {time}: {late} s");
    }
    let of = |event: &str| rows.iter().filter(|row| row[2] == event).count();
    for node in ["ascending node", "descending node"] {
        assert!((2..=3).contains(&of(node)), "{csv}");
    }
    assert!(of("periapsis") >= 2 && of("apoapsis") >= 2, "{csv}");
    let text = ask(&[]);
    let head = format!(
        "ISS (ZARYA): {} events, 2018-01-20T20:00:00.000Z to ",
        rows.len()
    );
    assert!(text.starts_with(&head), "{text}");
    for row in &rows {
        assert!(
            text.contains(&format!("{}  {}\n", row[1], row[2])),
            "{text}"
        );
    }
    let json: serde_json::Value = serde_json::from_str(&ask(&["--json"])).expect("JSON");
    let listed = json["events"].as_array().expect("an array");
    assert_eq!(listed.len(), rows.len());
    assert_eq!(listed[0]["epoch_utc"].as_str(), Some(rows[0][1]));
}

#[test]
fn every_source_has_eclipses() {
    let place = Place::new();
    let mut sum = 0;
    for name in ["omm", "oem", "czml", "csv", "kepler", "numerical"] {
        let scene = config(&format!("{name}.toml"));
        let csv = place.printed(&["orbit", &scene, "--events", "--csv"]);
        let events = csv.matches(",umbra ").count();
        // As often as the light of a state is another one than that before.
        let states = place.printed(&["orbit", &scene, "--every", "10"]);
        let rows = states.lines().skip(1);
        let dark: Vec<_> = rows.map(|row| row.contains("  umbra")).collect();
        let changes = dark.windows(2).filter(|pair| pair[0] != pair[1]).count();
        assert_eq!(events, changes, "{name}: {csv}");
        sum += events;
    }
    assert!(sum >= 4, "{sum}");
}
