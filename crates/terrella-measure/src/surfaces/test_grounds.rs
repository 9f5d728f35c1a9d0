//! Terrains of the flights.

use super::SurfacesError;
use std::sync::Arc;
use terrella::frames::Geodetic;
use terrella_ground::elevation::{
    Bounds, Elevation, Georeference, GridLimits, Ground, HeightGrid, Registration,
};
use terrella_play::read_ground;
use terrella_play::scene::Scene;

/// Ground to fly over.
#[derive(Clone)]
pub struct TestGround {
    /// As in tables.
    pub name: &'static str,
    /// Its elevation data.
    pub elevation: Arc<dyn Elevation>,
    /// Centre of all flights.
    pub site: Geodetic,
    /// Size of its elevation data in memory, bytes.
    pub bytes: u64,
}

/// The starter pack's elevation data of the whole Earth, seen over the Alps; the scene's own files, if it names any, over the centre of the finest;
/// and a worst case.
///
/// # Errors
/// Files that cannot be read.
pub fn test_grounds(scene: &Scene) -> Result<Vec<TestGround>, SurfacesError> {
    let alps = Geodetic::from_degrees(46.5, 8.0, 0.0);
    let globe = read_ground(&[], false, false)?;
    let mut grounds = vec![of("globe", globe.clone(), alps)];
    let relief = scene.earth.relief.as_ref();
    if let Some(relief) = relief.filter(|relief| !relief.elevation.is_empty()) {
        let heights = read_ground(&relief.elevation, relief.sea_floor, relief.denoise)?;
        let bounds = heights.grids().first().map(|grid| grid.bounds());
        let site = bounds.map_or(alps, |bounds| middle(&bounds));
        grounds.push(of(SCENE, heights, site));
    }
    let (worst, site) = worst_case()?;
    let grids = globe.grids().iter().cloned().chain([Arc::new(worst)]);
    let heights = Ground::new(grids).with_sea_surface(None);
    grounds.push(of(super::study::WORST, heights, site));
    Ok(grounds)
}

/// The name of a scene's own ground.
pub const SCENE: &str = "scene";

fn of(name: &'static str, heights: Ground, site: Geodetic) -> TestGround {
    TestGround {
        name,
        site,
        bytes: heights.bytes(),
        elevation: Arc::new(heights),
    }
}

fn middle(bounds: &Bounds) -> Geodetic {
    Geodetic {
        lat_rad: 0.5 * (bounds.south_rad + bounds.north_rad),
        lon_rad: bounds.west_rad + 0.5 * bounds.width_rad,
        height_m: 0.0,
    }
}

/// Samples along each side of the worst case, a size that is no power of two and one.
const SIDE: u32 = 700;

/// One degree of the worst possible terrain: cliffs of 3 km, a spike of 9 km one sample wide, a pit of 11 km, a flat plateau, and rubble in which
/// every sample differs.
fn worst_case() -> Result<(HeightGrid, Geodetic), SurfacesError> {
    let corner = Geodetic::from_degrees(20.0, 10.0, 0.0);
    let side_rad = 1_f64.to_radians();
    let bounds = Bounds {
        south_rad: corner.lat_rad,
        north_rad: corner.lat_rad + side_rad,
        west_rad: corner.lon_rad,
        width_rad: side_rad,
    };
    let place = Georeference::from_bounds(Registration::Posts, &bounds, SIDE, SIDE)?;
    let heights =
        (0..SIDE).flat_map(|row| (0..SIDE).map(move |column| worst_height_m(row, column)));
    let grid = HeightGrid::new(&place, heights.collect(), &GridLimits::default())?;
    Ok((grid, middle(&bounds)))
}

fn worst_height_m(row: u32, column: u32) -> f32 {
    let (half, quarter) = (SIDE / 2, SIDE / 4);
    // Numbers without order, the same each time (Steele and others 2014, SplitMix).
    let mut bits = u64::from(row * SIDE + column).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    let noise = ((bits >> 40) as f32) / 16_777_216.0;
    match (row, column) {
        (r, c) if r == quarter && c == quarter => 9000.0,
        (r, c) if r.abs_diff(3 * quarter) < 8 && c.abs_diff(quarter) < 8 => -11_000.0,
        // Cliffs, one every 40 samples.
        (r, c) if r < half && c >= half => {
            if (c / 40) % 2 == 0 {
                3000.0
            } else {
                0.0
            }
        }
        (r, c) if r >= half && c >= half => 400.0 * noise,
        _ => 500.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_case_has_what_it_says() {
        let (grid, site) = worst_case().expect("sound");
        let range = grid.stats().range;
        assert_eq!((range.low_m, range.high_m), (-11_000.0, 9000.0));
        let heights = Ground::new([Arc::new(grid)]);
        let step = 1_f64.to_radians() / f64::from(SIDE - 1);
        let at = |south: f64, east: f64| {
            let (lat, lon) = (site.lat_rad - south * step, site.lon_rad + east * step);
            heights.height_m(lat, lon, 0.0)
        };
        let cliffs: Vec<_> = (40..200).map(|east| at(-100.0, f64::from(east))).collect();
        let steps = cliffs
            .windows(2)
            .filter(|pair| (pair[1] - pair[0]).abs() > 1400.0);
        assert!(steps.count() >= 3);
        assert_eq!(at(-50.0, -50.0), 500.0);
        assert_ne!(at(100.0, 100.0), at(101.0, 100.0));
    }
}
