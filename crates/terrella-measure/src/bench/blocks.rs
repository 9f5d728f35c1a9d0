//! How many blocks an eye should see: counted without any of the code that chooses blocks for drawing.

use glam::{DMat4, DVec3};
use std::f64::consts::PI;
use terrella::frames::Ellipsoid;
use terrella_ground::globe::{Block, BlockGrid, Visibility, select_blocks};

/// Blocks above the horizon, the frustum left aside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BlockCounts {
    /// Blocks of which a point of the ellipsoid is above the horizon: [`sees_block`].
    pub exact: u32,
    /// Blocks that the paper's rule takes.
    pub paper_rule: u32,
    /// Blocks of the exact count that the Earth's own rule leaves out.
    pub lost: u32,
    /// Blocks of the exact count that the paper's rule leaves out.
    pub lost_paper_rule: u32,
}

impl BlockCounts {
    /// Counts for an eye; `visibility` is the Earth's own rule.
    pub fn of(grid: &BlockGrid, visibility: Visibility, eye_itrf_m: DVec3) -> Self {
        let mut own = Vec::new();
        let mut paper = Vec::new();
        // Planes of zeros cut nothing off.
        let no_frustum = DMat4::ZERO;
        select_blocks(grid, visibility, eye_itrf_m, &no_frustum, &mut own);
        select_blocks(grid, Visibility::Paper, eye_itrf_m, &no_frustum, &mut paper);
        let mut counts = Self {
            paper_rule: paper.len() as u32,
            ..Self::default()
        };
        for block in Block::all() {
            if sees_block(&grid.ellipsoid(), block, eye_itrf_m) {
                counts.exact += 1;
                counts.lost += u32::from(!own.contains(&block));
                counts.lost_paper_rule += u32::from(!paper.contains(&block));
            }
        }
        counts
    }

    /// The larger of each.
    pub fn max(self, other: Self) -> Self {
        Self {
            exact: self.exact.max(other.exact),
            paper_rule: self.paper_rule.max(other.paper_rule),
            lost: self.lost.max(other.lost),
            lost_paper_rule: self.lost_paper_rule.max(other.lost_paper_rule),
        }
    }
}

/// Longitude and latitude span of a block, radians.
const SPAN_RAD: f64 = PI / 8.0;
/// Parts of a block smaller than this count as seen if they may be: under a metre on the ground.
const FINEST_RAD: f64 = 1e-7;

/// Whether a point of the block is above the horizon of an eye outside the ellipsoid.
///
/// The point of geodetic latitude φ and longitude λ sees the eye iff the eye is above its tangent plane, f(φ, λ) = (e − P)·n > 0. With n the
/// normal, P·n = √(a² cos² φ + b² sin² φ), so that |∇f| ≤ |e| + (a² − b²)/2b. The block is bisected repeatedly: a part is finished if f > 0 at its
/// middle, or if f is too negative for any of its points to reach 0.
pub fn sees_block(ellipsoid: &Ellipsoid, block: Block, eye_itrf_m: DVec3) -> bool {
    let (a, b) = (ellipsoid.equatorial_radius_m, ellipsoid.polar_radius_m);
    let steepest = eye_itrf_m.length() + (a * a - b * b) / (2.0 * b);
    let half = 0.5 * SPAN_RAD;
    // Middle and half extent, latitude then longitude.
    let mut parts = vec![(block.center_lat_rad(), block.center_lon_rad(), half, half)];
    while let Some((lat, lon, half_lat, half_lon)) = parts.pop() {
        let (sin, cos) = lat.sin_cos();
        let normal = DVec3::new(cos * lon.cos(), cos * lon.sin(), sin);
        let above = eye_itrf_m.dot(normal) - (a * cos).hypot(b * sin);
        if above > 0.0 {
            return true;
        }
        // A way to any point of the part goes along a meridian, then along a parallel.
        if above + steepest * (half_lat + half_lon) < 0.0 {
            continue;
        }
        if half_lat.max(half_lon) < FINEST_RAD {
            return true;
        }
        let (less_lat, less_lon) = (0.5 * half_lat, 0.5 * half_lon);
        for (up, right) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            parts.push((
                lat + up * less_lat,
                lon + right * less_lon,
                less_lat,
                less_lon,
            ));
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EYE_HEIGHTS, GroundPath};
    use terrella::frames::Geodetic;

    fn grid() -> BlockGrid {
        BlockGrid::new(Ellipsoid::WGS84, 6).expect("a sound subdivision")
    }

    fn count(lat_deg: f64, lon_deg: f64, height_m: f64) -> u32 {
        let place = Geodetic::from_degrees(lat_deg, lon_deg, height_m);
        let eye = Ellipsoid::WGS84.itrf_from_geodetic(place);
        BlockCounts::of(&grid(), Visibility::Conservative, eye).exact
    }

    #[test]
    fn known_views_are_counted_right() {
        // The horizon of 1 km is 1° away: only the block below, two at an edge, four at a corner, all 16 at a pole.
        assert_eq!(count(11.25, 11.25, 1e3), 1);
        assert_eq!(count(11.25, 22.5, 1e3), 2);
        assert_eq!(count(22.5, 22.5, 1e3), 4);
        assert_eq!(count(90.0, 0.0, 1e3), 16);
        // 11° at 118 km just misses the neighbours of a block's middle on the equator's row; 12° at 142 km does not.
        assert_eq!(count(11.25, 11.25, 1.10e5), 1);
        assert!(count(11.25, 11.25, 1.6e5) >= 3);
        // From very far, a hemisphere: over a pole the four rows of it, with 64 blocks.
        assert_eq!(count(90.0, 0.0, 1e12), 64);
    }

    /// A dense scan cannot find more than the exact count, and misses only slivers.
    #[test]
    fn a_dense_scan_agrees() {
        let ellipsoid = Ellipsoid::WGS84;
        let (mut scanned, mut exact) = (0, 0);
        for height in EYE_HEIGHTS {
            let motion = GroundPath::Inclined.motion(&ellipsoid, height.height_km * 1e3, 0.37);
            let eye = motion.position_itrf_m;
            for block in Block::all() {
                let is_seen = sees_block(&ellipsoid, block, eye);
                let scan = (0..=40).any(|i| {
                    (0..=40).any(|j| {
                        let at = |n: u32| (f64::from(n) / 40.0 - 0.5) * SPAN_RAD;
                        let lat = block.center_lat_rad() + at(i);
                        let normal = Ellipsoid::normal(lat, block.center_lon_rad() + at(j));
                        (eye - ellipsoid.surface_point(normal)).dot(normal) > 0.0
                    })
                });
                assert!(is_seen || !scan, "{block:?} from {} km", height.height_km);
                scanned += u32::from(scan);
                exact += u32::from(is_seen);
            }
        }
        assert!(exact - scanned <= 2, "{scanned} of {exact}");
    }

    #[test]
    fn drawing_loses_none_and_the_paper_s_rule_does() {
        let grid = grid();
        let mut paper_lost = 0;
        for height in EYE_HEIGHTS {
            for path in GroundPath::ALL {
                for step in 0..23 {
                    let part = f64::from(step) / 23.0;
                    let motion = path.motion(&grid.ellipsoid(), height.height_km * 1e3, part);
                    let eye = motion.position_itrf_m;
                    let counts = BlockCounts::of(&grid, Visibility::Conservative, eye);
                    assert_eq!(counts.lost, 0, "{} km, {part}", height.height_km);
                    paper_lost += counts.lost_paper_rule;
                }
            }
        }
        assert!(paper_lost > 10, "{paper_lost}");
    }
}
