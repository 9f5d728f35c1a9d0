//! The drawn air against the tables of a radiative-transfer program in `../shared/oracle`: from space, past the limb, from
//! inside the air, and the light on the ground.

use crate::common::gpu;
use std::collections::BTreeMap;
use std::path::PathBuf;
use terrella::frames::Geodetic;
use terrella::{AirOptions, EarthOptions, SurfaceLight};
use terrella_ground::globe::Figure;
use terrella_measure::clear_air::{
    AirErrors, AirRow, AirSet, AirTable, LightRenderer, PlacedView, RowError, grey_ground,
    read_table, stored_albedo,
};

/// The folder of the tables; `None`, said loudly, where it is not.
fn tables() -> Option<PathBuf> {
    let folder = PathBuf::from(crate::REPOSITORY).join("../shared/oracle");
    if !folder.is_dir() {
        eprintln!(
            "SKIPPED: no {}, nothing to hold the air against",
            folder.display()
        );
        return None;
    }
    Some(folder)
}

/// The rows of a set, by the ground's albedo, each with its place over a figure.
pub fn placed(set: AirSet, figure: Figure) -> Option<Vec<Vec<(AirRow, PlacedView)>>> {
    let folder = tables()?;
    let tables = AirTable::ALL.map(|table| read_table(&folder, table, set).expect("a table"));
    let mut by_albedo: BTreeMap<u64, Vec<_>> = BTreeMap::new();
    let point = Geodetic::from_degrees(20.0, 30.0, 0.0);
    for row in tables.into_iter().flatten() {
        let view = PlacedView::new(&row, &figure.ellipsoid(), point, 0.7);
        by_albedo
            .entry((row.albedo * 1e6) as u64)
            .or_default()
            .push((row, view));
    }
    Some(by_albedo.into_values().collect())
}

/// Draws all rows of a set over a figure and returns their errors.
fn drawn(set: AirSet, figure: Figure) -> Option<AirErrors> {
    let mut rows = Vec::new();
    // Ground of each albedo is another Earth.
    for same in placed(set, figure)? {
        let albedo = same[0].0.albedo;
        let options = EarthOptions {
            figure,
            air: AirOptions {
                aerosol_optical_depth: set.aerosol_optical_depth(),
            },
            // The tables have Lambertian ground.
            light: SurfaceLight::PLAIN,
            ..EarthOptions::new(grey_ground(albedo).expect("a texel"))
        };
        let mut renderer = LightRenderer::new(gpu(), &options, (5, 5)).expect("an Earth");
        let views: Vec<_> = same.iter().map(|(_, view)| *view).collect();
        let light = renderer.along(&views).expect("light");
        let found = same.into_iter().zip(light);
        rows.extend(
            found.map(|((row, _), light)| RowError::new(row, stored_albedo(albedo), light)),
        );
    }
    Some(AirErrors { set, rows })
}

/// Prints all that is known of errors of light that was found by something, |found/true − 1| in %.
pub fn show(errors: &AirErrors, by: &str) {
    println!("\n--- begin csv\n{}--- end csv", errors.csv(by));
    println!(
        "mean ΔE2000 of set {} {by}: {:.2}",
        errors.set.letter(),
        errors.mean_color_difference(1.4)
    );
    for found in errors.worst(12) {
        println!(
            "{:.1} %: {}: {:.5?} for {:.5?}",
            100.0 * found.worst(),
            found.row.name(),
            found.found,
            found.truth
        );
    }
}

fn held(set: AirSet) {
    let Some(errors) = drawn(set, Figure::Sphere) else {
        return;
    };
    show(&errors, "drawn");
    let beyond = errors.beyond_bounds(1.0);
    assert!(beyond.is_empty(), "{}", beyond.join("\n"));
    let difference = errors.mean_color_difference(1.4);
    assert!(difference <= 1.5, "mean ΔE2000 {difference:.2}");
}

#[test]
fn clear_air_is_as_bright_as_radiative_transfer_says() {
    held(AirSet::Clear);
}

#[test]
fn hazy_air_is_as_bright_as_radiative_transfer_says() {
    held(AirSet::Haze);
}
