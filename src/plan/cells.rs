//! How the cells of the block sphere are drawn: by day without what shows by night, and where it suffices with the air's light interpolated
//! between their vertices.

use super::draws::{DrawLight, LISTED_INDICES, SurfaceDraw, block_ranges, whole_range};
use super::frame::FramePlan;
use glam::Vec3;
use std::sync::Arc;
use terrella_ground::air::{AirTables, InterpolationLimits};
use terrella_ground::globe::{Block, BlockGrid};

/// Chooses how cells are drawn.
pub(crate) struct CellLights {
    tables: Arc<AirTables>,
    limits: InterpolationLimits,
    /// For each vertex of a block what is enough about it.
    enough: Vec<DrawLight>,
}

/// What lights the cells of a frame.
pub(crate) struct CellLight {
    /// Unit vector to the Sun, ITRF axes.
    pub sun_itrf: Vec3,
    /// What light is multiplied by before it is shown.
    pub exposure: f32,
    /// Sine of the Sun's elevation above which nothing shows that shows by night.
    pub day_sin: f32,
}

impl CellLights {
    /// For light through this air.
    pub fn new(tables: Arc<AirTables>) -> Self {
        Self {
            limits: tables.interpolation().limits(),
            tables,
            enough: Vec::with_capacity(49 * 49),
        }
    }

    /// Lists the draws of a plan's blocks, whose vertices are placed. Allocates nothing.
    pub fn list(&mut self, grid: &BlockGrid, light: &CellLight, plan: &mut FramePlan) {
        let bound = self.tables.interpolation();
        bound.set_exposure(&mut self.limits, light.exposure);
        let ranges = block_ranges(grid);
        let per_block = grid.vertices_per_block() as usize;
        let radii_m = grid.ellipsoid().itrf_from_scaled();
        let place = VertexPlace {
            eye_itrf_m: plan.eye_itrf_m.as_vec3(),
            to_normal: (radii_m.x * radii_m.x / (radii_m * radii_m)).as_vec3(),
        };
        let side_rad = grid.cell_rad() as f32;
        let side_m = side_rad * radii_m.x as f32;
        let vertices = plan.vertices.chunks_exact(per_block);
        for (key, (block, vertices)) in (0u64..).zip(plan.blocks.iter().zip(vertices)) {
            self.enough.clear();
            self.enough.extend(vertices.iter().map(|from_eye_m| {
                let up = place.normal(*from_eye_m);
                let mu_s = up.dot(light.sun_itrf);
                if mu_s <= light.day_sin {
                    return DrawLight::Everything;
                }
                let distance_m = from_eye_m.length();
                let mu = -up.dot(*from_eye_m) / distance_m;
                let spans = (side_m / distance_m, side_rad);
                match self.limits.allow((mu, mu_s), spans) {
                    true => DrawLight::Interpolated,
                    false => DrawLight::Daylit,
                }
            }));
            let drawn = BlockDraws {
                grid,
                block: *block,
                key,
                enough: &self.enough,
            };
            let room = LISTED_INDICES - plan.cells.len();
            if !drawn.list_cells(room, &mut plan.cells, &mut plan.draws) {
                plan.draws.push(SurfaceDraw {
                    light: drawn.least(),
                    ..drawn.draw(whole_range(&ranges, *block), false)
                });
            }
        }
    }
}

/// Finds the normals of vertices.
struct VertexPlace {
    eye_itrf_m: Vec3,
    /// a²/a², a²/a², a²/b².
    to_normal: Vec3,
}

impl VertexPlace {
    fn normal(&self, from_eye_m: Vec3) -> Vec3 {
        ((self.eye_itrf_m + from_eye_m) * self.to_normal).normalize()
    }
}

/// A block whose draws are listed.
struct BlockDraws<'a> {
    grid: &'a BlockGrid,
    block: Block,
    key: u64,
    enough: &'a [DrawLight],
}

impl BlockDraws<'_> {
    /// What is enough for none of it to be wrong.
    fn least(&self) -> DrawLight {
        let all = self.enough.iter().copied().min();
        all.unwrap_or(DrawLight::Everything)
    }

    /// What is enough for a cell: for each of its corners.
    fn of_cell(&self, i: u32, j: u32) -> DrawLight {
        let corner = |i: u32, j: u32| self.enough[(j * (self.grid.subdivision() + 1) + i) as usize];
        let [a, b] = [j, j + 1].map(|j| corner(i, j).min(corner(i + 1, j)));
        a.min(b)
    }

    /// Lists the cells of a block whose cells are not all alike, if there is room for so many indices. Answers whether it did.
    fn list_cells(&self, room: usize, cells: &mut Vec<u16>, draws: &mut Vec<SurfaceDraw>) -> bool {
        let n = self.grid.subdivision();
        let first = self.enough[0];
        let are_alike = self.enough.iter().all(|enough| *enough == first);
        if are_alike || room < 6 * (n * n) as usize {
            return false;
        }
        for light in DrawLight::ALL {
            let start = cells.len();
            for j in 0..n {
                for i in 0..n {
                    if self.of_cell(i, j) == light {
                        self.grid.push_cell(self.block.kind(), (i, j), cells);
                    }
                }
            }
            if cells.len() > start {
                draws.push(SurfaceDraw {
                    light,
                    ..self.draw(start as u32..cells.len() as u32, true)
                });
            }
        }
        true
    }

    fn draw(&self, indices: std::ops::Range<u32>, is_listed: bool) -> SurfaceDraw {
        SurfaceDraw {
            patch: self.key,
            indices,
            is_listed,
            light: DrawLight::Everything,
            drawn_as: self.block.index(),
            block: Some(self.block),
        }
    }
}
