//! Displaced blocks: the block sphere with each vertex moved to the terrain's elevation.
//!
//! Every block has the same number of cells, so neighbours share their edges' vertices and there are no cracks. It is the simplest terrain
//! surface, and the coarsest: at 48 cells to a block, a cell is 52 km wide.

use super::blocks::{Block, BlockGrid, BlockRow, SubdivisionError};
use super::select::select_blocks_between;
use super::surface::{GroundVertex, GroundView, Patch, Surface, SurfaceStats, TriangleList};
use crate::elevation::{Bounds, COARSEST_STEP_RAD, Elevation, HeightChange};
use glam::{DVec3, Vec2};
use std::f64::consts::{FRAC_PI_8, PI};
use std::sync::Arc;
use terrella_frames::Ellipsoid;

#[derive(Clone, Copy)]
struct DisplacedVertex {
    position_itrf_m: DVec3,
    height_m: f32,
    slope: Vec2,
}

/// The block sphere displaced by the elevation data.
///
/// Memory: 40 bytes a vertex of each block seen so far, and 24 of each drawn; 20 MB at most with 48 cells to a block.
pub struct DisplacedBlocks {
    grid: BlockGrid,
    indices: [Arc<TriangleList>; 3],
    /// By block, computed when first visible.
    displaced: Vec<Option<Vec<DisplacedVertex>>>,
    patches: Vec<Patch>,
    drawn: usize,
    blocks: Vec<Block>,
}

impl DisplacedBlocks {
    /// Makes the surface with `subdivision` × `subdivision` cells a block, 1…48.
    ///
    /// # Errors
    /// A subdivision outside 1…48.
    pub fn new(ellipsoid: Ellipsoid, subdivision: u32) -> Result<Self, SubdivisionError> {
        Ok(Self::of(BlockGrid::new(ellipsoid, subdivision)?))
    }

    /// Makes the surface with the largest number of cells.
    pub fn finest(ellipsoid: Ellipsoid) -> Self {
        Self::of(BlockGrid::finest(ellipsoid))
    }

    fn of(grid: BlockGrid) -> Self {
        let indices = [BlockRow::North, BlockRow::Middle, BlockRow::South].map(|row| {
            Arc::new(TriangleList {
                triangles: grid.indices(row).into_iter().map(u32::from).collect(),
            })
        });
        Self {
            grid,
            indices,
            displaced: Block::all().map(|_| None).collect(),
            patches: Vec::new(),
            drawn: 0,
            blocks: Vec::new(),
        }
    }

    fn cell_rad(&self) -> f64 {
        FRAC_PI_8 / f64::from(self.grid.subdivision())
    }

    /// Reads a block's heights.
    fn displace(&self, block: Block, ground: &dyn Elevation) -> Vec<DisplacedVertex> {
        let n = self.grid.subdivision();
        let ellipsoid = self.grid.ellipsoid();
        let mut displaced = Vec::with_capacity(self.grid.vertices_per_block() as usize);
        for j in 0..=n {
            for (i, foot_itrf_m) in (0..).zip(self.grid.vertex_row(block, j)) {
                let (lat, lon) = self.grid.vertex_lat_lon_rad(block, i, j);
                // A place has one height: a pole uses longitude 0, and the date line −180°.
                let at_pole = (0.5 * PI - lat.abs()).abs() < 1e-12;
                let lon = match at_pole {
                    true => 0.0,
                    false if lon >= PI => -PI,
                    false => lon,
                };
                let height_m = ground.height_m(lat, lon, self.cell_rad());
                let slope = ground.slope(&ellipsoid, lat, lon, self.cell_rad());
                // From the lattice's own point, whose bits neighbours share, and its normal from the gradient.
                let scale = ellipsoid.scaled_from_itrf();
                let normal = (*foot_itrf_m * scale * scale).normalize();
                displaced.push(DisplacedVertex {
                    position_itrf_m: *foot_itrf_m + normal * height_m,
                    height_m: height_m as f32,
                    slope: slope.as_vec2(),
                });
            }
        }
        displaced
    }
}

