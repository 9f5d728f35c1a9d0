//! The air's quadrature against closed forms, against itself refined, and its tables against quadrature.

use super::air::{Air, Resolution};
use super::geometry::ScaledRay;
use super::grid::Gauss;
use super::light::GroundLight;
use crate::air::EARTH_AIR;
use glam::DVec3;

/// Largest relative difference of two colours.
fn apart(a: DVec3, b: DVec3) -> f64 {
    ((a - b) / b.abs().max(DVec3::splat(1e-300)))
        .abs()
        .max_element()
}

#[test]
fn the_zenith_column_is_the_integral_of_the_densities() {
    let air = Air::earth();
    let model = EARTH_AIR;
    let column = |height_m: f64| model.thickness_m / height_m;
    // ∫ exp(−h/H) from 0 to the top, and a tent of area half width × 1.
    let exponential = |h: f64| h * (1.0 - (-column(h)).exp());
    let exact = model.molecules.extinction_per_m * exponential(model.molecules.scale_height_m)
        + model.aerosol.extinction_per_m * exponential(model.aerosol.scale_height_m)
        + model.ozone_absorption_per_m * model.ozone_half_width_m;
    let found = air.depth_to_sun(0.0, 1.0, &Gauss::new(12));
    assert!(apart(found, exact) < 1e-9, "{found} {exact}");
}

#[test]
fn the_horizontal_column_is_chapmans() {
    // Molecules alone: Ch(X, 90°) = X eˣ K₁(X) ≈ √(πX/2) (1 + 3/(8X) − 15/(128X²)).
    let mut model = EARTH_AIR;
    model.aerosol.extinction_per_m = DVec3::ZERO;
    model.aerosol.scattering_per_m = DVec3::ZERO;
    model.ozone_absorption_per_m = DVec3::ZERO;
    let air = Air::new(
        model,
        Resolution {
            depths: (16, 16),
            higher: (4, 4),
            directions: (2, 2, 2),
            ..Resolution::PICTURE
        },
    );
    let h = model.molecules.scale_height_m;
    let x = model.radius_m / h;
    let chapman =
        (0.5 * std::f64::consts::PI * x).sqrt() * (1.0 + 3.0 / (8.0 * x) - 15.0 / (128.0 * x * x));
    let exact = model.molecules.extinction_per_m * (h * chapman);
    let found = air.depth_to_sun(0.0, 0.0, &Gauss::new(12));
    // The air ends at 100 km: e^−12.5 of it lies above.
    assert!(apart(found, exact) < 1e-5, "{found} {exact}");
}

#[test]
fn the_table_of_depths_is_the_quadrature() {
    let (air, rule) = (Air::earth(), Gauss::new(12));
    let (mut worst, mut worst_below) = (0.0_f64, 0.0_f64);
    for i in 0..60 {
        // Irrational steps: never on a node.
        let height_m = 100_000.0 * (f64::from(i) * 0.618_034).fract().powi(2);
        let height = height_m / EARTH_AIR.radius_m;
        let horizon = -(height * (height + 2.0)).sqrt() / (1.0 + height);
        for j in 0..60 {
            let x = (f64::from(j) * 0.754_877 + 0.1).fract();
            let mu = horizon + (1.0 - horizon) * x * x;
            let exact = air.depth_to_sun(height, mu, &rule);
            let through = |depth: DVec3| depth.to_array().map(|d| (-d).exp());
            let table = air.sunlight(height, mu).to_array();
            for (a, b) in table.into_iter().zip(through(exact)) {
                worst = worst.max((a - b).abs());
                if height_m < 30_000.0 {
                    worst_below = worst_below.max((a - b).abs());
                }
            }
        }
    }
    println!("transmittance by table: off by {worst:.1e} at most, {worst_below:.1e} below 30 km");
    // The worst is above nearly all air, where light grazes the ozone layer's kink.
    assert!(worst < 1e-3 && worst_below < 2e-4, "{worst} {worst_below}");
}

