//! Elevation tiles that touch form one ground.

use super::projection::Projection;
use super::warp::{AROUND, ProjectedGrid, Warp};
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

/// A projected tile whose first sample is so many steps from an origin, with one height.
fn projected(origin: &ProjectedGrid, right: f64, down: f64) -> Arc<HeightGrid> {
    let grid = ProjectedGrid {
        east_m: origin.east_m + right * origin.column_m,
        north_m: origin.north_m - down * origin.row_m,
        ..*origin
    };
    let warp = Warp::beyond(grid, AROUND).expect("a resampling");
    let (mut heights_m, mut places) = (Vec::new(), Vec::new());
    for row in 0..warp.place.rows {
        warp.locate_row(row, &mut places);
        let of_row = places.iter().zip(0..);
        heights_m.extend(of_row.map(|(place, n)| match place {
            Some(_) => PLATEAU_M + (n % 2) as f32 * 0.25,
            None => f32::NAN,
        }));
    }
    let grid = HeightGrid::new(&warp.place, heights_m, &GridLimits::default());
    let grid = grid.and_then(|grid| grid.with_border_of(Some(&warp)));
    Arc::new(grid.expect("a grid"))
}

/// Four tiles about a place, which share posts, touch, or leave a gap of one sample, in projections that turn and scale them.
#[test]
fn projected_tiles_have_no_valley_between_them() {
    let side = 200;
    for (epsg, east_m, north_m) in [
        (3857, 1.2e6, 5.8e6),
        (3413, -6e5, -1.3e6),
        (3031, 9e5, 1.1e6),
        (32633, 8.2e5, 5.2e6),
        // The pole lies where the four meet.
        (3413, 0.0, 0.0),
    ] {
        let projection = Projection::of_code(epsg).expect("a projection");
        for (margin, apart, what) in [
            (0.0, side - 1, "posts that share a row"),
            (0.0, side, "posts"),
            (0.5, side, "cells"),
            (0.5, side + 1, "cells with a gap of one"),
        ] {
            let origin = ProjectedGrid {
                projection,
                columns: side,
                rows: side,
                east_m: east_m - 100.0 * f64::from(apart),
                north_m: north_m + 100.0 * f64::from(apart),
                column_m: 100.0,
                row_m: 100.0,
                margin,
            };
            let apart = f64::from(apart);
            let offsets = [(0.0, 0.0), (apart, 0.0), (0.0, apart), (apart, apart)];
            let ground = Ground::new(offsets.map(|(right, down)| projected(&origin, right, down)));
            // Within two tenths of a tile of the seams, and farther from the outer border than its feather is wide.
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for n in -1500..=1500 {
                for across in [-40.0, -0.7, -0.1, 0.0, 0.1, 0.6, 1.3, 40.0] {
                    let along = f64::from(n) * 0.1;
                    for (right, down) in [(along, across), (across, along)] {
                        let (lat_rad, lon_rad) = projection.inverse_rad(
                            origin.east_m + (apart - 0.5 + right) * 100.0,
                            origin.north_m - (apart - 0.5 + down) * 100.0,
                        );
                        let height_m = ground.height_m(lat_rad, lon_rad, 0.0);
                        (low, high) = (low.min(height_m), high.max(height_m));
                    }
                }
            }
            assert!(
                low >= 1999.99 && high <= 2000.26,
                "{epsg}, {what}: {low} to {high}"
            );
        }
    }
}

/// A tile alone is feathered along the sides of its own samples, not of the bounds around them.
#[test]
fn a_projected_tile_alone_ends_softly_at_its_own_border() {
    let projection = Projection::of_code(3413).expect("a projection");
    let origin = ProjectedGrid {
        projection,
        columns: 320,
        rows: 320,
        east_m: 3e5,
        north_m: -1.2e6,
        column_m: 100.0,
        row_m: 100.0,
        margin: 0.5,
    };
    let ground = Ground::new([projected(&origin, 0.0, 0.0)]);
    let height_m = |column: f64, row: f64| {
        let (lat_rad, lon_rad) =
            projection.inverse_rad(origin.east_m + column * 100.0, origin.north_m - row * 100.0);
        ground.height_m(lat_rad, lon_rad, 0.0)
    };
    // A sixteenth of the side is feathered.
    for at in [25.0, 100.0, 160.0, 290.0] {
        for (column, row) in [(at, 22.0), (at, 297.0), (22.0, at), (297.0, at)] {
            assert!(height_m(column, row) > 1999.9, "{column} {row}");
        }
        for (column, row) in [(at, -0.5), (at, 319.5), (-0.5, at), (319.5, at)] {
            assert!(height_m(column, row) < 1.0, "{column} {row}");
            assert!((900.0..1100.0).contains(&height_m(9.5, 160.0)));
        }
    }
}
