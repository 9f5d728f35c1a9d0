//! The air's quadrature against brute force and against itself refined, its table against quadrature, and its energy.

use super::air::Air;
use super::all_orders::air_of_all_orders;
use super::geometry::ScaledRay;
use super::grid::Gauss;
use super::light::EarthAir;
use super::matter::Matter;
use super::spectrum::{BANDS, Spectrum};
use glam::DVec3;
use std::sync::OnceLock;

const RADIUS_M: f64 = 6_378_137.0;

/// Hazy air with all orders, made once.
fn air() -> &'static Air {
    static AIR: OnceLock<Air> = OnceLock::new();
    AIR.get_or_init(|| air_of_all_orders(Matter::new(0.1), RADIUS_M))
}

/// Largest difference of two spectra.
fn apart(a: &Spectrum, b: &Spectrum) -> f64 {
    a.iter()
        .zip(b)
        .fold(0.0, |most, (a, b)| most.max((a - b).abs()))
}

#[test]
fn columns_are_sums_over_small_steps() {
    let (air, matter) = (
        Air::without_orders(Matter::new(0.1), RADIUS_M),
        Matter::new(0.1),
    );
    for mu in [1.0, 0.3, 0.0] {
        let length = RADIUS_M * (((air.top * air.top) - 1.0 + mu * mu).sqrt() - mu);
        const STEPS: i32 = 200_000;
        let step = length / f64::from(STEPS);
        let exact: DVec3 = (0..STEPS)
            .map(|i| {
                let at = (f64::from(i) + 0.5) * step;
                let rise = at * (at + 2.0 * RADIUS_M * mu);
                let height_m = rise / (RADIUS_M + (RADIUS_M * RADIUS_M + rise).sqrt());
                matter.densities(height_m) * step
            })
            .sum();
        let found = air.columns_by_quadrature(0.0, mu, &Gauss::new(5));
        let error = ((found - exact) / exact).abs().max_element();
        // The ozone's profile has a corner every two kilometres.
        assert!(error < 1e-3, "{mu}: {found} {exact}");
    }
}

#[test]
fn the_table_of_columns_is_the_quadrature() {
    let (air, rule) = (
        Air::without_orders(Matter::new(0.1), RADIUS_M),
        Gauss::new(8),
    );
    let mut worst = 0.0_f64;
    for i in 0..60 {
        // Irrational steps: never on a node.
        let height = 100_000.0 / RADIUS_M * (f64::from(i) * 0.618_034).fract().powi(2);
        let horizon = -(height * (height + 2.0)).sqrt() / (1.0 + height);
        for j in 0..60 {
            let x = (f64::from(j) * 0.754_877 + 0.1).fract();
            let mu = horizon + (1.0 - horizon) * x * x;
            let exact = air
                .matter
                .through(air.columns_by_quadrature(height, mu, &rule));
            worst = worst.max(apart(&air.sunlight(height, mu), &exact));
        }
    }
    println!("transmittance by table: off by {worst:.1e} at most");
    assert!(worst < 2e-3, "{worst}");
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
    let exact = air().with_sight(12);
    let mut before = f64::INFINITY;
    for count in [1, 2, 3, 5] {
        let coarse = air().with_sight(count);
        let (mut worst, mut worst_transmittance) = (0.0_f64, 0.0_f64);
        for (line, sun) in cases() {
            let (a, b) = (coarse.sight(&line, sun), exact.sight(&line, sun));
            let (a, b) = (a.expect("air"), b.expect("air"));
            worst = worst.max(std::f64::consts::PI * apart(&a.black, &b.black));
            worst_transmittance =
                worst_transmittance.max(apart(&a.transmittance, &b.transmittance));
        }
        println!(
            "{count} nodes a piece: light off by {worst:.1e}, transmittance by {worst_transmittance:.1e}"
        );
        assert!(worst < before, "{count}: {worst} {before}");
        before = worst;
        if count == 3 {
            // A white sheet is 1. The worst is a hazy horizon under a low Sun.
            assert!(
                worst < 8e-3 && worst_transmittance < 1e-3,
                "{worst} {worst_transmittance}"
            );
        }
    }
}

