//! The reference renderer against the same tables as the drawn air: it shares no constant with either.

use crate::clear_air::{placed, show};
use terrella::{EarthOptions, SurfaceLight};
use terrella_ground::globe::Figure;
use terrella_measure::clear_air::{
    AirErrors, AirSet, RowError, ViewGroup, grey_ground, stored_albedo,
};
use terrella_reference::{Reference, ReferenceOptions};

/// Errors of the reference renderer for every `step`th row.
fn by_reference(set: AirSet, step: usize) -> Option<AirErrors> {
    let mut rows = Vec::new();
    for same in placed(set, Figure::Sphere)? {
        let albedo = same[0].0.albedo;
        let options = ReferenceOptions {
            figure: Figure::Sphere,
            aerosol_optical_depth: set.aerosol_optical_depth(),
            exposure: 1.0,
            // The tables have Lambertian ground.
            surface: SurfaceLight::PLAIN,
            ..ReferenceOptions::of(&EarthOptions::new(grey_ground(albedo).expect("a texel")), 1)
        };
        let maps = grey_ground(albedo).expect("a texel");
        let reference = Reference::new(&maps, options).expect("sound options");
        rows.extend(same.into_iter().step_by(step).map(|(row, view)| {
            let light = reference.light_along(view.eye_m, view.look, &view.sky());
            RowError::new(row, stored_albedo(albedo), light)
        }));
    }
    Some(AirErrors { set, rows })
}

/// Median errors of the reference in every group that the drawn air has a bound in.
fn reference_held(set: AirSet, step: usize, most: f64) {
    let by = if step == 1 {
        "reference"
    } else {
        "reference, in part"
    };
    let Some(errors) = by_reference(set, step) else {
        return;
    };
    show(&errors, by);
    for group in ViewGroup::ALL {
        if group.bound(set).is_none() {
            continue;
        }
        for (channel, sizes) in ["red", "green", "blue"]
            .into_iter()
            .zip(errors.sizes(group))
        {
            let median = sizes.median();
            assert!(
                median <= most,
                "{}, {channel}: median {median:.3}",
                group.name()
            );
        }
    }
}

#[test]
fn the_reference_agrees_with_radiative_transfer() {
    reference_held(AirSet::Clear, 9, 0.03);
    reference_held(AirSet::Haze, 19, 0.03);
}

#[test]
#[ignore = "all rows; a minute: cargo test --test accuracy reference_air -- --ignored --nocapture"]
fn the_reference_agrees_with_radiative_transfer_everywhere() {
    reference_held(AirSet::Clear, 1, 0.03);
    reference_held(AirSet::Haze, 1, 0.03);
}
