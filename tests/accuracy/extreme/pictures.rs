//! Every extreme picture is a defined one.

use crate::common::{Rig, gpu, plain, tilted};
use terrella::EarthOptions;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::internals::measure::extreme::{cases, run};

#[test]
fn every_extreme_case_gives_a_defined_picture_or_a_clear_error() {
    let layers = plain([120, 130, 140]);
    let mut failed = Vec::new();
    for case in cases() {
        let start = std::time::Instant::now();
        let outcome = run(&case, gpu(), &layers);
        let line = format!(
            "{}: expected {}; {} ({} not finite)",
            outcome.name, outcome.expected, outcome.what_was_drawn, outcome.nan_pixels
        );
        println!(
            "{} {line} [{:.2} s]",
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

/// A mesh lies below the ground between its vertices, so its outline ends short of the horizon: seen from low down, a dark
/// line is left between ground and sky, at most as high as the middle of a cell is deep.
#[test]
fn the_mesh_ends_no_farther_below_the_horizon_than_its_cells_are_deep() {
    const R: f64 = 6_378_137.0;
    let (lines, fov_deg) = (256, 8.0);
    let place = |height_m| Geodetic::from_degrees(3.3, 14.1, height_m);
    for subdivision in [6, 24, 48] {
        let mut options = EarthOptions::new(plain([120, 130, 140]));
        options.subdivision = terrella::Subdivision::Cells(subdivision);
        let mut rig = Rig::new(&options, (16, lines));
        for height_m in [1.0, 100.0, 1e4, 1e5] {
            let dip = |depth_m: f64| (2.0 * (height_m + depth_m) / R).sqrt();
            let view = tilted(
                place(height_m),
                60.0,
                -dip(0.0).to_degrees(),
                fov_deg,
                16.0 / f64::from(lines),
            );
            let (picture, _) = rig.draw(&view, Ellipsoid::normal(0.06, 0.25));
            let dark = (lines / 2..lines)
                .filter(|y| picture.get_pixel(8, *y).0[1] < 60)
                .count();
            let half_cell = std::f64::consts::PI / (16.0 * f64::from(subdivision));
            let deep_m = 2.0 * R * (1.0 - half_cell.cos());
            let most = (dip(deep_m) - dip(0.0)).to_degrees() * f64::from(lines) / fov_deg;
            println!(
                "n = {subdivision}, {height_m} m: {dark} of {lines} lines dark, at most {most:.1}"
            );
            assert!(
                dark as f64 <= most + 2.0,
                "n = {subdivision}, {height_m} m: {dark}, {most}"
            );
        }
    }
}
