//! Parts of blocks: repeated halvings of a block, into which maps finer than a block's tile are cut. Free functions over plain data.

use super::blocks::{Block, SPAN_RAD};
use super::culling::{Frustum, GroundShell, Horizon, ScaledFrustum, ScaledRect};
use crate::height::HeightRange;
use glam::{DMat4, DVec2, DVec3};
use terrella_frames::Ellipsoid;

/// One of the 2^depth × 2^depth parts of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Part {
    pub block: Block,
    /// Number of halvings, 0…15.
    pub depth: u8,
    /// Counted from the block's north.
    pub row: u16,
    /// Counted from the block's west.
    pub column: u16,
}

impl Part {
    pub fn whole(block: Block) -> Self {
        Self {
            block,
            depth: 0,
            row: 0,
            column: 0,
        }
    }

    /// The part's four quarters, row by row from the north-west.
    pub fn quarters(self) -> [Self; 4] {
        [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(row, column)| Self {
            block: self.block,
            depth: self.depth + 1,
            row: 2 * self.row + row,
            column: 2 * self.column + column,
        })
    }

    /// Index among the parts of the same depth, row by row. At a coarser `depth`, the index of the part that contains this one.
    pub fn index_at(self, depth: u8) -> u16 {
        let steps = self.depth.saturating_sub(depth);
        ((self.row >> steps) << depth) + (self.column >> steps)
    }

    fn rect(self, ellipsoid: &Ellipsoid) -> ScaledRect {
        let span_rad = SPAN_RAD / f64::from(1_u32 << self.depth);
        let lat = |row: f64| {
            let lat_rad = (4.0 - f64::from(self.block.row)) * SPAN_RAD - row * span_rad;
            let (a, b) = (ellipsoid.equatorial_radius_m, ellipsoid.polar_radius_m);
            // Parametric latitude: tan β = (b/a) tan φ.
            DVec2::new(a * lat_rad.cos(), b * lat_rad.sin()).normalize()
        };
        let west_rad = (f64::from(self.block.column) - 8.0) * SPAN_RAD;
        let (sin, cos) = (west_rad + (f64::from(self.column) + 0.5) * span_rad).sin_cos();
        ScaledRect {
            lon: DVec2::new(cos, sin),
            half_width_rad: 0.5 * span_rad,
            north: lat(f64::from(self.row)),
            south: lat(f64::from(self.row) + 1.0),
        }
    }
}

/// Visibility of parts in a view.
pub struct PartSight {
    ellipsoid: Ellipsoid,
    shell: GroundShell,
    horizon: Horizon,
    frustum: ScaledFrustum,
    eye_scaled: DVec3,
}

impl PartSight {
    /// A view of ground between these heights above the ellipsoid, metres. `eye_itrf_m` is the eye in ITRF metres; `clip_from_eye` takes
    /// eye-relative metres to clip space with z in 0…w.
    pub fn new(
        ellipsoid: Ellipsoid,
        range: HeightRange,
        eye_itrf_m: DVec3,
        clip_from_eye: &DMat4,
    ) -> Self {
        let shell = GroundShell::new(&ellipsoid, range);
        Self {
            ellipsoid,
            shell,
            horizon: Horizon::new(&ellipsoid, eye_itrf_m, shell),
            frustum: Frustum::new(clip_from_eye).scaled(&ellipsoid, eye_itrf_m),
            eye_scaled: ellipsoid.scaled_from_itrf() * eye_itrf_m,
        }
    }

