//! How the cells of the block sphere are lit. In daylight, cells skip the layers of the night, interpolate the air's light between their vertices
//! if that suffices, and are split into land without sea and open sea without land.

use super::draws::{DrawLight, LISTED_INDICES, SurfaceDraw, block_ranges, whole_range};
use super::frame::FramePlan;
use glam::Vec3;
use std::sync::Arc;
use terrella_ground::air::{AirAboveClouds, AirTables, InterpolationLimits};
use terrella_ground::globe::{Block, BlockGrid};
use terrella_ground::light::{DisplaySlope, Grade, Tone};
use terrella_imagery::{GroundKind, GroundKinds};

/// Number of cells per block edge at which most of the air's light can be interpolated, for an eye above the air: more if cells look large, but no
/// more than the limb needs if more vertices would cost more than they save.
pub(crate) fn interpolated_cells(height_m: f64) -> u32 {
    match height_m {
        4e5..9e5 => 48,
        9e5..2.4e6 => 16,
        _ => 0,
    }
}

/// Classifies cells by the light they need.
pub(crate) struct CellLights {
    tables: Arc<AirTables>,
    limits: InterpolationLimits,
    clouds: Option<(Arc<AirAboveClouds>, InterpolationLimits)>,
    display_slope: DisplaySlope,
    /// For each vertex of a block, the light that suffices there.
    enough: Vec<DrawLight>,
    /// For each of its cells, how it is drawn.
    drawn: Vec<DrawLight>,
}

/// Light on the cells of a frame.
pub(crate) struct CellLight {
    /// Unit vector to the Sun, ITRF axes.
    pub sun_itrf: Vec3,
    /// Exposure factor of light before display.
    pub exposure: f32,
    /// Sine of the Sun's elevation above which layers of the night are invisible.
    pub day_sin: f32,
}

impl CellLight {
    /// The light that suffices at a vertex.
    fn at_vertex(
        &self,
        (of_ground, of_clouds): (&InterpolationLimits, Option<&InterpolationLimits>),
        (up, from_eye_m): (Vec3, Vec3),
        side_m: f32,
        side_rad: f32,
    ) -> DrawLight {
        let mu_s = up.dot(self.sun_itrf);
        if mu_s <= self.day_sin {
            return DrawLight::Everything;
        }
        let distance_m = from_eye_m.length();
        let mu = -up.dot(from_eye_m) / distance_m;
        let allow = |limits: &InterpolationLimits| {
            limits.allow((mu, mu_s), (side_m / distance_m, side_rad))
        };
        match allow(of_ground) && of_clouds.is_none_or(allow) {
            true => DrawLight::Interpolated,
            false => DrawLight::Daylit,
        }
    }
}

impl CellLights {
    /// For light through this air, and the air above clouds if there are some, displayed with this curve and grade.
    pub fn new(
        tables: Arc<AirTables>,
        clouds: Option<Arc<AirAboveClouds>>,
        tone: Tone,
        grade: &Grade,
    ) -> Self {
        Self {
            limits: tables.interpolation().limits(),
            clouds: clouds.map(|above| {
                let limits = above.interpolation().limits();
                (above, limits)
            }),
            display_slope: DisplaySlope::of(tone, grade),
            tables,
            enough: Vec::with_capacity(49 * 49),
            drawn: Vec::with_capacity(48 * 48),
        }
    }

