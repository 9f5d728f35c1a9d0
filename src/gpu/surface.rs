//! The drawable of the surface: blocks of a lattice, patches of ground with relief, a grid, or pages that rays are cast at, one
//! indexed draw each.

use super::contours::{self, PageMesh};
use super::grid::GridMesh;
use super::ground::{self, GroundMesh};
use super::lattice::{self, Lattice};
use super::maps::Maps;
use super::tiles::{TILES_BYTES, TileTextures};
use super::{
    DepthBuffer, FramePlan, FrameUniforms, GpuLayer, PassFormat, PipelineDescription, ShaderError,
    ShaderVariant, SurfaceOutput,
};
use crate::globe::{Block, BlockGrid, DrawKind, Shading, Surface};
use crate::imagery::EarthLayers;
use crate::imagery::stream::{Pool, Upload};
use crate::imagery::tile::{MAP_LAYERS, MapLayer};

pub(crate) struct SurfaceDrawable {
    assembled: Assembled,
    geometry: Geometry,
    maps: Maps,
    imagery: Imagery,
    frame: wgpu::Buffer,
    /// Whether triangles that lie in several blocks are drawn with the tiles of each.
    crossing: bool,
    pub texture_bytes: u64,
}

/// What is drawn.
enum Geometry {
    /// The block sphere on the ellipsoid.
    Blocks(Lattice),
    /// Ground with relief.
    Ground {
        mesh: GroundMesh,
        /// All maps whole, for what lies in several blocks or in one without tiles; made where blocks have tiles.
        whole: Option<wgpu::BindGroup>,
    },
    /// The same, its vertices made on the GPU.
    Grid {
        mesh: Box<GridMesh>,
        /// As above.
        whole: Option<wgpu::BindGroup>,
    },
    /// The same as pages of contours. Each lies in one block.
    Pages(PageMesh),
}

impl Geometry {
    fn grid(&self) -> Option<&GridMesh> {
        match self {
            Self::Grid { mesh, .. } => Some(mesh.as_ref()),
            _ => None,
        }
    }

    fn pages(&self) -> Option<&PageMesh> {
        match self {
            Self::Pages(mesh) => Some(mesh),
            _ => None,
        }
    }
}

/// What drawing costs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DrawCosts {
    pub draw_calls: u32,
    pub triangles: u32,
    /// Bytes of vertices, triangles and heights held.
    pub bytes: u64,
}

/// What follows from a look.
struct Assembled {
    variant: ShaderVariant,
    pipeline: wgpu::RenderPipeline,
    bind_group: wgpu::BindGroup,
    shader_bytes: u64,
}

/// What blocks are drawn with.
enum Imagery {
    /// All with the whole maps.
    Whole(wgpu::BindGroup),
    /// Each with tiles of its own.
    Tiles(TileTextures),
}

/// How the surface is drawn: what can change while the maps stay.
pub(crate) struct SurfaceLook<'a> {
    pub shading: Shading,
    /// Which maps are used, of those that there are.
    pub shown: [bool; MAP_LAYERS],
    pub output: SurfaceOutput,
    pub anisotropy: u16,
    pub format: PassFormat,
    /// The air's sunlight table, if there is air and the shading uses it.
    pub sunlight: Option<&'a GpuLayer>,
    /// In what form ground with relief is drawn, if it is and not the block sphere. The variant does not change.
    pub ground: Option<DrawKind<'a>>,
    /// Whether that has triangles that lie in several blocks. Nor does that.
    pub crossing: bool,
    /// Whether edges of triangles are drawn alone.
    pub wireframe: bool,
}

