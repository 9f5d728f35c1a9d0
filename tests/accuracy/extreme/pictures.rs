//! Every extreme picture is a defined one.

use crate::common::{self, Rig, gpu, plain, tilted};
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::{Atmosphere, EarthOptions};
use terrella_measure::extreme::{cases, run};

#[test]
fn every_extreme_case_gives_a_defined_picture_or_a_clear_error() {
    let layers = plain([120, 130, 140]);
    let mut failed = Vec::new();
    for case in cases() {
        let start = std::time::Instant::now();
        let outcome = run(&case, gpu(), &layers);
        let line = format!(
            "{} | {} | {} | {} not finite",
            outcome.name, outcome.expected, outcome.what_was_drawn, outcome.nan_pixels
        );
        println!(
            "{} {line} | {:.2} s",
            if outcome.passed { "ok    " } else { "FAILED" },
            start.elapsed().as_secs_f64()
        );
        if !outcome.passed {
            failed.push(line);
        }
    }
    assert!(
        failed.is_empty(),
        "{} cases:\n{}",
        failed.len(),
        failed.join("\n")
    );
}

/// Facets are below the ground between their corners, so that an outline of them would end short of the horizon and leave a black line under the
/// sky: the part beyond the limb is lifted to it.
#[test]
fn ground_and_sky_meet_at_the_horizon() {
    let (lines, fov_deg) = (256, 8.0);
    let ellipsoid = Ellipsoid::WGS84;
    // With one cell a block the ground under a nearby eye is 30 km below the ellipsoid.
    for subdivision in [6, 24, 48] {
        for atmosphere in [Atmosphere::Billboard, Atmosphere::None] {
            let mut options = EarthOptions::new(plain([120, 130, 140]));
            options.subdivision = terrella::Subdivision::Cells(subdivision);
            options.atmosphere = atmosphere;
            let mut rig = Rig::new(&options, (16, lines));
            for height_m in [1.0, 3.0, 100.0, 1e4, 9e4, 1.1e5] {
                let place = Geodetic::from_degrees(3.3, 14.1, height_m);
                let dip = (2.0 * height_m / 6_378_137.0_f64).sqrt();
                let aspect = 16.0 / f64::from(lines);
                let view = tilted(place, 60.0, -dip.to_degrees(), fov_deg, aspect);
                let (picture, _) = rig.draw(&view, Ellipsoid::normal(0.06, 0.25));
                let is_dark = |y: &u32| picture.get_pixel(8, *y).0[1] < 60;
                let scale = ellipsoid.scaled_from_itrf();
                let first = (0..lines).find(|y| {
                    let ray = common::ray(&view, 8, *y, (16, lines));
                    let (eye, ray) = (view.eye_world * scale, (ray * scale).normalize());
                    eye.dot(ray) < 0.0 && eye.cross(ray).length() < 1.0
                });
                let first = first.expect("ground");
                let dark = (first..lines).filter(is_dark).count();
                println!(
                    "n = {subdivision}, {height_m} m, {atmosphere:?}: {dark} lines dark below {first}"
                );
                // A pixel of the limb may show as much sky as ground.
                let most = usize::from(atmosphere == Atmosphere::None);
                assert!(
                    dark <= most,
                    "n = {subdivision}, {height_m} m, {atmosphere:?}: {dark}"
                );
            }
        }
    }
}