    /// Lists the draws of a plan's blocks, whose vertices have been placed. Cells with only one kind of ground are listed as such if `kinds` is
    /// known. Allocates nothing.
    pub fn list(
        &mut self,
        grid: &BlockGrid,
        light: &CellLight,
        kinds: Option<&GroundKinds>,
        plan: &mut FramePlan,
    ) {
        let bound = self.tables.interpolation();
        let slope = &self.display_slope;
        bound.set_shown(&mut self.limits, light.exposure, |light| slope.at(light));
        if let Some((above, limits)) = &mut self.clouds {
            let bound = above.interpolation();
            bound.set_shown(limits, light.exposure, |light| slope.at(light));
        }
        let of_clouds = self.clouds.as_ref().map(|(_, limits)| limits);
        let ranges = block_ranges(grid);
        let n = grid.subdivision();
        let radii_m = grid.ellipsoid().itrf_from_scaled();
        let place = VertexPlace {
            eye_itrf_m: plan.eye_itrf_m.as_vec3(),
            to_normal: (radii_m.x * radii_m.x / (radii_m * radii_m)).as_vec3(),
        };
        let side_rad = grid.cell_rad() as f32;
        let side_m = side_rad * radii_m.x as f32;
        let vertices = plan
            .vertices
            .chunks_exact(grid.vertices_per_block() as usize);
        for (key, (block, vertices)) in (0u64..).zip(plan.blocks.iter().zip(vertices)) {
            self.enough.clear();
            self.enough.extend(vertices.iter().map(|from_eye_m| {
                let up = place.normal(*from_eye_m);
                let limits = (&self.limits, of_clouds);
                light.at_vertex(limits, (up, *from_eye_m), side_m, side_rad)
            }));
            let corner = |i: u32, j: u32| self.enough[(j * (n + 1) + i) as usize];
            self.drawn.clear();
            self.drawn.extend((0..n * n).map(|cell| {
                let (i, j) = (cell % n, cell / n);
                let [a, b] = [j, j + 1].map(|j| corner(i, j).min(corner(i + 1, j)));
                let kind = kinds.filter(|_| a.min(b) == DrawLight::Interpolated);
                match kind.map(|kinds| kinds.of(n, (block.column * n + i, block.row * n + j))) {
                    Some(GroundKind::Land) => DrawLight::Land,
                    Some(GroundKind::OpenSea) => DrawLight::OpenSea,
                    Some(GroundKind::Mixed) | None => a.min(b),
                }
            }));
            let drawn = BlockDraws {
                grid,
                block: *block,
                key,
                cells: &self.drawn,
            };
            let room = LISTED_INDICES - plan.cells.len();
            if !drawn.list_cells(room, &mut plan.cells, &mut plan.draws) {
                plan.draws.push(SurfaceDraw {
                    light: drawn.common(),
                    ..drawn.draw(whole_range(&ranges, *block), false)
                });
            }
            // They are written four bytes at a time; a block at a pole may have an odd number of triangles.
            if !plan.cells.len().is_multiple_of(2) {
                plan.cells.push(0);
            }
        }
    }
}

/// Computes the normals of vertices.
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
    /// The class of each of its cells, row by row.
    cells: &'a [DrawLight],
}

impl BlockDraws<'_> {
    /// The class for drawing the whole block at once.
    fn common(&self) -> DrawLight {
        let first = self.cells.first().copied();
        let alike = first.filter(|first| self.cells.iter().all(|cell| cell == first));
        let least = self.cells.iter().copied().min();
        // A block of land and open sea is neither.
        let least = least.map(|least| least.min(DrawLight::Interpolated));
        alike.or(least).unwrap_or(DrawLight::Everything)
    }

    /// Lists the cells of a block with several classes, if there is room for so many indices. Returns whether it did.
    fn list_cells(&self, room: usize, cells: &mut Vec<u16>, draws: &mut Vec<SurfaceDraw>) -> bool {
        let n = self.grid.subdivision();
        let are_alike = self.cells.windows(2).all(|pair| pair[0] == pair[1]);
        if are_alike || room < 6 * self.cells.len() {
            return false;
        }
        for light in DrawLight::ALL {
            let start = cells.len();
            for (cell, drawn) in (0..).zip(self.cells) {
                if *drawn == light {
                    let kind = self.block.kind();
                    self.grid.push_cell(kind, (cell % n, cell / n), cells);
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