impl SurfaceDrawable {
    /// Uploads the maps. `pools` are those of tiles, if blocks are drawn with tiles.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        grids: &[BlockGrid],
        layers: &EarthLayers,
        pools: Option<&[Pool]>,
        look: &SurfaceLook<'_>,
    ) -> Result<Self, ShaderError> {
        let display_values = look.shading == Shading::Paper;
        let maps = Maps::upload(
            device,
            queue,
            layers,
            display_values,
            look.shown,
            look.anisotropy,
        );
        let imagery = match pools {
            Some(pools) => Imagery::Tiles(TileTextures::new(device, &maps, pools, display_values)),
            None => Imagery::Whole(maps.bind_whole(device)),
        };
        let tile_bytes = match &imagery {
            Imagery::Tiles(tiles) => tiles.bytes,
            Imagery::Whole(_) => 0,
        };
        let texture_bytes = maps.bytes() + tile_bytes;
        let frame = super::uniform_buffer::<FrameUniforms>(device, "terrella frame");
        let whole = || pools.is_some().then(|| maps.bind_whole(device));
        let geometry = match &look.ground {
            None => Geometry::Blocks(Lattice::new(device, grids)),
            Some(DrawKind::Patches) => Geometry::Ground {
                mesh: GroundMesh::new(device),
                whole: whole(),
            },
            Some(DrawKind::Grid(grid)) => Geometry::Grid {
                mesh: Box::new(GridMesh::new(device, grid)),
                whole: whole(),
            },
            Some(DrawKind::ContourPages(pages)) => {
                Geometry::Pages(PageMesh::new(device, pages, look.format.depth))
            }
        };
        let assembled = assemble(device, &maps, &imagery, &frame, &geometry, look)?;
        Ok(Self {
            assembled,
            geometry,
            maps,
            imagery,
            frame,
            crossing: look.crossing && pools.is_some(),
            texture_bytes,
        })
    }

    /// Draws from now on with this look and these grids. Maps and tiles stay where they are.
    ///
    /// Nothing may be drawn until the next frame is written.
    pub fn set_look(
        &mut self,
        device: &wgpu::Device,
        grids: &[BlockGrid],
        look: &SurfaceLook<'_>,
    ) -> Result<(), ShaderError> {
        self.maps.arrange(device, look.shown, look.anisotropy);
        match &mut self.imagery {
            Imagery::Tiles(tiles) => tiles.bind_again(device, &self.maps),
            Imagery::Whole(bind_group) => *bind_group = self.maps.bind_whole(device),
        }
        let with = (&self.maps, &self.imagery, &self.frame);
        self.assembled = assemble(device, with.0, with.1, with.2, &self.geometry, look)?;
        match &mut self.geometry {
            Geometry::Blocks(lattice) => *lattice = Lattice::new(device, grids),
            Geometry::Ground { mesh, whole } => {
                mesh.clear();
                *whole = whole.take().map(|_| self.maps.bind_whole(device));
            }
            Geometry::Grid { mesh, whole } => {
                mesh.clear();
                *whole = whole.take().map(|_| self.maps.bind_whole(device));
            }
            Geometry::Pages(mesh) => mesh.clear(),
        }
        Ok(())
    }

    /// The shader that is drawn with.
    pub fn variant(&self) -> &ShaderVariant {
        &self.assembled.variant
    }

    /// Bytes of its text as the driver gets it.
    pub fn shader_bytes(&self) -> u64 {
        self.assembled.shader_bytes
    }

    /// Writes a part of a tile; does nothing where whole maps are drawn.
    pub fn write_tile(&self, queue: &wgpu::Queue, part: &Upload<'_>) {
        if let Imagery::Tiles(tiles) = &self.imagery {
            tiles.write(queue, part);
        }
    }

    /// Writes what a frame draws: the plan, and of ground with relief the patches or the grid of its surface, as far as they are
    /// not there. Returns the bytes written.
    pub fn write(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        plan: &FramePlan,
        ground: Option<&dyn Surface>,
    ) -> u64 {
        queue.write_buffer(&self.frame, 0, bytemuck::bytes_of(&plan.uniforms));
        let mut written = size_of::<FrameUniforms>() as u64;
        let mut tiled = None;
        if let Imagery::Tiles(tiles) = &mut self.imagery {
            for (block, chosen) in &plan.tiles {
                tiles.choose(device, &self.maps, *block, *chosen);
            }
            if self.crossing {
                tiles.find_tiled(&plan.blocks);
                tiled = Some(tiles.tiled());
            }
            written += tiles.flush(queue);
        }
        written
            + match (
                &mut self.geometry,
                ground.map(|ground| (ground, ground.draw_kind())),
            ) {
                (Geometry::Blocks(lattice), _) => lattice.write(queue, &plan.vertices),
                (Geometry::Ground { mesh, .. }, Some((ground, DrawKind::Patches))) => {
                    mesh.write(queue, ground, (&plan.ellipsoid, plan.eye_itrf_m), tiled)
                }
                (Geometry::Grid { mesh, .. }, Some((ground, DrawKind::Grid(grid)))) => {
                    mesh.write(queue, ground, &grid, tiled)
                }
                (Geometry::Pages(mesh), Some((ground, DrawKind::ContourPages(pages)))) => {
                    mesh.write(queue, ground, &pages, plan.eye_itrf_m)
                }
                // A surface is drawn in one way all its life.
                (Geometry::Ground { .. } | Geometry::Grid { .. } | Geometry::Pages(_), _) => 0,
            }
    }

    /// What the frame that was written last costs, of ground with relief; `None` of blocks.
    pub fn ground_costs(&self) -> Option<DrawCosts> {
        let (draw_calls, triangles, bytes) = match &self.geometry {
            Geometry::Blocks(_) => return None,
            Geometry::Ground { mesh, .. } => (mesh.draw_calls(), mesh.triangles(), mesh.bytes()),
            Geometry::Grid { mesh, .. } => (mesh.draw_calls(), mesh.triangles(), mesh.bytes()),
            Geometry::Pages(mesh) => (mesh.draw_calls(), mesh.triangles(), mesh.bytes()),
        };
        Some(DrawCosts {
            draw_calls,
            triangles,
            bytes,
        })
    }

    /// Draws the plan that was written last.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>, plan: &FramePlan) {
        pass.set_pipeline(&self.assembled.pipeline);
        pass.set_bind_group(0, &self.assembled.bind_group, &[]);
        if let Imagery::Whole(maps) = &self.imagery {
            pass.set_bind_group(1, maps, &[]);
        }
        let bind_tiles = |pass: &mut wgpu::RenderPass<'_>, block: Block| {
            if let Imagery::Tiles(tiles) = &self.imagery {
                pass.set_bind_group(1, tiles.bind_group(block), &[]);
            }
        };
        let bind = |pass: &mut wgpu::RenderPass<'_>, block: Option<Block>, whole: &_| match block {
            Some(block) => bind_tiles(pass, block),
            None => {
                if let Imagery::Tiles(_) = &self.imagery {
                    pass.set_bind_group(1, Option::as_ref(whole), &[]);
                }
            }
        };
        match &self.geometry {
            Geometry::Blocks(lattice) => {
                lattice.render(pass, plan.mesh, &plan.blocks, bind_tiles);
            }
            Geometry::Ground { mesh, whole } => {
                mesh.render(pass, |pass, block| bind(pass, block, whole));
            }
            Geometry::Grid { mesh, whole } => {
                mesh.render(pass, |pass, block| bind(pass, block, whole));
            }
            Geometry::Pages(mesh) => mesh.render(pass, bind_tiles),
        }
    }
}