#[test]
fn energy_is_not_made() {
    // The ground receives no more than the incident light of Sun and sky, and the sky scatters a part back.
    let back = air().sky_albedo();
    assert!(
        back.iter().all(|part| (0.02..0.4).contains(part)),
        "{back:?}"
    );
    assert!(
        back.windows(2).all(|pair| pair[0] > pair[1] - 0.01),
        "{back:?}"
    );
    for i in 0..=100 {
        let mu = f64::from(i) / 100.0;
        let (direct, sky) = (air().sunlight(0.0, mu), air().skylight_on_ground(mu));
        for band in 0..BANDS {
            let all = direct[band] * mu + sky[band];
            assert!(all <= mu + 0.03 && sky[band] > 0.0, "{mu}: {all}");
        }
    }
    assert_eq!(air().skylight_on_ground(-0.6), [0.0; BANDS]);
}

#[test]
fn light_of_the_ground_is_seen_through_the_air() {
    // Straight down on ground under a high Sun: the parts of the light on it come through, dimmed in their own colours.
    let earth = EarthAir::new(air().clone());
    let line = ScaledRay::new(DVec3::new(0.0, 0.0, 1.1), DVec3::NEG_Z);
    let sight = earth.air.sight(&line, DVec3::Z).expect("air");
    let black = earth.factors(1.0, &sight.transmittance, DVec3::ZERO);
    assert!(
        black.own.max_element() < 1.0 && black.own.x > black.own.z,
        "{black:?}"
    );
    // Sunlight that crossed the air has little blue left to lose: the eye receives nearly the same fraction of it as of other light.
    assert!(
        (black.sun / black.own - 1.0).abs().max_element() < 0.03,
        "{black:?}"
    );
    let white = earth.factors(1.0, &sight.transmittance, DVec3::splat(0.8));
    assert!(white.sky.cmpgt(black.sky * 1.2).all(), "{white:?}");
    assert_eq!(white.sun, black.sun);
}

/// Light of a grey Lambertian layer at 6 km from an independent program: its file describes the computation.
const LAYER: &str = include_str!("../../../tests/data/air/lambert_layer_6_km.csv");

#[test]
fn clouds_are_seen_through_the_air_above_them() {
    let earth = EarthAir::above(6_000.0, 0.0);
    let mut worst = 0.0_f64;
    for row in LAYER.lines().skip(5) {
        let numbers: Vec<f64> = row
            .split(',')
            .map(|n| n.parse().expect("a number"))
            .collect();
        let angles = [0, 2, 3].map(|n| numbers[n].to_radians());
        let (sun_zenith, view_zenith, azimuth) = (angles[0], angles[1], angles[2]);
        let (albedo, right) = (DVec3::splat(numbers[1]), DVec3::from_slice(&numbers[4..]));
        let sun = DVec3::new(sun_zenith.sin(), 0.0, sun_zenith.cos());
        // The ray runs towards the Sun's side at azimuth 0.
        let (sin, cos) = azimuth.sin_cos();
        let ray = DVec3::new(
            view_zenith.sin() * cos,
            view_zenith.sin() * sin,
            -view_zenith.cos(),
        );
        let sight = earth
            .air
            .sight(&ScaledRay::new(DVec3::Z - 0.2 * ray, ray), sun);
        let sight = sight.expect("air");
        let light = earth
            .at(sun.z)
            .times(&earth.factors(sun.z, &sight.transmittance, albedo));
        let found = earth.light(&sight, albedo) + albedo * (light.sun * sun.z + light.sky);
        let off = (found - right).abs().max_element() / right.max_element();
        worst = worst.max(off);
        assert!(off < 0.015, "{row}: {found} for {right}");
    }
    println!("at most {:.2} %", 100.0 * worst);
}
