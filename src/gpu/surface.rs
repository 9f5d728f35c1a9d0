//! The drawable of the surface: blocks of a lattice, patches of ground with relief, a grid, or pages that rays are cast at, one
//! indexed draw each.

use super::lattice::Lattice;
use super::maps::Maps;
use super::mesh::{DrawCosts, SurfaceMesh};
use super::relief;
use super::shader::{
    EarthOutput, EarthVariant, PaperLayers, ShaderModule, ShaderVariant, ShadingVariant,
    SunlitLayers, TruthLayers,
};
use super::surface_config::SurfaceConfig;
use super::tiles::{TILES_BYTES, TileTextures};
use super::{AirSide, Binding, FramePlan, FrameUniforms, SurfaceLightUniforms};
use super::{PipelineDescription, ShaderError, SurfaceOutput};
use crate::globe::{Block, BlockGrid, Shading, Surface};
use crate::imagery::EarthLayers;
use crate::imagery::residency::{Pool, Upload};
use crate::imagery::tile::MapLayer;

pub(crate) struct SurfaceDrawable {
    assembled: Assembled,
    mesh: Box<dyn SurfaceMesh + Send + Sync>,
    maps: Maps,
    imagery: Imagery,
    uniforms: Uniforms,
    /// Whether triangles that lie in several blocks are drawn with the tiles of each.
    crossing: bool,
    pub texture_bytes: u64,
}

/// What follows from a configuration.
struct Assembled {
    /// One without air; else that of an eye outside of it, and that of an eye inside.
    passes: Vec<SurfacePasses>,
    shader_bytes: u64,
}

/// How the surface is drawn from one side of the air.
struct SurfacePasses {
    all: SurfacePass,
    /// Without what shows by night alone, if there is any: for blocks by day.
    daylit: Option<SurfacePass>,
    /// For frames that the Moon's shadow is in.
    eclipsed: Option<SurfacePass>,
}

struct SurfacePass {
    variant: EarthVariant,
    pipeline: wgpu::RenderPipeline,
    bind_group: wgpu::BindGroup,
    shader_bytes: u64,
}

/// What the shader is told beside textures.
struct Uniforms {
    /// Of each frame.
    frame: wgpu::Buffer,
    /// Of the surface's light, whatever the frame.
    light: wgpu::Buffer,
}

/// What blocks are drawn with.
enum Imagery {
    /// All with the whole maps.
    Whole(wgpu::BindGroup),
    /// Each with tiles of its own.
    Tiles {
        tiles: TileTextures,
        /// All maps whole, for what lies in several blocks or in one without tiles.
        whole: wgpu::BindGroup,
    },
}