/// Makes what a look needs.
fn assemble(
    device: &wgpu::Device,
    maps: &Maps,
    imagery: &Imagery,
    frame: &wgpu::Buffer,
    geometry: &Geometry,
    look: &SurfaceLook<'_>,
) -> Result<Assembled, ShaderError> {
    let format = look.format;
    let (grid, pages) = (geometry.grid(), geometry.pages());
    let has_tiles = matches!(imagery, Imagery::Tiles(_));
    let shader = match look.output {
        SurfaceOutput::Color => color_variant(maps, look, has_tiles),
        SurfaceOutput::Geolocation => variant(look, has_tiles, &[("places", true)]),
    };
    let (module, shader_bytes) = shader.module(device)?;
    let table_sampler = table_sampler(device);
    let both = wgpu::ShaderStages::VERTEX_FRAGMENT;
    let mut layout = vec![super::uniform_entry(0, both, size_of::<FrameUniforms>())];
    let mut entries = vec![wgpu::BindGroupEntry {
        binding: 0,
        resource: frame.as_entire_binding(),
    }];
    if let Some(sunlight) = look.sunlight {
        layout.push(super::texture_entry(1, wgpu::TextureViewDimension::D2));
        layout.push(super::sampler_entry(2));
        entries.push(wgpu::BindGroupEntry {
            binding: 1,
            resource: wgpu::BindingResource::TextureView(&sunlight.view),
        });
        entries.push(wgpu::BindGroupEntry {
            binding: 2,
            resource: wgpu::BindingResource::Sampler(&table_sampler),
        });
    }
    if let Imagery::Tiles(tiles) = imagery {
        let fragment = wgpu::ShaderStages::FRAGMENT;
        layout.push(super::uniform_entry(3, fragment, TILES_BYTES));
        entries.push(wgpu::BindGroupEntry {
            binding: 3,
            resource: tiles.placements().as_entire_binding(),
        });
    }
    if let Some(grid) = grid {
        layout.extend(grid.layout());
        entries.extend(grid.entries());
    }
    if let Some(pages) = pages {
        layout.push(pages.layout());
        entries.push(pages.entry());
    }
    let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("terrella earth"),
        entries: &layout,
    });
    let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("terrella earth"),
        layout: &layout,
        entries: &entries,
    });
    let pipeline = PipelineDescription {
        label: "terrella earth",
        bind_groups: Some(&[Some(&layout), Some(maps.layout())]),
        module: &module,
        buffers: match geometry {
            Geometry::Blocks(_) => &lattice::BUFFERS,
            Geometry::Ground { .. } => &ground::BUFFERS,
            Geometry::Grid { .. } => &[],
            Geometry::Pages(_) => &contours::BUFFERS,
        },
        primitive: wgpu::PrimitiveState {
            front_face: wgpu::FrontFace::Ccw,
            // Of a prism the far sides are drawn, so that an eye inside sees its page.
            cull_mode: Some(match pages {
                None => wgpu::Face::Back,
                Some(_) => wgpu::Face::Front,
            }),
            polygon_mode: match look.wireframe {
                false => wgpu::PolygonMode::Fill,
                true => wgpu::PolygonMode::Line,
            },
            ..Default::default()
        },
        format,
        writes_depth: true,
        blend: None,
    }
    .create(device);
    Ok(Assembled {
        variant: shader,
        pipeline,
        bind_group,
        shader_bytes,
    })
}

