//! Holes, repeated columns, poles, memory and rejections during construction of a grid.

use super::super::*;
use super::{degrees, grid_of};
use std::f64::consts::{FRAC_PI_2, PI};

#[test]
fn holes_are_filled_and_counted() {
    let bounds = degrees(0.0, 10.0, 0.0, 10.0);
    let place = Georeference::from_bounds(Registration::Cells, &bounds, 40, 40).unwrap();
    let plane = |n: usize| (n % 40) as f32 * 10.0;
    let mut heights: Vec<f32> = (0..1600).map(plane).collect();
    // One NaN and one infinity: both are filled from their surroundings.
    heights[20 * 40 + 20] = f32::NAN;
    heights[10 * 40 + 30] = f32::INFINITY;
    let grid = HeightGrid::new(&place, heights.clone(), &GridLimits::default()).unwrap();
    assert_eq!((grid.stats().holes, grid.stats().left_holes), (2, 0));
    let at = |row: f64, column: f64| {
        (
            (10.0 - (row + 0.5) / 4.0).to_radians(),
            ((column + 0.5) / 4.0).to_radians(),
        )
    };
    let (lat, lon) = at(20.0, 20.0);
    assert!((grid.height_m(lat, lon, 0.0) - 200.0).abs() < 11.0);
    assert_eq!(grid.weight(lat, lon), 1.0);

    // A hole at the north-east corner: filled near data, left from 9 samples on.
    for row in 0..20 {
        heights[row * 40 + 20..(row + 1) * 40].fill(f32::NAN);
    }
    let grid = HeightGrid::new(&place, heights, &GridLimits::default()).unwrap();
    assert_eq!(grid.stats().holes, 401);
    assert_eq!(grid.stats().left_holes, 16 * 16);
    let weight = |row: f64, column: f64| {
        let (lat, lon) = at(row, column);
        grid.weight(lat, lon)
    };
    assert_eq!(weight(10.0, 19.0), 1.0);
    assert_eq!(weight(10.0, 23.0), 1.0);
    assert!(
        (weight(10.0, 25.0) - 0.6).abs() < 1e-9,
        "{}",
        weight(10.0, 25.0)
    );
    assert_eq!(weight(10.0, 29.0), 0.0);
    let (lat, lon) = at(10.0, 30.0);
    assert!(grid.height_m(lat, lon, 0.0).is_finite());
    let inside = degrees(6.0, 7.0, 7.0, 0.5);
    assert!(!grid.rules(&inside) && grid.rules(&degrees(3.0, 4.0, 7.0, 0.5)));

    let empty = HeightGrid::new(&place, vec![f32::NAN; 1600], &GridLimits::default());
    assert_eq!(empty.unwrap_err(), GridError::Empty);
}

#[test]
fn a_hole_across_the_seam_is_measured_round_it() {
    // 20 columns without data, half of them on each side of the date line: the middle is 10 from data.
    let place = Georeference::from_bounds(Registration::Cells, &Bounds::GLOBE, 72, 36).unwrap();
    let mut heights = vec![100.0f32; 72 * 36];
    for row in heights.chunks_exact_mut(72) {
        row[..10].fill(f32::NAN);
        row[62..].fill(f32::NAN);
    }
    let grid = HeightGrid::new(&place, heights, &GridLimits::default()).unwrap();
    let weight = |lon_deg: f64| grid.weight(0.0, lon_deg.to_radians());
    assert_eq!(weight(180.0), 0.0);
    assert!((weight(-177.5) - weight(177.5)).abs() < 1e-9);
    assert!((weight(-152.5) - 0.8).abs() < 1e-9 && (weight(152.5) - 0.8).abs() < 1e-9);
    assert_eq!(weight(-132.5), 1.0);

    // Data begin east of the date line: the last column is adjacent to them.
    let mut heights = vec![100.0f32; 72 * 36];
    for row in heights.chunks_exact_mut(72) {
        row[52..].fill(f32::NAN);
    }
    let grid = HeightGrid::new(&place, heights, &GridLimits::default()).unwrap();
    let weight = |lon_deg: f64| grid.weight(0.0, lon_deg.to_radians());
    assert_eq!((weight(177.5), weight(162.5)), (1.0, 1.0));
    assert_eq!((weight(137.5), weight(130.0)), (0.0, 0.0));
}

