//! Elevation tiles that touch form one ground.

use super::*;
use std::sync::Arc;

/// The height of every tile, metres: any place between two of them must have it too.
const PLATEAU_M: f32 = 2000.0;

fn bounds(west_deg: f64, south_deg: f64, width_deg: f64, height_deg: f64) -> Bounds {
    Bounds {
        south_rad: south_deg.to_radians(),
        north_rad: (south_deg + height_deg).to_radians(),
        west_rad: west_deg.to_radians(),
        width_rad: width_deg.to_radians(),
    }
}

fn tile(registration: Registration, bounds: Bounds, side: u32) -> Arc<HeightGrid> {
    flat(registration, bounds, side, PLATEAU_M)
}

/// Almost flat; a flat grid would be stored as one number.
fn flat(registration: Registration, bounds: Bounds, side: u32, height_m: f32) -> Arc<HeightGrid> {
    let place = Georeference::from_bounds(registration, &bounds, side, side).expect("a place");
    let heights = (0..side * side).map(|n| height_m + (n % 2) as f32 * 0.25);
    let grid = HeightGrid::new(&place, heights.collect(), &GridLimits::default());
    Arc::new(grid.expect("a grid"))
}

/// Lowest and highest height along a line, in many steps.
fn along(ground: &Ground, from_deg: (f64, f64), to_deg: (f64, f64)) -> (f64, f64) {
    let heights = (0..=4000).map(|n| {
        let part = f64::from(n) / 4000.0;
        let at = |from: f64, to: f64| (from + part * (to - from)).to_radians();
        ground.height_m(at(from_deg.0, to_deg.0), at(from_deg.1, to_deg.1), 0.0)
    });
    heights.fold(
        (f64::INFINITY, f64::NEG_INFINITY),
        |(low, high), height_m| (low.min(height_m), high.max(height_m)),
    )
}

fn assert_plateau(ground: &Ground, from_deg: (f64, f64), to_deg: (f64, f64), what: &str) {
    let (low, high) = along(ground, from_deg, to_deg);
    assert!(low >= 1999.99 && high <= 2000.26, "{what}: {low} to {high}");
}

/// Latitudes and longitudes of lines across and along the seam at 6° E between tiles of 45 to 46°
/// N.
const LINES: [((f64, f64), (f64, f64)); 3] = [
    ((45.5, 5.2), (45.5, 6.8)),
    ((45.2, 6.0), (45.8, 6.0)),
    ((45.21, 5.3), (45.78, 6.71)),
];

#[test]
fn tiles_that_share_a_post_or_touch_by_cells_have_no_valley_between_them() {
    for (registration, what) in [
        (Registration::Posts, "posts"),
        (Registration::Cells, "cells"),
    ] {
        let west = tile(registration, bounds(5.0, 45.0, 1.0, 1.0), 121);
        let east = tile(registration, bounds(6.0, 45.0, 1.0, 1.0), 121);
        for grids in [[west.clone(), east.clone()], [east, west]] {
            let ground = Ground::new(grids);
            for (from, to) in LINES {
                assert_plateau(&ground, from, to, what);
            }
            // The outer border is still feathered.
            assert!(along(&ground, (45.5, 6.8), (45.5, 7.0)).0 < 1.0);
        }
    }
}

/// Files that end half a sample early: the last post of one is a sample from the first of the other.
#[test]
fn tiles_a_sample_apart_touch() {
    let step = 1.0 / 120.0;
    let west = tile(Registration::Posts, bounds(5.0, 45.0, 1.0 - step, 1.0), 120);
    let east = tile(Registration::Posts, bounds(6.0, 45.0, 1.0 - step, 1.0), 120);
    let ground = Ground::new([west, east]);
    for (from, to) in LINES {
        assert_plateau(&ground, from, to, "a sample apart");
    }
}

#[test]
fn four_tiles_meet_in_a_corner_and_across_the_date_line() {
    for west_deg in [5.0, 179.0, -181.0] {
        let tiles = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(east, north)| {
            let bounds = bounds(west_deg + east, 45.0 + north, 1.0, 1.0);
            tile(Registration::Cells, bounds, 64)
        });
        let ground = Ground::new(tiles);
        let middle = west_deg + 1.0;
        assert_plateau(
            &ground,
            (45.3, middle - 0.7),
            (46.7, middle + 0.7),
            "diagonal",
        );
        assert_plateau(
            &ground,
            (46.0, middle - 0.8),
            (46.0, middle + 0.8),
            "along the seam",
        );
        assert_plateau(&ground, (45.2, middle), (46.8, middle), "up the seam");
    }
}

#[test]
fn beside_a_shorter_neighbour_the_rest_of_the_border_is_feathered_without_a_step() {
    let west = tile(Registration::Posts, bounds(4.0, 45.0, 2.0, 2.0), 241);
    let east = tile(Registration::Posts, bounds(6.0, 45.0, 1.0, 1.0), 121);
    let ground = Ground::new([west, east]);
    assert_plateau(&ground, (45.4, 5.0), (45.4, 6.6), "where both are");
    // Beside the open half the border falls to the sea …
    assert!(along(&ground, (46.5, 5.0), (46.5, 6.0)).0 < 1.0);
    // … and there is no jump from one half to the other or over the seam.
    for (from, to) in [
        ((45.2, 5.99), (46.8, 5.99)),
        ((45.97, 5.5), (45.97, 6.5)),
        ((45.9, 5.9), (46.1, 6.1)),
    ] {
        let mut before: Option<f64> = None;
        for n in 0..=8000 {
            let part = f64::from(n) / 8000.0;
            let at = |from: f64, to: f64| (from + part * (to - from)).to_radians();
            let height_m = ground.height_m(at(from.0, to.0), at(from.1, to.1), 0.0);
            if let Some(before) = before.replace(height_m) {
                assert!(
                    (height_m - before).abs() < 20.0,
                    "{before} to {height_m} at {part}"
                );
            }
        }
    }
}

/// A fine tile in a coarse one blends into it; beside another fine tile it does not.
#[test]
fn fine_tiles_that_touch_over_a_coarse_one_are_feathered_into_it_alone() {
    let base = flat(
        Registration::Cells,
        bounds(0.0, 40.0, 12.0, 12.0),
        96,
        500.0,
    );
    let west = tile(Registration::Posts, bounds(5.0, 45.0, 1.0, 1.0), 121);
    let east = tile(Registration::Posts, bounds(6.0, 45.0, 1.0, 1.0), 121);
    let ground = Ground::new([base, west, east]);
    for (from, to) in LINES {
        assert_plateau(&ground, from, to, "over a base");
    }
    let (low, high) = along(&ground, (45.5, 7.0), (45.5, 7.5));
    assert!(
        (499.0..501.0).contains(&low) && high < 501.0,
        "{low} to {high}"
    );
}

/// Tiles with a wide overlap still blend into each other, and neither falls to the sea.
#[test]
fn tiles_that_overlap_do_not_fall_to_the_sea_inside_each_other() {
    for overlap_deg in [0.02, 0.1, 0.5] {
        let west = tile(
            Registration::Posts,
            bounds(5.0, 45.0, 1.0 + overlap_deg, 1.0),
            121,
        );
        let east = tile(Registration::Posts, bounds(6.0, 45.0, 1.0, 1.0), 121);
        let ground = Ground::new([west, east]);
        assert_plateau(&ground, (45.5, 5.2), (45.5, 6.8), "overlap");
    }
}
