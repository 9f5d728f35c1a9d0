//! The drawable of the surface: blocks of a lattice, patches of ground with relief, a grid, or pages that rays are cast at, one
//! indexed draw each. What all views share stands here, what each has of its own in `surface_view.rs`.

use super::maps::Maps;
use super::mesh::SurfaceMesh;
use super::shader::{
    EarthOutput, EarthVariant, PaperLayers, ShaderModule, ShaderVariant, ShadingVariant,
    SunlitLayers, TruthLayers,
};
use super::surface_config::SurfaceConfig;
use super::surface_view::{PassGroups, SurfaceView};
use super::tiles::{TILES_BYTES, TileTextures};
use super::{AirSide, Binding, BlockTiles, FramePlan, FrameUniforms, SurfaceLightUniforms};
use super::{PipelineDescription, ShaderError, SurfaceOutput};
use crate::globe::{Block, BlockSet, Shading};
use crate::imagery::EarthLayers;
use crate::imagery::residency::{Pool, Upload};
use crate::imagery::tile::MapLayer;

pub(crate) struct SurfaceDrawable {
    assembled: Assembled,
    maps: Maps,
    imagery: Imagery,
    /// What the shader is told of the surface's light, whatever frame and view.
    light: wgpu::Buffer,
    /// Whether triangles that lie in several blocks are drawn with the tiles of each.
    crossing: bool,
    pub texture_bytes: u64,
}