    /// Distance from the eye to the part's nearest point on the ellipsoid, metres, as in
    /// [`BlockGrid::distance_m`](super::BlockGrid::distance_m). `None` if the part is not visible.
    pub fn distance_m(&self, part: Part) -> Option<f64> {
        let rect = part.rect(&self.ellipsoid);
        if self.horizon.hides_rect(&rect) || self.frustum.excludes_rect(&rect, &self.shell) {
            return None;
        }
        Some(rect.distance(self.eye_scaled) * self.ellipsoid.equatorial_radius_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::globe::BlockGrid;
    use terrella_frames::Geodetic;

    const RANGE: HeightRange = HeightRange {
        low_m: 0.0,
        high_m: 0.0,
    };

    #[test]
    fn quarters_lie_in_their_part() {
        let block = Block { column: 3, row: 2 };
        let mut part = Part::whole(block);
        assert_eq!(part.index_at(0), 0);
        for turn in [3, 0, 2, 1] {
            let quarter = part.quarters()[turn];
            assert_eq!(quarter.index_at(part.depth), part.index_at(part.depth));
            part = quarter;
        }
        // South-east, north-west, south-west, north-east: rows 1010, columns 1001 in binary.
        assert_eq!((part.row, part.column, part.depth), (0b1010, 0b1001, 4));
        assert_eq!(part.index_at(4), 0b1010 * 16 + 0b1001);
        assert_eq!(part.index_at(2), 0b10 * 4 + 0b10);
    }

    /// A view straight down that spans the whole Earth, so that the frustum excludes nothing.
    fn sight(eye_itrf_m: DVec3) -> PartSight {
        let clip = glam::dcamera::rh::proj::directx::perspective(3.0, 1.0, 1.0, 1e8)
            * glam::dcamera::rh::view::look_to_mat4(
                DVec3::ZERO,
                -eye_itrf_m.normalize(),
                DVec3::new(0.3, 0.2, 0.9),
            );
        PartSight::new(Ellipsoid::WGS84, RANGE, eye_itrf_m, &clip)
    }

    #[test]
    fn a_part_is_as_far_as_its_nearest_place() {
        let grid = BlockGrid::new(Ellipsoid::WGS84, 6).expect("good");
        let eye = Ellipsoid::WGS84.itrf_from_geodetic(Geodetic::from_degrees(12.0, 40.0, 3e5));
        let sight = sight(eye);
        let mut seen = 0;
        for block in Block::all() {
            let Some(whole_m) = sight.distance_m(Part::whole(block)) else {
                continue;
            };
            let of_grid_m = grid.distance_m(block, eye);
            assert!((whole_m - of_grid_m).abs() < 1e-6 * of_grid_m, "{block:?}");
            for part in Part::whole(block)
                .quarters()
                .into_iter()
                .flat_map(Part::quarters)
            {
                let Some(distance_m) = sight.distance_m(part) else {
                    continue;
                };
                seen += 1;
                assert!(distance_m >= whole_m - 1e-3, "{part:?}");
                // Compare with points of a dense lattice, on a sphere except for the flattening.
                let nearest = (0..=40)
                    .flat_map(|i| (0..=40).map(move |j| (i, j)))
                    .map(|(i, j)| {
                        let span = 22.5 / 4.0;
                        let lat = 90.0
                            - f64::from(block.row) * 22.5
                            - (f64::from(part.row) + f64::from(i) / 40.0) * span;
                        let lon = f64::from(block.column) * 22.5 - 180.0
                            + (f64::from(part.column) + f64::from(j) / 40.0) * span;
                        let place = Geodetic::from_degrees(lat, lon, 0.0);
                        Ellipsoid::WGS84.itrf_from_geodetic(place).distance(eye)
                    });
                let nearest_m = nearest.fold(f64::INFINITY, f64::min);
                assert!(
                    distance_m <= 1.004 * nearest_m,
                    "{part:?}: {distance_m} {nearest_m}"
                );
                assert!(
                    distance_m >= 0.97 * nearest_m,
                    "{part:?}: {distance_m} {nearest_m}"
                );
            }
        }
        assert!(seen > 40, "{seen}");
    }

    #[test]
    fn parts_beyond_the_horizon_or_beside_the_picture_are_not_seen() {
        let eye = Ellipsoid::WGS84.itrf_from_geodetic(Geodetic::from_degrees(12.0, 40.0, 2e5));
        // 1.6 million metres to the horizon: 14.4°.
        let far = Part::whole(Block { column: 12, row: 3 });
        assert!(sight(eye).distance_m(far).is_none());
        let narrow = glam::dcamera::rh::proj::directx::perspective(0.1, 1.0, 1.0, 1e8)
            * glam::dcamera::rh::view::look_to_mat4(DVec3::ZERO, -eye.normalize(), DVec3::Z);
        let sight = PartSight::new(Ellipsoid::WGS84, RANGE, eye, &narrow);
        let below = Part::whole(Block { column: 9, row: 3 });
        let seen: Vec<_> = below
            .quarters()
            .into_iter()
            .flat_map(Part::quarters)
            .filter(|part| sight.distance_m(*part).is_some())
            .collect();
        // 12° N 40° E: 10.5° below the block's north and 17.5° from its west, in parts of 5.6°.
        let nadir = Part {
            block: below.block,
            depth: 2,
            row: 1,
            column: 3,
        };
        assert_eq!(seen, [nadir]);
    }
}
