//! Dry land below the level of the sea.
//!
//! Below 0 m, grids of the whole Earth hold the floor of the sea and of lakes, and rock below ice. In a few basins they hold dry land. This module
//! lists these basins. Elsewhere land is drawn at sea level, or slightly below where a map marks it as land ([`LandShares`](super::LandShares)). The
//! box of a basin contains no sea coast. Its depth is that of its dry land or of its lake's surface. Beds of lakes, such as that of the Caspian Sea,
//! are therefore not drawn.

use super::Bounds;
use std::sync::LazyLock;

/// Width of the edge within which a basin begins, degrees.
const EDGE_DEG: f64 = 0.05;

/// South, north, west and east in degrees, and the lowest land in metres. Sources of the levels: CIA, The World Factbook (2024), "Elevation
/// extremes"; for the others, encyclopaedia entries of the places.
const BASINS: [[f64; 5]; 18] = [
    // The Dead Sea and the valley of the Jordan.
    [30.3, 33.0, 35.1, 35.9, -440.0],
    // Turpan.
    [42.2, 43.4, 88.0, 90.9, -160.0],
    // The Qattara depression, Siwa, and the Faiyum.
    [28.3, 30.6, 25.2, 28.6, -140.0],
    [28.9, 29.7, 30.1, 31.1, -60.0],
    // The Danakil depression, and Lake Assal.
    [13.2, 14.4, 39.9, 41.0, -130.0],
    [11.6, 11.75, 42.3, 42.45, -160.0],
    // Death Valley, and the Salton Sea with the valleys beside it.
    [35.6, 36.9, -117.4, -116.4, -90.0],
    [32.6, 33.8, -116.3, -115.2, -75.0],
    // The lands around the Caspian Sea and its surface, and the depression of Karagiye.
    [36.4, 50.0, 46.0, 55.2, -30.0],
    [43.2, 44.0, 51.3, 52.2, -135.0],
    // Chott Melrhir and Chott el Gharsa.
    [33.6, 34.7, 5.8, 8.2, -42.0],
    // Sabkhat Ghuzayyil.
    [29.5, 30.1, 19.4, 20.2, -50.0],
    // The Tah depression.
    [27.55, 27.8, -12.9, -12.5, -58.0],
    // Lake Enriquillo.
    [18.35, 18.65, -71.9, -71.3, -48.0],
    // The great depression of San Julián.
    [-49.8, -49.3, -68.6, -68.0, -107.0],
    // The Bajo del Gualicho.
    [-40.7, -40.0, -65.8, -64.95, -72.0],
    // Lake Eyre.
    [-29.6, -27.8, 136.6, 138.3, -17.0],
    // Polders of Holland and Flevoland.
    [51.85, 52.75, 4.7, 5.9, -8.0],
];

/// Cells of the Earth used to find the basins of a place: side in degrees, and their number along a parallel and a meridian.
const PART_DEG: f64 = 5.0;
const COLUMNS: usize = 72;
const ROWS: usize = 36;

/// Whether a basin overlaps each cell, from the north-west.
static HAS_BASIN: LazyLock<Vec<bool>> = LazyLock::new(|| {
    let mut has = vec![false; COLUMNS * ROWS];
    for [south, north, west, east, _] in BASINS {
        for row in row_of(north)..=row_of(south) {
            for column in column_of(west)..=column_of(east) {
                has[row * COLUMNS + column] = true;
            }
        }
    }
    has
});

fn row_of(lat_deg: f64) -> usize {
    // Negative numbers saturate at 0.
    (((90.0 - lat_deg) / PART_DEG) as usize).min(ROWS - 1)
}

fn column_of(lon_deg: f64) -> usize {
    (((lon_deg + 180.0) / PART_DEG) as usize).min(COLUMNS - 1)
}

/// The lowest land at a place, metres: 0 outside the basins. Continuous.
pub(super) fn lowest_m(lat_rad: f64, lon_rad: f64) -> f64 {
    let lat = lat_rad.to_degrees();
    let lon = (lon_rad.to_degrees() + 180.0).rem_euclid(360.0) - 180.0;
    if !HAS_BASIN[row_of(lat) * COLUMNS + column_of(lon)] {
        return 0.0;
    }
    let of_basin = |[south, north, west, east, depth_m]: &[f64; 5]| {
        let inside = (lat - south)
            .min(north - lat)
            .min(lon - west)
            .min(east - lon);
        depth_m * (inside / EDGE_DEG).clamp(0.0, 1.0)
    };
    // Avoids a negative zero.
    0.0 + BASINS.iter().map(of_basin).fold(0.0, f64::min)
}

/// A lower bound of the land heights within bounds, metres.
pub(super) fn lowest_in_m(bounds: &Bounds) -> f64 {
    let overlaps = |[south, north, west, east, _]: &&[f64; 5]| {
        let basin = Bounds {
            south_rad: south.to_radians(),
            north_rad: north.to_radians(),
            west_rad: west.to_radians(),
            width_rad: (east - west).to_radians(),
        };
        basin.overlaps(bounds)
    };
    let basins = BASINS.iter().filter(overlaps);
    basins.map(|basin| basin[4]).fold(0.0, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_land_below_the_sea_is_in_a_basin_and_the_sea_is_not() {
        let lowest = |lat: f64, lon: f64| lowest_m(lat.to_radians(), lon.to_radians());
        for (name, lat, lon, level_m) in [
            ("shore of the Dead Sea", 31.5, 35.5, -430.0),
            ("Aydingkol in Turpan", 42.66, 89.27, -154.0),
            ("Qattara", 29.6, 27.0, -133.0),
            ("Badwater", 36.25, -116.83, -86.0),
            ("Laguna del Carbón", -49.57, -68.35, -105.0),
            ("Lake Assal", 11.66, 42.38, -155.0),
            ("Flevoland", 52.45, 5.5, -4.0),
            ("Badwater, counted eastwards", 36.25, 243.17, -86.0),
        ] {
            let found = lowest(lat, lon);
            assert!(
                found <= level_m && found > level_m - 15.0,
                "{name}: {found}"
            );
        }
        for (name, lat, lon) in [
            ("Mediterranean off Gaza", 31.5, 34.2),
            ("North Sea off Haarlem", 52.4, 4.4),
            ("Red Sea off Thio", 14.7, 41.2),
            ("Gulf of Tadjoura", 11.6, 42.9),
            ("Gulf of California", 31.3, -114.6),
            ("Lake Superior", 47.7, -87.3),
            ("Ross Ice Shelf", -81.0, -175.0),
        ] {
            assert_eq!(lowest(lat, lon), 0.0, "{name}");
        }
        // The surface of the Caspian Sea, not its bed.
        assert_eq!(lowest(42.0, 50.5), -30.0);
    }

    #[test]
    fn bounds_hold_the_lowest_within_them() {
        for n in 0..20_000 {
            let x = f64::from(n);
            let (lat, lon) = (70.0 * (x * 0.618).sin(), (x * 7.31) % 720.0 - 360.0);
            let bounds = Bounds {
                south_rad: (lat - 0.3).to_radians(),
                north_rad: (lat + 0.2).to_radians(),
                west_rad: (lon - 0.4).to_radians(),
                width_rad: 0.7_f64.to_radians(),
            };
            let low_m = lowest_in_m(&bounds);
            let at_m = lowest_m(lat.to_radians(), lon.to_radians());
            assert!(low_m <= at_m, "{lat} {lon}: {low_m} above {at_m}");
        }
    }
}
