//! Properties of tables for any atmosphere. `tests/accuracy` compares the brightness with radiative transfer.

use super::*;

fn tables(aerosol_optical_depth: f64) -> Arc<AirTables> {
    AirTables::shared(&AirOptions {
        aerosol_optical_depth,
    })
}

#[test]
fn every_texel_is_defined_from_clear_air_to_the_thickest_haze() {
    for depth in [0.0, 0.1, AirOptions::MAX_AEROSOL] {
        let tables = tables(depth);
        for (name, size, texels) in [
            ("scattering", SCATTERING, &tables.scattering),
            ("bounce", BOUNCE, &tables.bounce),
            ("through", THROUGH, &tables.through),
            ("sunlight", SUNLIGHT, &tables.sunlight),
            ("transmittance", TRANSMITTANCE, &tables.transmittance),
            ("sources", SOURCES, &tables.sources),
            ("profile", PROFILE, &tables.profile),
        ] {
            assert_eq!(texels.len(), size.texels(), "{name}");
            let sound = |t: &Vec4| t.is_finite() && t.abs().max_element() < 100.0;
            assert!(texels.iter().all(sound), "{name} of {depth}");
        }
        let albedo = tables.sky_albedo;
        assert!(albedo.min_element() > 0.0 && albedo.max_element() < 1.0);
    }
}

#[test]
fn the_air_makes_no_light() {
    for depth in [0.0, 0.5] {
        let tables = tables(depth);
        for n in 0..=20 {
            let mu_s = f64::from(n) / 20.0;
            let [direct, sky] = tables.sunlight_at(mu_s);
            // Irradiance on the ground is at most the incoming light. Each colour loses what returns to space.
            let falls = direct * mu_s as f32 + sky;
            let came = mu_s as f32 + 0.02;
            assert!(falls.max_element() < came, "{mu_s}: {falls} of {came}");
            assert!(sky.min_element() >= 0.0 && direct.max_element() <= 1.0);
        }
    }
}

#[test]
fn the_sun_coordinate_is_inverted() {
    for n in 0..=1000 {
        let coordinate = f64::from(n) / 1000.0;
        let found = f64::from(sun_coordinate(sun_cosine(coordinate) as f32));
        assert!((found - coordinate).abs() < 3e-5, "{coordinate}: {found}");
    }
    assert_eq!(sun_coordinate(-1.0), 0.0);
}

#[test]
fn airs_are_made_once_and_forgotten_in_turn() {
    let first = tables(0.031);
    assert!(Arc::ptr_eq(&first, &tables(0.031)));
    assert!(!Arc::ptr_eq(&first, &tables(0.032)));
}
