//! The air's numbers: the paper's square in its stable form, and tables that obey physics.

use glam::{Vec3, Vec4};
use terrella_ground::air::{
    AirOptions, AirTables, SCATTERING, SUNLIGHT, TRANSMITTANCE, horizon_square,
};

const R: f64 = 6_378_164.0;

#[test]
fn the_square_is_the_horizon_circle_at_every_height() {
    for height in [1e-3, 1.0, 100.0, 1e5, 4e5, 2e7, 3.84e8, 1e12] {
        let square = horizon_square(R, height).unwrap();
        // Against series that share nothing with the closed form: x = h/R.
        let x: f64 = height / R;
        let side = if x < 1e-3 {
            // S/2R = √(2x + x²)/(1 + x) = √(2x)·(1 − 3x/4 + 23x²/32 − …)
            2.0 * R * (2.0 * x).sqrt() * (1.0 - 0.75 * x + 23.0 / 32.0 * x * x)
        } else {
            // The circle's radius is R·sin θ with cos θ = R/L.
            2.0 * R * (R / (R + height)).acos().sin()
        };
        let error = (square.side / side - 1.0).abs();
        assert!(error < 2e-9, "S at {height} m: {} and {side}", square.side);
        assert!(((square.l1 + square.l2) / (R + height) - 1.0).abs() < 1e-15);
        // S = 2√(L1·L2), as printed.
        assert!((square.side / (2.0 * (square.l1 * square.l2).sqrt()) - 1.0).abs() < 1e-15);
    }
}

#[test]
fn the_printed_form_cancels_where_ours_does_not() {
    let height = 1e-3;
    let l = R + height;
    let printed = l - R * R / l;
    // L2 = h(L + R)/L = 2h(1 − h/2R + …): 2 mm, here to all digits.
    let exact = 2.0 * height * (1.0 - 0.5 * height / R);
    let ours = horizon_square(R, height).unwrap().l2;
    assert!((ours / exact - 1.0).abs() < 1e-15);
    assert!(
        (printed / exact - 1.0).abs() > 1e-8,
        "the printed form is this good: {printed} and {exact}"
    );
}

#[test]
fn at_and_below_the_surface_there_is_no_square() {
    for height in [0.0, -1.0, -R, f64::NAN, f64::INFINITY] {
        assert_eq!(horizon_square(R, height), None);
    }
    assert_eq!(horizon_square(0.0, 1.0), None);
}

fn texel(table: &[Vec4], x: u32, y: u32, z: u32, size: terrella_ground::air::TableSize) -> Vec4 {
    table[((z * size.y + y) * size.x + x) as usize]
}

/// Light is stored by its fourth root.
fn light(texel: Vec4) -> Vec3 {
    texel.truncate().powf(4.0)
}

#[test]
fn tables_keep_to_physics() {
    let tables = AirTables::shared(&AirOptions::default());
    for table in [
        &tables.transmittance,
        &tables.through,
        &tables.bounce,
        &tables.scattering,
        &tables.sunlight,
    ] {
        let sound = |t: &Vec4| t.is_finite() && t.min_element() >= 0.0;
        assert!(table.iter().all(sound));
    }
    // No value exceeds the light of the white sheet, and no transmittance exceeds 1.
    for table in [&tables.transmittance, &tables.through] {
        assert!(table.iter().all(|t| t.truncate().max_element() <= 1.0));
    }
    assert!(tables.scattering.iter().all(|t| t.w <= 1.0));
    // Straight up from the ground, by optical depths at 630, 550 and 450 nm as published: molecules (Bodhaine et al. 1999, table
    // 4), 300 Dobson units of ozone (Serdyuchenko et al. 2014), and the aerosol of the default.
    let depths = [
        0.0552 + 0.0280 + 0.0838,
        0.0971 + 0.0266 + 0.1,
        0.2209 + 0.0014 + 0.1298,
    ];
    let up = texel(
        &tables.transmittance,
        TRANSMITTANCE.x - 1,
        0,
        0,
        TRANSMITTANCE,
    );
    for (n, depth) in depths.into_iter().enumerate() {
        let ratio = f64::from(up[n]) / f64::exp(-depth);
        assert!((ratio - 1.0).abs() < 0.02, "{n}: {ratio}");
    }
    // Blue light is scattered most: the halo is blue, the low Sun red.
    let day = texel(
        &tables.scattering,
        SCATTERING.x * 3 / 4,
        SCATTERING.y - 1,
        0,
        SCATTERING,
    );
    assert!(day.z > day.x, "{day}");
    let low = texel(&tables.sunlight, SUNLIGHT.x * 2 / 5, 0, 0, SUNLIGHT);
    assert!(low.x >= low.z, "{low}");
}

#[test]
fn the_halo_fades_outwards_and_with_the_sun() {
    let tables = AirTables::shared(&AirOptions::default());
    let half = SCATTERING.x / 2;
    // Sun overhead at the tangent point: outwards from the ground the light falls to nothing.
    let outwards: Vec<f32> = (half..SCATTERING.x)
        .map(|x| {
            light(texel(
                &tables.scattering,
                x,
                SCATTERING.y - 1,
                0,
                SCATTERING,
            ))
            .y
        })
        .collect();
    let peak = outwards.iter().copied().fold(0.0, f32::max);
    assert!(peak > 0.05, "{peak}");
    let from_peak = outwards.iter().position(|v| *v == peak).unwrap();
    assert!(
        outwards[from_peak..].windows(2).all(|w| w[1] <= w[0]),
        "{outwards:?}"
    );
    assert!(outwards[outwards.len() - 1] < 0.01 * peak);
    // The deepest night of the table is black.
    let night = (0..SCATTERING.x).map(|x| light(texel(&tables.scattering, x, 0, 8, SCATTERING)));
    assert!(night.fold(0.0, |most: f32, light| most.max(light.max_element())) < 1e-5);
    // More Sun, more light on the ground.
    for row in tables.sunlight.chunks(SUNLIGHT.x as usize) {
        assert!(row.windows(2).all(|w| w[1].y >= w[0].y - 1e-6));
    }
}