/// The shader with what follows from the form of the ground.
fn variant(
    look: &SurfaceLook<'_>,
    has_tiles: bool,
    others: &[(&'static str, bool)],
) -> ShaderVariant {
    let is_cast = matches!(look.ground, Some(DrawKind::ContourPages(_)));
    let of_ground = [
        ("tiles", has_tiles),
        ("relief", look.ground.is_some()),
        ("crossing", has_tiles && look.crossing),
        ("grid", matches!(look.ground, Some(DrawKind::Grid(_)))),
        ("cast", is_cast),
        // Where rays are cast, the shader says itself how deep a pixel lies.
        ("depth", is_cast && look.format.depth != DepthBuffer::None),
    ];
    ShaderVariant::new(super::EARTH_SHADER, &[&of_ground, others].concat())
}

/// The shader that draws pictures.
fn color_variant(maps: &Maps, look: &SurfaceLook<'_>, has_tiles: bool) -> ShaderVariant {
    let paper = look.shading == Shading::Paper;
    let stores_display_values = look.format.stores_display_values();
    variant(
        look,
        has_tiles,
        &[
            ("paper", paper),
            ("clouds", maps.has(MapLayer::Clouds)),
            ("normals", maps.has(MapLayer::Normals)),
            ("night_lights", maps.has(MapLayer::NightLights)),
            // The paper's shading has no glint.
            ("water", !paper && maps.has(MapLayer::Water)),
            ("air", look.sunlight.is_some()),
            ("encode", !paper && stores_display_values),
            ("decode", paper && !stores_display_values),
        ],
    )
}

/// Linear, clamped: for tables that end on texel centres.
pub(super) fn table_sampler(device: &wgpu::Device) -> wgpu::Sampler {
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("terrella tables"),
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..Default::default()
    })
}