impl Surface for DisplacedBlocks {
    fn name(&self) -> &'static str {
        "blocks"
    }

    fn prepare(&mut self, view: &GroundView, ground: &dyn Elevation) -> SurfaceStats {
        let range = ground.range_m(&Bounds::GLOBE);
        let mut blocks = std::mem::take(&mut self.blocks);
        select_blocks_between(
            &self.grid,
            range,
            view.eye_itrf_m,
            &view.clip_from_eye,
            &mut blocks,
        );
        let mut stats = SurfaceStats::default();
        self.drawn = blocks.len();
        for (place, block) in blocks.iter().enumerate() {
            let index = block.index() as usize;
            if self.displaced[index].is_none() {
                let displaced = self.displace(*block, ground);
                stats.samples_read += 5 * displaced.len() as u64;
                self.displaced[index] = Some(displaced);
            }
            if place == self.patches.len() {
                self.patches.push(Patch {
                    key: place as u64,
                    revision: 0,
                    origin_itrf_m: view.eye_itrf_m,
                    vertices: Vec::with_capacity(self.grid.vertices_per_block() as usize),
                    changed: std::iter::once(0..self.grid.vertices_per_block()).collect(),
                    indices: self.indices[1].clone(),
                    block: None,
                });
            }
            let (Some(displaced), Some(patch)) =
                (&self.displaced[index], self.patches.get_mut(place))
            else {
                continue;
            };
            let indices = match block.kind() {
                BlockRow::North => &self.indices[0],
                BlockRow::Middle => &self.indices[1],
                BlockRow::South => &self.indices[2],
            };
            if !Arc::ptr_eq(&patch.indices, indices) {
                patch.indices = indices.clone();
            }
            // Relative to the eye: nearby vertices are exact, however wide the block.
            patch.origin_itrf_m = view.eye_itrf_m;
            patch.revision += 1;
            patch.block = Some(*block);
            patch.vertices.clear();
            patch
                .vertices
                .extend(displaced.iter().map(|vertex| GroundVertex {
                    from_origin_m: (vertex.position_itrf_m - view.eye_itrf_m).as_vec3(),
                    height_m: vertex.height_m,
                    slope: vertex.slope,
                }));
            stats.vertices += patch.vertices.len() as u32;
            stats.triangles += patch.indices.triangles.len() as u32 / 3;
        }
        self.blocks = blocks;
        stats.patches = self.drawn as u32;
        let held: usize = self.displaced.iter().flatten().map(Vec::len).sum();
        let staged: usize = self.patches.iter().map(|p| p.vertices.capacity()).sum();
        let triangles: usize = self.indices.iter().map(|i| i.triangles.len()).sum();
        stats.resident_bytes = (held * size_of::<DisplacedVertex>()
            + staged * size_of::<GroundVertex>()
            + triangles * size_of::<u32>()) as u64;
        stats
    }

    fn heights_changed(&mut self, changes: &[HeightChange], _: &dyn Elevation) {
        let cell_rad = self.cell_rad();
        // Slopes are computed between points this far apart.
        let beyond_rad = cell_rad.max(COARSEST_STEP_RAD);
        for block in Block::all() {
            let south_rad = block.center_lat_rad() - 0.5 * FRAC_PI_8;
            let bounds = Bounds {
                south_rad,
                north_rad: south_rad + FRAC_PI_8,
                west_rad: block.center_lon_rad() - 0.5 * FRAC_PI_8,
                width_rad: FRAC_PI_8,
            };
            let touches = |change: &HeightChange| change.touches(&bounds, beyond_rad, cell_rad);
            if changes.iter().any(touches) {
                self.displaced[block.index() as usize] = None;
            }
        }
    }

    /// Does nothing: blocks depend on the view alone.
    fn forget_views(&mut self) {}

    fn for_each_patch(&self, draw: &mut dyn FnMut(&Patch)) {
        for patch in &self.patches[..self.drawn] {
            draw(patch);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elevation::HeightRange;
    use glam::{DMat4, DVec4};
    use std::collections::HashMap;

    /// Hills of 3 km and one of 9 km, troughs of 11 km.
    struct Hills;

    impl Elevation for Hills {
        fn height_m(&self, lat_rad: f64, lon_rad: f64, _: f64) -> f64 {
            let p = Ellipsoid::normal(lat_rad, lon_rad);
            3000.0 * (11.0 * p.x).sin() * (9.0 * p.y + 5.0 * p.z).cos()
                + 6000.0 * (-100.0 * (1.0 - p.x)).exp()
                - 8000.0 * (-100.0 * (1.0 - p.z)).exp()
        }
        fn range_m(&self, _: &Bounds) -> HeightRange {
            HeightRange {
                low_m: -11_000.0,
                high_m: 9000.0,
            }
        }
        fn finest_spacing_rad(&self, _: f64, _: f64) -> f64 {
            0.01
        }
    }

    fn view(eye_itrf_m: DVec3) -> GroundView {
        GroundView {
            eye_itrf_m,
            // Everything in front of and behind the eye is inside the frustum.
            clip_from_eye: DMat4::from_cols(DVec4::ZERO, DVec4::ZERO, DVec4::ZERO, DVec4::W),
            pixel_rad: 1e-3,
            tolerance_px: 1.0,
        }
    }

    #[test]
    fn neighbours_share_their_edges() {
        let mut surface = DisplacedBlocks::new(Ellipsoid::WGS84, 4).expect("sound");
        let displaced: Vec<_> = Block::all().map(|b| surface.displace(b, &Hills)).collect();
        let mut edges: HashMap<[[u64; 3]; 2], u32> = HashMap::new();
        for block in Block::all() {
            let displaced = &displaced[block.index() as usize];
            let bits = |k: u32| {
                let p = displaced[k as usize].position_itrf_m + DVec3::ZERO;
                p.to_array().map(f64::to_bits)
            };
            let row = match block.kind() {
                BlockRow::North => 0,
                BlockRow::Middle => 1,
                BlockRow::South => 2,
            };
            for triangle in surface.indices[row].triangles.chunks(3) {
                for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                    let (a, b) = (bits(triangle[a]), bits(triangle[b]));
                    *edges
                        .entry(if a < b { [a, b] } else { [b, a] })
                        .or_default() += 1;
                }
            }
        }
        let single = edges.values().filter(|count| **count != 2).count();
        assert_eq!(single, 0, "of {} edges", edges.len());
        assert_eq!(surface.name(), "blocks");
        let stats = surface.prepare(&view(DVec3::new(7e6, 0.0, 0.0)), &Hills);
        assert!(stats.patches > 4 && stats.samples_read > 0);
        let again = surface.prepare(&view(DVec3::new(7e6, 0.0, 0.0)), &Hills);
        assert_eq!((again.samples_read, again.patches), (0, stats.patches));
    }

    #[test]
    fn no_block_with_a_vertex_in_sight_is_left_out() {
        let mut surface = DisplacedBlocks::new(Ellipsoid::WGS84, 8).expect("sound");
        let displaced: Vec<_> = Block::all().map(|b| surface.displace(b, &Hills)).collect();
        let scale = Ellipsoid::WGS84.scaled_from_itrf();
        let mut seen = 0;
        for k in 0..200_u32 {
            let t = f64::from(k);
            let direction = Ellipsoid::normal((t * 0.37).sin() * 1.5, t * 2.4);
            let height_m = 10_f64.powf(2.0 + 0.03 * t);
            let eye = Ellipsoid::WGS84.surface_point(direction) + direction * height_m;
            surface.prepare(&view(eye), &Hills);
            for block in Block::all() {
                let visible = displaced[block.index() as usize].iter().any(|vertex| {
                    // Hidden by a sphere of scaled space below all ground.
                    let (a, b) = (eye * scale, vertex.position_itrf_m * scale);
                    let r = 1.0 - 1.2e4 / 6.356e6;
                    let d = b - a;
                    let t = (-a.dot(d) / d.length_squared()).clamp(0.0, 1.0);
                    (a + d * t).length() > r
                });
                let drawn = surface.blocks.contains(&block);
                assert!(drawn || !visible, "{block:?} from {height_m} m");
                seen += u32::from(visible);
            }
        }
        assert!(seen > 1000);
    }
}
