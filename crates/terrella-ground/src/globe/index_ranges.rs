//! Which blocks ground may touch, and therefore which tiles a range of its triangles is drawn with.

use super::blocks::{BlockSet, COLUMNS, ROWS};
use super::surface::{IndexRange, Patch};
use glam::{DVec3, Vec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use terrella_frames::Ellipsoid;

/// Largest number of triangles in a range: those of a square of 16 × 16 cells.
pub const RANGE_TRIANGLES: usize = 512;

/// Upper bound of the ratio of a change in geodetic latitude to the geocentric angle along it.
const GEODETIC: f64 = 1.01;
/// Error bound of positions on the GPU, radians (6 m).
const ROUNDED_RAD: f64 = 1e-6;

/// The blocks that points up to `radius_m` from `middle_itrf_m` may be in.
pub fn blocks_near(ellipsoid: &Ellipsoid, middle_itrf_m: DVec3, radius_m: f64) -> BlockSet {
    let sine = radius_m / middle_itrf_m.length();
    // A comparison with NaN is false.
    if !(0.0..0.8).contains(&sine) {
        return BlockSet::ALL;
    }
    let angle_rad = sine.asin() * GEODETIC + ROUNDED_RAD;
    let place = ellipsoid.geodetic_from_itrf(middle_itrf_m);
    let (north, south) = (place.lat_rad + angle_rad, place.lat_rad - angle_rad);
    let row = |lat_rad: f64| {
        let row = (0.5 - lat_rad / PI) * f64::from(ROWS);
        (row.max(0.0) as u32).min(ROWS - 1)
    };
    let mut columns = 0..i64::from(COLUMNS);
    if north < FRAC_PI_2 && south > -FRAC_PI_2 {
        // A circle about the place touches the meridians at sin Δλ = sin r / cos φ.
        let aside = angle_rad.sin() / place.lat_rad.cos();
        let aside_rad = aside.min(1.0).asin() + ROUNDED_RAD;
        let column = |lon_rad: f64| ((lon_rad / TAU + 0.5) * f64::from(COLUMNS)).floor() as i64;
        let (first, last) = (
            column(place.lon_rad - aside_rad),
            column(place.lon_rad + aside_rad),
        );
        columns = first..(last + 1).min(first + i64::from(COLUMNS));
    }
    let mut blocks = BlockSet::default();
    for row in row(north)..=row(south) {
        for column in columns.clone() {
            let column = column.rem_euclid(i64::from(COLUMNS)) as u32;
            blocks.insert((row * COLUMNS + column) as u8);
        }
    }
    blocks
}

/// Ranges of a patch's triangles, from the bounding boxes of their vertices.
pub fn patch_ranges(patch: &Patch, ellipsoid: &Ellipsoid, out: &mut Vec<IndexRange>) {
    out.clear();
    let mut start = 0;
    for list in patch.indices.triangles.chunks(3 * RANGE_TRIANGLES) {
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for vertex in list {
            if let Some(vertex) = patch.vertices.get(*vertex as usize) {
                low = low.min(vertex.from_origin_m);
                high = high.max(vertex.from_origin_m);
            }
        }
        let middle_m = patch.origin_itrf_m + 0.5 * (low.as_dvec3() + high.as_dvec3());
        let radius_m = 0.5 * f64::from(low.distance(high));
        let end = start + list.len() as u32;
        out.push(IndexRange {
            indices: start..end,
            blocks: blocks_near(ellipsoid, middle_m, radius_m),
        });
        start = end;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrella_frames::Geodetic;

    /// The block of a place, from its latitude and longitude.
    fn block_of(place: Geodetic) -> u8 {
        let row = ((0.5 - place.lat_rad / PI) * 8.0).clamp(0.0, 7.0) as u8;
        let column = ((place.lon_rad / TAU + 0.5) * 16.0)
            .floor()
            .rem_euclid(16.0) as u8;
        row * 16 + column
    }

    #[test]
    fn no_block_near_a_point_is_left_out_and_few_are_too_many() {
        let wgs84 = Ellipsoid::WGS84;
        let mut too_many = 0;
        let mut seed = 7_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        for round in 0..400 {
            let lat_deg = match round % 4 {
                0 => 90.0,
                1 => -89.0,
                _ => 180.0 * random() - 90.0,
            };
            let lon_deg = if round % 3 == 0 {
                179.99
            } else {
                360.0 * random()
            };
            let middle = wgs84.itrf_from_geodetic(Geodetic::from_degrees(lat_deg, lon_deg, 5e3));
            let radius_m = 10_f64.powf(3.0 + 3.5 * random());
            let found = blocks_near(&wgs84, middle, radius_m);
            let mut seen = BlockSet::default();
            for _ in 0..400 {
                let aside = DVec3::new(random() - 0.5, random() - 0.5, random() - 0.5);
                let place = middle + aside.normalize() * radius_m;
                // There is no ground deep in the Earth.
                if place.length() < 6.3e6 {
                    continue;
                }
                seen.insert(block_of(wgs84.geodetic_from_itrf(place)));
            }
            assert_eq!(seen.0 & !found.0, 0, "{lat_deg} {lon_deg} {radius_m}");
            too_many += u32::from(radius_m < 3e5 && found.len() > seen.len() + 2);
        }
        assert!(too_many < 40, "{too_many}");
    }

    #[test]
    fn a_point_that_is_none_may_lie_anywhere() {
        let wgs84 = Ellipsoid::WGS84;
        for (middle, radius_m) in [(DVec3::ZERO, 1.0), (DVec3::X, f64::NAN), (DVec3::NAN, 1.0)] {
            assert_eq!(blocks_near(&wgs84, middle, radius_m), BlockSet::ALL);
        }
    }
}
