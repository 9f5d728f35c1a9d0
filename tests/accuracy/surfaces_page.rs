//! docs/surfaces.md agrees with the measurements, and the default surface follows from them.

use std::collections::BTreeMap;
use terrella::SurfaceKind;
use terrella_measure::surfaces::{SurfacePath, SurfaceStudy, TimeRow, markdown};

fn recorded() -> (SurfaceStudy, BTreeMap<String, String>) {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../docs/recorded/surfaces.json"
    );
    let text = std::fs::read_to_string(path).expect("recorded");
    let mut value: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let mut part = |name: &str| value["run"][name].take();
    let study = serde_json::from_value(part("study")).expect("a study");
    (
        study,
        serde_json::from_value(part("sections")).expect("texts"),
    )
}

#[test]
fn texts_are_those_of_the_recorded_tables() {
    let (mut study, sections) = recorded();
    assert!(!study.is_partial && study.size == (1280, 720));
    assert_eq!(markdown::sections(&study), sections);
    for (name, text) in &sections {
        let rows = text.lines().filter(|line| line.starts_with('|'));
        let mut fields = rows.map(|line| line.matches('|').count());
        let of_head = fields.next().unwrap_or_default();
        assert!(fields.all(|count| count == of_head), "{name}: {text}");
    }
    study.errors[0].error_px_p99 += 1.0;
    assert_ne!(markdown::sections(&study), sections);
}

#[test]
fn the_default_surface_is_the_one_that_the_rule_gives() {
    let (study, _) = recorded();
    assert_eq!(study.default_surface(), Some(SurfaceKind::default()));
}

#[test]
fn the_rule_looks_at_holes_error_and_cost() {
    let (study, _) = recorded();
    let default = SurfaceKind::default();
    // A surface with a hole is not chosen.
    let mut holed = study.clone();
    let rows = holed.errors.iter_mut();
    for row in rows.filter(|row| row.surface == default) {
        row.holes = 1;
    }
    // Among those that are as exact.
    let other = SurfaceKind::ALL
        .iter()
        .find(|kind| **kind != default)
        .copied();
    let other = other.expect("another");
    for row in holed.errors.iter_mut().filter(|row| row.surface == other) {
        (row.error_px_p99, row.holes) = (0.1, 0);
    }
    assert_ne!(holed.default_surface(), Some(default));
    // Twice as dear, it gives way to one that is exact.
    let mut dear = study.clone();
    for row in dear.errors.iter_mut() {
        row.error_px_p99 = 0.5;
        row.holes = 0;
    }
    let double = |row: &mut TimeRow| row.frame_ms *= if row.surface == other { 0.5 } else { 2.0 };
    dear.times.iter_mut().for_each(double);
    assert_eq!(dear.default_surface(), Some(other));
    // A surface without frame times is not chosen by cost.
    dear.times.retain(|row| row.path != SurfacePath::Low);
    assert_eq!(dear.default_surface(), None);
}