#[test]
fn a_repeated_column_is_dropped_and_rows_at_poles_get_one_height() {
    let grid = grid_of(Registration::Posts, &Bounds::GLOBE, (9, 5), |lat, lon| {
        if lat > 1.5 {
            lon.cos() * 100.0
        } else {
            10.0 * lon.cos()
        }
    });
    assert_eq!(
        (grid.place.lattice.columns, grid.place.lattice.is_periodic),
        (8, true)
    );
    assert!(grid.height_m(FRAC_PI_2, 1.0, 0.0).abs() < 1e-4);
    // Files of 21 601 x 10 801 that declare their posts as cells: half a cell too large on all
    // sides.
    let place = Georeference {
        columns: 9,
        rows: 5,
        registration: Registration::Cells,
        north_rad: FRAC_PI_2,
        lat_step_rad: PI / 4.0,
        west_rad: -PI,
        lon_step_rad: PI / 4.0,
    };
    let grid = HeightGrid::new(&place, vec![1.0; 45], &GridLimits::default()).unwrap();
    assert_eq!(
        (grid.place.lattice.columns, grid.weight(1.5, 3.1)),
        (8, 1.0)
    );
}

#[test]
fn heights_are_rounded_where_memory_is_short() {
    let bounds = degrees(0.0, 10.0, 0.0, 10.0);
    let place = Georeference::from_bounds(Registration::Cells, &bounds, 256, 256).unwrap();
    let heights: Vec<f32> = (0..65_536).map(|n| n as f32 * 0.01 + 0.005).collect();
    let make = |bytes| HeightGrid::new(&place, heights.clone(), &GridLimits { bytes });
    let whole = make(1 << 20).unwrap().stats();
    assert_eq!(whole.quantum_m, 0.0);
    assert_eq!(whole.bytes, 65_536 * 4 + 21_845 * 12);
    let rounded = make(400_000).unwrap();
    assert!((rounded.stats().quantum_m - 0.01).abs() < 1e-3);
    assert!(rounded.stats().bytes <= 400_000);
    let (lat, lon) = (5.0_f64.to_radians(), 5.0_f64.to_radians());
    let error = rounded.height_m(lat, lon, 0.0) - make(1 << 20).unwrap().height_m(lat, lon, 0.0);
    assert!(error.abs() <= 0.006 && error != 0.0, "{error}");
    assert_eq!(
        make(300_000).unwrap_err().to_string(),
        "256 x 256 samples would take 1 MB and 0 MB are allowed; make them coarser (`gdalwarp -r average -tr LON LAT \
         IN OUT`) or allow more"
    );
}

#[test]
fn what_makes_no_grid_is_said() {
    let globe = |columns, rows| {
        Georeference::from_bounds(Registration::Cells, &Bounds::GLOBE, columns, rows)
    };
    let sizes = "expected 1 to 1048576 along each side, of posts 2 at least";
    assert!(globe(0, 4).unwrap_err().to_string().contains(sizes));
    assert!(globe(2_000_000, 4).unwrap_err().to_string().contains(sizes));
    let posts = Georeference::from_bounds(Registration::Posts, &Bounds::GLOBE, 1, 4);
    assert!(posts.unwrap_err().to_string().contains(sizes));

    let good = globe(8, 4).unwrap();
    let said = |place: &Georeference, heights| {
        HeightGrid::new(place, heights, &GridLimits::default())
            .unwrap_err()
            .to_string()
    };
    let place = |change: fn(&mut Georeference)| {
        let mut place = good;
        change(&mut place);
        said(&place, vec![0.0; 32])
    };
    assert!(place(|p| p.north_rad += 0.6).contains("beyond a pole"));
    assert!(place(|p| p.lon_step_rad *= 1.3).contains("more than a full turn"));
    assert!(place(|p| p.lon_step_rad = -1.0).contains("not positive"));
    assert!(place(|p| p.lat_step_rad = f64::NAN).contains("not positive"));
    assert!(place(|p| p.lat_step_rad = 1e-300).contains("beyond all measure"));
    assert!(place(|p| p.west_rad = 1e30).contains("beyond all measure"));
    assert_eq!(
        said(&good, vec![0.0; 31]),
        "has 31 heights for 32 samples; give one for each"
    );
    for (height, reported) in [(29_029.0, "29029 m"), (-32_768.0, "-32768 m")] {
        let mut heights = vec![0.0; 32];
        heights[3] = height;
        let said = said(&good, heights);
        assert!(
            said.contains(reported)
                && said.contains("correct unit, scale, offset, no-data value or byte order")
        );
    }
    let huge = GridLimits::default().check(1 << 20, 1 << 20);
    assert!(matches!(huge, Err(GridError::Memory { .. })));
}