impl SurfaceDrawable {
    /// Uploads the maps. `pools` are those of tiles, if blocks are drawn with tiles.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        grids: &[BlockGrid],
        layers: &EarthLayers,
        pools: Option<&[Pool]>,
        config: &SurfaceConfig<'_>,
    ) -> Result<Self, ShaderError> {
        let display_values = config.shading == Shading::Paper;
        let maps = Maps::upload(
            device,
            queue,
            layers,
            display_values,
            config.shown,
            config.anisotropy,
        );
        let imagery = match pools {
            Some(pools) => Imagery::Tiles {
                tiles: TileTextures::new(device, &maps, pools, display_values),
                whole: maps.bind_whole(device),
            },
            None => Imagery::Whole(maps.bind_whole(device)),
        };
        let tile_bytes = match &imagery {
            Imagery::Tiles { tiles, .. } => tiles.bytes,
            Imagery::Whole(_) => 0,
        };
        let texture_bytes = maps.bytes() + tile_bytes;
        let uniforms = Uniforms {
            frame: super::uniform_buffer::<FrameUniforms>(device, "terrella frame"),
            light: super::uniform_buffer::<SurfaceLightUniforms>(device, "terrella surface light"),
        };
        queue.write_buffer(&uniforms.light, 0, bytemuck::bytes_of(&config.light));
        let mesh: Box<dyn SurfaceMesh + Send + Sync> = match &config.ground {
            None => Box::new(Lattice::new(device, grids)),
            Some(form) => relief::mesh(device, form, config),
        };
        let assembled = assemble(device, &maps, &imagery, &uniforms, mesh.as_ref(), config)?;
        Ok(Self {
            assembled,
            mesh,
            maps,
            imagery,
            uniforms,
            crossing: config.crosses_blocks && pools.is_some(),
            texture_bytes,
        })
    }

    /// Draws from now on with this configuration and these grids. Maps and tiles stay where they are.
    ///
    /// Nothing may be drawn until the next frame is written.
    pub fn set_config(
        &mut self,
        device: &wgpu::Device,
        grids: &[BlockGrid],
        config: &SurfaceConfig<'_>,
    ) -> Result<(), ShaderError> {
        self.maps.arrange(device, config.shown, config.anisotropy);
        match &mut self.imagery {
            Imagery::Tiles { tiles, whole } => {
                tiles.bind_again(device, &self.maps);
                *whole = self.maps.bind_whole(device);
            }
            Imagery::Whole(bind_group) => *bind_group = self.maps.bind_whole(device),
        }
        self.assembled = assemble(
            device,
            &self.maps,
            &self.imagery,
            &self.uniforms,
            self.mesh.as_ref(),
            config,
        )?;
        self.mesh.reset(device, grids);
        Ok(())
    }

    /// What shaders of the surface have.
    pub fn features(&self) -> Vec<&'static str> {
        let Some(first) = self.assembled.passes.first() else {
            return Vec::new();
        };
        let mut features = first.all.variant.conditions_met();
        features.extend(first.eclipsed.as_ref().map(|_| "eclipses"));
        features
    }

    /// Bytes of their texts as the driver gets them.
    pub fn shader_bytes(&self) -> u64 {
        self.assembled.shader_bytes
    }

    /// Writes a part of a tile; does nothing where whole maps are drawn.
    pub fn write_tile(&self, queue: &wgpu::Queue, part: &Upload<'_>) {
        if let Imagery::Tiles { tiles, .. } = &self.imagery {
            tiles.write(queue, part);
        }
    }

    /// Writes what all drawables of a frame read.
    pub fn write_frame(&self, queue: &wgpu::Queue, uniforms: &FrameUniforms) {
        queue.write_buffer(&self.uniforms.frame, 0, bytemuck::bytes_of(uniforms));
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
        self.write_frame(queue, &plan.uniforms);
        let mut written = size_of::<FrameUniforms>() as u64;
        let mut tiled = None;
        if let Imagery::Tiles { tiles, .. } = &mut self.imagery {
            for (block, chosen) in &plan.tiles {
                tiles.choose(device, &self.maps, *block, *chosen);
            }
            if self.crossing {
                tiles.find_tiled(&plan.blocks);
                tiled = Some(tiles.tiled());
            }
            written += tiles.flush(queue);
        }
        written + self.mesh.write(queue, plan, ground, tiled)
    }

    /// What the frame that was written last costs, of ground with relief; `None` of blocks.
    pub fn ground_costs(&self) -> Option<DrawCosts> {
        self.mesh.ground_costs()
    }

    /// Draws the plan that was written last.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>, plan: &FramePlan) {
        let side = plan.air.as_ref().map_or(0, |air| air.side() as usize);
        let Some(passes) = self.assembled.passes.get(side) else {
            return;
        };
        let choose = |pass: &mut wgpu::RenderPass<'_>, drawn: &SurfacePass| {
            pass.set_pipeline(&drawn.pipeline);
            pass.set_bind_group(0, &drawn.bind_group, &[]);
        };
        let eclipsed = passes.eclipsed.as_ref().filter(|_| plan.has_moon_shadow);
        choose(pass, eclipsed.unwrap_or(&passes.all));
        let mut is_daylit = false;
        let mut by_light = |pass: &mut wgpu::RenderPass<'_>, block: Option<Block>| {
            let Some(daylit) = passes.daylit.as_ref().filter(|_| eclipsed.is_none()) else {
                return;
            };
            let wanted = block.is_some_and(|block| plan.daylit.contains(block.index() as u8));
            if wanted != is_daylit {
                is_daylit = wanted;
                choose(pass, if wanted { daylit } else { &passes.all });
            }
        };
        match &self.imagery {
            Imagery::Whole(maps) => {
                pass.set_bind_group(1, maps, &[]);
                self.mesh.render(pass, plan, &mut by_light);
            }
            Imagery::Tiles { tiles, whole } => self.mesh.render(pass, plan, &mut |pass, block| {
                by_light(pass, block);
                let maps = block.map_or(whole, |block| tiles.bind_group(block));
                pass.set_bind_group(1, maps, &[]);
            }),
        }
    }
}

/// Makes what a configuration needs.
fn assemble(
    device: &wgpu::Device,
    maps: &Maps,
    imagery: &Imagery,
    uniforms: &Uniforms,
    mesh: &dyn SurfaceMesh,
    config: &SurfaceConfig<'_>,
) -> Result<Assembled, ShaderError> {
    let sides = AirSide::of_air(config.air.is_some());
    let mut passes = Vec::with_capacity(sides.len());
    for &side in sides {
        let all = EarthVariant {
            form: mesh.vertex_form(matches!(imagery, Imagery::Tiles { .. })),
            output: output(maps, config, side),
        };
        let pass = |variant| surface_pass(device, maps, imagery, uniforms, mesh, config, variant);
        let eclipsed = all.eclipsed().filter(|_| config.eclipses);
        passes.push(SurfacePasses {
            all: pass(all)?,
            daylit: all.daylit().map(pass).transpose()?,
            eclipsed: eclipsed.map(pass).transpose()?,
        });
    }
    let drawn = passes.iter();
    let drawn = drawn.flat_map(|passes| {
        let others = passes.daylit.iter().chain(&passes.eclipsed);
        std::iter::once(&passes.all).chain(others)
    });
    Ok(Assembled {
        shader_bytes: drawn.map(|pass| pass.shader_bytes).sum(),
        passes,
    })
}

