//! Ground for tests.

use glam::DVec2;
use terrella_frames::Ellipsoid;
use terrella_ground::elevation::{Bounds, fractal_heights_m};
use terrella_ground::globe::contours::dem::{Dem, DemFrame};

/// Pseudorandom numbers in −1…1.
pub fn noise(seed: &mut u64) -> f64 {
    *seed = seed
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// Midpoint displacement over n × n samples, n = 2ᵏ + 1, 90 m apart: a height range of about 1 500 m.
pub fn fractal(n: u32, seed: u64) -> Dem {
    let heights = fractal_heights_m(n, seed, 900.0 * f64::from(n) / 129.0, 0.5);
    let heights = heights.into_iter().map(|z| (2_000.0 + z) as f32).collect();
    let step_m = DVec2::splat(90.0);
    Dem::new(n, n, heights, DemFrame::Flat { step_m }).unwrap()
}

/// A flat grid of heights by column and row, 70 m and 90 m apart.
pub fn flat(columns: u32, rows: u32, f: impl Fn(u32, u32) -> f32) -> Dem {
    let heights = (0..columns * rows)
        .map(|k| f(k % columns, k / columns))
        .collect();
    let step_m = DVec2::new(70.0, 90.0);
    Dem::new(columns, rows, heights, DemFrame::Flat { step_m }).unwrap()
}

/// n × n heights by column and row over a part of WGS84.
pub fn globe(n: u32, bounds: Bounds, f: impl Fn(u32, u32) -> f32) -> Dem {
    let heights = (0..n * n).map(|k| f(k % n, k / n)).collect();
    let ellipsoid = Ellipsoid::WGS84;
    Dem::new(n, n, heights, DemFrame::Geodetic { ellipsoid, bounds }).unwrap()
}
