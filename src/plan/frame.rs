//! The content of a frame.

use super::{AirPlan, DrawCosts, DrawLight, FrameUniforms, LISTED_INDICES, SurfaceDraw};
use bytemuck::Zeroable;
use glam::{DVec3, Vec3};
use std::ops::Range;
use terrella_frames::Ellipsoid;
use terrella_ground::globe::{BLOCK_COUNT, Block, BlockGrid, BlockSet, TangentCone};
use terrella_imagery::CITY_CELLS;
use terrella_imagery::residency::{PartTables, ResidentTile};
use terrella_imagery::tile::MAP_LAYERS;

/// Triangles of the rectangle for airglow and aurora.
const GLOW_TRIANGLES: u32 = 2;

/// Quads of the ring for the clouds above the edge of the ground.
pub(crate) const LIMB_SEGMENTS: u32 = 128;

/// Triangles of the rectangle for a city light.
const POINT_TRIANGLES: u32 = 2;

/// The tiles that a block is drawn with, by [`terrella_imagery::tile::MapLayer::index`]; `None` is the whole map.
pub(crate) type BlockTiles = [Option<ResidentTile>; MAP_LAYERS];

/// Tiles of the blocks in sight and of their parts.
#[derive(Default)]
pub(crate) struct ChosenTiles {
    pub blocks: Vec<(Block, BlockTiles)>,
    pub parts: PartTables,
}

impl ChosenTiles {
    /// The blocks that have a tile of any map.
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

/// The content of a frame, except the vertices of terrain, which stay with their surface.
///
/// One plan is reused for all frames, so that its lists keep their capacity.
pub(crate) struct FramePlan {
    /// The figure of the Earth.
    pub ellipsoid: Ellipsoid,
    pub eye_itrf_m: DVec3,
    /// Uniforms of the frame, for all shaders of the Earth.
    pub uniforms: FrameUniforms,
    /// Index of the blocks' mesh in [`terrella_ground::globe::Meshes::grids`].
    pub mesh: usize,
    /// The blocks in sight, in drawing order.
    pub blocks: Vec<Block>,
    /// Their vertices relative to the eye, ITRF axes, metres: (n + 1)² a block, row by row. Empty with terrain.
    pub vertices: Vec<Vec3>,
    /// Indices of the cells of blocks whose cells are drawn in several ways.
    pub cells: Vec<u16>,
    /// The draws of the surface, in order.
    pub draws: Vec<SurfaceDraw>,
    /// The city lights that may be lit and in sight.
    pub city_lights: Vec<CityDraw>,
    /// The blocks where the Sun is above the horizon everywhere: no lamp is lit there.
    pub daylit: BlockSet,
    /// The blocks where the Sun is so low everywhere that it gives no light.
    pub night: BlockSet,
    /// Whether the Moon's shadow may be in view.
    pub has_moon_shadow: bool,
    /// Whether the eye is below the clouds, or so little above that they are also visible from below.
    pub is_below_clouds: bool,
    /// Whether clouds are drawn around the eye.
    pub has_clouds_around: bool,
    /// Whether clouds may be seen above the edge of the ground.
    pub has_clouds_at_limb: bool,
    /// Lower bound of the size of a pixel on the ground, equatorial radii.
    pub least_pixel: f64,
    /// The billboard of the air's halo; `None` without air.
    pub air: Option<AirPlan>,
}

/// City lights of a cell.
#[derive(Clone, Debug)]
pub struct CityDraw {
    /// Index of the cell.
    pub cell: usize,
    /// Which of its points.
    pub points: Range<u32>,
}

impl FramePlan {
    /// An empty plan with capacity for so many vertices.
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
            night: BlockSet::default(),
            has_moon_shadow: false,
            is_below_clouds: false,
            has_clouds_around: false,
            has_clouds_at_limb: false,
            least_pixel: 0.0,
            air: None,
        }
    }

    /// Empties the plan; keeps the capacity of its lists.
    pub fn clear(&mut self) {
        self.blocks.clear();
        self.vertices.clear();
        self.cells.clear();
        self.draws.clear();
        self.city_lights.clear();
        self.daylit = BlockSet::default();
        self.night = BlockSet::default();
        self.has_moon_shadow = false;
        self.is_below_clouds = false;
        self.has_clouds_around = false;
        self.has_clouds_at_limb = false;
        self.least_pixel = 0.0;
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
                + usize::from(self.has_clouds_around)
                + usize::from(self.has_clouds_at_limb)
                + usize::from(air.is_some())
                + usize::from(glow.is_some())) as u32,
            triangles: surface
                .chain(city_lights)
                .chain(air)
                .chain(glow)
                .chain(self.is_below_clouds.then_some(1))
                .chain(self.has_clouds_around.then_some(1))
                .chain(self.has_clouds_at_limb.then_some(2 * LIMB_SEGMENTS))
                .sum(),
        }
    }

    /// Adds city lights, if there are any.
    pub fn add_city_lights(&mut self, draw: CityDraw) {
        if !draw.points.is_empty() {
            self.city_lights.push(draw);
        }
    }

    /// Computes the vertices of the blocks in sight relative to the eye, in f64. Vertices beyond the limb are lifted to it.
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