/// Makes what one variant of the shader is drawn with.
fn surface_pass(
    device: &wgpu::Device,
    maps: &Maps,
    imagery: &Imagery,
    uniforms: &Uniforms,
    mesh: &dyn SurfaceMesh,
    config: &SurfaceConfig<'_>,
    variant: EarthVariant,
) -> Result<SurfacePass, ShaderError> {
    let shader = ShaderModule::new(device, &variant)?;
    let bindings = bindings(imagery, uniforms, mesh, config, &variant);
    let (layout, bind_group) = super::bind(device, "terrella earth", bindings);
    let pipeline = PipelineDescription {
        label: "terrella earth",
        bind_groups: Some(&[Some(&layout), Some(maps.layout())]),
        module: &shader.module,
        buffers: mesh.buffers(),
        primitive: wgpu::PrimitiveState {
            front_face: wgpu::FrontFace::Ccw,
            cull_mode: Some(mesh.culled()),
            polygon_mode: match config.wireframe {
                false => wgpu::PolygonMode::Fill,
                true => wgpu::PolygonMode::Line,
            },
            ..Default::default()
        },
        format: config.format,
        writes_depth: true,
        blend: None,
    }
    .create(device);
    Ok(SurfacePass {
        variant,
        pipeline,
        bind_group,
        shader_bytes: shader.bytes,
    })
}

/// Group 0.
fn bindings<'a>(
    imagery: &'a Imagery,
    uniforms: &'a Uniforms,
    mesh: &'a dyn SurfaceMesh,
    config: &SurfaceConfig<'a>,
    variant: &EarthVariant,
) -> Vec<Binding<'a>> {
    let both = wgpu::ShaderStages::VERTEX_FRAGMENT;
    let mut bindings = vec![(
        super::uniform_entry(0, both, size_of::<FrameUniforms>()),
        wgpu::BindGroupEntry {
            binding: 0,
            resource: uniforms.frame.as_entire_binding(),
        },
    )];
    if let Some((air, side)) = config.air.zip(variant.air()) {
        bindings.extend(air.bindings(side));
        if config.shading == Shading::Sunlit {
            bindings.push(air.sunlight_binding());
        }
    }
    if let Imagery::Tiles { tiles, .. } = imagery {
        let fragment = wgpu::ShaderStages::FRAGMENT;
        bindings.push((
            super::uniform_entry(3, fragment, TILES_BYTES),
            wgpu::BindGroupEntry {
                binding: 3,
                resource: tiles.placements().as_entire_binding(),
            },
        ));
    }
    if variant.conditions_met().contains(&"surface_light") {
        let fragment = wgpu::ShaderStages::FRAGMENT;
        bindings.push((
            super::uniform_entry(12, fragment, size_of::<SurfaceLightUniforms>()),
            wgpu::BindGroupEntry {
                binding: 12,
                resource: uniforms.light.as_entire_binding(),
            },
        ));
    }
    bindings.extend(mesh.bindings());
    bindings
}

/// What the pixels of a configuration get, the eye being on this side of the air.
fn output(maps: &Maps, config: &SurfaceConfig<'_>, air: Option<AirSide>) -> EarthOutput {
    let clouds = maps.has(MapLayer::Clouds);
    let normals = maps.has(MapLayer::Normals);
    let shading = match config.shading {
        Shading::Paper => ShadingVariant::Paper(PaperLayers {
            clouds,
            normals,
            air,
        }),
        Shading::Sunlit => ShadingVariant::Sunlit(SunlitLayers {
            clouds,
            cloud_shadows: clouds && config.cloud_shadows,
            normals,
            night_lights: maps.has(MapLayer::NightLights),
            water: maps.has(MapLayer::Water),
            moonlight: config.moonlight,
            eclipse: false,
            detail: config.detail,
            air,
        }),
    };
    match config.output {
        SurfaceOutput::Color => EarthOutput::Picture(shading, config.format.target_color()),
        SurfaceOutput::Geolocation => EarthOutput::Geolocation,
        SurfaceOutput::Truth => EarthOutput::Truth(TruthLayers {
            clouds,
            normals,
            water: maps.has(MapLayer::Water),
        }),
    }
}