/// What follows from a configuration.
#[derive(Default)]
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
    /// Of group 0, which each view binds of its own.
    layout: wgpu::BindGroupLayout,
    shader_bytes: u64,
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
    /// Uploads the maps. `pools` are those of tiles, if blocks are drawn with tiles; `first` is a view of it, which is bound.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        layers: &EarthLayers,
        pools: Option<&[Pool]>,
        config: &SurfaceConfig<'_>,
        first: &mut SurfaceView,
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
        let light = super::uniform_buffer::<SurfaceLightUniforms>(device, "terrella surface light");
        queue.write_buffer(&light, 0, bytemuck::bytes_of(&config.light));
        let mut drawable = Self {
            assembled: Assembled::default(),
            maps,
            imagery,
            light,
            crossing: config.crosses_blocks && pools.is_some(),
            texture_bytes,
        };
        drawable.assemble(device, config, first)?;
        Ok(drawable)
    }

    /// Draws from now on with this configuration, and binds this view for it; others have to be bound before they are drawn.
    /// Maps and tiles stay where they are.
    ///
    /// Nothing may be drawn until the next frame is written.
    pub fn set_config(
        &mut self,
        device: &wgpu::Device,
        config: &SurfaceConfig<'_>,
        first: &mut SurfaceView,
    ) -> Result<(), ShaderError> {
        self.maps.arrange(device, config.shown, config.anisotropy);
        self.bind_maps(device);
        self.assemble(device, config, first)
    }

    fn bind_maps(&mut self, device: &wgpu::Device) {
        match &mut self.imagery {
            Imagery::Tiles { tiles, whole } => {
                tiles.bind_again(device, &self.maps);
                *whole = self.maps.bind_whole(device);
            }
            Imagery::Whole(bind_group) => *bind_group = self.maps.bind_whole(device),
        }
    }

    /// Makes pipelines for a configuration, and binds a view for them.
    fn assemble(
        &mut self,
        device: &wgpu::Device,
        config: &SurfaceConfig<'_>,
        first: &mut SurfaceView,
    ) -> Result<(), ShaderError> {
        let sides = AirSide::of_air(config.air.is_some());
        let mut passes = Vec::with_capacity(sides.len());
        for &side in sides {
            let all = EarthVariant {
                form: first.mesh().vertex_form(self.has_tiles()),
                output: output(&self.maps, config, side),
            };
            let pass = |variant| self.pass(device, config, variant, first);
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
        self.assembled = Assembled {
            shader_bytes: drawn.map(|pass| pass.shader_bytes).sum(),
            passes,
        };
        self.bind_view(device, config, first);
        Ok(())
    }

    /// Binds what a view is drawn with.
    pub fn bind_view(
        &self,
        device: &wgpu::Device,
        config: &SurfaceConfig<'_>,
        view: &mut SurfaceView,
    ) {
        let group = |pass: &SurfacePass| {
            let bindings = self.bindings(view, config, &pass.variant);
            super::bind_to(device, "terrella earth", &pass.layout, bindings)
        };
        let passes = self.assembled.passes.iter();
        let groups = passes.map(|passes| PassGroups {
            all: group(&passes.all),
            daylit: passes.daylit.as_ref().map(group),
            eclipsed: passes.eclipsed.as_ref().map(group),
        });
        let groups = groups.collect();
        view.set_groups(groups);
    }

    fn has_tiles(&self) -> bool {
        matches!(self.imagery, Imagery::Tiles { .. })
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

    /// Has blocks drawn from now on with these tiles, and finds out which of them have any, where triangles lie in several. Answers the
    /// bytes written.
    pub fn choose_tiles(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        chosen: &[(Block, BlockTiles)],
    ) -> u64 {
        let Imagery::Tiles { tiles, .. } = &mut self.imagery else {
            return 0;
        };
        for (block, chosen) in chosen {
            tiles.choose(device, &self.maps, *block, *chosen);
        }
        if self.crossing {
            tiles.find_tiled(chosen.iter().map(|(block, _)| *block));
        }
        tiles.flush(queue)
    }

    /// The blocks that have tiles, where triangles lie in several.
    pub fn tiled(&self) -> Option<BlockSet> {
        match &self.imagery {
            Imagery::Tiles { tiles, .. } if self.crossing => Some(tiles.tiled()),
            _ => None,
        }
    }

    /// Draws the plan that was written to a view last.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>, view: &SurfaceView, plan: &FramePlan) {
        let side = plan.air.as_ref().map_or(0, |air| air.side() as usize);
        let Some((passes, groups)) = self.assembled.passes.get(side).zip(view.groups(side)) else {
            return;
        };
        type Drawn<'a> = (&'a SurfacePass, &'a wgpu::BindGroup);
        let choose = |pass: &mut wgpu::RenderPass<'_>, (drawn, group): Drawn<'_>| {
            pass.set_pipeline(&drawn.pipeline);
            pass.set_bind_group(0, group, &[]);
        };
        let all = (&passes.all, &groups.all);
        let daylit = passes.daylit.as_ref().zip(groups.daylit.as_ref());
        let eclipsed = passes.eclipsed.as_ref().zip(groups.eclipsed.as_ref());
        let eclipsed = eclipsed.filter(|_| plan.has_moon_shadow);
        choose(pass, eclipsed.unwrap_or(all));
        let mut is_daylit = false;
        let mut by_light = |pass: &mut wgpu::RenderPass<'_>, block: Option<Block>| {
            let Some(daylit) = daylit.filter(|_| eclipsed.is_none()) else {
                return;
            };
            let wanted = block.is_some_and(|block| plan.daylit.contains(block.index() as u8));
            if wanted != is_daylit {
                is_daylit = wanted;
                choose(pass, if wanted { daylit } else { all });
            }
        };
        let mesh: &dyn SurfaceMesh = view.mesh();
        match &self.imagery {
            Imagery::Whole(maps) => {
                pass.set_bind_group(1, maps, &[]);
                mesh.render(pass, plan, &mut by_light);
            }
            Imagery::Tiles { tiles, whole } => mesh.render(pass, plan, &mut |pass, block| {
                by_light(pass, block);
                let maps = block.map_or(whole, |block| tiles.bind_group(block));
                pass.set_bind_group(1, maps, &[]);
            }),
        }
    }

    /// Makes what one variant of the shader is drawn with, in the form of a view's mesh.
    fn pass(
        &self,
        device: &wgpu::Device,
        config: &SurfaceConfig<'_>,
        variant: EarthVariant,
        view: &SurfaceView,
    ) -> Result<SurfacePass, ShaderError> {
        let shader = ShaderModule::new(device, &variant)?;
        let bindings = self.bindings(view, config, &variant);
        let layout = super::layout_of(device, "terrella earth", &bindings);
        let mesh = view.mesh();
        let pipeline = PipelineDescription {
            label: "terrella earth",
            bind_groups: Some(&[Some(&layout), Some(self.maps.layout())]),
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
            layout,
            shader_bytes: shader.bytes,
        })
    }

    /// Group 0 of a view.
    fn bindings<'a>(
        &'a self,
        view: &'a SurfaceView,
        config: &SurfaceConfig<'a>,
        variant: &EarthVariant,
    ) -> Vec<Binding<'a>> {
        let both = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let mut bindings = vec![(
            super::uniform_entry(0, both, size_of::<FrameUniforms>()),
            wgpu::BindGroupEntry {
                binding: 0,
                resource: view.uniforms().as_entire_binding(),
            },
        )];
        if let Some((air, side)) = config.air.zip(variant.air()) {
            bindings.extend(air.bindings(side));
            if config.shading == Shading::Sunlit {
                bindings.push(air.sunlight_binding());
            }
        }
        let fragment = wgpu::ShaderStages::FRAGMENT;
        if let Imagery::Tiles { tiles, .. } = &self.imagery {
            bindings.push((
                super::uniform_entry(3, fragment, TILES_BYTES),
                wgpu::BindGroupEntry {
                    binding: 3,
                    resource: tiles.placements().as_entire_binding(),
                },
            ));
        }
        if variant.conditions_met().contains(&"surface_light") {
            bindings.push((
                super::uniform_entry(12, fragment, size_of::<SurfaceLightUniforms>()),
                wgpu::BindGroupEntry {
                    binding: 12,
                    resource: self.light.as_entire_binding(),
                },
            ));
        }
        bindings.extend(view.mesh().bindings());
        bindings
    }
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
