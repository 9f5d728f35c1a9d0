//! The air's numbers: the paper's square in its stable form, and tables that obey physics.

use glam::{DMat4, DVec3, Vec4};
use terrella::frames::Ellipsoid;
use terrella::internals::air::{
    AirTables, Billboard, EARTH_AIR, SCATTERING, SUNLIGHT, Screen, TRANSMITTANCE, horizon_square,
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

#[test]
fn the_enlarged_square_just_holds_the_air() {
    let scale = Ellipsoid::WGS84.itrf_from_scaled();
    let top = EARTH_AIR.top();
    for eye in [
        DVec3::new(1.3, 0.0, 0.0),
        DVec3::new(0.0, -0.9, 0.9),
        DVec3::new(0.0, 0.0, 6.0),
        DVec3::new(0.1, 60.0, 3.0),
    ] {
        let square = Billboard::new(eye, top, &DMat4::IDENTITY, scale);
        assert_eq!(square.screen, Screen::Square, "{eye}");
        let l = eye.length();
        assert!((square.eye_distance - l).abs() < 1e-12 * l);
        // The middle of a side looks along a tangent of the air's upper boundary.
        let middle = (square.ray[0] + square.ray[1]) * 0.5;
        let direction = middle.normalize();
        let nearest = l * (1.0 - direction.z * direction.z).sqrt();
        assert!((nearest - top).abs() < 1e-9 * l, "{nearest} and {top}");
        // And it stands on the horizon's plane, L2 before the eye.
        assert!((middle.z - horizon_square(1.0, l - 1.0).unwrap().l2).abs() < 1e-12 * l);
        // Its axes are perpendicular, and the third points to the centre.
        let [a, b, c] = square.axes;
        assert!(
            a.dot(b).abs() + a.dot(c).abs() + b.dot(c).abs() < 1e-14
                && c.distance(-eye / l) < 1e-14
        );
    }
}

#[test]
fn every_eye_has_a_billboard() {
    let view = terrella::EyeView::itrf(
        DVec3::new(6.5e6, 0.0, 0.0),
        DVec3::NEG_X,
        DVec3::Z,
        0.8,
        1.5,
    );
    let (_, clip_from_eye) = view.to_itrf();
    let scale = Ellipsoid::WGS84.itrf_from_scaled();
    for eye in [
        DVec3::ZERO,
        DVec3::X,
        DVec3::new(0.0, 0.0, 1.0 + 1e-12),
        DVec3::new(0.2, 0.1, 0.0),
        DVec3::new(1.01, 0.0, 0.0),
        DVec3::new(1e6, 0.0, 0.0),
    ] {
        let square = Billboard::new(eye, EARTH_AIR.top(), &clip_from_eye, scale);
        assert!(square.eye_distance >= 1.0);
        assert!(
            square.clip.iter().all(|c| c.is_finite()) && square.ray.iter().all(|r| r.is_finite()),
            "{eye}"
        );
        if eye.length() < EARTH_AIR.top() {
            assert_eq!(square.screen, Screen::Whole);
        }
    }
}

fn texel(
    table: &[Vec4],
    x: u32,
    y: u32,
    z: u32,
    size: terrella::internals::air::TableSize,
) -> Vec4 {
    table[((z * size.y + y) * size.x + x) as usize]
}

#[test]
fn tables_keep_to_physics() {
    let tables = AirTables::earth();
    for table in [
        &tables.transmittance,
        &tables.multiple,
        &tables.scattering,
        &tables.sunlight,
    ] {
        assert!(
            table
                .iter()
                .all(|t| t.is_finite() && t.min_element() >= 0.0)
        );
    }
    // Nothing shines brighter than the white sheet's worth of scattered sunlight, and nothing lets through more than all.
    assert!(
        tables
            .transmittance
            .iter()
            .all(|t| t.truncate().max_element() <= 1.0)
    );
    assert!(tables.scattering.iter().all(|t| t.w <= 1.0));
    // Straight up from the ground: the optical depth is known in closed form, Σ β·H (and the ozone's tent).
    let depth = |rgb: usize| {
        let m = &EARTH_AIR;
        m.molecules.extinction_per_m[rgb] * m.molecules.scale_height_m
            + m.aerosol.extinction_per_m[rgb] * m.aerosol.scale_height_m
            + m.ozone_absorption_per_m[rgb] * m.ozone_half_width_m
    };
    let up = texel(
        &tables.transmittance,
        TRANSMITTANCE.x - 1,
        0,
        0,
        TRANSMITTANCE,
    );
    for rgb in 0..3 {
        let exact = (-depth(rgb)).exp();
        assert!(
            (f64::from(up[rgb]) - exact).abs() < 2e-3,
            "{rgb}: {} and {exact}",
            up[rgb]
        );
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
    let tables = AirTables::earth();
    let half = SCATTERING.x / 2;
    // Sun overhead at the tangent point: outwards from the ground the light falls to nothing.
    let outwards: Vec<f32> = (half..SCATTERING.x)
        .map(|x| texel(&tables.scattering, x, SCATTERING.y - 1, 0, SCATTERING).y)
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
    assert!((0..SCATTERING.x).all(|x| {
        texel(&tables.scattering, x, 0, 8, SCATTERING)
            .truncate()
            .max_element()
            < 1e-4
    }));
    // More Sun, more light on the ground.
    for row in tables.sunlight.chunks(SUNLIGHT.x as usize) {
        assert!(row.windows(2).all(|w| w[1].y >= w[0].y - 1e-6));
    }
}