/// Lines of sight of all kinds: down, along the limb at several heights, up from the ground, from inside the air; and
/// Suns from noon to twilight.
fn cases() -> Vec<(ScaledRay, DVec3)> {
    let mut cases = Vec::new();
    for (eye, direction) in [
        ((0.0, 0.0, 1.1), (0.0, 0.0, -1.0)),
        ((0.0, 0.0, 1.1), (0.3, 0.1, -1.0)),
        ((0.0, 0.0, 5.0), (0.19, 0.02, -1.0)),
        ((-3.0, 0.0, 1.0001), (1.0, 0.0, 0.0)),
        ((-3.0, 0.0, 1.003), (1.0, 0.0, 0.0)),
        ((-3.0, 0.0, 1.01), (1.0, 0.0, 0.0)),
        ((0.0, 0.0, 1.0), (1.0, 0.0, 0.01)),
        ((0.0, 0.0, 1.0), (1.0, 0.4, 1.0)),
        ((0.0, 0.0, 1.005), (1.0, 0.0, -0.12)),
        ((0.0, 0.0, 1.005), (1.0, 0.0, 0.05)),
    ] {
        for elevation_deg in [80.0, 30.0, 5.0, 0.0, -3.0, -7.0] {
            let (sin, cos) = f64::to_radians(elevation_deg).sin_cos();
            let line = ScaledRay::new(DVec3::from(eye), DVec3::from(direction).normalize());
            cases.push((line, DVec3::new(0.8 * cos, 0.6 * cos, sin)));
        }
    }
    cases
}

#[test]
fn light_along_rays_converges() {
    let air = Air::earth();
    let nodes = |sight| air.with_sight(sight);
    let exact = nodes(16);
    let mut before = f64::INFINITY;
    for count in [2, 3, 4, 6] {
        let coarse = nodes(count);
        let (mut worst, mut worst_transmittance) = (0.0_f64, 0.0_f64);
        for (line, sun) in cases() {
            let (a, b) = (coarse.sight(&line, sun), exact.sight(&line, sun));
            let (a, b) = (a.expect("air"), b.expect("air"));
            // As light on a display of exposure 1.4.
            worst = worst.max((a.light - b.light).abs().max_element() * 1.4 * std::f64::consts::PI);
            worst_transmittance =
                worst_transmittance.max((a.transmittance - b.transmittance).abs().max_element());
        }
        println!(
            "{count} nodes a piece: light off by {worst:.1e}, transmittance by {worst_transmittance:.1e}"
        );
        assert!(worst < before, "{count}: {worst} {before}");
        before = worst;
        if count == Resolution::PICTURE.sight {
            assert!(
                worst < 1e-4 && worst_transmittance < 3e-5,
                "{worst} {worst_transmittance}"
            );
        }
    }
}

#[test]
fn higher_orders_and_skylight_converge() {
    let air = Air::earth();
    let fine = Air::new(
        EARTH_AIR,
        Resolution {
            sight: 6,
            higher: (128, 40),
            directions: (20, 16, 16),
            ..Resolution::PICTURE
        },
    );
    let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
    for i in 0..40 {
        let height = 0.0157 * (f64::from(i) * 0.618_034).fract().powi(2);
        for j in 0..40 {
            let mu = 2.0 * (f64::from(j) * 0.754_877 + 0.1).fract() - 1.0;
            // Counted by what is there to scatter it.
            let air_m = (-height * EARTH_AIR.radius_m / 8_000.0).exp();
            let (a, b) = (
                air.higher(height, mu) * air_m,
                fine.higher(height, mu) * air_m,
            );
            worst = worst.max((a - b).abs().max_element());
            largest = largest.max(b.max_element());
        }
    }
    println!("higher orders: off by {worst:.1e} of {largest:.3}");
    assert!(worst < 1e-3 * largest, "{worst} of {largest}");
    let light = GroundLight::earth();
    let up = Gauss::new(40);
    for mu in [1.0, 0.6, 0.2, 0.03, -0.02, -0.08] {
        let (a, b) = (light.at(mu).sky, fine.skylight(mu, &up, 40));
        println!("skylight at {mu}: {a} for {b}");
        assert!(
            (a - b).abs().max_element() < 1e-3 * b.max_element() + 1e-6,
            "{mu}: {a} {b}"
        );
    }
}

#[test]
fn energy_is_not_made() {
    // White ground, no absorption: what the ground gets of Sun and sky is not more than what comes.
    let light = GroundLight::earth();
    for i in 0..=100 {
        let mu = f64::from(i) / 100.0;
        let at = light.at(mu);
        let irradiance = at.sun * mu + at.sky;
        assert!(irradiance.max_element() <= mu + 0.03, "{mu}: {irradiance}");
        assert!(at.sun.min_element() >= 0.0 && at.sky.min_element() >= 0.0);
    }
    let night = light.at(-0.4);
    assert!(
        night.sun == DVec3::ZERO && night.sky.max_element() < 1e-6,
        "{night:?}"
    );
}
