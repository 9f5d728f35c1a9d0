//! The whole Earth's brightness against what is published.
//!
//! T. D. Robinson 2025 (arXiv:2507.22258), from ground and spacecraft, 0.4–0.7 µm: geometric albedo 0.242 ± 0.005, spherical albedo
//! 0.294 ± 0.002, phase integral 1.22 ± 0.03. Here it is luminance, one day's clouds and no seasons.

use crate::common::gpu;
use std::path::Path;
use terrella::EarthOptions;
use terrella::internals::gpu::BcSupport;
use terrella_measure::clear_air::{DiscLight, LightRenderer};
use terrella_play::Flight;
use terrella_play::scene::Scene;

fn luminance([red, green, blue]: [f64; 3]) -> f64 {
    0.2126 * red + 0.7152 * green + 0.0722 * blue
}

/// Geometric albedo, spherical albedo and phase integral.
fn albedos(options: &EarthOptions) -> [f64; 3] {
    let mut renderer = LightRenderer::new(gpu(), options, (128, 128)).expect("an Earth");
    let light = DiscLight::drawn(&mut renderer, &options.figure.ellipsoid()).expect("light");
    for phase in &light.phases {
        let [red, green, blue] = phase.albedo;
        println!(
            "{:3.0}°: {:.4} (red {red:.4}, green {green:.4}, blue {blue:.4})",
            phase.phase_rad.to_degrees(),
            luminance(phase.albedo)
        );
    }
    let geometric = luminance(light.geometric_albedo());
    let spherical = luminance(light.spherical_albedo());
    let integral = spherical / geometric;
    println!(
        "geometric albedo {geometric:.3}, spherical albedo {spherical:.3}, phase integral {integral:.2}"
    );
    [geometric, spherical, integral]
}

#[test]
fn the_whole_earth_is_as_bright_as_published() {
    let path = Path::new(crate::REPOSITORY).join("config/test.toml");
    let flight = Flight::open(Scene::from_toml("", &path).expect("a scene")).expect("opens");
    let mut options = flight.earth_options(BcSupport::None).expect("maps");
    // A day's clouds and painted maps.
    let [geometric, spherical, integral] = albedos(&options);
    assert!((geometric - 0.242).abs() < 0.012, "{geometric}");
    assert!((spherical - 0.294).abs() < 0.012, "{spherical}");
    assert!((integral - 1.22).abs() < 0.08, "{integral}");
    // Directional reflectance redistributes light; it does not change the total.
    options.light.directional_reflectance = false;
    let [_, lambertian, _] = albedos(&options);
    assert!((spherical / lambertian - 1.0).abs() < 0.01, "{lambertian}");
}
