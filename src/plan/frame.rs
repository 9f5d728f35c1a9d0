//! All that a frame draws.

use super::{AirPlan, DrawCosts, DrawLight, FrameUniforms, LISTED_INDICES, SurfaceDraw};
use bytemuck::Zeroable;
use glam::{DVec3, Vec3};
use std::ops::Range;
use terrella_frames::Ellipsoid;
use terrella_ground::globe::{BLOCK_COUNT, Block, BlockGrid, BlockSet, TangentCone};
use terrella_imagery::CITY_CELLS;
use terrella_imagery::residency::{PartTables, ResidentTile};
use terrella_imagery::tile::MAP_LAYERS;

/// Of the rectangle that the air's own light is drawn in.
const GLOW_TRIANGLES: u32 = 2;

/// Of the rectangle that a point of city lights is drawn in.
const POINT_TRIANGLES: u32 = 2;

/// The tiles that a block is drawn with, by [`terrella_imagery::tile::MapLayer::index`]; `None` is the whole map.
pub(crate) type BlockTiles = [Option<ResidentTile>; MAP_LAYERS];

/// What the blocks in sight are drawn with, and parts of them.
#[derive(Default)]
pub(crate) struct ChosenTiles {
    pub blocks: Vec<(Block, BlockTiles)>,
    pub parts: PartTables,
}

impl ChosenTiles {
    /// The blocks that have tiles, of whatever map.
    pub fn tiled(&self) -> BlockSet {
        let mut tiled = BlockSet::default();
        for (block, tiles) in &self.blocks {
            if tiles.iter().any(Option::is_some) {
                tiled.insert(block.index() as u8);
            }
        }
        tiled
    }
}

/// All that a frame draws but the vertices of terrain: these stay with the surface that made them.
///
/// One plan serves all frames, so that its lists keep their memory.
pub(crate) struct FramePlan {
    /// The figure of the Earth.
    pub ellipsoid: Ellipsoid,
    pub eye_itrf_m: DVec3,
    /// What all shaders of the Earth read of a frame.
    pub uniforms: FrameUniforms,
    /// The mesh that blocks are drawn with: its place among [`terrella_ground::globe::Meshes::grids`].
    pub mesh: usize,
    /// The blocks in sight, in the order in which they are drawn.
    pub blocks: Vec<Block>,
    /// Their vertices from the eye, ITRF axes, metres: (n + 1)² a block, row by row. None where there is terrain.
    pub vertices: Vec<Vec3>,
    /// Indices of the cells of blocks that are not drawn alike everywhere.
    pub cells: Vec<u16>,
    /// The draws of the surface, in their order.
    pub draws: Vec<SurfaceDraw>,
    /// The city lights that may be lit and in sight.
    pub city_lights: Vec<CityDraw>,
    /// The blocks on which the Sun stands above the horizon everywhere: no lamp is lit there.
    pub daylit: BlockSet,
    /// Whether the Moon's shadow may be in view.
    pub has_moon_shadow: bool,
    /// Whether the eye is below the clouds, or so near above that they are seen from below too.
    pub is_below_clouds: bool,
    /// The ring that carries the air's halo; `None` without air.
    pub air: Option<AirPlan>,
}

/// City lights of a cell.
#[derive(Clone, Debug)]
pub struct CityDraw {
    /// Number of the cell.
    pub cell: usize,
    /// Which of its points.
    pub points: Range<u32>,
}

impl FramePlan {
    /// A plan that draws nothing, with room for so many vertices.
    pub fn new(ellipsoid: Ellipsoid, vertices: usize) -> Self {
        Self {
            ellipsoid,
            eye_itrf_m: DVec3::ZERO,
            uniforms: FrameUniforms::zeroed(),
            mesh: 0,
            blocks: Vec::with_capacity(BLOCK_COUNT as usize),
            vertices: Vec::with_capacity(vertices),
            cells: Vec::with_capacity(if vertices > 0 { LISTED_INDICES } else { 0 }),
            draws: Vec::with_capacity(DrawLight::ALL.len() * BLOCK_COUNT as usize),
            city_lights: Vec::with_capacity(CITY_CELLS),
            daylit: BlockSet::default(),
            has_moon_shadow: false,
            is_below_clouds: false,
            air: None,
        }
    }

    /// Draws nothing until it is filled again; keeps the lists' memory.
    pub fn clear(&mut self) {
        self.blocks.clear();
        self.vertices.clear();
        self.cells.clear();
        self.draws.clear();
        self.city_lights.clear();
        self.daylit = BlockSet::default();
        self.has_moon_shadow = false;
        self.is_below_clouds = false;
        self.air = None;
    }

    pub fn costs(&self) -> DrawCosts {
        let surface = self.draws.iter().map(|draw| draw.indices.len() as u32 / 3);
        let air = self.air.as_ref().map(|air| air.ring.triangles());
        let glow = self.air.as_ref().and_then(|air| air.glow.as_ref());
        let glow = glow.map(|_| GLOW_TRIANGLES);
        let city_lights = self.city_lights.iter();
        let city_lights = city_lights.map(|draw| POINT_TRIANGLES * draw.points.len() as u32);
        DrawCosts {
            draw_calls: (self.draws.len()
                + self.city_lights.len()
                + usize::from(self.is_below_clouds)
                + usize::from(air.is_some())
                + usize::from(glow.is_some())) as u32,
            triangles: surface
                .chain(city_lights)
                .chain(air)
                .chain(glow)
                .chain(self.is_below_clouds.then_some(1))
                .sum(),
        }
    }

    /// Adds city lights, if there are any.
    pub fn add_city_lights(&mut self, draw: CityDraw) {
        if !draw.points.is_empty() {
            self.city_lights.push(draw);
        }
    }

    /// Subtracts the eye from every vertex of the blocks in sight, in f64, those beyond the limb lifted to it.
    pub fn place_vertices(&mut self, grid: &BlockGrid) {
        let cone = TangentCone::new(self.eye_itrf_m, &self.ellipsoid);
        self.vertices.clear();
        for block in &self.blocks {
            for row in 0..=grid.subdivision() {
                let row = grid.vertex_row(*block, row).iter();
                self.vertices
                    .extend(row.map(|v| (cone.lifted(*v) - self.eye_itrf_m).as_vec3()));
            }
        }
    }
}
